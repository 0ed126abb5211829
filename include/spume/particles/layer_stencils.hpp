// SPDX-License-Identifier: MIT
// Buffer layers behind openings (particles/buffer_layers.hpp) of incompressible phases: their velocities and pressures
// follow those of the liquid before the side, at the place m that a particle of a layer mirrors, as of the points of
// operators/wall_stencils.hpp; m lies half a layer before the side at least. With n inwards, r the particle, and s its
// distance from the side over that of m,
//
//   pressure  q(m) - (m - r) . n (rho a . n)    inflow: grad q . n = rho a . n, what the pressure takes away
//             (1 + s) q_o - s q(m)              outflow: q_o given on the side
//   velocity  given                             inflow, before the pressure: and dt a
//             u(m), (u(m) . n) n                outflow; where it comes back
//
// q(m), u(m) are those of the phase of the particle where enough of it is before the side. The pressure outside, with a
// level that of the heaviest phase below it and of the lightest above, is that of a liquid at rest: where liquid comes
// back with u_n it has rho u_n^2 / 2 less on the side. With the pressure outside itself there what comes back gains
// energy without bound.
#pragma once

#include <functional>
#include <vector>

#include "spume/operators/tied_rows.hpp"
#include "spume/particles/buffer_layers.hpp"
#include "spume/particles/opening_points.hpp"

namespace spume {

class LayerStencils {
 public:
  // All outlive them.
  LayerStencils(const Scene& scene, const Resolution& resolution, BufferLayers& layers)
      : scene_(scene), resolution_(resolution), layers_(layers) {}

  // Of the particles as they are arranged, of which `thin` hides some (null: none), for a step dt; `phase` of each.
  void find(const Arrangement& arrangement, const ParticleStore& particles, std::span<const std::uint8_t> phase,
            const ThinWalls* thin, double dt);
  // A velocity `after` a step dt without pressure, in the layers: of inflows with what the pressure will take away,
  // whose gradient is kept. `before` the step; `density` of the particles.
  void predict(const std::array<const double*, 3>& before, const std::array<double*, 3>& after, double dt,
               std::span<const float> density);
  // A velocity that the pressure has corrected, in the layers; of inflows the one that they move with in this step.
  void follow(const std::array<double*, 3>& velocity) const;
  // The pressures of outflows at time t, for liquid that moves with `velocity`; reduced(place, i) is what q has beside
  // the pressure there, of a particle as i.
  void give_pressures(double t, const std::array<const double*, 3>& velocity,
                      const std::function<double(const Vec3& place, std::size_t i)>& reduced);

  const TiedRows& tied() const { return tied_; }
  const Array<std::uint8_t>& masked() const { return masked_; }  // 1 in the layers
  double bytes() const;

 private:
  double behind(const OpeningPoint& point) const;
  Vec3 velocity_at(std::size_t g, const std::array<const double*, 3>& velocity, bool before) const;

  const Scene& scene_;
  const Resolution& resolution_;
  BufferLayers& layers_;
  const Array<std::int32_t>* members_ = nullptr;
  std::vector<OpeningPoint> points_;  // of the members
  WallStencils stencils_;
  Array<std::int32_t> point_of_;  // of the particles
  Array<std::uint8_t> masked_;
  TiedRows tied_;
};

}  // namespace spume
