// SPDX-License-Identifier: MIT
// Where a body goes through an opening: beyond the side stand the images of its wall points, as the body is taken to go
// on symmetrically. An image has the values of its wall point, by the same coefficients, and the pressure that the
// opening gives there.
#include <optional>

#include "spume/core/parallel.hpp"
#include "spume/particles/open_sides.hpp"
#include "spume/particles/point_fits.hpp"

namespace spume {

void OpenSides::find_corners(const VectorField& at, double t, const WallStencils& walls,
                             const std::array<Array<double>, 3>& position) {
  const auto r = read(at);
  corners_.clear();
  for (std::size_t g = 0; g < gates_.size(); ++g) {
    const OpenGate& gate = gates_[g];
    const Opening& opening = *gate.opening;
    const std::size_t axis = static_cast<std::size_t>(opening.axis);
    if (!scene_.domain.sides[opening.axis][opening.side].opening) continue;
    // The liquid that a wall point stands for is next to a particle, which tells whether it is before this opening.
    const auto foot_of = [&](std::size_t p) {
      Vec3 foot{};
      for (std::size_t a = 0; a < static_cast<std::size_t>(scene_.domain.dimensions); ++a)
        foot[a] = r[a][walls.nearest[p]];
      foot[axis] = gate.plane;
      return foot;
    };
    Array<std::int32_t> chosen;
    parallel_select(walls.size(), chosen, [&](std::size_t p) {
      const double ahead = gate.inwards * (position[axis][p] - gate.plane);
      return ahead >= 0 && ahead < resolution_.support_radius && gate.column_at(foot_of(p)) >= 0;
    });
    if (chosen.size() == 0) continue;
    std::size_t first = corners_.size();
    corners_.resize(first + chosen.size());
    const bool given = opening.inflow && step_ > 0;
    const double wet = given ? gate.wet_area() : 0;
    std::optional<Entering> entering, last;
    if (given) {
      entering.emplace(opening, wet, t);
      last.emplace(opening, wet, t - step_);
    }
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      Corner& corner = corners_[first + k];
      corner.wall_point = static_cast<std::size_t>(chosen[k]);
      corner.gate = static_cast<std::int32_t>(g);
      corner.foot = foot_of(corner.wall_point);
      corner.way = 2 * (walls.mirrored(corner.wall_point, r[axis]) - gate.plane);
      if (given)
        corner.acceleration = (entering->velocity(corner.foot)[axis] - last->velocity(corner.foot)[axis]) / step_;
    }
  }
}

void OpenSides::append_corners(WallStencils& stencils, std::array<Array<double>, 3>& position) {
  const int d = scene_.domain.dimensions;
  std::vector<PointFits> blocks(block_count(corners_.size(), PointFits::block));
  parallel_blocks(corners_.size(), PointFits::block, [&](std::size_t b, std::size_t first, std::size_t last) {
    PointFits& fits = blocks[b];
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t p = corners_[k].wall_point;
      const auto from = static_cast<std::size_t>(stencils.first[p]),
                 to = static_cast<std::size_t>(stencils.first[p + 1]);
      fits.nearest.push_back(stencils.nearest[p]);
      fits.entries.push_back(static_cast<std::int32_t>(to - from));
      fits.source.insert(fits.source.end(), stencils.source.data() + from, stencils.source.data() + to);
      fits.coefficient.insert(fits.coefficient.end(), stencils.coefficient.data() + from,
                              stencils.coefficient.data() + to);
      if (!stencils.bend.empty())
        fits.bend.insert(fits.bend.end(), stencils.bend.data() + from, stencils.bend.data() + to);
    }
  });
  first_corner_ = append_points(blocks, d, stencils);
  for (int axis = 0; axis < d; ++axis) position[axis].resize(stencils.size());
  parallel_for(corners_.size(), [&](std::size_t k) {
    const std::size_t g = first_corner_ + k, p = corners_[k].wall_point;
    const OpenGate& gate = gates_[static_cast<std::size_t>(corners_[k].gate)];
    stencils.no_slip[g] = stencils.no_slip[p];
    for (int axis = 0; axis < d; ++axis) {
      const bool along = axis == gate.opening->axis;
      position[axis][g] = along ? 2 * gate.plane - position[axis][p] : position[axis][p];
      stencils.normal[axis][g] = along ? -stencils.normal[axis][p] : stencils.normal[axis][p];
      stencils.wall_velocity[axis][g] = stencils.wall_velocity[axis][p];
    }
  });
}

void OpenSides::give_corner_gradients(const std::array<const double*, 3>& before,
                                      const std::array<const double*, 3>& after, double dt,
                                      WallStencils& stencils) const {
  parallel_for(corners_.size(), [&](std::size_t k) {
    const Corner& corner = corners_[k];
    const Opening& opening = *gates_[static_cast<std::size_t>(corner.gate)].opening;
    if (!opening.inflow) return;
    const auto axis = static_cast<std::size_t>(opening.axis);
    const std::size_t g = first_corner_ + k;
    const double change =
        stencils.mirrored(g, after[axis]) - (before[axis] == nullptr ? 0.0 : stencils.mirrored(g, before[axis]));
    stencils.given_pressure[g] = -corner.way * (change / dt - corner.acceleration);
  });
}

}  // namespace spume
