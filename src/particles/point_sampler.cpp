// SPDX-License-Identifier: MIT
#include "spume/particles/point_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/operators/moving_least_squares.hpp"

namespace spume {
namespace {

// How values come from a particle to the place of its image.
struct Mirrored {
  std::array<double, 3> sign{1, 1, 1};  // reflection of geometric offsets
  // Velocity of an image: sign * u + offset, 2 u_wall - u in the components that a wall holds.
  std::array<double, 3> velocity_sign{1, 1, 1};
  Vec3 velocity_offset{};
};

// A point and its reflections: summing the particles around each copy is summing particles and images around the
// point.
struct Copy : Mirrored {
  Vec3 point;
  std::array<int, 3> side{-1, -1, -1};  // of the domain that mirrors, along each axis
};

// Of a probe in a solid, in spacings: farther behind a face it tells nothing of the liquid before it.
constexpr double deepest_probe = 0.5;
// In spacings: a point on a face looks from before it.
constexpr double before_face = 1e-3;

// `face`: SolidUnion::face_near.
void reflect_velocity(const SampledState& state, int axis, int face, Mirrored& copy, const Vec3& point) {
  const Domain& domain = state.boundary->domain();
  Vec3 speed{};
  if (face < 2 && domain.sides[axis][face].velocity) {
    Vec3 foot = point;
    foot[axis] = state.boundary->walls[axis][face];
    speed = state.boundary->wall_velocity(axis, face, foot, state.time);
  }
  for (int a = 0; a < state.particles->dimensions; ++a) {
    if (a != axis && kind_of_face(domain, axis, face) == BoundaryKind::free_slip) continue;
    copy.velocity_sign[a] = -copy.velocity_sign[a];
    copy.velocity_offset[a] = 2 * speed[a] - copy.velocity_offset[a];
  }
}

Mirrored mirrored_by(const SampledState& state, const ImagePath& path, const ImageRules& rules, const Vec3& point) {
  Mirrored result;
  for (int axis = 0; axis < state.particles->dimensions; ++axis) {
    result.sign[axis] = Images::sign(path, rules, axis);
    for (const std::int16_t face : path.face[axis])
      if (face >= 0) reflect_velocity(state, axis, face, result, point);
  }
  return result;
}

// `outside`: how far particles may be beyond periodic sides.
std::vector<Copy> copies_of(const SampledState& state, const Vec3& point, double outside) {
  const Domain& domain = state.boundary->domain();
  const double support_radius = state.arrangement->grid.support_radius();
  std::vector<Copy> copies{{{}, point}};
  for (int axis = 0; axis < state.particles->dimensions; ++axis) {
    const std::size_t made = copies.size();
    const double length = state.boundary->walls[axis][1] - state.boundary->walls[axis][0];
    for (int side = 0; side < 2; ++side) {
      const double plane = state.boundary->walls[axis][side];
      const double reach = domain.periodic(axis) ? support_radius + outside : support_radius;
      if (std::abs(point[axis] - plane) >= reach || domain.sides[axis][side].kind == BoundaryKind::open) continue;
      for (std::size_t c = 0; c < made; ++c) {
        Copy copy = copies[c];
        if (domain.periodic(axis)) {
          copy.point[axis] += side == 0 ? length : -length;
        } else {
          copy.point[axis] = 2 * plane - copy.point[axis];
          copy.sign[axis] = -1;
          copy.side[axis] = side;
          // Without layers the liquid before an opening is all that tells what passes it.
          if (state.layer != nullptr || !state.boundary->open_at(axis, side, point))
            reflect_velocity(state, axis, side, copy, point);
        }
        copies.push_back(copy);
      }
    }
  }
  return copies;
}

// Behind openings stand particles in place of images: as Images::build.
bool mirrored_at_opening(const SampledState& state, const Copy& copy, Vec3 place) {
  for (int axis = 0; axis < state.particles->dimensions; ++axis) {
    const int side = copy.side[axis];
    if (side < 0) continue;
    if (state.boundary->open_at(axis, side, place)) return true;
    place[axis] = 2 * state.boundary->walls[axis][side] - place[axis];
  }
  return false;
}

}  // namespace

const PointSampler& PointSampler::update(const SampledState& state) {
  state_ = state;
  const auto r = read(state.particles->position);
  const CellGrid& grid = state.arrangement->grid;
  table_.build(grid, r[0], r[1], r[2], state.particles->size());
  outside_ = 0;
  for (int axis = 0; axis < state.particles->dimensions; ++axis) {
    if (!state.boundary->domain().periodic(axis)) continue;
    const double lower = state.boundary->walls[axis][0], upper = state.boundary->walls[axis][1];
    outside_ = parallel_max(state.particles->size(), outside_,
                            [&, axis](std::size_t i) { return std::max(lower - r[axis][i], r[axis][i] - upper); });
  }
  if (state.boundary->solids() != nullptr)
    images_.build(state.boundary->image_rules(grid.support_radius()), grid, r[0], r[1], r[2], state.particles->size());
  return *this;
}

double PointSampler::potential_at(const Vec3& r) const {
  double sum = 0;
  for (int axis = 0; axis < state_.particles->dimensions; ++axis)
    sum -= state_.uniform_acceleration[axis] * (r[axis] - state_.arrangement->origin[axis]);
  return sum;
}

Vec3 PointSampler::eye_of(const Vec3& point) const {
  const SolidUnion* solids = state_.boundary->solids();
  if (solids == nullptr || !solids->inside(point)) return point;
  const double gap = before_face * state_.resolution->spacing;
  const Vec3 foot = solids->nearest_free(point, 1e-3 * gap);
  constexpr int ways = 27;  // -1, 0 or 1 along every axis, those along one first
  Vec3 eye = foot;
  for (int most = 1; most <= 3; ++most)
    for (int way = 0; way < ways; ++way) {
      const std::array<int, 3> step{way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1};
      if (std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]) != most) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) eye[axis] = foot[axis] + gap * step[axis];
      if (!solids->inside(eye)) return eye;
    }
  return foot;
}

