// SPDX-License-Identifier: MIT
// Bubbles beside walls.
//
// The liquid behind the surface of a body is its wall points, which bubbles see as they see particles. Of a bubble the
// liquid sees, besides itself, its reflection in the point of the surface nearest to it, with the share
//
//   s_b = sum_g V_g W(r_b - r_g, h_g) / sum_i V_i W(r_b' - r_i, h_i),    g wall points, i particles,
//
// so that what wall points would receive of the bubble goes to the particles around its reflection: all of the bubble
// arrives in the liquid, at surfaces of any curvature and in corners. Before a plane the share is 1, as of an image in
// a side of the domain.
//
// A bubble that is pressed to a surface, a side of the domain or a box slides along it: what would lead it nearer than
// the gap that particles keep within a step is taken away, together with the forces that press it, which the wall
// bears. Between two of them it slides along their edge, between three it rests. Without this 20 bubbles of 0.02 below
// a ridge or a lid stir the liquid without an end, to 0.15 and 0.34 after six units of time.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "liquid_record.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/core/vectors.hpp"
#include "spume/physics/bubbles/coupling.hpp"

namespace spume::bubbles {
namespace {

// In the corner of three planes a bubble has seven reflections, of which one is made.
constexpr double largest_share = 7;
// The sine of the angle between walls above which they make an edge.
constexpr double least_of_edge = 1e-3;
// The cosine of the angle between walls below which they make an edge. A wall that bends under way by less than 17
// degrees is one: held at both of its normals a bubble in a pipe that lies lost half of its speed in every step.
constexpr double bend = 0.955;

// Kernel sums of particles and of wall points around a place, with their images.
struct Weights {
  double liquid = 0, walls = 0;
};

constexpr std::uint8_t beside = 1, without_reflection = 2;

}  // namespace

// The bubbles nearer to a surface than the liquid sees, and where they are reflected. Beyond a wall of the domain there
// is no reflection, as there are no wall points.
void BubbleCoupling::reflect_bubbles(const ImageRules& rules) {
  const std::size_t nb = population_.size();
  const BodyWalls& bodies = *carrier_.boundary.bodies();
  for (auto& component : mirrored_place_) component.resize(nb);
  wall_near_.resize(nb);
  const auto reflect = [&](const Vec3& r, const NearestPoint& wall, Vec3& place) {
    place = subtract(multiply(2, wall.point), r);
    for (std::size_t a = 0; a < 3; ++a) {
      if (rules.sides[a][0] == ImageKind::periodic)
        place[a] = wrap_periodic(place[a], rules.lower[a], rules.upper[a] - rules.lower[a]);
      if ((rules.sides[a][0] == ImageKind::mirror && place[a] < rules.lower[a]) ||
          (rules.sides[a][1] == ImageKind::mirror && place[a] > rules.upper[a]))
        return false;
    }
    return true;
  };
  parallel_for(nb, [&](std::size_t b) {
    const Vec3 r = vector_at(population_.next_position, 3, b);
    const auto wall = bodies.wall_within(r, rules.support_radius);
    Vec3 place = r;
    wall_near_[b] = !wall ? 0 : reflect(r, *wall, place) ? beside : without_reflection;
    for (std::size_t a = 0; a < 3; ++a) mirrored_place_[a][b] = wall_near_[b] == beside ? place[a] : r[a];
  });
  parallel_select(nb, beside_walls_, [&](std::size_t b) { return wall_near_[b] != 0; });
  for (auto& component : reflection_) component.resize(beside_walls_.size());
  parallel_for(beside_walls_.size(), [&](std::size_t k) {
    for (std::size_t a = 0; a < 3; ++a)
      reflection_[a][k] = mirrored_place_[a][static_cast<std::size_t>(beside_walls_[k])];
  });
}

WallPointView BubbleCoupling::reflections() const {
  return {beside_walls_.size(),
          {reflection_[0].data(), reflection_[1].data(), reflection_[2].data()},
          beside_walls_.data()};
}

// Calls take(k, own, mirrored) for every bubble beside walls, with the weights around it and around its reflection.
// `point`: coordinates of particles and images; factor(j) multiplies their weights.
template <class Factor, class Take>
void BubbleCoupling::weigh_beside_walls(const std::array<const float*, 3>& point, const Factor& factor,
                                        const Take& take) const {
  const Arrangement& arrangement = carrier_.arrangement;
  const Images& images = arrangement.images;
  const std::size_t n = carrier_.size();
  const CrossSearch::Points sets[] = {{&arrangement.table, n}, images_as_points(images)};
  const CrossSearch search(arrangement.grid, arrangement.origin, point, sets);
  const auto largest = static_cast<float>(arrangement.grid.support_radius() * carrier_.sizes.largest_length_ratio);
  const std::int32_t* wall_point = images.wall_point();
  with_plain_kernel(3, carrier_.resolution.kernel, [&]<int d, class Kernel>() {
    const auto weights_around = [&](const std::array<float, 3>& place, CrossSearch::Found& found) {
      search.near_place(place, largest, inverse_support_radius_.data(), found);
      Weights sum;
      for (std::size_t k = 0; k < found.size; ++k) {
        const auto j = static_cast<std::size_t>(found.index[k]);
        const bool of_wall = j >= n && wall_point != nullptr && wall_point[j - n] >= 0;
        (of_wall ? sum.walls : sum.liquid) +=
            double{Kernel::w(static_cast<float>(Kernel::support) * std::sqrt(found.share2[k]))} * factor(j);
      }
      return sum;
    };
    parallel_blocks(beside_walls_.size(), 64, [&](std::size_t, std::size_t first, std::size_t last) {
      thread_local CrossSearch::Found found;
      for (std::size_t k = first; k < last; ++k) {
        const auto b = static_cast<std::size_t>(beside_walls_[k]);
        std::array<float, 3> own, mirrored;
        for (std::size_t a = 0; a < 3; ++a) {
          own[a] = bubble_point_[a][b];
          mirrored[a] = static_cast<float>(reflection_[a][k] - arrangement.origin[a]);
        }
        const Weights around = weights_around(own, found);
        take(k, around, weights_around(mirrored, found));
      }
    });
  });
}

// s_b. Volumes are those of the volume fraction that h_i follows, so that V_i / h_i^3 is the same everywhere.
void BubbleCoupling::weigh_reflections() {
  const Arrangement& arrangement = carrier_.arrangement;
  const std::size_t n = carrier_.size(), m = arrangement.images.size();
  reflection_share_.resize(beside_walls_.size());
  if (beside_walls_.size() == 0) return;
  inverse_support_radius_.resize(n + m + simd::pair_lanes);
  std::array<const float*, 3> point{};
  for (std::size_t a = 0; a < 3; ++a) {
    liquid_point_[a].resize(n + m + simd::pair_lanes);
    const double *particle = carrier_.intermediate_position[a]->data(),
                 *image = arrangement.images.position(static_cast<int>(a)), zero = arrangement.origin[a];
    float* out = liquid_point_[a].data();
    parallel_for(n, [=](std::size_t i) { out[i] = static_cast<float>(particle[i] - zero); });
    parallel_for(m, [=](std::size_t k) { out[n + k] = static_cast<float>(image[k] - zero); });
    point[a] = out;
  }
  const float* support_radius = carrier_.sizes.support_radius.data();
  const std::int32_t* source = arrangement.images.source();
  parallel_for(n, [&](std::size_t i) { inverse_support_radius_[i] = 1 / support_radius[i]; });
  parallel_for(m, [&](std::size_t k) { inverse_support_radius_[n + k] = 1 / support_radius[source[k]]; });
  weigh_beside_walls(
      point, [](std::size_t) { return 1.0; },
      [&](std::size_t k, const Weights& around, const Weights& mirrored) {
        const bool reflected = wall_near_[static_cast<std::size_t>(beside_walls_[k])] == beside && mirrored.liquid > 0;
        reflection_share_[k] =
            reflected ? static_cast<float>(std::min(largest_share, around.walls / mirrored.liquid)) : 0.0F;
      });
}

// The sum of the weights with which particles receive what a bubble and its reflection give.
void BubbleCoupling::weigh_received() {
  received_weight_.resize(population_.size());
  parallel_for(population_.size(), [&](std::size_t b) {
    received_weight_[b] = interpolated_[b * liquid_record::record + liquid_record::factor_at];
  });
  const NeighbourList& list = carrier_.arrangement.list;
  double scale = 0;
  with_kernel(carrier_.arrangement.context,
              [&]<int d, class Kernel>() { scale = KernelScale<d, Kernel>(carrier_.arrangement.context).value; });
  weigh_beside_walls(
      {list.coordinate(0), list.coordinate(1), list.coordinate(2)},
      [&](std::size_t j) { return double{liquid_records_[j * liquid_record::record + liquid_record::factor_at]}; },
      [&](std::size_t k, const Weights& around, const Weights& mirrored) {
        received_weight_[static_cast<std::size_t>(beside_walls_[k])] =
            static_cast<float>(scale * (around.liquid + double{reflection_share_[k]} * mirrored.liquid));
      });
}

// Of bubble image k, the share of what its bubble has.
float BubbleCoupling::share_of_image(std::size_t k) const {
  const std::int32_t* reflection = images_.wall_point();
  return reflection == nullptr || reflection[k] < 0 ? 1.0F : reflection_share_[static_cast<std::size_t>(reflection[k])];
}

// A wall point, or an image of one: velocities by the fit, the rest as of its nearest particle, mirrored. Free-slip
// surfaces reflect velocities, no-slip ones reverse them; behind both their gradient is G R, with R = 1 - 2 n n.
void BubbleCoupling::mirror_record(const ImageMap& map, std::size_t k, std::size_t point, float* value) const {
  using namespace liquid_record;
  const WallStencils& walls = *carrier_.arrangement.context.walls;
  const std::size_t source = map.source(k);
  const Vec3 normal{walls.normal[0][point], walls.normal[1][point], walls.normal[2][point]};
  const auto reflected = [&](const Vec3& v) { return subtract(v, multiply(2 * dot(v, normal), normal)); };
  const auto turned = [&](const Vec3& v) { return walls.no_slip[point] != 0 ? multiply(-1, v) : reflected(v); };
  const Vec3 velocity = walls.velocity(point, 3, read(carrier_.advecting_velocity), true, true, false);
  Vec3 change[3];  // d u / d x_b
  for (int b = 0; b < 3; ++b)
    for (int a = 0; a < 3; ++a) change[b][static_cast<std::size_t>(a)] = gradient_component(a, b)[source];
  Vec3 mirrored[3];  // G R, then reflected or reversed
  for (std::size_t b = 0; b < 3; ++b) {
    Vec3 along{};
    for (std::size_t c = 0; c < 3; ++c)
      along = add(along, multiply((b == c ? 1 : 0) - 2 * normal[b] * normal[c], change[c]));
    mirrored[b] = turned(along);
  }
  const auto slope = [&](int a, int b) {
    return map.velocity_sign(k, a) * map.vector_sign(k, b) * mirrored[b][static_cast<std::size_t>(a)];
  };
  const Vec3 acceleration = turned({value[acceleration_at], value[acceleration_at + 1], value[acceleration_at + 2]}),
             surface_normal = reflected({value[normal_at], value[normal_at + 1], value[normal_at + 2]});
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    value[velocity_at + a] = value[factor_at] * static_cast<float>(map.velocity(k, a, velocity[i]));
    value[vorticity_at + a] = value[factor_at] * static_cast<float>(slope(c, b) - slope(b, c));
    value[acceleration_at + a] = map.velocity_sign(k, a) * static_cast<float>(acceleration[i]);
    value[normal_at + a] = map.vector_sign(k, a) * static_cast<float>(surface_normal[i]);
  }
}

