// SPDX-License-Identifier: MIT
#include "spume/particles/wall_bends.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

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
// In spacings: no particle stands nearer to a side for long, so that none sees images farther behind it than a support
// less this.
constexpr double nearest_row = 0.25;

// A side that images are reflected in.
struct WallSide {
  int axis = 0, side = 0;
  double plane = 0, inward = 1;
  const Array<Vec3>* velocity = nullptr;  // at the foot of each particle; null: at rest
};

// The bend of one particle after another. One per thread.
template <int d>
class BendFit {
 public:
  BendFit(const Boundary& boundary, const Arrangement& arrangement, const Resolution& resolution, const VectorField& at)
      : boundary_(boundary),
        thin_(boundary.bodies() == nullptr ? nullptr : boundary.bodies()->thin()),
        arrangement_(arrangement),
        h_(resolution.smoothing_length),
        reach_(fit_reach_of(d) * resolution.support_radius),
        spacing_(resolution.spacing),
        position_(read(at)) {
    for (const ImagePath& path : arrangement.images.paths()) {
      bool copy = path.reflections() == 0;
      for (int axis = 0; axis < d; ++axis) copy = copy && (path.side[axis] < 0 || boundary.domain().periodic(axis));
      copies_.push_back(copy);
    }
  }

  // e of particle i at a side. `velocity` of all particles.
  std::array<double, d> bend(std::size_t i, const WallSide& wall, const std::array<const double*, 3>& velocity) {
    std::array<double, d> e{};
    Vec3 here{};
    for (int a = 0; a < d; ++a) here[a] = position_[a][i];
    const double s = wall.inward * (here[wall.axis] - wall.plane);
    if (!(s > least_distance * h_)) return e;
    gather(i, here, wall);
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
        if (wall.velocity == nullptr) {
          for (int a = 0; a < d; ++a) e[a] += share * velocity[a][j];
        } else {
          const Vec3& its = (*wall.velocity)[j];
          for (int a = 0; a < d; ++a) e[a] += share * (velocity[a][j] - its[a]);
        }
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
  };

  // In two dimensions the support of a particle beside a wall holds too few for a fit of order 2; in three it holds 45
  // and more, which the lists name.
  void gather(std::size_t i, const Vec3& here, const WallSide& wall) {
    near_.clear();
    if constexpr (d == 2) {
      visit_near(boundary_.domain(), arrangement_.grid, arrangement_.table, here, reach_,
                 [&](std::int32_t j, const Vec3& shift) {
                   Vec3 place{};
                   for (int a = 0; a < d; ++a) place[a] = position_[a][j] + shift[a];
                   if (thin_ != nullptr && hides(i, here, j, place)) return;
                   add(static_cast<std::size_t>(j), place, here, wall);
                 });
    } else {
      const auto n = static_cast<std::int32_t>(arrangement_.list.particles());
      const Images& images = arrangement_.images;
      add(i, here, here, wall);
      for (const std::int32_t j : arrangement_.list.of(i)) {
        const auto k = static_cast<std::size_t>(j - n);
        if (j >= n && !is_copy(images, k)) continue;
        Vec3 place{};
        for (int a = 0; a < d; ++a) place[a] = j < n ? position_[a][j] : images.position(a)[k];
        add(arrangement_.particle_of(j), place, here, wall);
      }
    }
    fit_.resize(near_.size());
    for (std::size_t k = 0; k < near_.size(); ++k) {
      for (int a = 0; a < d; ++a) fit_.offset(a)[k] = near_[k].offset[a];
      fit_.weight()[k] = near_[k].weight;
    }
  }

  // As lists have it.
  bool hides(std::size_t i, const Vec3& here, std::int32_t j, const Vec3& place) const {
    const double free = thin_->particle_distance(i);
    return free < reach_ && thin_->hides(here, free, place, thin_->particle_distance(static_cast<std::size_t>(j)));
  }

  // Whether image k is a particle beyond periodic sides: no mirror image, no wall point.
  bool is_copy(const Images& images, std::size_t k) const {
    return copies_[static_cast<std::size_t>(images.path()[k])] &&
           (images.wall_point() == nullptr || images.wall_point()[k] < 0);
  }

  void add(std::size_t j, const Vec3& place, const Vec3& here, const WallSide& wall) {
    double r2 = 0;
    for (int a = 0; a < d; ++a) r2 += (place[a] - here[a]) * (place[a] - here[a]);
    const double distance = wall.inward * (place[wall.axis] - wall.plane) / h_;
    if (r2 >= reach_ * reach_ || !(distance > least_distance)) return;
    if (boundary_.features.openings && opens(wall, place)) return;
    Near near{.particle = static_cast<std::int32_t>(j), .distance = distance, .weight = 0, .offset = {}};
    near.weight = WendlandC2::w(WendlandC2::support * std::sqrt(r2) / reach_) * distance * distance;
    for (int a = 0; a < d; ++a) near.offset[a] = (place[a] - here[a]) / h_;
    near.offset[wall.axis] = wall.inward * distance;
    near_.push_back(near);
  }

