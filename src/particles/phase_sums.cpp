// SPDX-License-Identifier: MIT
#include "spume/particles/phase_sums.hpp"

#include "spume/core/parallel.hpp"

namespace spume {

void PhaseSums::find() {
  for (std::size_t n = 0; n < sums_.size(); ++n) sums_[n] = sums_of(n);
}

PhaseSums::Sums PhaseSums::sums_of(std::size_t phase) const {
  return parallel_reduce(
      particles_.size(), Sums{},
      [&](std::size_t first, std::size_t last) {
        Sums sums;
        for (std::size_t i = first; i < last; ++i) {
          if (static_cast<std::size_t>(phase_[i]) != phase || (left_out_ != nullptr && (*left_out_)[i] >= 0)) continue;
          const double mass = particles_.volume * density_[phase];
          sums.mass += mass;
          for (int axis = 0; axis < particles_.dimensions; ++axis) {
            sums.momentum[axis] += mass * (*particles_.velocity[axis])[i];
            const double x = (*particles_.position[axis])[i];
            sums.moment[axis] += mass * (domain_ == nullptr ? x : domain_->inside(axis, x));
          }
        }
        return sums;
      },
      [](Sums a, const Sums& b) {
        a.mass += b.mass;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          a.momentum[axis] += b.momentum[axis];
          a.moment[axis] += b.moment[axis];
        }
        return a;
      });
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
