// SPDX-License-Identifier: MIT
#include "spume/particles/wall_bends.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "spume/core/parallel.hpp"
#include "spume/operators/moving_least_squares.hpp"
#include "spume/particles/near_particles.hpp"

namespace spume {
namespace {

constexpr int highest_order = 2, lowest_order = 1;
// Of the sum of |e_j| per spacing of s: 6 to 13 on lattices jittered by a fifth of a spacing, in two and three
// dimensions. It bounds what particles that barely bear a fit answer with.
constexpr double most_bend = 16;
// In smoothing lengths: a particle on the wall tells nothing of the liquid before it.
constexpr double least_distance = 1e-3;

// A side that images are reflected in.
struct WallSide {
  int axis = 0, side = 0;
  double plane = 0, inward = 1;
  std::optional<VectorExpression> velocity;  // of its own: expressions keep their variables inside
};

// The bend of one particle after another. One per thread.
template <int d>
class BendFit {
 public:
  BendFit(const Boundary& boundary, const Arrangement& arrangement, const Resolution& resolution, const VectorField& at,
          double t)
      : boundary_(boundary),
        arrangement_(arrangement),
        h_(resolution.smoothing_length),
        reach_(fit_reach * resolution.support_radius),
        spacing_(resolution.spacing),
        position_(read(at)),
        time_(t) {}

  // The velocity of the wall at the foot of a place.
  Vec3 wall_velocity(const WallSide& wall, Vec3 place) const {
    if (!wall.velocity) return {};
    place[wall.axis] = wall.plane;
    return (*wall.velocity)(place, time_);
  }

  // e of particle i at a side. `velocity` of all particles.
  std::array<double, d> bend(std::size_t i, const WallSide& wall, const std::array<const double*, 3>& velocity) {
    std::array<double, d> e{};
    Vec3 here{};
    for (int a = 0; a < d; ++a) here[a] = position_[a][i];
    const double s = wall.inward * (here[wall.axis] - wall.plane);
    if (!(s > least_distance * h_)) return e;
    gather(here, wall);
    for (int order = highest_order; order >= lowest_order; --order) {
      if (near_.size() <= 2 * monomial_count(d, order) || !fit_.factor(order)) continue;
      const auto slope = fit_.gradient(wall.axis, 1);
      const double factor = 2 * s * s / (h_ * h_) * wall.inward;
      double moduli = 0;
      for (std::size_t k = 0; k < near_.size(); ++k) moduli += std::abs(factor * slope[k]) / near_[k].distance;
      if (moduli > most_bend * s / spacing_) continue;
      for (std::size_t k = 0; k < near_.size(); ++k) {
        const double share = factor * slope[k] / near_[k].distance;
        const auto j = static_cast<std::size_t>(near_[k].particle);
        for (int a = 0; a < d; ++a) e[a] += share * (velocity[a][j] - near_[k].wall_velocity[a]);
      }
      break;
    }
    return e;
  }

 private:
  struct Near {
    std::int32_t particle;
    double distance;  // from the wall, in smoothing lengths
    double weight;
    std::array<double, d> offset;  // from the foot
    Vec3 wall_velocity;
  };

  void gather(const Vec3& here, const WallSide& wall) {
    near_.clear();
    visit_near(boundary_.domain(), arrangement_.grid, arrangement_.table, here, reach_,
               [&](std::int32_t j, const Vec3& shift) {
                 double r2 = 0;
                 Vec3 place{};
                 for (int a = 0; a < d; ++a) {
                   place[a] = position_[a][j] + shift[a];
                   r2 += (place[a] - here[a]) * (place[a] - here[a]);
                 }
                 const double distance = wall.inward * (place[wall.axis] - wall.plane) / h_;
                 if (r2 >= reach_ * reach_ || !(distance > least_distance)) return;
                 if (boundary_.features.openings && opens(wall, place)) return;
                 Near near{.particle = j, .distance = distance, .weight = 0, .offset = {}, .wall_velocity = {}};
                 near.weight = WendlandC2::w(WendlandC2::support * std::sqrt(r2) / reach_) * distance * distance;
                 for (int a = 0; a < d; ++a) near.offset[a] = (place[a] - here[a]) / h_;
                 near.offset[wall.axis] = wall.inward * distance;
                 near.wall_velocity = wall_velocity(wall, place);
                 near_.push_back(near);
               });
    fit_.resize(near_.size());
    for (std::size_t k = 0; k < near_.size(); ++k) {
      for (int a = 0; a < d; ++a) fit_.offset(a)[k] = near_[k].offset[a];
      fit_.weight()[k] = near_[k].weight;
    }
  }

