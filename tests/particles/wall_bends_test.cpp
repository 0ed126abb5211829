// SPDX-License-Identifier: MIT
#include "spume/particles/wall_bends.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "neighbours/neighbourhood.hpp"
#include "reference/least_squares.hpp"
#include "scene/helpers.hpp"
#include "spume/particles/near_particles.hpp"

namespace spume::test {
namespace {

const std::string sheared_floor =
    "lower = [0, 0]\nupper = [1, 0.5]\nleft = \"open\"\nright = \"open\"\nbottom = \"no-slip\"\ntop = \"free-slip\"\n"
    "[domain.wall_velocity]\nbottom = [\"0.3 + 0.2*x\", \"0\"]\n";
const std::string sheared_floor_3d =
    "lower = [0, 0, 0]\nupper = [1, 1, 0.7]\nleft = \"open\"\nright = \"open\"\nfront = \"open\"\nback = \"open\"\n"
    "bottom = \"no-slip\"\ntop = \"free-slip\"\n[domain.wall_velocity]\nbottom = [\"0.3 + 0.2*x\", \"0.1*y\", \"0\"]\n";
const std::string closed =
    "lower = [0, 0]\nupper = [1, 0.6]\nleft = \"no-slip\"\nright = \"free-slip\"\nbottom = \"no-slip\"\ntop = "
    "\"no-slip\"\n[domain.wall_velocity]\ntop = [\"1 + 0.2*sin(3*x)\", \"0\"]\n";
const std::string closed_3d =
    "lower = [0, 0, 0]\nupper = [0.8, 0.8, 0.7]\nx = \"periodic\"\nfront = \"no-slip\"\nback = \"free-slip\"\n"
    "bottom = \"no-slip\"\ntop = \"no-slip\"\n";

// Jittered particles of a scene, sorted, with their images and a velocity.
struct Held {
  LoadedCase loaded;
  Resolution resolution;
  ParticleStore particles;
  Boundary boundary;
  Arrangement arrangement;
  WallBends bends;
  std::array<Array<double>, 3> velocity;

