// SPDX-License-Identifier: MIT
#include "spume/physics/oxygen/rigid_bubbles.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "spume/core/error.hpp"
#include "spume/core/kernel.hpp"
#include "spume/core/parallel.hpp"

namespace spume::oxygen {
namespace {

// Facets over the largest extent of a shape: areas of smooth shapes are right to (pi / 1000)^2 / 24, 4e-7, in two
// dimensions and to 1e-4 in three.
constexpr double facets_2d = 1000, facets_3d = 60;

Vec3 copy_nearest_to(const Domain& domain, const Vec3& centre, Vec3 r) {
  for (int axis = 0; axis < domain.dimensions; ++axis)
    if (domain.periodic(axis)) {
      const double period = domain.upper[axis] - domain.lower[axis];
      r[axis] -= period * std::round((r[axis] - centre[axis]) / period);
    }
  return r;
}

// Of the sphere of the same volume, or the circle of the same area.
double equivalent_diameter(double volume, int dimensions) {
  return dimensions == 3 ? std::cbrt(6 * volume / std::numbers::pi) : 2 * std::sqrt(volume / std::numbers::pi);
}

bool is_bubble(const Scene& scene, const BodyMotion& motion) {
  if (!motion.release) return false;
  const Body& body = scene.bodies[motion.bodies.front()];
  return body.inside && body.wall != BoundaryKind::open;
}

// The number of its release that a body is on its way with.
std::int64_t release_number(const Release& release, double t) {
  return static_cast<std::int64_t>(std::floor((t - release.first) / release.cycle));
}

double power(double x, int n) {
  return n == 3 ? x * x * x : n == 2 ? x * x : x;
}

}  // namespace

double surface_area(const Shape& shape, int dimensions) {
  const Bounds box = shape.bounds();
  double extent = 0;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a)
    extent = std::max(extent, box.upper[a] - box.lower[a]);
  const TriangleSurface surface = shape.surface(box, extent / (dimensions == 3 ? facets_3d : facets_2d));
  double sum = 0;
  if (dimensions == 3) {
    for (const auto& t : surface.triangles) {
      const Vec3& a = surface.points[static_cast<std::size_t>(t[0])];
      sum += length(cross(subtract(surface.points[static_cast<std::size_t>(t[1])], a),
                          subtract(surface.points[static_cast<std::size_t>(t[2])], a))) /
             2;
    }
    return sum;
  }
  // The edges of one triangle alone are those of the shape.
  std::map<std::array<std::int32_t, 2>, int> edges;
  for (const auto& t : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
  for (const auto& [edge, triangles] : edges)
    if (triangles == 1)
      sum += length(subtract(surface.points[static_cast<std::size_t>(edge[1])],
                             surface.points[static_cast<std::size_t>(edge[0])]));
  return sum;
}

const char* in_words(const Scene& scene) {
  return RigidBubbles::exist(scene) ? "transfer from released bodies and through the surface"
                                    : "transfer through the surface";
}

bool RigidBubbles::exist(const Scene& scene) {
  return std::any_of(scene.motions.begin(), scene.motions.end(),
                     [&](const BodyMotion& motion) { return is_bubble(scene, motion); });
}

RigidBubbles::RigidBubbles(const Scene& scene, const Resolution& resolution, const Gas& gas)
    : scene_(scene),
      gas_(gas),
      dimensions_(scene.domain.dimensions),
      h_(resolution.smoothing_length),
      support_(resolution.support_radius),
      near_(scene.domain, resolution.spacing, 0) {
  for (std::size_t m = 0; m < scene.motions.size(); ++m) {
    const BodyMotion& motion = scene.motions[m];
    if (!is_bubble(scene, motion)) continue;
    const Body& body = scene.bodies[motion.bodies.front()];
    const Bounds box = body.alone->bounds();
    Vec3 farthest{};
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions_); ++a)
      farthest[a] = std::max(box.upper[a] - motion.pivot[a], motion.pivot[a] - box.lower[a]);
    Bubble bubble{.motion = m, .shape = body.alone, .volume = body.alone->volume(), .reach = length(farthest)};
    // Copies of an entry have its shape.
    bubble.area = motion.release->copy > 0 && bubbles_.back().shape == bubble.shape
                      ? bubbles_.back().area
                      : surface_area(*bubble.shape, dimensions_);
    bubbles_.push_back(std::move(bubble));
  }
  turns_.resize(bubbles_.size());
  saved_.add(released_).add(given_).add(left_).add(conductance_).add(capacity_).add(area_);
}

