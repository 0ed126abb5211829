// SPDX-License-Identifier: MIT
// Fields of particles at arbitrary points, for probes. Points near walls and solids see the mirrored liquid, and
// nothing behind a solid, however thin (scene/solid_union.hpp). A point on a face, or less than half a spacing behind
// it, looks from before the face.
#pragma once

#include "spume/io/samples.hpp"
#include "spume/neighbours/images.hpp"
#include "spume/particles/boundary.hpp"

namespace spume {

// A scalar field of the particles.
struct SampledScalar {
  const Array<double>* values = nullptr;
  double hydrostatic_density = 0;  // of a pressure: its hydrostatic part is interpolated exactly
};

// What is sampled: the state of a time.
struct SampledState {
  const Arrangement* arrangement = nullptr;  // of its cells and kernel only
  const Boundary* boundary = nullptr;
  const ParticleStore* particles = nullptr;
  const Resolution* resolution = nullptr;
  std::vector<SampledScalar> scalars = {};
  const Array<double>* volume_fraction = nullptr;  // of the liquid; null: 1
  Vec3 uniform_acceleration{};                     // of the hydrostatic pressure
  const Array<std::int64_t>* layer = nullptr;      // >= 0: of a buffer layer behind an opening; null: none is
  double time = 0;
};

class PointSampler {
 public:
  // Bins the particles of a state; call again when they have moved.
  const PointSampler& update(const SampledState& state);

  // Weighted linear fit of velocity and scalars over the particles in the support (Shepard average where they are
  // too few); coverage is the kernel sum, 0 in a solid. In the air and in a solid, where `wet_share` is below one half,
  // all are not a number.
  PointSample sample(const Vec3& point) const;
  double coverage(const Vec3& point) const;
  // Shepard average of 1 at particles of the phase and 0 at others; not a number where there are none.
  double colour(const Vec3& point, const Array<std::int64_t>& phase, std::int64_t number) const;
  // Coverage of the point, or in a solid of the nearest point before it: one half at the surface. Beside bodies with
  // the liquid mirrored at them.
  double wet_share(const Vec3& point) const;
  // Highest point of the column where the coverage reaches one half, found on steps of a quarter spacing and refined
  // by bisection; the bottom of the domain when there is none.
  double elevation(const Vec3& point) const;
  // Sum of the intervals of the column whose coverage is above one half, their ends found in the same way.
  double wetted_length(const Vec3& point) const;
  // Of the particles below the height, but for those of buffer layers.
  double front(int axis, double height) const;
  // Averages over a plane across the domain, from cells one spacing wide whose middle lies in no solid. The liquid part
  // of a cell is where `wet_share`, linear between the corners, is one half or more; the fields are sampled at its
  // centroid. Linear fields come out exact, and the area changes continuously as the surface moves.
  PlaneSample plane_average(int axis, double position) const;

  const SampledState& state() const { return state_; }

 private:
  PointSample fit(const Vec3& point) const;
  // Where a point looks from.
  Vec3 eye_of(const Vec3& point) const;
  // In a solid, deeper than so many spacings.
  bool deep_in_solid(const Vec3& point, double depth) const;
  double potential_at(const Vec3& r) const;
  // Where the coverage falls to one half between a wet point and a dry height.
  double crossing(Vec3 wet, double dry) const;
  // A dry point above all liquid in the column of `point`; returns the step of the search.
  double highest_sample(const Vec3& point, Vec3& sample) const;
  template <class Visit>
  void visit(const Vec3& point, Visit&& visit) const;

  SampledState state_;
  CellOrder table_;
  Images images_;       // with solids
  double outside_ = 0;  // the farthest way of a particle beyond a periodic side
};

}  // namespace spume
