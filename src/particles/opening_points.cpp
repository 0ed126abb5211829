// SPDX-License-Identifier: MIT
#include "spume/particles/opening_points.hpp"

#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/point_fits.hpp"

namespace spume {
namespace {

// Below this share of a full kernel sum, of the liquid and its reflection in the side, a point has no liquid before it.
// The foremost point of a lattice has 0.4 where it passes the side with the next layer a spacing ahead, and at a
// surface half of what it has below one.
constexpr double wet_opening_share = 0.15;

// Whether a particle is fitted to at a point: liquid, and of its phase where that is asked for.
struct Fitted {
  const OpeningLiquid& liquid;
  bool own_phase;
  bool operator()(std::int32_t j, const OpeningPoint& point) const {
    const auto k = static_cast<std::size_t>(j);
    if (liquid.layer != nullptr && (*liquid.layer)[k] >= 0) return false;
    return !own_phase || liquid.phase[k] == point.phase;
  }
};

template <int dimensions>
bool fit_point(const OpeningLiquid& liquid, const OpeningPoint& point, const Fitted& fitted,
               PointFit<dimensions>& fit) {
  const double h = liquid.resolution.smoothing_length;
  const OpenGate& gate = liquid.gates[static_cast<std::size_t>(point.gate)];
  const int axis = gate.opening->axis;
  const double above = gate.inwards * (point.mirror[axis] - gate.plane);
  const double free = liquid.thin == nullptr ? infinite : liquid.thin->free_distance(point.mirror);
  const NearParticles& near = fit.begin(liquid.domain, liquid.arrangement, liquid.at, point.mirror);
  double kernel_sum = 0;
  with_plain_kernel(dimensions, liquid.resolution.kernel, [&]<int d, class Kernel>() {
    const double scale = liquid.particle_volume * Kernel::normalisation(d) / std::pow(h, d);
    for (std::size_t k = 0; k < near.size(); ++k) {
      if (!fitted(near.particle(k), point)) continue;
      if (free < fit.reach()) {
        Vec3 place = point.mirror;
        for (int a = 0; a < d; ++a) place[a] += near.offset(a, k);
        if (liquid.thin->hides(point.mirror, free, place,
                               liquid.thin->particle_distance(static_cast<std::size_t>(near.particle(k)))))
          continue;
      }
      const double r2 = near.r2(k), height = gate.inwards * near.offset(axis, k) + above,
                   mirrored2 = r2 + 4 * std::max(0.0, height) * above;
      kernel_sum += scale * (Kernel::w(std::sqrt(r2) / h) + Kernel::w(std::sqrt(mirrored2) / h));
      fit.add(k);
    }
  });
  return kernel_sum >= wet_opening_share && fit.fit() >= 0;
}

template <int dimensions>
void fit_points(const OpeningLiquid& liquid, std::span<const OpeningPoint> points, PointFits& fits) {
  PointFit<dimensions> fit(liquid.resolution);
  for (const OpeningPoint& point : points) {
    const bool fits_own = liquid.phase != nullptr && fit_point(liquid, point, {liquid, true}, fit);
    if (fits_own || fit_point(liquid, point, {liquid, false}, fit))
      fit.append(fits);
    else
      fit.append_none(fits);
  }
}

}  // namespace

OpeningPoint opening_point(const OpenGate& gate, std::int32_t number_of_gate, const Vec3& place, const Vec3& velocity,
                           std::int32_t number) {
  OpeningPoint point{
      .place = place, .mirror = place, .foot = place, .gate = number_of_gate, .number = number, .velocity = velocity};
  const int axis = gate.opening->axis;
  point.foot[axis] = gate.plane;
  // The first liquid is at least half a layer before the foremost point of what enters. A value nearer to the side
  // would be one beyond all particles, and the gradient that an inflow gives would act over no distance: plug flow
  // into a channel of 16 across between no-slip walls, Re = 50, then loses 13 % of its flow rate as points pass the
  // side and has blown up at t = 0.6; what comes back through an outflow in shear leaves voids and blows up.
  const double depth = gate.depth_behind(place);
  point.mirror[axis] = gate.plane + gate.inwards * std::max(depth, gate.layer - depth);
  return point;
}

double share_behind(const OpenGate& gate, const OpeningPoint& point) {
  return gate.depth_behind(point.place) / std::abs(point.mirror[gate.opening->axis] - gate.plane);
}

std::size_t append_opening_points(const OpeningLiquid& liquid, std::span<const OpeningPoint> points,
                                  WallStencils& stencils) {
  const int d = liquid.domain.dimensions;
  const std::size_t n = points.size();
  std::vector<PointFits> blocks(block_count(n, PointFits::block));
  parallel_blocks(n, PointFits::block, [&](std::size_t b, std::size_t first, std::size_t last) {
    const auto own = points.subspan(first, last - first);
    if (d == 3)
      fit_points<3>(liquid, own, blocks[b]);
    else
      fit_points<2>(liquid, own, blocks[b]);
  });
  const std::size_t first_point = append_points(blocks, d, stencils), all = first_point + n;
  stencils.kind.resize(all);
  stencils.pressure_sign.resize(all);
  stencils.given_pressure.resize(all);
  for (int axis = 0; axis < d; ++axis) stencils.predicted[axis].resize(all);
  parallel_for(n, [&](std::size_t p) {
    const std::size_t g = first_point + p;
    const OpeningPoint& point = points[p];
    const OpenGate& gate = liquid.gates[static_cast<std::size_t>(point.gate)];
    const bool inflow = gate.opening->inflow, wet = stencils.first[g + 1] > stencils.first[g];
    stencils.no_slip[g] = 0;
    // What has left without liquid behind it keeps its velocity.
    stencils.kind[g] = inflow || !wet ? PointKind::inflow : PointKind::outflow;
    stencils.pressure_sign[g] = !wet ? 0.0F : inflow ? 1.0F : -1.0F;
    stencils.given_pressure[g] = 0;
    for (int axis = 0; axis < d; ++axis) {
      stencils.normal[axis][g] = axis == gate.opening->axis ? static_cast<float>(gate.inwards) : 0.0F;
      stencils.wall_velocity[axis][g] = static_cast<float>(point.velocity[axis]);
      stencils.predicted[axis][g] = 0;
    }
  });
  return first_point;
}

void give_opening_gradients(const std::vector<OpenGate>& gates, std::span<const OpeningPoint> points,
                            std::size_t first_point, const std::array<const double*, 3>& before,
                            const std::array<const double*, 3>& after, double dt, int dimensions,
                            WallStencils& stencils) {
  parallel_for(points.size(), [&](std::size_t p) {
    const OpeningPoint& point = points[p];
    const OpenGate& gate = gates[static_cast<std::size_t>(point.gate)];
    const std::size_t g = first_point + p;
    for (int axis = 0; axis < dimensions; ++axis) stencils.predicted[axis][g] = 0;
    if (!gate.opening->inflow || stencils.pressure_sign[g] == 0) return;
    const auto axis = static_cast<std::size_t>(gate.opening->axis);
    const double change =
        stencils.mirrored(g, after[axis]) - (before[axis] == nullptr ? 0.0 : stencils.mirrored(g, before[axis]));
    const double gradient = change / dt - point.acceleration[axis];
    if (before[axis] != nullptr) {
      // The velocity goes on linearly through what is given: a zero gradient in its place lets half of a difference
      // between the two pass, as the divergence of the other half is behind the side.
      const double behind = share_behind(gate, point);
      for (int k = 0; k < dimensions; ++k)
        stencils.predicted[k][g] = static_cast<float>(behind * (point.velocity[k] - stencils.mirrored(g, before[k])));
    }
    stencils.predicted[axis][g] += static_cast<float>(dt * gradient);
    stencils.given_pressure[g] = (point.place[axis] - point.mirror[axis]) * gradient;
  });
}

}  // namespace spume