// What it sets out with.
Contents RigidBubbles::first_contents(const Bubble& bubble) const {
  const double height = scene_.motions[bubble.motion].pivot[static_cast<std::size_t>(dimensions_ - 1)];
  const double total = gas_.moles(bubble.volume, height), oxygen = gas_.fraction * total;
  return {oxygen, total - oxygen};
}

double RigidBubbles::oxygen_feed() const {
  double feed = 0;
  for (const Bubble& bubble : bubbles_)
    feed += mass(first_contents(bubble)) / scene_.motions[bubble.motion].release->cycle;
  return feed;
}

void RigidBubbles::each(const Each& see) const {
  const Domain& domain = scene_.domain;
  const Vec3 middle = multiply(0.5, add(domain.lower, domain.upper));
  for (const Turn& turn : turns_)
    if (turn.conductance > 0)
      see(copy_nearest_to(domain, middle, turn.place.position), turn.conductance, turn.capacity);
}

void RigidBubbles::set_out(double t) {
  for (std::size_t b = 0; b < bubbles_.size(); ++b) {
    Bubble& bubble = bubbles_[b];
    const BodyMotion& motion = scene_.motions[bubble.motion];
    turns_[b] = {.place = given_place(motion, t)};
    const std::int64_t turn = turns_[b].place.scale > 0 ? release_number(*motion.release, t) : -1;
    if (turn == bubble.turn) continue;
    left_ += mass(bubble.contents);
    bubble.contents = turn < 0 ? Contents{} : first_contents(bubble);
    bubble.turn = turn;
    released_ += mass(bubble.contents);
  }
}

void RigidBubbles::find_particles(const Liquid& liquid) {
  near_.clear();
  for (std::size_t b = bubbles_.size(); b-- > 0;) {
    if (bubbles_[b].turn < 0) continue;
    const double reach = turns_[b].place.scale * bubbles_[b].reach + support_;
    const Vec3& centre = turns_[b].place.position;
    near_.mark({subtract(centre, {reach, reach, reach}), add(centre, {reach, reach, reach})}, b);
  }
  seen_.resize(block_count(liquid.size, default_block));
  parallel_blocks(liquid.size, default_block, [&](std::size_t block, std::size_t first, std::size_t last) {
    std::vector<Seen>& found = seen_[block];
    found.clear();
    for (std::size_t i = first; i < last; ++i) {
      if (liquid.left_out != nullptr && (*liquid.left_out)[i] >= 0) continue;
      const Vec3 r = vector_at(liquid.places, dimensions_, i);
      const auto see = [&](std::size_t b) {
        if (bubbles_[b].turn < 0) return;
        const RigidPlace& place = turns_[b].place;
        const Vec3 own = copy_nearest_to(scene_.domain, place.position, r);
        const double reach = place.scale * bubbles_[b].reach + support_;
        const Vec3 way = subtract(own, place.position);
        if (dot(way, way) > reach * reach) return;
        const double distance = place.scale * bubbles_[b].shape->distance(place.start(own));
        const double weight = WendlandC2::w(std::max(distance, 0.0) / h_);
        if (distance < support_ && weight > 0)
          found.push_back({static_cast<std::int32_t>(b), static_cast<std::int32_t>(i), weight});
      };
      if (near_.visit(r, see)) continue;
      for (std::size_t b = 0; b < bubbles_.size(); ++b) see(b);
    }
  });
}

