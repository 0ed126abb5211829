// SPDX-License-Identifier: MIT
#include "spume/particles/thin_walls.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

// In spacings.
constexpr double grazing = 0.05, least_stride = 1e-3;
// Spacings: a bound that is more stands for the distance where less is of use too.
constexpr double clear = 0.1;
// Halves of halves, after which what is left of a way is shorter than `grazing` for any that lists have.
constexpr int most_halves = 8;
// Spacings: of a flat face from its plane.
constexpr double on_face = 0.1;
// Of the height above a face, what is free half-way to it where nothing else is near; one half above a plane.
constexpr double free_half_way = 0.4;

}  // namespace

ThinWalls::ThinWalls(const Scene& scene, const Resolution& resolution, std::vector<const RigidWalls*> parts)
    : parts_(std::move(parts)), spacing_(resolution.spacing), reach_(resolution.support_radius) {
  const Domain& domain = scene.domain;
  sides_.dimensions = domain.dimensions;
  sides_.lower = domain.lower;
  sides_.upper = domain.upper;
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (int side = 0; side < 2; ++side)
      sides_.sides[axis][side] = domain.periodic(axis)                                 ? ImageKind::periodic
                                 : domain.sides[axis][side].kind == BoundaryKind::open ? ImageKind::none
                                                                                       : ImageKind::mirror;
}

void ThinWalls::set_sides(const ImageRules& rules) {
  sides_ = rules;
  sides_.solids.reset();
  sides_.open_at = nullptr;
}

Vec3 ThinWalls::folded(const Vec3& place, Vec3* sign) const {
  Vec3 inside = place;
  for (int axis = 0; axis < sides_.dimensions; ++axis) {
    const double lower = sides_.lower[axis], upper = sides_.upper[axis];
    const auto& kinds = sides_.sides[axis];
    double& x = inside[axis];
    if (kinds[0] == ImageKind::periodic) {
      if (x < lower) x += upper - lower;
      if (x > upper) x -= upper - lower;
      continue;
    }
    if (kinds[0] == ImageKind::mirror && x < lower)
      x = 2 * lower - x;
    else if (kinds[1] == ImageKind::mirror && x > upper)
      x = 2 * upper - x;
    else
      continue;
    if (sign != nullptr) (*sign)[axis] = -1;
  }
  return inside;
}

double ThinWalls::distance(const Vec3& place) const {
  const Vec3 inside = folded(place);
  double least = infinite;
  for (const RigidWalls* part : parts_)
    if (!part->surely_farther(inside, 2 * reach_)) least = std::min(least, part->thin_distance(inside));
  return least;
}

NearDistances::Range ThinWalls::range(const Vec3& place) const {
  const Vec3 inside = folded(place);
  NearDistances::Range found{infinite, infinite};
  for (const RigidWalls* part : parts_) {
    const NearDistances::Range own = part->thin_range(inside);
    found = {std::min(found.least, own.least), std::min(found.most, own.most)};
  }
  return found;
}

NearestPoint ThinWalls::nearest(const Vec3& place) const {
  NearestPoint best;
  best.distance = infinite;
  for (const RigidWalls* part : parts_) {
    const NearestPoint own = nearest(*part, place);
    if (own.distance < best.distance) best = own;
  }
  return best;
}

NearestPoint ThinWalls::nearest(const RigidWalls& part, const Vec3& place) const {
  Vec3 sign{1, 1, 1};
  NearestPoint found = part.thin_nearest(folded(place, &sign));
  for (std::size_t axis = 0; axis < 3; ++axis) found.normal[axis] *= sign[axis];
  return found;
}

double ThinWalls::free_distance(const Vec3& place) const {
  const double least = range(place).least;
  return least > clear * spacing_ ? least : distance(place);
}

bool ThinWalls::hides(const Vec3& from, const Vec3& to) const {
  const double free = std::max(range(from).least, 0.0) + std::max(range(to).least, 0.0);
  if (length(subtract(to, from)) <= free + 2 * grazing * spacing_) return false;
  return hides(from, distance(from), to, distance(to));
}