  // Liquid before an opening is held by no wall.
  bool opens(const WallSide& wall, Vec3 place) const {
    place[wall.axis] = wall.plane;
    return boundary_.open_at(wall.axis, wall.side, place);
  }

  const Boundary& boundary_;
  const Arrangement& arrangement_;
  const double h_, reach_, spacing_;
  const std::array<const double*, 3> position_;
  const double time_;
  MovingLeastSquares<d> fit_;
  std::vector<Near> near_;
};

// The sides of the domain that a path is reflected in, each with its axis.
template <class Visit>
void for_each_side(const ImagePath& path, int dimensions, Visit&& visit) {
  for (int axis = 0; axis < dimensions; ++axis) {
    for (const std::int16_t face : path.face[axis])
      if (face >= 0 && face < 2) visit(axis, static_cast<int>(face));
    if (path.side[axis] >= 0) visit(axis, static_cast<int>(path.side[axis]));
  }
}

}  // namespace

bool has_no_slip_sides(const Domain& domain) {
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (const Side& side : domain.sides[axis])
      if (side.kind == BoundaryKind::no_slip) return true;
  return false;
}

template <int d>
void WallBends::add_bends(const Arrangement& arrangement, const VectorField& at,
                          const std::array<const double*, 3>& velocity, double t) {
  const Domain& domain = boundary_.domain();
  const Images& images = arrangement.images;
  parallel_blocks_dynamic(images.size(), 256, [&](std::size_t, std::size_t first, std::size_t last) {
    BendFit<d> fit(boundary_, arrangement, resolution_, at, t);
    std::array<std::array<WallSide, 2>, 3> walls;
    for (int axis = 0; axis < d; ++axis)
      for (int side = 0; side < 2; ++side) {
        WallSide& wall = walls[axis][side];
        wall = {axis, side, boundary_.next_walls[axis][side], side == 0 ? 1.0 : -1.0, {}};
        if (const auto& own = domain.sides[axis][side].velocity) wall.velocity = own->clone();
      }
    for (std::size_t k = first; k < last; ++k) {
      if (images.wall_point() != nullptr && images.wall_point()[k] >= 0) continue;
      const ImagePath& path = images.paths()[static_cast<std::size_t>(images.path()[k])];
      for_each_side(path, d, [&](int axis, int side) {
        if (domain.sides[axis][side].kind != BoundaryKind::no_slip) return;
        const auto e = fit.bend(static_cast<std::size_t>(images.source()[k]), walls[axis][side], velocity);
        // The other reflections of the path; of its own side -1.
        const auto& sign = rule_.sign[static_cast<std::size_t>(images.path()[k])];
        for (int a = 0; a < d; ++a) rule_.offset[a][k] -= sign[a] * static_cast<float>(e[a]);
      });
    }
  });
}

void WallBends::find(const Arrangement& arrangement, const VectorField& at,
                     const std::array<const double*, 3>& velocity, double t) {
  const int d = boundary_.domain().dimensions;
  const std::size_t count = arrangement.images.size();
  const VelocityImageRule& odd = boundary_.velocity_rule();
  rule_.sign = odd.sign;
  rule_.friction = odd.friction;
  rule_.moving = odd.moving;
  rule_.bends = odd.bends;
  rule_.before_pressure = odd.before_pressure;
  for (int axis = 0; axis < d; ++axis) {
    rule_.offset[axis].resize(count);
    if (odd.offset[axis].empty())
      rule_.offset[axis].fill(0);
    else
      std::copy_n(odd.offset[axis].data(), count, rule_.offset[axis].data());
  }
  if (d == 3)
    add_bends<3>(arrangement, at, velocity, t);
  else
    add_bends<2>(arrangement, at, velocity, t);
}

double WallBends::bytes() const {
  double sum = 0;
  for (const auto& component : rule_.offset) sum += component.bytes();
  return sum;
}

}  // namespace spume
