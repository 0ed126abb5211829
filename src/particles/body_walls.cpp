// SPDX-License-Identifier: MIT
#include "spume/particles/body_walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/point_fits.hpp"

namespace spume {
namespace {

constexpr double wet_wall_share = 0.5;
// Means of a few particles are no values of liquid mirrored at a wall: where one of them has a pressure and the others
// hold p = 0, the mean draws it into the wall, the faster the more its pressure grows. At the back of a weir spray
// reached 135 m/s where the water falls with 2.6 m/s.
constexpr int least_order = 1;

}  // namespace

// What a block of wall points found: those that are wet, in their order.
struct BodyWalls::Block {
  std::vector<std::int32_t>& point;
  PointFits& fits;
};

BodyWalls::BodyWalls(const Scene& scene, const Resolution& resolution, double particle_volume)
    : scene_(scene), resolution_(resolution), points_(make_wall_points(scene, resolution, particle_volume)) {
  const int d = scene.domain.dimensions;
  cell_ = 2 * resolution.support_radius;
  for (int axis = 0; axis < d; ++axis) {
    cell_lower_[axis] = scene.domain.lower[axis] - cell_;
    cells_[axis] = static_cast<std::size_t>(std::ceil((scene.domain.upper[axis] - cell_lower_[axis]) / cell_)) + 1;
  }
  middle_.resize(cells_[0] * cells_[1] * cells_[2]);
  parallel_blocks_dynamic(cells_[1] * cells_[2], 1, [&](std::size_t row, std::size_t, std::size_t) {
    for (std::size_t i = 0; i < cells_[0]; ++i) {
      Vec3 place{cell_lower_[0] + (static_cast<double>(i) + 0.5) * cell_,
                 cell_lower_[1] + (static_cast<double>(row % cells_[1]) + 0.5) * cell_,
                 d == 3 ? cell_lower_[2] + (static_cast<double>(row / cells_[1]) + 0.5) * cell_ : 0.0};
      middle_[row * cells_[0] + i] = static_cast<float>(scene.walls.distance(place));
    }
  });
  fine_ = resolution.spacing;
  for (int axis = 0; axis < d; ++axis) {
    fine_lower_[axis] = scene.domain.lower[axis];
    fine_cells_[axis] =
        static_cast<std::size_t>(std::ceil((scene.domain.upper[axis] - scene.domain.lower[axis]) / fine_));
  }
  least_.resize(fine_cells_[0] * fine_cells_[1] * fine_cells_[2]);
  // Half a diagonal, what rounding to float takes, and what interpolated distances are off by.
  double off = (0.5 * std::sqrt(static_cast<double>(d)) + 1e-3) * fine_;
  for (const Body& body : scene.bodies)
    if (body.wall != BoundaryKind::open) off += body.solid->error();
  parallel_blocks_dynamic(fine_cells_[1] * fine_cells_[2], 1, [&](std::size_t row, std::size_t, std::size_t) {
    for (std::size_t i = 0; i < fine_cells_[0]; ++i) {
      const Vec3 place{fine_lower_[0] + (static_cast<double>(i) + 0.5) * fine_,
                       fine_lower_[1] + (static_cast<double>(row % fine_cells_[1]) + 0.5) * fine_,
                       d == 3 ? fine_lower_[2] + (static_cast<double>(row / fine_cells_[1]) + 0.5) * fine_ : 0.0};
      least_[row * fine_cells_[0] + i] = static_cast<float>(distance(place) - off);
    }
  });
  body_.resize(points_.size());
  parallel_for(points_.size(), [&](std::size_t g) { body_[g] = static_cast<std::uint8_t>(body_at(points_[g].foot)); });
  for (const Body& body : scene.bodies) moving_ = moving_ || (body.wall != BoundaryKind::open && body.velocity);
}

// The wall whose surface the foot lies on: the later of two that touch there.
std::size_t BodyWalls::body_at(const Vec3& foot) const {
  std::size_t best = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    if (scene_.bodies[b].wall == BoundaryKind::open) continue;
    const double away = std::abs(scene_.bodies[b].solid->distance(foot));
    if (away <= nearest) {
      nearest = away;
      best = b;
    }
  }
  return best;
}

