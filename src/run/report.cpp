// SPDX-License-Identifier: MIT
#include "spume/run/report.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "spume/core/machine.hpp"
#include "spume/physics/bubbles/options.hpp"
#include "spume/run/version.hpp"

namespace spume {
namespace {

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::string box_text(const Domain& domain) {
  std::string text;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(domain.dimensions); ++axis)
    text += (text.empty() ? "" : " x ") +
            ('[' + short_number(domain.lower[axis]) + ", " + short_number(domain.upper[axis]) + ']');
  return text + format(" (%d-D)", domain.dimensions);
}

std::string boundary_text(const Domain& domain) {
  static constexpr const char* kinds[] = {"periodic", "free-slip", "no-slip", "open"};
  std::string text;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(domain.dimensions); ++axis) {
    const auto& sides = domain.sides[axis];
    const std::string low = kinds[static_cast<int>(sides[0].kind)], high = kinds[static_cast<int>(sides[1].kind)];
    text += (axis == 0 ? "" : ", ") + std::string(1, "xyz"[axis]) + ' ' + (low == high ? low : low + '/' + high);
  }
  return text;
}

double finite(double value) {
  return std::isfinite(value) ? value : 0;
}

// JSON has no NaN and no infinity: such a value is written as null.
nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

std::string short_number(double value) {
  return format("%.4g", value);
}

std::string exact_number(double value) {
  return format("%.10g", value);
}

std::string human_bytes(double bytes) {
  static constexpr const char* units[] = {"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  while (bytes >= 1000 && unit + 1 < std::size(units)) bytes /= 1000, ++unit;
  return format(unit == 0 ? "%.0f %s" : "%.3g %s", bytes, units[unit]);
}

std::string human_duration(double seconds) {
  if (!std::isfinite(seconds)) return "--:--";
  const auto whole = static_cast<long long>(std::llround(std::max(seconds, 0.0)));
  if (whole >= 3600) return format("%lld:%02lld:%02lld", whole / 3600, whole / 60 % 60, whole % 60);
  return format("%02lld:%02lld", whole / 60, whole % 60);
}

// VmHWM is of this program alone; what getrusage counts begins with the memory of the program that started it.
std::int64_t peak_resident_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (long long kilobytes = 0; std::sscanf(line.c_str(), "VmHWM: %lld kB", &kilobytes) == 1) return kilobytes * 1024;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

// Before the first step a method has not made all of its arrays.
double needed_bytes(const LoadedCase& loaded, const Method& method, double resident) {
  double made = 0;
  for (const auto& array : method.arrays()) made += array.bytes;
  const auto count = static_cast<double>(method.particle_count());
  return resident + std::max(0.0, count * loaded.bytes_per_particle - made) + method.snapshot_bytes();
}

std::string start_table(const LoadedCase& loaded, const Method& method, int threads, const std::string& folder) {
  const Case& options = loaded.options;
  const Scene& scene = loaded.scene;
  const StepLimit limit = method.step_limit();
  std::string on, off;
  for (const auto& stage : method.plan()) {
    std::string& list = stage.on ? on : off;
    list += (list.empty() ? "" : ", ") + stage.name;
  }
  std::size_t width = 10;
  for (const auto& [name, value] : options.groups) width = std::max(width, name.size());
  const auto line = [&](const std::string& label, const std::string& value) {
    return "  " + label + std::string(width + 2 - label.size(), ' ') + value + '\n';
  };
  std::string text = "Spume " + program_version() + " (" + program_commit() + ")\n";
  text += line("case", options.title.empty() ? options.path : options.title + "  (" + options.path + ')');
  text += line("method", options.method);
  text += line("box", box_text(scene.domain));
  text += line("boundaries", boundary_text(scene.domain));
  if (scene.grid[0] > 0)
    text += line("grid", std::to_string(scene.grid[0]) + " x " + std::to_string(scene.grid[1]) + " x " +
                             std::to_string(scene.grid[2]) + " points");
  else
    text += line("particles", std::to_string(method.particle_count()) + ", spacing " + short_number(scene.spacing));
  for (const auto& [name, value] : options.groups)
    if (name != "particles") text += line(name, value);
  text += line("first step", format("%.3e, limited by %s", limit.dt, limit.limited_by.c_str()));
  text += line("until", short_number(options.time.end));
  text += line("on", on.empty() ? "nothing" : on);
  if (!off.empty()) text += line("off", off);
  text += line("threads", std::to_string(threads) + ", " + vector_instructions());
  text +=
      line("memory", "about " + human_bytes(needed_bytes(loaded, method, static_cast<double>(peak_resident_bytes()))) +
                         " of " + human_bytes(machine_memory_bytes()));
  text += line("seed", std::to_string(options.seed));
  if (!folder.empty()) text += line("results", folder);
  return text;
}

std::string plan_table(const std::vector<Stage>& plan) {
  std::size_t width = 5;
  for (const auto& stage : plan) width = std::max(width, stage.name.size());
  std::string text;
  for (const auto& stage : plan)
    text += format("  %-*s  %-3s  ", static_cast<int>(width), stage.name.c_str(), stage.on ? "on" : "off") +
            stage.reason + (of_the_start(stage.part) ? " (at the start only)\n" : "\n");
  return text;
}

std::string array_table(const std::vector<ArrayInfo>& arrays, std::size_t count, bool on_grid) {
  const std::string of_suspended = "all of particles";
  std::size_t width = of_suspended.size();
  ArrayInfo total{"total"}, suspended{of_suspended};
  for (const auto& array : arrays) {
    width = std::max(width, array.name.size());
    total.bytes += array.bytes;
    if (array.suspended > 0) suspended = {of_suspended, suspended.bytes + array.bytes, array.suspended};
  }
  std::string text;
  const auto row = [&](const ArrayInfo& array) {
    const std::size_t shared = array.suspended > 0 ? array.suspended : std::max<std::size_t>(count, 1);
    text += format("  %-*s  %10s  %8.1f B per %s\n", static_cast<int>(width), array.name.c_str(),
                   human_bytes(array.bytes).c_str(), array.bytes / static_cast<double>(shared),
                   on_grid && array.suspended == 0 ? "point" : "particle");
  };
  for (const auto& array : arrays) row(array);
  if (suspended.suspended > 0) row(suspended);
  row(total);
  return text;
}

std::string ledger_table(const Ledger& ledger, double wall_seconds) {
  std::size_t width = 5;
  for (const auto& entry : ledger.entries()) width = std::max(width, entry.stage.size());
  std::string text = format("  %-*s %9s %10s %7s %14s %9s\n", static_cast<int>(width), "stage", "calls", "seconds",
                            "share", "cost", "GB/s");
  for (const auto& entry : ledger.entries()) {
    const double ns = entry.seconds * 1e9;
    const std::string cost = entry.pairs > 0       ? format("%.3g ns/pair", ns / entry.pairs)
                             : entry.particles > 0 ? format("%.3g ns/part", ns / entry.particles)
                                                   : "-";
    const std::string rate = entry.bytes > 0 ? format("%.3g", entry.bytes / ns) : "-";
    text += format("  %-*s %9lld %10.3f %6.1f%% %14s %9s\n", static_cast<int>(width), entry.stage.c_str(),
                   static_cast<long long>(entry.calls), entry.seconds, finite(100 * entry.seconds / wall_seconds),
                   cost.c_str(), rate.c_str());
  }
  return text;
}

std::string ledger_json(const Ledger& ledger, double wall_seconds) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::array();
  for (const auto& entry : ledger.entries())
    stages.push_back({{"stage", entry.stage},
                      {"calls", entry.calls},
                      {"seconds", entry.seconds},
                      {"share", finite(entry.seconds / wall_seconds)},
                      {"particles", entry.particles},
                      {"pairs", entry.pairs},
                      {"bytes", entry.bytes}});
  return nlohmann::ordered_json{{"wall_seconds", wall_seconds}, {"stages", stages}}.dump(2) + '\n';
}