bool ThinWalls::hides(const Vec3& from, double from_distance, const Vec3& to, double to_distance) const {
  return hides(from, from_distance, to, to_distance, length(subtract(to, from)), 0);
}

bool ThinWalls::hides(const Vec3& a, double da, const Vec3& b, double db, double length, int depth) const {
  if (length <= std::max(da, 0.0) + std::max(db, 0.0) + 2 * grazing * spacing_ || depth == most_halves) return false;
  Vec3 middle;
  for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] = 0.5 * (a[axis] + b[axis]);
  const NearDistances::Range bounds = range(middle);
  const double dm = bounds.most < -grazing * spacing_ ? bounds.most
                    : bounds.least > clear * spacing_ ? bounds.least
                                                      : distance(middle);
  if (dm < -grazing * spacing_) return true;
  return hides(a, da, middle, dm, length / 2, depth + 1) || hides(middle, dm, b, db, length / 2, depth + 1);
}

std::optional<ThinWalls::Entry> ThinWalls::entry(const Vec3& from, double from_distance, const Vec3& to) const {
  const Vec3 way = subtract(to, from);
  const double size = length(way), tiny = grazing * spacing_;
  if (!(size > 0)) return std::nullopt;
  double gone = 0, away = from_distance;
  while (true) {
    const Vec3 at = add(from, multiply(gone / size, way));
    if (away <= tiny) {
      const NearestPoint near = nearest(at);
      if (dot(near.normal, way) < 0 || away < -tiny) return Entry{at, near.normal};
    }
    if (gone >= size) return std::nullopt;
    gone = std::min(size, gone + std::max(away, tiny));
    away = free_distance(add(from, multiply(gone / size, way)));
  }
}

std::optional<ThinWalls::Entry> ThinWalls::entry(const RigidWalls& part, const Vec3& from, const Vec3& to) const {
  const Vec3 way = subtract(to, from);
  const double size = length(way);
  if (!(size > 0)) return std::nullopt;
  double gone = 0;
  while (true) {
    const Vec3 at = add(from, multiply(gone / size, way));
    const double away = part.thin_distance(folded(at));
    if (away <= 0) {
      const NearestPoint near = nearest(part, at);
      if (dot(near.normal, way) < 0 || away < -grazing * spacing_) return Entry{at, near.normal};
    }
    if (gone >= size) return std::nullopt;
    gone = std::min(size, gone + std::max(away, least_stride * spacing_));
  }
}

void ThinWalls::measure(const std::array<const double*, 3>& position, std::size_t particles, double reach) {
  position_ = position;
  particles_ = particles;
  reach_ = reach;
  images_ = nullptr;
  distance_.resize(particles);
  parallel_for(particles, [&](std::size_t i) { distance_[i] = static_cast<float>(free_distance(particle_place(i))); });
}

void ThinWalls::measure(const Images& images, const std::vector<WallPoint>& points,
                        const std::vector<std::int32_t>& wet) {
  images_ = &images;
  points_ = &points;
  wet_ = &wet;
  distance_.resize(particles_ + images.size());
  parallel_for(images.size(), [&](std::size_t k) {
    const bool of_body = images.wall_point() != nullptr && images.wall_point()[k] >= 0 &&
                         static_cast<std::size_t>(images.wall_point()[k]) < wet.size();
    distance_[particles_ + k] = of_body ? 0 : static_cast<float>(free_distance(image_place(k)));
  });
}

Vec3 ThinWalls::particle_place(std::size_t particle) const {
  Vec3 place{};
  for (int axis = 0; axis < sides_.dimensions; ++axis) place[axis] = position_[axis][particle];
  return place;
}

Vec3 ThinWalls::image_place(std::size_t image) const {
  Vec3 place{};
  for (int axis = 0; axis < sides_.dimensions; ++axis) place[axis] = images_->position(axis)[image];
  return place;
}