// The wall of a body that a bubble which moves with `velocity` from `at` would pass within the step, else the sides and
// boxes that would turn it back: a direction out of the wall, and the least velocity along it.
std::optional<BubbleCoupling::Stop> BubbleCoupling::stop_before(const Vec3& at, const Vec3& velocity, double dt) const {
  const Boundary& boundary = carrier_.boundary;
  if (beside_bodies()) {
    const BodyWalls& bodies = *boundary.bodies();
    const double gap = boundary.gap();
    if (const auto wall = bodies.wall_within(at, gap + dt * (length(velocity) + bodies.largest_speed()))) {
      const double least = dot(wall->velocity, wall->normal) - std::max(0.0, wall->distance - gap) / dt;
      if (dot(velocity, wall->normal) < least) return Stop{wall->normal, least};
    }
  }
  const Vec3 next = add(at, multiply(dt, velocity));
  Vec3 kept = next;
  boundary.apply_walls(boundary.next_walls, kept, nullptr);
  Vec3 back = subtract(kept, next);
  const Domain& domain = boundary.domain();
  for (int axis = 0; axis < 3; ++axis) {
    const double period = domain.upper[axis] - domain.lower[axis];
    if (domain.periodic(axis)) back[axis] -= period * std::round(back[axis] / period);
  }
  const double size = length(back);
  if (!(size > boundary.gap())) return {};
  // Up to the gap before another face of a body. Sides and boxes reflect: as far before as it would be behind.
  const double inside = beside_bodies() ? boundary.gap() - boundary.bodies()->distance(next) : 0;
  const Vec3 normal = multiply(1 / size, back);
  return Stop{normal, dot(velocity, normal) + (inside > 0 ? inside : size / 2) / dt};
}

