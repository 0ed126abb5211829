// SPDX-License-Identifier: MIT
#include "spume/fourier/line_transform.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "fftw.hpp"
#include "lane_passes.hpp"
#include "lane_plan.hpp"
#include "spume/core/array.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;
using fourier::LanePass;
using fourier::PlanPair;

// Where wisdom is kept; empty when the user has no home.
fs::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return fs::path(cache) / "spume";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "spume";
  return {};
}

// Wisdom is a help, never a need: what cannot be read or written is planned anew.
template <class T>
class Wisdom {
 public:
  explicit Wisdom(Planning planning) {
    const fs::path folder = planning == Planning::measure ? cache_folder() : fs::path();
    if (folder.empty()) return;
    std::error_code ignored;
    fs::create_directories(folder, ignored);
    file_ = folder / (std::string("fftw-wisdom-") + fftw::Api<T>::name);
    static bool read = false;
    if (!read) fftw::Api<T>::import_wisdom(file_.c_str());
    read = true;
  }
  ~Wisdom() {
    if (file_.empty()) return;
    const fs::path fresh = file_.string() + ".new";
    std::error_code ignored;
    if (fftw::Api<T>::export_wisdom(fresh.c_str())) fs::rename(fresh, file_, ignored);
  }
  Wisdom(const Wisdom&) = delete;
  Wisdom& operator=(const Wisdom&) = delete;

 private:
  fs::path file_;
};

// Makes the two plans of a kind of line under the planner's lock.
template <class T, class Make>
void make_plans(Planning planning, typename fftw::Api<T>::Plan& forward, typename fftw::Api<T>::Plan& inverse,
                Make&& make) {
  const std::lock_guard lock(fftw::planner_mutex());
  const Wisdom<T> wisdom(planning);
  fftw::Api<T>::plan_for_one_thread();
  const unsigned flags = planning == Planning::measure ? FFTW_MEASURE : FFTW_ESTIMATE;
  make(flags);
  if (forward && inverse) return;
  if (forward) fftw::Api<T>::destroy(forward);
  if (inverse) fftw::Api<T>::destroy(inverse);
  throw std::runtime_error("FFTW has no plan for a line of a Fourier transform");
}

}  // namespace

std::mutex& fftw::planner_mutex() {
  static std::mutex mutex;
  return mutex;
}

namespace {

// Radices of a length, smallest first; empty where a prime above 5 divides it. As few passes as there can be, as
// passes through the first cache cost as much as the arithmetic: three twos make an 8, a two and a three a 6. At least
// two passes, the first of which may only load.
std::vector<int> radices(std::size_t n) {
  std::array<int, 3> power{};
  constexpr std::array<std::size_t, 3> prime{2, 3, 5};
  for (std::size_t f = 0; f < 3; ++f)
    for (; n % prime[f] == 0 && n > 0; n /= prime[f]) ++power[f];
  if (n != 1) return {};
  const auto passes_of_twos = [](int twos) { return (twos + 2) / 3; };
  int sixes = 0;
  for (int k = 1; k <= std::min(power[0], power[1]); ++k)
    if (passes_of_twos(power[0] - k) <= passes_of_twos(power[0] - sixes)) sixes = k;
  std::vector<int> result(static_cast<std::size_t>(sixes), 6);
  result.insert(result.end(), static_cast<std::size_t>(power[1] - sixes), 3);
  result.insert(result.end(), static_cast<std::size_t>(power[2]), 5);
  for (int twos = power[0] - sixes; twos > 0;) {
    const int taken = (twos + passes_of_twos(twos) - 1) / passes_of_twos(twos);
    result.push_back(1 << taken);
    twos -= taken;
  }
  std::sort(result.begin(), result.end());
  while (result.size() < 2) result.insert(result.begin(), 1);
  return result;
}

template <class T>
std::vector<LanePass<T>> own_passes(std::size_t n) {
  std::vector<LanePass<T>> passes;
  std::size_t rest = n, apart = 1;
  for (const int radix : radices(n)) {
    const std::size_t whole = rest, r = static_cast<std::size_t>(radix);
    rest /= r;
    LanePass<T>& pass = passes.emplace_back(LanePass<T>{radix, rest, apart, {}});
    pass.turns.resize(2 * (r - 1) * rest);
    std::size_t at = 0;
    for (std::size_t p = 0; p < rest; ++p)
      for (std::size_t k = 1; k < r; ++k) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(p * k) / static_cast<double>(whole);
        pass.turns[at++] = static_cast<T>(std::cos(angle));
        pass.turns[at++] = static_cast<T>(std::sin(angle));
      }
    apart *= r;
  }
  return passes;
}

}  // namespace

