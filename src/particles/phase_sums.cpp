// SPDX-License-Identifier: MIT
#include "spume/particles/phase_sums.hpp"

#include <array>

#include "spume/core/parallel.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/core/unrolled.hpp"

namespace spume {
namespace {

std::vector<double> densities_of(const Scene& scene) {
  std::vector<double> densities;
  for (const Phase& phase : scene.phases) densities.push_back(phase.density);
  return densities;
}

}  // namespace

PhaseSums::PhaseSums(const ParticleStore& particles, const Array<std::int64_t>& phase, const Scene& scene,
                     const Array<std::int64_t>* left_out)
    : PhaseSums(particles, phase, densities_of(scene), left_out) {}

void PhaseSums::find() {
  sums_ = parallel_reduce(
      particles_.size(), std::vector<Sums>(sums_.size()),
      [&](std::size_t first, std::size_t last) {
        return particles_.dimensions == 2 ? sums_of<2>(first, last) : sums_of<3>(first, last);
      },
      [](std::vector<Sums> a, const std::vector<Sums>& b) {
        for (std::size_t n = 0; n < a.size(); ++n) {
          a[n].mass += b[n].mass;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            a[n].momentum[axis] += b[n].momentum[axis];
            a[n].moment[axis] += b[n].moment[axis];
          }
        }
        return a;
      });
}

// Runs of one phase, whose sums stay in registers; a loop over the particles for each phase reads them all each time.
template <int dimensions>
std::vector<PhaseSums::Sums> PhaseSums::sums_of(std::size_t first, std::size_t last) const {
  std::vector<Sums> sums(sums_.size());
  const auto x = read(particles_.position), u = read(particles_.velocity);
  const std::int64_t* const phase = phase_.data();
  const std::int64_t* const left_out = left_out_ == nullptr ? nullptr : left_out_->data();
  std::array<double, dimensions> lower{}, length{};  // 0: not periodic
  for (int axis = 0; axis < dimensions; ++axis) {
    if (domain_ == nullptr || !domain_->periodic(axis)) continue;
    lower[axis] = domain_->lower[axis];
    length[axis] = domain_->upper[axis] - lower[axis];
  }
  for (std::size_t i = first; i < last;) {
    std::size_t to = sums.size() == 1 ? last : i + 1;
    const auto n = static_cast<std::size_t>(sums.size() == 1 ? 0 : phase[i]);
    while (to < last && phase[to] == phase[i]) ++to;
    Sums run = sums[n];
    const double mass = particles_.volume * density_[n];
    for (; i < to; ++i) {
      if (left_out != nullptr && left_out[i] >= 0) continue;
      run.mass += mass;
      unrolled<dimensions>([&](auto axis) {
        run.momentum[axis] += mass * u[axis][i];
        const double at = x[axis][i];
        run.moment[axis] += mass * (length[axis] > 0 ? wrap_periodic(at, lower[axis], length[axis]) : at);
      });
    }
    sums[n] = run;
  }
  return sums;
}

void PhaseSums::add_columns(SeriesTable& series, std::size_t phase, const std::string& name) const {
  const std::string axes = "xyz";
  const auto d = static_cast<std::size_t>(particles_.dimensions);
  for (std::size_t axis = 0; axis < d; ++axis)
    series.add("centre_" + name + "_" + axes[axis], "length",
               [this, phase, axis] { return sums_[phase].moment[axis] / sums_[phase].mass; });
  for (std::size_t axis = 0; axis < d; ++axis)
    series.add("velocity_" + name + "_" + axes[axis], "length/time, mean",
               [this, phase, axis] { return sums_[phase].momentum[axis] / sums_[phase].mass; });
}

}  // namespace spume