// As Images::move.
Vec3 ThinWalls::imaged(const ImagePath& path, const Vec3& place) const {
  Vec3 at = place;
  for (int axis = 0; axis < sides_.dimensions; ++axis) {
    const std::int8_t side = path.side[axis];
    if (side < 0) continue;
    const double lower = sides_.lower[axis], upper = sides_.upper[axis];
    if (sides_.sides[axis][side] == ImageKind::mirror)
      at[axis] = 2 * (side == 0 ? lower : upper) - at[axis];
    else
      at[axis] += side == 0 ? lower - upper : upper - lower;
  }
  return at;
}

bool ThinWalls::sees_face(const Vec3& eye, double eye_distance, const Vec3& point, const Vec3& unfolded,
                          const WallPoint& kind) const {
  const Vec3 across = subtract(unfolded, point);
  const double size = length(across);
  const Vec3 normal = multiply(1 / size, across), way = subtract(point, eye);
  const double above = -dot(way, normal) - size / 2;  // the eye above the plane of the face
  if (!(above > 0)) return false;
  const Vec3 crossing = add(eye, multiply(above / (above + size / 2), way));
  // What is within the support of a flat face, beside which no other is, sees it, unless something that moves is near.
  if (kind.flat && parts_.size() == 1) return true;
  if (kind.flat || (!kind.beside_edge && std::abs(distance(crossing)) < on_face * spacing_)) {
    Vec3 half_way;
    for (std::size_t axis = 0; axis < 3; ++axis) half_way[axis] = 0.5 * (eye[axis] + crossing[axis]);
    if (range(half_way).least > free_half_way * above || distance(half_way) > free_half_way * above) return true;
  }
  const std::optional<Entry> found = entry(eye, eye_distance, point);
  return found && dot(found->normal, normal) > kind.least_cosine;
}

// The face that the way to a point enters has what the point mirrors before it and the point behind it: so have those
// of the corner between, but none past their ends, which both stand behind.
bool ThinWalls::enters_between(const Vec3& eye, double eye_distance, const Vec3& point, const Vec3& mirror) const {
  const std::optional<Entry> found = entry(eye, eye_distance, point);
  return found && dot(subtract(mirror, found->place), found->normal) > 0 &&
         dot(subtract(point, found->place), found->normal) < 0;
}

bool ThinWalls::is_behind_face(std::size_t point) const {
  if (point < particles_ || images_->wall_point() == nullptr) return false;
  const std::int32_t g = images_->wall_point()[point - particles_];
  if (g < 0 || static_cast<std::size_t>(g) >= wet_->size()) return false;
  const WallPoint& wall = (*points_)[static_cast<std::size_t>((*wet_)[static_cast<std::size_t>(g)])];
  return wall.one_sided || wall.in_corner;
}

bool ThinWalls::sees(std::size_t particle, std::size_t point) const {
  const Vec3 eye = particle_place(particle);
  const double eye_distance = distance_[particle];
  if (eye_distance >= reach_) return !is_behind_face(point);
  if (point < particles_) return !hides(eye, eye_distance, particle_place(point), distance_[point]);
  const std::size_t k = point - particles_;
  const Vec3 place = image_place(k);
  const std::int32_t g = images_->wall_point() == nullptr ? -1 : images_->wall_point()[k];
  if (g < 0 || static_cast<std::size_t>(g) >= wet_->size()) return !hides(eye, eye_distance, place, distance_[point]);
  const WallPoint& wall = (*points_)[static_cast<std::size_t>((*wet_)[static_cast<std::size_t>(g)])];
  const Vec3 unfolded = imaged(images_->paths()[static_cast<std::size_t>(images_->path()[k])], wall.unfolded());
  return sees(eye, eye_distance, place, unfolded, wall);
}

bool ThinWalls::sees(const Vec3& eye, double eye_distance, const Vec3& point, const Vec3& unfolded,
                     const WallPoint& kind) const {
  if (eye_distance >= reach_) return !kind.one_sided && !kind.in_corner;
  if (kind.one_sided) return sees_face(eye, eye_distance, point, unfolded, kind);
  return !hides(eye, eye_distance, unfolded, free_distance(unfolded)) &&
         (!kind.turned || enters_between(eye, eye_distance, point, unfolded));
}

}  // namespace spume