  Held(const std::string& domain, double spacing, const std::function<Vec3(const Vec3&)>& field,
       const std::string& liquid = "")
      : loaded(load_text("method = \"les-sph\"\n[time]\nend = 1\n[domain]\n" + domain + "[resolution]\nspacing = " +
                         std::to_string(spacing) + "\n[fluid]\nreynolds = 100\n[[liquid]]\n" + liquid)),
        resolution(scene().domain.dimensions, scene().spacing, KernelKind::wendland_c2, 1.3),
        particles(scene().domain.dimensions, scene().particles),
        boundary(scene().domain, scene().spacing, make_body_walls(scene(), resolution)),
        arrangement(scene().domain, resolution, particles.volume, particles.size()),
        bends(boundary, resolution) {
    for (std::size_t i = 0; i < particles.size(); ++i)
      for (int axis = 0; axis < particles.dimensions; ++axis)
        (*particles.position[axis])[i] += 0.2 * spacing * (uniform(i, 3)[static_cast<std::size_t>(axis)] - 0.5);
    arrangement.sort(particles, particles.position);
    boundary.make_images(arrangement, particles, particles.position, 1, {});
    arrangement.find_neighbours(particles, particles.position, {});
    for (auto& component : velocity) component = Array<double>(particles.size(), 0.0);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const Vec3 u = field(place(i));
      for (std::size_t axis = 0; axis < 3; ++axis) velocity[axis][i] = u[axis];
    }
    find();
  }
  void find() {
    bends.find(arrangement, particles.position, {velocity[0].data(), velocity[1].data(), velocity[2].data()}, 0,
               particles.scratch());
  }
  const Scene& scene() const { return loaded.scene; }
  // Behind a side: no particle that stands off it sees farther.
  double deepest_seen() const { return resolution.support_radius - 0.25 * scene().spacing; }
  Vec3 place(std::size_t i) const { return vector_at(particles.position, particles.dimensions, i); }
  std::size_t images() const { return arrangement.images.size(); }
  std::size_t source(std::size_t k) const { return static_cast<std::size_t>(arrangement.images.source()[k]); }
  const ImagePath& path(std::size_t k) const {
    return arrangement.images.paths()[static_cast<std::size_t>(arrangement.images.path()[k])];
  }
  double image_velocity(std::size_t k, int axis, const VelocityImageRule& rule) const {
    const ImageMap map{arrangement.images, rule, boundary.reflection()};
    return map.velocity(k, axis, velocity[axis][source(k)]);
  }
  // What the bend adds behind image k.
  double added(std::size_t k, int axis) const {
    return image_velocity(k, axis, bends.rule()) - image_velocity(k, axis, boundary.velocity_rule());
  }
};

// e of a particle at a side by an orthogonal decomposition over all particles and their periodic copies.
Vec3 slow_bend(const Held& held, std::size_t i, int axis, int side) {
  const auto is_open = [&](const Vec3& from, const Vec3& to) {
    constexpr int steps = 200;
    for (int k = 0; k <= steps; ++k)
      if (held.scene().walls.distance(add(multiply(1 - double(k) / steps, from), multiply(double(k) / steps, to))) < 0)
        return false;
    return true;
  };
  const Domain& domain = held.scene().domain;
  const double h = held.resolution.smoothing_length,
               reach = fit_reach_of(domain.dimensions) * held.resolution.support_radius;
  const double plane = side == 0 ? domain.lower[axis] : domain.upper[axis], inward = side == 0 ? 1 : -1;
  const Vec3 here = held.place(i);
  const double s = inward * (here[axis] - plane);
  if (s >= held.deepest_seen()) return {};
  std::vector<reference::Neighbour> near;
  std::vector<double> distance;
  std::vector<Vec3> relative;  // to the wall
  for (std::size_t j = 0; j < held.particles.size(); ++j)
    for (const int copy : {-1, 0, 1}) {
      if (copy != 0 && !domain.periodic(0)) continue;
      Vec3 r = held.place(j), foot;
      r[0] += copy * (domain.upper[0] - domain.lower[0]);
      foot = r;
      foot[axis] = plane;
      const double away = length(subtract(r, here));
      if (away >= reach) continue;
      if (held.boundary.bodies() != nullptr && held.boundary.bodies()->thin() != nullptr && !is_open(here, r)) continue;
      const Vec3 wall = domain.sides[axis][side].velocity ? (*domain.sides[axis][side].velocity)(foot, 0) : Vec3{};
      const double eta = inward * (r[axis] - plane) / h;
      reference::Neighbour neighbour;
      for (std::size_t a = 0; a < 3; ++a) neighbour.offset[a] = (r[a] - here[a]) / h;
      neighbour.offset[static_cast<std::size_t>(axis)] = eta;
      neighbour.weight = WendlandC2::w(WendlandC2::support * away / reach) * eta * eta;
      near.push_back(neighbour);
      distance.push_back(eta);
      relative.push_back(subtract(vector_at(held.velocity, 3, j), wall));
    }
  for (const int order : {2, 1}) {
    const std::size_t monomials = reference::exponents(domain.dimensions, order).size();
    if (near.size() <= 2 * monomials) continue;
    // Monomials by degree: 1, then the coordinates.
    const Eigen::MatrixXd c = reference::fit_coefficients(domain.dimensions, order, near);
    Vec3 e{};
    double moduli = 0;
    for (std::size_t j = 0; j < near.size(); ++j) {
      const double share = 2 * s * s / (h * h) * c(1 + axis, static_cast<Eigen::Index>(j)) / distance[j];
      moduli += std::abs(share);
      for (int a = 0; a < domain.dimensions; ++a) e[a] += share * relative[j][a];
    }
    // Where particles hardly bear the fit, as beside the ball, a lower order answers.
    if (moduli <= 16 * s / held.scene().spacing) return e;
  }
  return {};
}

Vec3 smooth_velocity(const Vec3& r) {
  return {std::cos(2 * r[1]) + r[2], r[0] * r[1] - 0.3, r[0] * r[0] + 0.4 * r[2]};
}

}  // namespace

// Cubics that are the velocity of the wall all along it go on behind it as they are.
TEST(WallBends, ContinueCubicsBehindWallsThatShear) {
  for (const bool three : {false, true}) {
    const auto up = static_cast<std::size_t>(three ? 2 : 1);
    const auto field = [&](const Vec3& r) -> Vec3 {
      const double s = r[up];
      return {0.3 + 0.2 * r[0] + s * (1 - 2 * s + 0.5 * r[0] + 0.3 * r[0] * r[0] + s * r[0] + 0.7 * s * s),
              three ? 0.1 * r[1] + s * (0.4 + s * r[1]) : s * s, three ? s * s * (1 - s) : 0.0};
    };
    const double spacing = three ? 0.1 : 0.05;
    const Held held(three ? sheared_floor_3d : sheared_floor, spacing, field);
    std::size_t seen = 0;
    for (std::size_t k = 0; k < held.images(); ++k) {
      Vec3 place{};
      for (int axis = 0; axis < held.particles.dimensions; ++axis)
        place[axis] = held.arrangement.images.position(axis)[k];
      if (place[up] > 0 || -place[up] > held.deepest_seen()) continue;
      // Where liquid is on all sides of the foot, which bears a polynomial of order 2.
      const double clear = 3.5 * spacing;
      if (place[0] < clear || place[0] > 1 - clear || (three && (place[1] < clear || place[1] > 1 - clear))) continue;
      ++seen;
      const Vec3 there = field(place);
      for (int axis = 0; axis < held.particles.dimensions; ++axis)
        // Single precision: of the velocity, and of the offset that the motion of the wall and e are added to.
        EXPECT_NEAR(held.image_velocity(k, axis, held.bends.rule()), there[static_cast<std::size_t>(axis)], 1e-6);
    }
    EXPECT_GT(seen, 15U);
  }
}