  // Liquid before an opening is held by no wall.
  bool opens(const WallSide& wall, Vec3 place) const {
    place[wall.axis] = wall.plane;
    return boundary_.open_at(wall.axis, wall.side, place);
  }

  const Boundary& boundary_;
  const ThinWalls* const thin_;  // null: nothing is hidden
  const Arrangement& arrangement_;
  const double h_, reach_, spacing_;
  const std::array<const double*, 3> position_;
  std::vector<bool> copies_;  // paths that periodic sides make
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
void WallBends::fit_bends(const Arrangement& arrangement, const VectorField& at,
                          const std::array<const double*, 3>& velocity, Bends& bends) const {
  const Domain& domain = boundary_.domain();
  const auto r = read(at);
  const double seen = resolution_.support_radius - nearest_row * resolution_.spacing;
  parallel_blocks(arrangement.list.particles(), 256, [&](std::size_t, std::size_t first, std::size_t last) {
    BendFit<d> fit(boundary_, arrangement, resolution_, at);
    for (int axis = 0; axis < d; ++axis) {
      if (bends[axis][0].empty()) continue;
      for (std::size_t i = first; i < last; ++i) {
        std::array<double, d> e{};
        for (int side = 0; side < 2; ++side) {
          const double plane = boundary_.next_walls[axis][side], inward = side == 0 ? 1 : -1;
          if (domain.sides[axis][side].kind != BoundaryKind::no_slip || !(inward * (r[axis][i] - plane) < seen))
            continue;
          const Array<Vec3>& moving = wall_velocity_[axis][side];
          e = fit.bend(i, {axis, side, plane, inward, moving.empty() ? nullptr : &moving}, velocity);
        }
        for (int a = 0; a < d; ++a) bends[axis][a][i] = static_cast<float>(e[a]);
      }
    }
  });
}

void WallBends::add(const Images& images, const Bends& bends) {
  const Domain& domain = boundary_.domain();
  const int d = domain.dimensions;
  parallel_for(images.size(), [&](std::size_t k) {
    if (images.wall_point() != nullptr && images.wall_point()[k] >= 0) return;
    const ImagePath& path = images.paths()[static_cast<std::size_t>(images.path()[k])];
    const auto i = static_cast<std::size_t>(images.source()[k]);
    // That of the other reflections of the path is its opposite: its own reverses all components.
    const auto& sign = rule_.sign[static_cast<std::size_t>(images.path()[k])];
    for_each_side(path, d, [&](int axis, int side) {
      if (domain.sides[axis][side].kind != BoundaryKind::no_slip) return;
      for (int a = 0; a < d; ++a) rule_.offset[a][k] -= sign[a] * bends[axis][a][i];
    });
  });
}

// At the feet of the particles that a fit beside the wall may take.
void WallBends::find_wall_velocities(std::size_t count, const VectorField& at, double t) {
  const Domain& domain = boundary_.domain();
  const double reach = (1 + fit_reach) * resolution_.support_radius;
  const auto r = read(at);
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (int side = 0; side < 2; ++side) {
      const Side& wall = domain.sides[axis][side];
      if (wall.kind != BoundaryKind::no_slip || !wall.velocity) continue;
      Array<Vec3>& found = wall_velocity_[axis][side];
      found.resize(count);
      const double plane = boundary_.next_walls[axis][side];
      parallel_blocks(count, 4096, [&](std::size_t, std::size_t first, std::size_t last) {
        // Expressions keep their variables inside: each block evaluates its own copy.
        const VectorExpression velocity = wall.velocity->clone();
        for (std::size_t i = first; i < last; ++i) {
          if (!(std::abs(r[axis][i] - plane) < reach)) continue;
          Vec3 foot{};
          for (int a = 0; a < domain.dimensions; ++a) foot[a] = r[a][i];
          foot[axis] = plane;
          found[i] = boundary_.with_correction(velocity(foot, t), axis, side, t);
        }
      });
    }
}

void WallBends::find(const Arrangement& arrangement, const VectorField& at,
                     const std::array<const double*, 3>& velocity, double t, ScratchPool& scratch) {
  const Domain& domain = boundary_.domain();
  const int d = domain.dimensions;
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
  const std::size_t n = arrangement.list.particles();
  find_wall_velocities(n, at, t);
  Bends bends;
  for (int axis = 0; axis < d; ++axis)
    if (domain.sides[axis][0].kind == BoundaryKind::no_slip || domain.sides[axis][1].kind == BoundaryKind::no_slip)
      scratch.lease(bends[axis], d, n);
  if (d == 3)
    fit_bends<3>(arrangement, at, velocity, bends);
  else
    fit_bends<2>(arrangement, at, velocity, bends);
  add(arrangement.images, bends);
  for (auto& of_axis : bends) scratch.release(of_axis);
}

double WallBends::bytes() const {
  double sum = 0;
  for (const auto& component : rule_.offset) sum += component.bytes();
  for (const auto& sides : wall_velocity_)
    for (const auto& velocity : sides) sum += velocity.bytes();
  return sum;
}

}  // namespace spume
