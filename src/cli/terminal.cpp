// SPDX-License-Identifier: MIT
#include "spume/cli/terminal.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "spume/run/report.hpp"

namespace spume {
namespace {

using namespace std::chrono_literals;
constexpr auto live_interval = 200ms;
constexpr auto plain_interval = 10s;

std::string short_exponent(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  std::string number = text;
  const auto digits = number.find('e') + 2;
  while (digits + 1 < number.size() && number[digits] == '0') number.erase(digits, 1);
  return number;
}

}  // namespace

std::string progress_line(const Progress& progress) {
  // Time with as many decimals as show about a thousandth of the run.
  const int decimals =
      progress.end > 0 ? std::clamp(3 - static_cast<int>(std::floor(std::log10(progress.end))), 0, 9) : 3;
  char text[256];
  std::snprintf(text, sizeof text, "step %lld  t %.*f/%.*f  dt %s (%s)  %.2g Mp-steps/s  ETA %s",
                static_cast<long long>(progress.step), decimals, progress.time, decimals, progress.end,
                short_exponent(progress.dt).c_str(), progress.limited_by.c_str(),
                progress.particle_steps_per_second / 1e6, human_duration(progress.remaining_seconds).c_str());
  return text;
}

TerminalObserver::TerminalObserver(bool quiet)
    : quiet_(quiet), live_(::isatty(STDOUT_FILENO) != 0), shown_(std::chrono::steady_clock::now()) {}

void TerminalObserver::draw(const std::string& line) {
  if (live_)
    std::printf("\r\033[K%s", line.c_str());
  else
    std::printf("%s\n", line.c_str());
  flush();
  drawn_ = true;
}

// Whether a line is to be drawn now.
bool TerminalObserver::due() {
  if (quiet_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (now - shown_ < (live_ ? std::chrono::milliseconds(live_interval) : std::chrono::milliseconds(plain_interval)))
    return false;
  shown_ = now;
  return true;
}

void TerminalObserver::progress(const Progress& progress) {
  last_ = progress;
  if (due()) draw(progress_line(last_));
}

void TerminalObserver::preparing(Simulation& /*simulation*/, const std::string& how_far) {
  if (due()) draw("preparing: " + how_far);
}

void TerminalObserver::note(const std::string& text) {
  if (quiet_) return;
  std::printf("%s%s\n", live_ && drawn_ ? "\r\033[K" : "", text.c_str());
  flush();
}

// After a failed write, as to a closed terminal, nothing more is written.
void TerminalObserver::flush() {
  if (std::fflush(stdout) != 0) quiet_ = true;
}

void TerminalObserver::finish() {
  if (quiet_ || last_.step == 0) return;
  draw(progress_line(last_));
  if (live_) std::printf("\n");
}

}  // namespace spume