TEST(WallBends, AreThoseOfFitsOverAllParticles) {
  // A ball on the floor has wall points, which are no liquid.
  const std::string ball = "[[body]]\nshape = \"ball\"\nradius = 0.2\nposition = [0.4, 0.35, 0.05]\n";
  for (const std::string& bodies : {std::string(), ball}) {
    for (const std::string& domain : {closed, closed_3d}) {
      const bool three = domain == closed_3d;
      if (!three && !bodies.empty()) continue;
      const Held held(domain, three ? 0.1 : 0.05, smooth_velocity, bodies);
      const Domain& sides = held.scene().domain;
      std::size_t plain = 0, in_corners = 0;
      for (std::size_t k = 0; k < held.images(); ++k) {
        if (held.arrangement.images.wall_point() != nullptr && held.arrangement.images.wall_point()[k] >= 0) continue;
        const ImagePath& path = held.path(k);
        Vec3 expected{};
        int reflections = 0, held_by = 0;
        for (int axis = 0; axis < sides.dimensions; ++axis) {
          const int side = path.side[axis];
          if (side < 0 || sides.sides[axis][side].kind == BoundaryKind::periodic) continue;
          ++reflections;
          if (sides.sides[axis][side].kind != BoundaryKind::no_slip) continue;
          ++held_by;
          const Vec3 e = slow_bend(held, held.source(k), axis, side);
          for (int a = 0; a < sides.dimensions; ++a) {
            double sign = 1;
            for (int other = 0; other < sides.dimensions; ++other) {
              if (other == axis || path.side[other] < 0) continue;
              const BoundaryKind kind = sides.sides[other][path.side[other]].kind;
              if (kind == BoundaryKind::no_slip || (kind == BoundaryKind::free_slip && other == a)) sign = -sign;
            }
            expected[a] += sign * e[a];
          }
        }
        if (reflections == held_by) ++plain;
        if (held_by > 1) ++in_corners;
        for (int a = 0; a < sides.dimensions; ++a)
          EXPECT_NEAR(held.added(k, a), expected[a], 2e-6 * (1 + std::abs(expected[a]))) << "image " << k;
      }
      EXPECT_GT(plain, 100U);
      EXPECT_GT(in_corners, 10U);
    }
  }
}

// Nor does a particle beside a plate see what is on its other side, which slides the other way.
TEST(WallBends, AreOfTheirSideOfAPlate) {
  const auto sliding = [](const Vec3& r) -> Vec3 {
    const Vec3 u = smooth_velocity(r);
    return r[0] < 0.525 ? u : multiply(-5, u);
  };
  const Held held(closed, 0.05, sliding, "[[body]]\nshape = \"box\"\nsize = [0.05, 4]\nposition = [0.525, 0.3]\n");
  ASSERT_NE(held.boundary.bodies()->thin(), nullptr);
  std::size_t beside = 0;
  for (std::size_t k = 0; k < held.images(); ++k) {
    if (held.arrangement.images.wall_point() != nullptr && held.arrangement.images.wall_point()[k] >= 0) continue;
    const ImagePath& path = held.path(k);
    if (path.side[1] != 0 || path.side[0] >= 0) continue;
    if (std::abs(held.place(held.source(k))[0] - 0.525) < 0.1) ++beside;
    const Vec3 expected = slow_bend(held, held.source(k), 1, 0);
    for (std::size_t a = 0; a < 2; ++a)
      EXPECT_NEAR(held.added(k, static_cast<int>(a)), expected[a], 1e-5 * (1 + std::abs(expected[a]))) << "image " << k;
  }
  EXPECT_GT(beside, 4U);
}

// A few particles bear no fit.
TEST(WallBends, SprayHasNone) {
  const Held held(closed, 0.05, smooth_velocity, "lower = [0.4, 0]\nupper = [0.55, 0.05]\n");
  ASSERT_EQ(held.particles.size(), 3U);
  ASSERT_GE(held.images(), 3U);
  for (std::size_t k = 0; k < held.images(); ++k)
    for (const int axis : {0, 1}) EXPECT_EQ(held.added(k, axis), 0);
}

TEST(WallBends, DoNotDependOnTheThreads) {
  Held held(closed, 0.02, smooth_velocity);
  std::vector<std::vector<float>> found;
  const int before = omp_get_max_threads();
  for (const int threads : {1, 3}) {
    omp_set_num_threads(threads);
    held.find();
    const auto& offset = held.bends.rule().offset[0];
    found.emplace_back(offset.data(), offset.data() + offset.size());
  }
  omp_set_num_threads(before);
  EXPECT_EQ(found[0], found[1]);
}

}  // namespace spume::test