bool PointSampler::deep_in_solid(const Vec3& point, double depth) const {
  const Vec3 eye = eye_of(point);
  double distance2 = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) distance2 += (eye[axis] - point[axis]) * (eye[axis] - point[axis]);
  return std::sqrt(distance2) > (depth + 2 * before_face) * state_.resolution->spacing;
}

// visit(particle, W V, offset of it or its image from the point, its place, Mirrored) for every particle or image in
// the support of the point; with solids, for those that the point sees.
template <class Visit>
void PointSampler::visit(const Vec3& point, Visit&& visit) const {
  const CellGrid& grid = state_.arrangement->grid;
  const int d = state_.particles->dimensions;
  const double support_radius = grid.support_radius();
  const auto each_in_rows = [&](const Vec3& around, const CellOrder& table, auto&& body) {
    const auto range = [&](int axis) {
      return std::pair(grid.index(axis, around[axis] - support_radius),
                       grid.index(axis, around[axis] + support_radius));
    };
    const auto [x0, x1] = range(0);
    const auto [y0, y1] = range(1);
    const auto [z0, z1] = d == 3 ? range(2) : std::pair(0, 0);
    for (int iz = z0; iz <= z1; ++iz)
      for (int iy = y0; iy <= y1; ++iy) {
        const std::int64_t row = std::int64_t{grid.row(iy, iz)} * grid.columns();
        for (std::int32_t k = table.first()[row + x0]; k < table.first()[row + x1 + 1]; ++k) body(k);
      }
  };
  const auto place_of = [&](std::size_t j) {
    Vec3 place{};
    for (int axis = 0; axis < d; ++axis) place[axis] = (*state_.particles->position[axis])[j];
    return place;
  };
  with_kernel(state_.arrangement->context, [&]<int dimensions, class Kernel>() {
    const double h = state_.resolution->smoothing_length;
    const double scale = state_.particles->volume * Kernel::normalisation(dimensions) / std::pow(h, dimensions);
    const auto weigh = [&](std::size_t j, const Vec3& offset, double r2, const Vec3& place, const Mirrored& mirrored) {
      const double swelling = state_.volume_fraction == nullptr ? 1.0 : 1 / (*state_.volume_fraction)[j];
      visit(j, swelling * scale * Kernel::w(std::sqrt(r2) / h), offset, place, mirrored);
    };
    const auto particle_at = [&](std::int32_t k) {
      return static_cast<std::size_t>(table_.order()[static_cast<std::size_t>(k)]);
    };
    if (const SolidUnion* solids = state_.boundary->solids(); solids != nullptr) {
      const Vec3 eye = eye_of(point);
      const ImageRules rules = state_.boundary->image_rules(support_radius);
      const auto offset_of = [&](const Vec3& place, double& r2) {
        Vec3 offset{};
        r2 = 0;
        for (int axis = 0; axis < d; ++axis) {
          offset[axis] = place[axis] - point[axis];
          r2 += offset[axis] * offset[axis];
        }
        return offset;
      };
      double r2 = 0;
      each_in_rows(point, table_, [&](std::int32_t k) {
        const Vec3 place = place_of(particle_at(k)), offset = offset_of(place, r2);
        if (r2 < support_radius * support_radius && solids->sees(eye, place, place))
          weigh(particle_at(k), offset, r2, place, {});
      });
      each_in_rows(point, images_.table(), [&](std::int32_t k) {
        const auto image = static_cast<std::size_t>(k), j = static_cast<std::size_t>(images_.source()[image]);
        Vec3 at{};
        for (int axis = 0; axis < d; ++axis) at[axis] = images_.position(axis)[image];
        const Vec3 place = place_of(j), offset = offset_of(at, r2);
        if (r2 < support_radius * support_radius && images_.sees(eye, image, place))
          weigh(j, offset, r2, place,
                mirrored_by(state_, images_.paths()[static_cast<std::size_t>(images_.path()[image])], rules, point));
      });
      return;
    }
    const ThinWalls* thin = state_.boundary->bodies() == nullptr ? nullptr : state_.boundary->bodies()->thin();
    const double free = thin == nullptr ? infinite : thin->distance(point);
    for (const Copy& copy : copies_of(state_, point, outside_))
      each_in_rows(copy.point, table_, [&](std::int32_t k) {
        const std::size_t j = particle_at(k);
        if (state_.layer != nullptr && mirrored_at_opening(state_, copy, place_of(j))) return;
        Vec3 offset{}, place = point;
        double r2 = 0;
        for (int axis = 0; axis < d; ++axis) {
          offset[axis] = copy.sign[axis] * ((*state_.particles->position[axis])[j] - copy.point[axis]);
          r2 += offset[axis] * offset[axis];
          place[axis] = copy.sign[axis] > 0 ? point[axis] + offset[axis] : copy.point[axis] - offset[axis];
        }
        if (r2 >= support_radius * support_radius) return;
        if (free < support_radius) {
          const Vec3 seen = add(point, offset);
          if (thin->hides(point, free, seen, thin->free_distance(seen))) return;
        }
        weigh(j, offset, r2, place, copy);
      });
  });
}