double BodyWalls::distance(const Vec3& point) const {
  std::array<std::size_t, 3> at{};
  double outside = 0;  // of the cells, along one axis at most
  for (int axis = 0; axis < scene_.domain.dimensions; ++axis) {
    const double cell = (point[axis] - cell_lower_[axis]) / cell_;
    const double inside = std::clamp(cell, 0.0, static_cast<double>(cells_[axis]) - 0.5);
    outside = std::max(outside, std::abs(cell - inside));
    at[axis] = static_cast<std::size_t>(inside);
  }
  const double middle = middle_[(at[2] * cells_[1] + at[1]) * cells_[0] + at[0]];
  // Half the diagonal of a cell, and the reach of whoever asks.
  const double half = 0.5 * std::sqrt(static_cast<double>(scene_.domain.dimensions)) * cell_;
  if (outside == 0 && std::abs(middle) > half + 2 * cell_) return std::copysign(std::abs(middle) - half, middle);
  return scene_.walls.distance(point);
}

bool BodyWalls::surely_farther(const Vec3& point, double gap) const {
  std::array<std::size_t, 3> at{};
  for (int axis = 0; axis < scene_.domain.dimensions; ++axis) {
    const double cell = (point[axis] - fine_lower_[axis]) / fine_;
    if (!(cell >= 0 && cell < static_cast<double>(fine_cells_[axis]))) return false;
    at[axis] = static_cast<std::size_t>(cell);
  }
  return least_[(at[2] * fine_cells_[1] + at[1]) * fine_cells_[0] + at[0]] > gap;
}

void BodyWalls::keep_outside(Vec3& position, Vec3* velocity, double gap) const {
  if (surely_farther(position, gap) || distance(position) >= gap) return;
  NearestPoint near = scene_.walls.nearest(position);
  const NearestPoint first = near;
  position = add(near.point, multiply(std::max(gap, std::abs(near.distance)), near.normal));
  if (!(scene_.walls.distance(position) >= 0.5 * gap)) {
    // Another wall is there: before the nearest face.
    for (int round = 0; round < 3 && near.distance < gap; ++round) {
      position = add(near.point, multiply(gap, near.normal));
      near = scene_.walls.nearest(position);
    }
  }
  if (velocity == nullptr) return;
  const double inwards = dot(*velocity, first.normal);
  if (inwards < 0) *velocity = subtract(*velocity, multiply(inwards, first.normal));
}

void BodyWalls::limit_approach(const Vec3& position, double gap, double speed, const Vec3& before,
                               Vec3& velocity) const {
  if (surely_farther(position, gap) || distance(position) >= gap) return;
  const Vec3 normal = scene_.walls.nearest(position).normal;
  const double approach = dot(velocity, normal), most = std::min(-speed, dot(before, normal));
  if (approach < most) velocity = add(velocity, multiply(most - approach, normal));
}

bool BodyWalls::is_wet(std::size_t point) const {
  return std::binary_search(wet_points_.begin(), wet_points_.end(), static_cast<std::int32_t>(point));
}

WallPointView BodyWalls::wet() const {
  WallPointView view{.size = stencils_.size(), .source = stencils_.nearest.data()};
  for (int axis = 0; axis < scene_.domain.dimensions; ++axis) view.position[axis] = wet_position_[axis].data();
  return view;
}

template <int dimensions>
void BodyWalls::fit_block(const Arrangement& arrangement, const VectorField& at, double particle_volume,
                          std::size_t first, std::size_t last, Block& block) const {
  const auto r = read(at);
  const double h = resolution_.smoothing_length;
  PointFit<dimensions> fit(resolution_);
  const double reach = fit.reach();
  for (std::size_t g = first; g < last; ++g) {
    const WallPoint& point = points_[g];
    fit.clear();
    double kernel_sum = 0;
    bool seen = false;  // from within the support radius
    with_plain_kernel(dimensions, resolution_.kernel, [&]<int d, class Kernel>() {
      const double scale = particle_volume * Kernel::normalisation(d) / std::pow(h, d);
      visit_near(scene_.domain, arrangement.grid, arrangement.table, point.mirror, reach,
                 [&](std::int32_t j, const Vec3& shift) {
                   Vec3 offset{};
                   double r2 = 0, across = 0, way2 = 0;
                   for (int axis = 0; axis < d; ++axis) {
                     const double x = r[axis][j] + shift[axis];
                     offset[axis] = x - point.mirror[axis];
                     r2 += offset[axis] * offset[axis];
                     across += (x - point.foot[axis]) * point.normal[axis];
                     way2 += (x - point.position[axis]) * (x - point.position[axis]);
                   }
                   seen = seen || way2 < resolution_.support_radius * resolution_.support_radius;
                   // Behind the tangent plane stands liquid of another side, or of a curved one, which the fit can
                   // miss.
                   if (across < 0 || r2 >= reach * reach) return;
                   const double mirrored2 = r2 + 4 * across * dot(subtract(point.mirror, point.foot), point.normal);
                   kernel_sum += scale * (Kernel::w(std::sqrt(r2) / h) + Kernel::w(std::sqrt(mirrored2) / h));
                   fit.add(j, offset, r2);
                 });
    });
    if (kernel_sum < wet_wall_share || !seen || fit.fit() < least_order) continue;
    block.point.push_back(static_cast<std::int32_t>(g));
    fit.append(block.fits);
  }
}

