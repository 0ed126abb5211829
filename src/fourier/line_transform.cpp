// SPDX-License-Identifier: MIT
#include "spume/fourier/line_transform.hpp"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "fftw.hpp"
#include "spume/core/array.hpp"
#include "spume/fourier/mode_layout.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;

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

template <class T>
struct PlanPair {
  typename fftw::Api<T>::Plan forward = nullptr, inverse = nullptr;
  PlanPair() = default;
  PlanPair(const PlanPair&) = delete;
  PlanPair& operator=(const PlanPair&) = delete;
  ~PlanPair() {
    const std::lock_guard lock(fftw::planner_mutex());
    fftw::Api<T>::destroy(forward);
    fftw::Api<T>::destroy(inverse);
  }
};

}  // namespace

template <class T>
struct LaneTransform<T>::Plans : PlanPair<T> {
  using PlanPair<T>::forward, PlanPair<T>::inverse;
  Plans(std::size_t n, Planning planning) {
    Array<std::complex<T>> buffer(n * lanes<T>);
    auto* const line = fftw::pointer(buffer.data());
    const int size = static_cast<int>(n), count = static_cast<int>(lanes<T>);
    make_plans<T>(planning, forward, inverse, [&](unsigned flags) {
      const auto make = [&](int sign) {
        return fftw::Api<T>::many(1, &size, count, line, nullptr, count, 1, line, nullptr, count, 1, sign, flags);
      };
      forward = make(FFTW_FORWARD);
      inverse = make(FFTW_BACKWARD);
    });
  }
};

template <class T>
LaneTransform<T>::LaneTransform(std::size_t n, Planning planning)
    : n_(n), plans_(std::make_shared<const Plans>(n, planning)) {}

template <class T>
void LaneTransform<T>::inverse(std::complex<T>* buffer) const {
  fftw::Api<T>::execute(plans_->inverse, fftw::pointer(buffer), fftw::pointer(buffer));
}

template <class T>
void LaneTransform<T>::forward(std::complex<T>* buffer) const {
  fftw::Api<T>::execute(plans_->forward, fftw::pointer(buffer), fftw::pointer(buffer));
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