double PointSampler::coverage(const Vec3& point) const {
  double sum = 0;
  if (deep_in_solid(point, 0)) return sum;
  visit(point, [&](std::size_t, double weight, const Vec3&, const Vec3&, const Mirrored&) { sum += weight; });
  return sum;
}

double PointSampler::colour(const Vec3& point, const Array<std::int64_t>& phase, std::int64_t number) const {
  double within = 0, all = 0;
  visit(point, [&](std::size_t j, double weight, const Vec3&, const Vec3&, const Mirrored&) {
    all += weight;
    if (phase[j] == number) within += weight;
  });
  return within / all;
}

double PointSampler::wet_share(const Vec3& point) const {
  const BodyWalls* bodies = state_.boundary->bodies();
  if (bodies == nullptr || !bodies->nearer_than(point, state_.arrangement->grid.support_radius()))
    return coverage(eye_of(point));
  const double distance = bodies->distance(point);
  if (distance < -deepest_probe * state_.resolution->spacing) return 0;
  // With the liquid mirrored in the tangent plane: beside a wall about half of the surroundings is liquid.
  return coverage(point) + coverage(subtract(point, multiply(2 * distance, bodies->normal(point))));
}

PointSample PointSampler::sample(const Vec3& point) const {
  if (!deep_in_solid(point, deepest_probe) && wet_share(point) >= 0.5) return fit(point);
  const double none = std::numeric_limits<double>::quiet_NaN();
  return {.scalars = std::vector<double>(state_.scalars.size(), none),
          .velocity = {none, none, none},
          .coverage = coverage(point)};
}

