// SPDX-License-Identifier: MIT
// Liquid fields at arbitrary points, for probes. Points near walls see the mirrored liquid.
#pragma once

#include "spume/methods/les_sph/liquid.hpp"
#include "spume/methods/method.hpp"

namespace spume::les_sph {

class PointSampler {
 public:
  // Bins the particles of the present state; call again when the liquid has moved.
  void update(const Liquid& liquid);
  std::int64_t step() const { return step_; }

  // Weighted linear fit of pressure and velocity over the particles in the support (Shepard average where they are
  // too few); coverage is the kernel sum.
  PointSample sample(const Liquid& liquid, const Vec3& point) const;
  double coverage(const Liquid& liquid, const Vec3& point) const;
  // Highest point of the column where the coverage reaches one half, found on steps of a quarter spacing and refined
  // by bisection; the bottom of the domain when there is none.
  double elevation(const Liquid& liquid, const Vec3& point) const;
  // Sum of the intervals of the column whose coverage is above one half, their ends found in the same way.
  double wetted_length(const Liquid& liquid, const Vec3& point) const;
  double front(const Liquid& liquid, int axis, double height) const;
  // Averages over samples one spacing apart on a plane across the domain, at the middles of equal cells; those whose
  // coverage is one half or more and that lie in no solid are the liquid part. Linear fields come out exact; the area
  // is a whole number of cells.
  PlaneSample plane_average(const Liquid& liquid, int axis, double position) const;

 private:
  // Where the coverage falls to one half between a wet point and a dry height.
  double crossing(const Liquid& liquid, Vec3 wet, double dry) const;
  // A dry point above all liquid in the column of `point`; returns the step of the search.
  double highest_sample(const Liquid& liquid, const Vec3& point, Vec3& sample) const;
  template <class Visit>
  void visit(const Liquid& liquid, const Vec3& point, Visit&& visit) const;

  CellOrder table_;
  std::int64_t step_ = -1;
};

}  // namespace spume::les_sph