void BodyWalls::find_stencils(const Arrangement& arrangement, const VectorField& at, double particle_volume, double t) {
  const int d = scene_.domain.dimensions;
  std::vector<PointFits> fits(block_count(points_.size(), PointFits::block));
  std::vector<std::vector<std::int32_t>> wet_of(fits.size());
  parallel_blocks_dynamic(points_.size(), PointFits::block, [&](std::size_t b, std::size_t first, std::size_t last) {
    Block block{wet_of[b], fits[b]};
    if (d == 3)
      fit_block<3>(arrangement, at, particle_volume, first, last, block);
    else
      fit_block<2>(arrangement, at, particle_volume, first, last, block);
  });
  stencils_.clear();
  append_points(fits, d, stencils_);
  const std::size_t wet = stencils_.size();
  wet_points_.clear();
  for (const auto& points : wet_of) wet_points_.insert(wet_points_.end(), points.begin(), points.end());
  for (int axis = 0; axis < d; ++axis) wet_position_[axis].resize(wet);
  parallel_for(wet, [&](std::size_t g) {
    const auto p = static_cast<std::size_t>(wet_points_[g]);
    stencils_.no_slip[g] = scene_.bodies[body_[p]].wall == BoundaryKind::no_slip ? 1 : 0;
    for (int axis = 0; axis < d; ++axis) {
      wet_position_[axis][g] = points_[p].position[axis];
      stencils_.normal[axis][g] = static_cast<float>(points_[p].normal[axis]);
    }
  });
  set_surfaces(t);
}

void BodyWalls::set_surfaces(double t) {
  const int d = scene_.domain.dimensions;
  const std::size_t wet = stencils_.size();
  if (!moving_) {
    for (int axis = 0; axis < d; ++axis) stencils_.wall_velocity[axis].fill(0);
    return;
  }
  parallel_blocks(wet, 1024, [&](std::size_t, std::size_t first, std::size_t last) {
    // Expressions keep their variables inside: each block evaluates its own copies.
    std::vector<VectorExpression> velocity;
    for (const Body& body : scene_.bodies)
      velocity.push_back(body.velocity ? body.velocity->clone() : VectorExpression{});
    for (std::size_t g = first; g < last; ++g) {
      const auto p = static_cast<std::size_t>(wet_points_[g]);
      const Vec3 u = velocity[body_[p]](points_[p].foot, t);
      for (int axis = 0; axis < d; ++axis) stencils_.wall_velocity[axis][g] = static_cast<float>(u[axis]);
    }
  });
  largest_speed_ = std::sqrt(parallel_max(wet, 0.0, [&](std::size_t g) {
    double speed2 = 0;
    for (int axis = 0; axis < d; ++axis) {
      const double u = stencils_.wall_velocity[axis][g];
      speed2 += u * u;
    }
    return speed2;
  }));
  if (std::isfinite(largest_speed_)) return;
  StepFailure::Details details;
  details.cause = "the velocity of the surface of a body is not a finite number";
  details.option = "body.velocity";
  details.value = largest_speed_;
  throw StepFailure(details);
}

double BodyWalls::bytes() const {
  double sum = stencils_.bytes() +
               static_cast<double>(points_.capacity() * sizeof(WallPoint) + body_.capacity() + 4 * middle_.capacity() +
                                   4 * least_.capacity() + 4 * wet_points_.capacity());
  for (const auto& component : wet_position_) sum += component.bytes();
  return sum;
}

}  // namespace spume