template <class T>
fourier::LanePlan<T>::LanePlan(std::size_t lines, Planning planning, LineKernels kernels) : n(lines) {
  if (kernels == LineKernels::own) passes = own_passes<T>(n);
  if (!passes.empty()) return;
  Array<std::complex<T>> buffer(n * lanes<T>);
  auto* const line = fftw::pointer(buffer.data());
  const int size = static_cast<int>(n), count = static_cast<int>(lanes<T>);
  make_plans<T>(planning, fftw_plans.forward, fftw_plans.inverse, [&](unsigned flags) {
    const auto make = [&](int sign) {
      return fftw::Api<T>::many(1, &size, count, line, nullptr, count, 1, line, nullptr, count, 1, sign, flags);
    };
    fftw_plans.forward = make(FFTW_FORWARD);
    fftw_plans.inverse = make(FFTW_BACKWARD);
  });
}

template <class T>
LaneTransform<T>::LaneTransform(std::size_t n, Planning planning, LineKernels kernels)
    : n_(n), plan_(std::make_shared<const fourier::LanePlan<T>>(n, planning, kernels)) {}

template <class T>
bool LaneTransform<T>::uses_fftw() const {
  return plan_->passes.empty();
}

template <class T>
std::size_t LaneTransform<T>::work_size() const {
  return plan_->work_size();
}

template <class T>
template <bool inverse>
void LaneTransform<T>::execute(const Complex* from, std::size_t from_stride, Complex* to, std::size_t to_stride,
                               Complex* work) const {
  using Lanes = fourier::Lanes<T>;
  using V = typename Lanes::V;
  const auto* const in = reinterpret_cast<const T*>(from);
  auto* const out = reinterpret_cast<T*>(to);
  fourier::transform<inverse>(
      *plan_,
      [=](std::size_t j, std::size_t at, V & real, V & imaginary)
          __attribute__((always_inline)) { Lanes::get_numbers(in + 2 * j * from_stride + at, real, imaginary); },
      [=](std::size_t j, std::size_t at, V real, V imaginary)
          __attribute__((always_inline)) { Lanes::put_numbers(out + 2 * j * to_stride + at, real, imaginary); },
      work);
}

template <class T>
void LaneTransform<T>::inverse(const Complex* from, std::size_t from_stride, Complex* to, std::size_t to_stride,
                               Complex* work) const {
  execute<true>(from, from_stride, to, to_stride, work);
}

template <class T>
void LaneTransform<T>::forward(const Complex* from, std::size_t from_stride, Complex* to, std::size_t to_stride,
                               Complex* work) const {
  execute<false>(from, from_stride, to, to_stride, work);
}

template <class T>
void LaneTransform<T>::inverse(Complex* buffer, Complex* work) const {
  execute<true>(buffer, lanes<T>, buffer, lanes<T>, work);
}

template <class T>
void LaneTransform<T>::forward(Complex* buffer, Complex* work) const {
  execute<false>(buffer, lanes<T>, buffer, lanes<T>, work);
}

template <class T>
struct RealLineTransform<T>::Plans : PlanPair<T> {
  using PlanPair<T>::forward, PlanPair<T>::inverse;
  Plans(std::size_t n, Planning planning) {
    Array<std::complex<T>> modes(n / 2 + 1);
    Array<T> values(n);
    auto* const line = fftw::pointer(modes.data());
    const int size = static_cast<int>(n), apart = size / 2 + 1;
    make_plans<T>(planning, forward, inverse, [&](unsigned flags) {
      flags |= FFTW_DESTROY_INPUT;
      forward = fftw::Api<T>::many_r2c(1, &size, 1, values.data(), nullptr, 1, size, line, nullptr, 1, apart, flags);
      inverse = fftw::Api<T>::many_c2r(1, &size, 1, line, nullptr, 1, apart, values.data(), nullptr, 1, size, flags);
    });
  }
};

template <class T>
RealLineTransform<T>::RealLineTransform(std::size_t n, Planning planning)
    : n_(n), plans_(std::make_shared<const Plans>(n, planning)) {}

template <class T>
void RealLineTransform<T>::inverse(std::complex<T>* modes, T* values) const {
  fftw::Api<T>::execute_c2r(plans_->inverse, fftw::pointer(modes), values);
}

template <class T>
void RealLineTransform<T>::forward(T* values, std::complex<T>* modes) const {
  fftw::Api<T>::execute_r2c(plans_->forward, values, fftw::pointer(modes));
}

template class LaneTransform<double>;
template class LaneTransform<float>;
template class RealLineTransform<double>;
template class RealLineTransform<float>;

}  // namespace spume
