// SPDX-License-Identifier: MIT
// What the points behind openings carry in a step.
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/open_sides.hpp"
#include "spume/particles/point_fits.hpp"

namespace spume {
namespace {

// Below this share of a full kernel sum, of the liquid and its reflection in the side, a point has no liquid before it.
// The foremost point of a lattice has 0.4 where it passes the side with the next layer a spacing ahead, and at a
// surface half of what it has below one.
constexpr double wet_opening_share = 0.15;

}  // namespace

void OpenSides::list_points(double t) {
  points_.clear();
  const auto add_point = [&](std::size_t g, const Vec3& place, const Vec3& velocity, std::int32_t number) {
    const OpenGate& gate = gates_[g];
    Point point{place, place, place, static_cast<std::int32_t>(g), number, velocity, {}};
    point.foot[gate.opening->axis] = gate.plane;
    // Behind an inflow the first liquid is at least half a layer before the foremost point. A value nearer to the side
    // would be one beyond all particles, and the gradient that an inflow gives would act over no distance: plug flow
    // into a channel of 16 across between no-slip walls, Re = 50, then loses 13 % of its flow rate as points pass the
    // side and has blown up at t = 0.6.
    const double depth = gate.depth_behind(place);
    const double ahead = number >= 0 ? std::abs(depth) : std::max(depth, gate.layer - depth);
    point.mirror[gate.opening->axis] = gate.plane + gate.inwards * ahead;
    points_.push_back(point);
  };
  for (std::size_t g = 0; g < gates_.size(); ++g) {
    OpenGate& gate = gates_[g];
    if (!gate.opening->inflow) continue;
    const double wet = gate.find_wet(scene_.domain.dimensions - 1, t);
    const Entering entering(*gate.opening, wet, t), last(*gate.opening, wet, t - step_);
    for (const OpenGate::Column& column : gate.columns) {
      if (!column.wet) continue;
      const Vec3 velocity = entering.velocity(column.foot);
      Vec3 acceleration{};
      if (step_ > 0) acceleration = multiply(1 / step_, subtract(velocity, last.velocity(column.foot)));
      const int layers = static_cast<int>(std::ceil(resolution_.support_radius / column.layer)) + 1;
      for (int layer = 0; layer < layers; ++layer) {
        Vec3 place = column.foot;
        place[gate.opening->axis] -= gate.inwards * ((layer + 0.5) * column.layer - column.next);
        add_point(g, place, velocity, -1);
        points_.back().acceleration = acceleration;
      }
    }
  }
  for (std::size_t k = 0; k < drifting_.size(); ++k)
    add_point(static_cast<std::size_t>(drifting_[k].gate), drifting_[k].next, drifting_[k].velocity,
              static_cast<std::int32_t>(k));
  double speed2 = 0;
  for (const Point& point : points_) speed2 = std::max(speed2, dot(point.velocity, point.velocity));
  largest_speed_ = std::sqrt(speed2);
}

template <int dimensions>
void OpenSides::fit(const Arrangement& arrangement, const VectorField& at, std::size_t first, std::size_t last,
                    PointFits& fits) const {
  const auto r = read(at);
  const double h = resolution_.smoothing_length;
  PointFit<dimensions> fit(resolution_);
  const double reach = fit.reach();
  for (std::size_t k = first; k < last; ++k) {
    const Point& point = points_[k];
    const OpenGate& gate = gates_[static_cast<std::size_t>(point.gate)];
    const double above = gate.inwards * (point.mirror[gate.opening->axis] - gate.plane);
    fit.clear();
    double kernel_sum = 0;
    with_plain_kernel(dimensions, resolution_.kernel, [&]<int d, class Kernel>() {
      const double scale = particle_volume_ * Kernel::normalisation(d) / std::pow(h, d);
      visit_near(scene_.domain, arrangement.grid, arrangement.table, point.mirror, reach,
                 [&](std::int32_t j, const Vec3& shift) {
                   Vec3 offset{};
                   double r2 = 0;
                   for (int axis = 0; axis < d; ++axis) {
                     offset[axis] = r[axis][j] + shift[axis] - point.mirror[axis];
                     r2 += offset[axis] * offset[axis];
                   }
                   if (r2 >= reach * reach) return;
                   const double height = gate.inwards * offset[gate.opening->axis] + above;
                   const double mirrored2 = r2 + 4 * std::max(0.0, height) * above;
                   kernel_sum += scale * (Kernel::w(std::sqrt(r2) / h) + Kernel::w(std::sqrt(mirrored2) / h));
                   fit.add(j, offset, r2);
                 });
    });
    if (kernel_sum >= wet_opening_share && fit.fit() >= 0)
      fit.append(fits);
    else
      fit.append_none(fits);
  }
}

void OpenSides::find_stencils(const Arrangement& arrangement, const VectorField& at, double t, WallStencils& stencils,
                              std::array<Array<double>, 3>& position) {
  list_points(t);
  const std::size_t walls = stencils.size();
  find_corners(at, t, stencils, position);
  append_corners(stencils, position);
  const int d = scene_.domain.dimensions;
  const std::size_t n = points_.size();
  std::vector<PointFits> blocks(block_count(n, PointFits::block));
  parallel_blocks_dynamic(n, PointFits::block, [&](std::size_t b, std::size_t first, std::size_t last) {
    if (d == 3)
      fit<3>(arrangement, at, first, last, blocks[b]);
    else
      fit<2>(arrangement, at, first, last, blocks[b]);
  });
  first_point_ = append_points(blocks, d, stencils);
  const std::size_t all = first_point_ + n;
  stencils.kind.resize(all);
  stencils.pressure_sign.resize(all);
  stencils.given_pressure.resize(all);
  for (int axis = 0; axis < d; ++axis) {
    position[axis].resize(all);
    stencils.predicted[axis].resize(all);
  }
  parallel_for(first_point_, [&](std::size_t g) {
    stencils.kind[g] = PointKind::wall;
    const bool out = g >= walls && !gates_[static_cast<std::size_t>(corners_[g - walls].gate)].opening->inflow;
    stencils.pressure_sign[g] = out ? -1 : 1;
    stencils.given_pressure[g] = 0;
  });
  parallel_for(n, [&](std::size_t p) {
    const std::size_t g = first_point_ + p;
    const Point& point = points_[p];
    const OpenGate& gate = gates_[static_cast<std::size_t>(point.gate)];
    const bool inflow = gate.opening->inflow, wet = stencils.first[g + 1] > stencils.first[g];
    stencils.no_slip[g] = 0;
    // What has left without liquid behind it keeps its velocity.
    stencils.kind[g] = inflow || !wet ? PointKind::inflow : PointKind::outflow;
    stencils.pressure_sign[g] = !wet ? 0.0F : inflow ? 1.0F : -1.0F;
    stencils.given_pressure[g] = 0;
    for (int axis = 0; axis < d; ++axis) {
      position[axis][g] = point.place[axis];
      stencils.normal[axis][g] = axis == gate.opening->axis ? static_cast<float>(gate.inwards) : 0.0F;
      stencils.wall_velocity[axis][g] = static_cast<float>(point.velocity[axis]);
    }
  });
}

void OpenSides::give_gradients(const std::array<const double*, 3>& before, const std::array<const double*, 3>& after,
                               double dt, WallStencils& stencils) const {
  const int d = scene_.domain.dimensions;
  give_corner_gradients(before, after, dt, stencils);
  parallel_for(points_.size(), [&](std::size_t p) {
    const Point& point = points_[p];
    const OpenGate& gate = gates_[static_cast<std::size_t>(point.gate)];
    const std::size_t g = first_point_ + p;
    for (int axis = 0; axis < d; ++axis) stencils.predicted[axis][g] = 0;
    if (!gate.opening->inflow || stencils.pressure_sign[g] == 0) return;
    const auto axis = static_cast<std::size_t>(gate.opening->axis);
    const double change =
        stencils.mirrored(g, after[axis]) - (before[axis] == nullptr ? 0.0 : stencils.mirrored(g, before[axis]));
    const double gradient = change / dt - point.acceleration[axis];
    if (before[axis] != nullptr) {
      // The velocity goes on linearly through what is given: a zero gradient in its place lets half of a difference
      // between the two pass, as the divergence of the other half is behind the side.
      const double behind = gate.depth_behind(point.place) / std::abs(point.mirror[axis] - gate.plane);
      for (int k = 0; k < d; ++k)
        stencils.predicted[k][g] = static_cast<float>(behind * (point.velocity[k] - stencils.mirrored(g, before[k])));
    }
    stencils.predicted[axis][g] += static_cast<float>(dt * gradient);
    stencils.given_pressure[g] = (point.place[axis] - point.mirror[axis]) * gradient;
  });
}

void OpenSides::give_pressures(const std::function<double(const Vec3&)>& potential, double t,
                               WallStencils& stencils) const {
  const double density = scene_.fluid.density;
  for (std::size_t k = 0; k < corners_.size(); ++k) {
    const Corner& corner = corners_[k];
    const Opening& opening = *gates_[static_cast<std::size_t>(corner.gate)].opening;
    if (opening.inflow) continue;
    stencils.given_pressure[first_corner_ + k] =
        2 * (pressure_outside(scene_, opening, corner.foot, density, t) / density + potential(corner.foot));
  }
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Point& point = points_[p];
    const Opening& opening = *gates_[static_cast<std::size_t>(point.gate)].opening;
    const std::size_t g = first_point_ + p;
    const bool wet = stencils.pressure_sign[g] != 0;
    if (wet && opening.inflow) continue;
    const double q =
        pressure_outside(scene_, opening, point.foot, density, t) / density + potential(wet ? point.foot : point.place);
    stencils.given_pressure[g] = wet ? 2 * q : q;
  }
}

}  // namespace spume
