// SPDX-License-Identifier: MIT
// What the points behind openings carry in a step.
#include <cmath>
#include <limits>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/open_sides.hpp"

namespace spume {

void OpenSides::list_points(double t) {
  points_.clear();
  const auto add_point = [&](std::size_t g, const Vec3& place, const Vec3& velocity, std::int32_t number) {
    points_.push_back(opening_point(gates_[g], static_cast<std::int32_t>(g), place, velocity, number));
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
  for (const OpeningPoint& point : points_) speed2 = std::max(speed2, dot(point.velocity, point.velocity));
  largest_speed_ = std::sqrt(speed2);
}

void OpenSides::find_stencils(const Arrangement& arrangement, const VectorField& at, double t, const ThinWalls* thin,
                              WallStencils& stencils, std::array<Array<double>, 3>& position) {
  list_points(t);
  const std::size_t walls = stencils.size();
  find_corners(at, t, stencils, position);
  append_corners(stencils, position);
  const int d = scene_.domain.dimensions;
  const std::size_t n = points_.size();
  first_point_ = append_opening_points({.domain = scene_.domain,
                                        .resolution = resolution_,
                                        .gates = gates_,
                                        .particle_volume = particle_volume_,
                                        .arrangement = arrangement,
                                        .at = at,
                                        .thin = thin},
                                       points_, stencils);
  for (int axis = 0; axis < d; ++axis) position[axis].resize(first_point_ + n);
  parallel_for(first_point_, [&](std::size_t g) {
    stencils.kind[g] = PointKind::wall;
    const bool out = g >= walls && !gates_[static_cast<std::size_t>(corners_[g - walls].gate)].opening->inflow;
    stencils.pressure_sign[g] = out ? -1 : 1;
    stencils.given_pressure[g] = 0;
  });
  parallel_for(n, [&](std::size_t p) {
    for (int axis = 0; axis < d; ++axis) position[axis][first_point_ + p] = points_[p].place[axis];
    if (stencils.kind[first_point_ + p] == PointKind::outflow)
      stencils.pressure_sign[first_point_ + p] =
          static_cast<float>(-share_behind(gates_[static_cast<std::size_t>(points_[p].gate)], points_[p]));
  });
}

void OpenSides::give_gradients(const std::array<const double*, 3>& before, const std::array<const double*, 3>& after,
                               double dt, WallStencils& stencils) const {
  const int d = scene_.domain.dimensions;
  give_corner_gradients(before, after, dt, stencils);
  give_opening_gradients(gates_, points_, first_point_, before, after, dt, d, stencils);
}

void OpenSides::give_pressures(const std::function<double(const Vec3&)>& potential, double t,
                               WallStencils& stencils) const {
  const double density = scene_.fluid.density;
  const auto head_of = [&](const OpeningPoint& point) {
    const OpenGate& gate = gates_[static_cast<std::size_t>(point.gate)];
    const double inwards = gate.inwards * point.velocity[gate.opening->axis];
    return inwards > 0 ? 0.5 * inwards * inwards : 0;
  };
  // Corners have no velocity of their own: that of the nearest point behind the side, where something comes back.
  std::vector<double> head(corners_.size());
  std::vector<bool> comes_back(gates_.size());
  for (const OpeningPoint& point : points_)
    if (head_of(point) > 0) comes_back[static_cast<std::size_t>(point.gate)] = true;
  parallel_blocks(corners_.size(), 16, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const auto g = static_cast<std::size_t>(corners_[k].gate);
      if (gates_[g].opening->inflow || !comes_back[g]) continue;
      double nearest2 = std::numeric_limits<double>::infinity();
      for (std::size_t p = 0; p < points_.size(); ++p) {
        if (points_[p].gate != corners_[k].gate || stencils.pressure_sign[first_point_ + p] == 0) continue;
        const Vec3 way = scene_.domain.shortest(subtract(points_[p].place, corners_[k].foot));
        if (dot(way, way) >= nearest2) continue;
        nearest2 = dot(way, way);
        head[k] = head_of(points_[p]);
      }
    }
  });
  for (std::size_t k = 0; k < corners_.size(); ++k) {
    const Corner& corner = corners_[k];
    const Opening& opening = *gates_[static_cast<std::size_t>(corner.gate)].opening;
    if (opening.inflow) continue;
    stencils.given_pressure[first_corner_ + k] =
        2 * (pressure_outside(scene_, opening, corner.foot, {density}, t) / density - head[k] + potential(corner.foot));
  }
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const OpeningPoint& point = points_[p];
    const Opening& opening = *gates_[static_cast<std::size_t>(point.gate)].opening;
    const std::size_t g = first_point_ + p;
    const bool wet = stencils.pressure_sign[g] != 0;
    if (wet && opening.inflow) continue;
    const double q = pressure_outside(scene_, opening, point.foot, {density}, t) / density -
                     (wet ? head_of(point) : 0) + potential(wet ? point.foot : point.place);
    stencils.given_pressure[g] = wet ? (1 - double{stencils.pressure_sign[g]}) * q : q;
  }
}

}  // namespace spume
