// SPDX-License-Identifier: MIT
// Half steps of velocity Verlet, u' = u + dt/2 a and r' = r + dt/2 (u' + delta u): what the particles of a block go in
// them. Loops are over one axis and many particles with every pointer in a register, which takes several at a time: 5
// ns a particle in three dimensions where loops over the axes of one particle take 11.
#pragma once

#include <cstddef>

#include "spume/particles/store.hpp"

namespace spume {

struct HalfSteps {
  double dt = 0;  // of the whole step
  std::array<const double*, 3> position{}, velocity{};
  std::array<const float*, 3> acceleration{}, shift{};  // shift: velocity delta u; null: none

  double velocity_of(int axis, std::size_t i) const {
    return velocity[axis][i] + dt / 2 * acceleration[axis][i];
  }  // u'
  // dt/2 (u' + delta u), of u'.
  double way_of(int axis, std::size_t i, double u) const {
    return dt / 2 * (shift[axis] == nullptr ? u : u + shift[axis][i]);
  }
  // Where the second half ends if no wall holds the particle.
  double end_of(int axis, std::size_t i, double u) const {
    const double way = way_of(axis, i, u);
    return position[axis][i] + way + way;
  }

  // The same of particles first .. last - 1; what is written is none of what is read, or u' over u.
  void velocities(int axis, std::size_t first, std::size_t last, double* result) const;  // u'
  void middles(int axis, std::size_t first, std::size_t last, double* result) const;     // r'
  // From r' to the end of the step.
  void go_on(int axis, std::size_t first, std::size_t last, double* place) const;
  // u at the end of the step over u', and the acceleration there, `of_first` that of particle first: it is rounded
  // before it is used, since both halves of a step take what is kept between them.
  void finish(std::size_t first, std::size_t last, const double* of_first, float* after, double* u) const;
};

}  // namespace spume
