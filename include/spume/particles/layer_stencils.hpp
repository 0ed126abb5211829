// SPDX-License-Identifier: MIT
// Buffer layers behind openings (particles/buffer_layers.hpp) of incompressible phases: their velocities and pressures
// follow those of the liquid before the side, at the place m that a particle of a layer mirrors, as of the points of
// operators/wall_stencils.hpp. With n inwards and r the particle,
//
//   pressure  q(m) - (m - r) . n (rho a . n)    inflow: grad q . n = rho a . n, what the pressure takes away
//             2 q_o - q(m)                      outflow: q_o given on the side
//   velocity  given                             inflow, before the pressure: and dt a
//             u(m)                              outflow
//
// q(m), u(m) are those of the phase of the particle where enough of it is before the side.
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

  // Of the particles as they are arranged; `phase` of each.
  void find(const Arrangement& arrangement, const ParticleStore& particles, std::span<const std::uint8_t> phase);
  // A velocity `after` a step dt without pressure, in the layers: of inflows with what the pressure will take away,
  // whose gradient is kept. `before` the step; `density` of the particles.
  void predict(const std::array<const double*, 3>& before, const std::array<double*, 3>& after, double dt,
               std::span<const float> density);
  // A velocity that the pressure has corrected, in the layers.
  void follow(const std::array<double*, 3>& velocity) const;
  // The pressures of outflows at time t, of a unit of q; reduced(place, i) is what q has beside the pressure there, of a
  // particle as i.
  void give_pressures(double t, const std::function<double(const Vec3& place, std::size_t i)>& reduced);

  const TiedRows& tied() const { return tied_; }
  const Array<std::uint8_t>& masked() const { return masked_; }  // 1 in the layers
  double bytes() const;

 private:
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