double RigidBubbles::exchange(double t, double dt, const Liquid& liquid, Array<float>& change) {
  set_out(t);
  find_particles(liquid);
  // In the order of the particles, whatever the threads.
  for (const std::vector<Seen>& block : seen_)
    for (const Seen& one : block) {
      Turn& turn = turns_[static_cast<std::size_t>(one.bubble)];
      const auto i = static_cast<std::size_t>(one.particle);
      turn.weight += one.weight;
      turn.concentration += one.weight * liquid.dissolved[i];
      for (int axis = 0; axis < dimensions_; ++axis) turn.velocity[axis] += one.weight * (*liquid.velocity[axis])[i];
    }
  conductance_ = capacity_ = area_ = 0;
  double sum = 0;
  for (std::size_t b = 0; b < bubbles_.size(); ++b) {
    Turn& turn = turns_[b];
    Bubble& bubble = bubbles_[b];
    if (bubble.turn < 0 || !(turn.weight > 0)) continue;
    const double scale = turn.place.scale;
    const Vec3 slip = subtract(turn.place.velocity, multiply(1 / turn.weight, turn.velocity));
    const Interface interface {
      .diameter = scale * equivalent_diameter(bubble.volume, dimensions_),
      .area = power(scale, dimensions_ - 1) * bubble.area
    };
    const Exchange result = oxygen::exchange(gas_, bubble.contents, interface,
                                             turn.place.position[static_cast<std::size_t>(dimensions_ - 1)],
                                             length(slip), turn.concentration / turn.weight, dt);
    bubble.contents = result.after;
    turn.given = result.given;
    turn.conductance = result.conductance;
    turn.capacity = result.capacity;
    sum += result.given;
    conductance_ += result.conductance;
    capacity_ += result.capacity;
    area_ += interface.area;
  }
  given_ += sum;
  change.fill(0.0F);
  for (const std::vector<Seen>& block : seen_)
    for (const Seen& one : block) {
      const Turn& turn = turns_[static_cast<std::size_t>(one.bubble)];
      change[static_cast<std::size_t>(one.particle)] +=
          static_cast<float>(one.weight / turn.weight * turn.given / liquid.particle_volume);
    }
  return sum;
}

void RigidBubbles::add_columns(SeriesTable& series) const {
  series.add("bubble_area", dimensions_ == 3 ? "length^2" : "length, per depth", [this] { return area_; });
  series.add("oxygen_released", "g, with the gas, since the start", [this] { return released_; });
  series.add("oxygen_from_bubbles", "g, given to the liquid since the start", [this] { return given_; });
  series.add("oxygen_left", "g, with bubbles that were taken away, since the start", [this] { return left_; });
  series.add("oxygen_in_bubbles", "g", [this] {
    double sum = 0;
    for (const Bubble& bubble : bubbles_) sum += mass(bubble.contents);
    return sum;
  });
}

void RigidBubbles::save(StateWriter& writer) const {
  saved_.save(writer);
  Array<double> contents(2 * bubbles_.size());
  Array<std::int64_t> turns(bubbles_.size());
  for (std::size_t b = 0; b < bubbles_.size(); ++b) {
    contents[2 * b] = bubbles_[b].contents.oxygen;
    contents[2 * b + 1] = bubbles_[b].contents.inert;
    turns[b] = bubbles_[b].turn;
  }
  writer.f64("rigid_bubble_gas", {contents.data(), contents.size()});
  writer.i64("rigid_bubble_turns", {turns.data(), turns.size()});
}

void RigidBubbles::load(StateReader& reader) {
  saved_.load(reader);
  Array<double> contents;
  Array<std::int64_t> turns;
  reader.f64("rigid_bubble_gas", contents);
  reader.i64("rigid_bubble_turns", turns);
  if (turns.size() != bubbles_.size() || contents.size() != 2 * bubbles_.size())
    throw FileError("the checkpoint holds other released bodies than the case");
  for (std::size_t b = 0; b < bubbles_.size(); ++b) {
    bubbles_[b].contents = {contents[2 * b], contents[2 * b + 1]};
    bubbles_[b].turn = turns[b];
  }
}

}  // namespace spume::oxygen