// A fit takes four fields. Scalar 0 and the velocity are fields 0 to 3, the other scalars follow.
PointSample PointSampler::fit(const Vec3& point) const {
  constexpr std::size_t wide = LinearFit::fields;
  const int d = state_.particles->dimensions;
  const std::vector<SampledScalar>& scalars = state_.scalars;
  const auto field_of = [](std::size_t scalar) { return scalar == 0 ? 0 : scalar + 3; };
  std::vector<LinearFit> fits(1 + (scalars.size() + 2) / wide, LinearFit(d));
  std::vector<std::array<double, wide>> values(fits.size());
  PointSample sample{.scalars = std::vector<double>(scalars.size())};
  visit(point, [&](std::size_t j, double weight, const Vec3& offset, const Vec3& place, const Mirrored& copy) {
    // A wall mirrors a pressure but for its hydrostatic part, which belongs to the place of the source.
    Vec3 scaled{};
    for (int axis = 0; axis < d; ++axis) {
      scaled[axis] = offset[axis] / state_.resolution->smoothing_length;
      values[0][axis + 1] =
          copy.velocity_sign[axis] * (*state_.particles->velocity[axis])[j] + copy.velocity_offset[axis];
    }
    for (std::size_t k = 0; k < scalars.size(); ++k) {
      const double value = (*scalars[k].values)[j];
      values[field_of(k) / wide][field_of(k) % wide] = value + scalars[k].hydrostatic_density * potential_at(place);
      sample.scalars[k] += weight * value;
    }
    for (std::size_t k = 0; k < fits.size(); ++k) fits[k].add(weight, scaled, values[k]);
  });
  if (fits[0].count() == 0) return sample;
  std::vector<LinearFit::Result> results;
  results.reserve(fits.size());
  for (const LinearFit& fit : fits) results.push_back(fit.at_centre());
  sample.coverage = fits[0].weight();
  for (std::size_t k = 0; k < scalars.size(); ++k)
    sample.scalars[k] = results[0].fitted ? results[field_of(k) / wide].value[field_of(k) % wide] -
                                                scalars[k].hydrostatic_density * potential_at(point)
                                          : sample.scalars[k] / sample.coverage;
  for (int axis = 0; axis < d; ++axis) sample.velocity[axis] = results[0].value[axis + 1];
  return sample;
}

double PointSampler::crossing(Vec3 wet, double dry) const {
  const int up = state_.particles->dimensions - 1;
  double inside = wet[up];
  for (int k = 0; k < 20; ++k) {  // halves: to 1e-6 of where it started
    wet[up] = 0.5 * (inside + dry);
    (coverage(wet) >= 0.5 ? inside : dry) = wet[up];
  }
  return inside;
}

double PointSampler::highest_sample(const Vec3& point, Vec3& sample) const {
  const int up = state_.particles->dimensions - 1;
  const double bottom = state_.boundary->domain().lower[up];
  const double step = state_.resolution->spacing / 4;
  sample = point;
  sample[up] = 2 * step + parallel_max(state_.particles->size(), bottom,
                                       [&](std::size_t i) { return (*state_.particles->position[up])[i]; });
  return step;
}

double PointSampler::elevation(const Vec3& point) const {
  const int up = state_.particles->dimensions - 1;
  const double bottom = state_.boundary->domain().lower[up];
  Vec3 r;
  for (const double step = highest_sample(point, r); r[up] > bottom; r[up] -= step)
    if (coverage(r) >= 0.5) return crossing(r, r[up] + step);
  return bottom;
}

double PointSampler::wetted_length(const Vec3& point) const {
  const int up = state_.particles->dimensions - 1;
  const double bottom = state_.boundary->domain().lower[up];
  double length = 0, top = bottom;
  bool above = false;  // whether the last sample was wet
  Vec3 r;
  for (const double step = highest_sample(point, r); r[up] > bottom; r[up] -= step) {
    const bool wet = coverage(r) >= 0.5;
    if (wet && !above) top = crossing(r, r[up] + step);
    if (!wet && above) {
      Vec3 inside = r;
      inside[up] += step;
      length += top - crossing(inside, r[up]);
    }
    above = wet;
  }
  return above ? length + top - bottom : length;
}

double PointSampler::front(int axis, double height) const {
  const int up = state_.particles->dimensions - 1;
  const double lowest = state_.boundary->domain().lower[axis];
  const double farthest = parallel_max(state_.particles->size(), lowest, [&](std::size_t i) {
    if (state_.layer != nullptr && (*state_.layer)[i] >= 0) return lowest;
    if ((*state_.particles->position[up])[i] >= height) return lowest;
    Vec3 r{};
    for (int a = 0; a < state_.particles->dimensions; ++a) r[a] = (*state_.particles->position[a])[i];
    return coverage(r) >= 0.5 ? r[axis] : lowest;
  });
  if (farthest == lowest) return lowest;
  const double front = farthest + 0.5 * state_.resolution->spacing;
  return state_.layer == nullptr ? front : std::min(front, state_.boundary->walls[axis][1]);
}

}  // namespace spume