std::string summary_json(const LoadedCase& loaded, const RunFigures& figures) {
  const double particles = static_cast<double>(std::max<std::size_t>(figures.particles, 1));
  const ArrayStatistics arrays = array_statistics();
  const double resident = static_cast<double>(peak_resident_bytes());
  nlohmann::ordered_json values = nlohmann::ordered_json::object();
  for (const auto& [name, value] : figures.final_values) values[name] = number(value);
  nlohmann::ordered_json verdicts = nlohmann::ordered_json::array();
  for (const Verdict& one : figures.verdicts)
    verdicts.push_back({{"quantity", one.quantity},
                        {"value", number(one.value)},
                        {"bound", one.bound},
                        {"verdict", one.pass() ? "pass" : "FAIL"}});
  // Scales that follow from the case, for those who read the results.
  nlohmann::ordered_json derived = nlohmann::ordered_json::object();
  if (const auto* gas = loaded.options.find<BubbleOptions>(); gas != nullptr && gas->on) {
    if (gas->tension > 0) derived["surface_tension_over_density"] = gas->tension;
    if (gas->hinze_radius > 0) derived["hinze_radius"] = gas->hinze_radius;
  }
  const nlohmann::ordered_json summary = {
      {"title", loaded.options.title},
      {"case", figures.case_file},
      {"method", loaded.options.method},
      {"state", figures.state},
      {"message", figures.message},
      {"time", figures.time},
      {"end", figures.end},
      {"steps", figures.steps},
      {"retries", figures.retries},
      {"particles", figures.particles},
      {"spacing", loaded.scene.spacing},
      {"derived", derived},
      {"final", values},
      {"verdicts", verdicts},
      {"program_version", program_version()},
      {"commit", program_commit()},
      {"threads", figures.threads},
      {"vector_instructions", vector_instructions()},
      {"seed", loaded.options.seed},
      {"wall_seconds", figures.wall_seconds},
      {"total_wall_seconds", figures.total_wall_seconds},
      {"steps_this_process", figures.steps_this_run},
      {"particle_steps_per_second", finite(figures.particle_steps / figures.wall_seconds)},
      {"peak_array_bytes", arrays.peak_bytes},
      {"peak_array_bytes_per_particle", static_cast<double>(arrays.peak_bytes) / particles},
      {"peak_resident_bytes", resident},
      {"peak_resident_bytes_per_particle", resident / particles}};
  return summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

}  // namespace spume
