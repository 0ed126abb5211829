// SPDX-License-Identifier: MIT
// What keeps particles half a spacing from walls beside a free surface.
//
// A particle on a mirror is at rest there: its force towards its image vanishes, and what the others leave of a flat
// density field cancels it to first order. Closer to its image than the spacing it feels a stress of the form of that
// of Monaghan, SPH without a tensile instability (2000), which is zero at the spacing here:
//
//   (rho du/dt)_i = -g / v 0.2 rho_0 U^2 ((W(2 d) / W(spacing))^4 - 1) 2 d n,
//
// d the distance from the wall, n its normal into the liquid, g of operators/wcsph_sums.hpp at 2 d, v = 1 / (1 + s), U
// the largest expected speed. The acceleration depends on the place alone, so that walls that stand still
// do no work.
// The image behind the wall of a body is as far behind it. Bodies that stand still do without: particles that a slanted
// face leaves nearer than half a spacing are at rest there, and the stress would stir them.
#pragma once

#include <optional>
#include <vector>

#include "spume/operators/wall_averages.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/phase_law.hpp"

namespace spume {

class WallParting {
 public:
  // Scene and boundary outlive it. Speed: U.
  WallParting(const Scene& scene, const Boundary& boundary, const Resolution& resolution, double particle_volume,
              double speed);

  struct Liquid {
    ParticleLaws law;
    std::array<const double*, 3> place{};
    const float* volume = nullptr;  // v
    double gradient_scale = 1;      // of the kernel gradient: SweepContext
  };
  double stress() const;  // 0.2 U^2
  // Adds (rho du/dt)_i of sides and bodies, those standing where they were put last.
  void add_forces(std::size_t particles, const Liquid& liquid, const std::array<float*, 3>& out) const;
  // Adds what the bodies take of it, in the order of the particles.
  void add_to_bodies(std::size_t particles, const Liquid& liquid, std::vector<SurfaceForce>& forces) const;

 private:
  struct Parting {
    std::size_t body = 0;
    Vec3 foot{}, force{};
  };
  double force_of(const Liquid& liquid, std::size_t i, double distance, double gap) const;
  std::optional<Parting> from_bodies(const Liquid& liquid, std::size_t i, const Vec3& r) const;
  Vec3 place_of(const Liquid& liquid, std::size_t i) const;

  const Scene& scene_;
  const Boundary& boundary_;
  const int dimensions_;
  const double h_, particle_volume_, speed_;
};

}  // namespace spume