void BubbleCoupling::slide_along_walls(std::size_t b, const Surroundings& around, const Vec3& u, double radius,
                                       const Braking& braking, double dt, Moved& moved) const {
  Vec3 at = vector_at(population_.next_position, 3, b);
  carrier_.boundary.apply_walls(carrier_.boundary.next_walls, at, nullptr);
  // Directions, at right angles, in which walls give the bubble a speed.
  std::array<Vec3, 3> held{};
  std::array<double, 3> speed{};
  std::size_t faces = 0;
  Vec3 last{};
  for (int look = 0; look < 4 && faces < 3; ++look) {
    const auto stop = stop_before(at, moved.velocity, dt);
    if (!stop) return;
    if (faces > 0 && dot(stop->normal, last) > bend) --faces;  // the face ahead in place of that beside
    last = stop->normal;
    Vec3 normal = stop->normal;
    for (std::size_t k = 0; k < faces; ++k) normal = subtract(normal, multiply(dot(normal, held[k]), held[k]));
    const double size = length(normal);
    if (!(size > least_of_edge)) return;
    normal = multiply(1 / size, normal);
    held[faces] = normal;
    // Along `normal` for what the wall wants along its own.
    speed[faces] = dot(moved.velocity, normal) + (stop->least - dot(moved.velocity, stop->normal)) / size;
    // Lift along a wall is that of what turns about its normal; along an edge there is none.
    const Vec3 vorticity = faces == 0 ? multiply(dot(around.vorticity, normal), normal) : Vec3{};
    ++faces;
    const auto along = [&](Vec3 v) {
      for (std::size_t k = 0; k < faces; ++k) v = subtract(v, multiply(dot(v, held[k]), held[k]));
      return v;
    };
    Vec3 given{};
    for (std::size_t k = 0; k < faces; ++k) given = add(given, multiply(speed[k], held[k]));
    Gas pressed = gas_;
    pressed.gravity = along(gas_.gravity);
    const Surroundings beside{add(along(around.velocity), given), vorticity, along(around.acceleration)};
    moved = accelerate(pressed, b, beside, add(along(u), given), radius, braking, dt);
    moved.velocity = add(along(moved.velocity), given);  // whatever a surface of the liquid adds
  }
}

void BubbleCoupling::keep_new_bubbles_outside(std::size_t first) {
  parallel_for(population_.size() - first, [&](std::size_t k) {
    const std::size_t b = first + k;
    Vec3 r = vector_at(population_.position, 3, b);
    carrier_.boundary.apply_walls(carrier_.boundary.walls, r, nullptr);
    for (std::size_t a = 0; a < 3; ++a) (*population_.position[a])[b] = (*population_.next_position[a])[b] = r[a];
  });
}

}  // namespace spume::bubbles
