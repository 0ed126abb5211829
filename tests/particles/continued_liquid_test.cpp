// SPDX-License-Identifier: MIT
#include "spume/particles/continued_liquid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "particles/walled.hpp"
#include "spume/core/kernel.hpp"
#include "spume/particles/options.hpp"
#include "spume/particles/surface.hpp"

namespace spume::test {
namespace {

const std::string tank =
    "lower = [0, 0]\nupper = [1.2, 1]\nleft = \"free-slip\"\nright = \"free-slip\"\nbottom = \"no-slip\"\n";
const std::string canal = "lower = [0, 0]\nupper = [1.2, 1]\nx = \"periodic\"\nbottom = \"free-slip\"\n";
const std::string basin =
    "lower = [0, 0, 0]\nupper = [0.9, 0.9, 0.9]\nx = \"periodic\"\nfront = \"free-slip\"\nback = \"free-slip\"\nbottom "
    "= \"free-slip\"\n";
const std::string upper_half = "where = \"0.5 + 0.03*sin(5*x) - y\"\n";

std::vector<Layout> surface_layouts() {
  const std::string half_space = "[[body]]\nshape = \"half-space\"\nposition = ";
  return {
      {"beach", scene_text(tank, 0.04, half_space + "[0.3, 0]\nnormal = [0.866, 0.5]\n", upper_half)},
      {"overhang", scene_text(tank, 0.04, half_space + "[0.4, 0]\nnormal = [0.866, -0.5]\n", upper_half)},
      {"disc across a periodic side",
       scene_text(canal, 0.04, "[[body]]\nshape = \"cylinder\"\nradius = 0.2\nposition = [0.05, 0.5]\n", upper_half)},
      {"two discs, the gap between them narrow",
       scene_text(tank, 0.04,
                  "[[body]]\nshape = \"cylinder\"\nradius = 0.2\nposition = [0.4, 0.5]\n"
                  "[[body]]\nshape = \"cylinder\"\nradius = 0.2\nposition = [0.9, 0.5]\n",
                  upper_half)},
      {"ball at a wall",
       scene_text(basin, 0.1, "[[body]]\nshape = \"ball\"\nradius = 0.25\nposition = [0.4, 0.2, 0.5]\n",
                  "where = \"0.5 - z\"\n")}};
}

struct Plane {
  Vec3 through{}, normal{};
};

// Over all particles, wall points and what they are seen at.
class Twin {
 public:
  explicit Twin(const Walled& walled, const MomentFields& moments)
      : walled_(walled), sums_(walled.twin([](const Vec3&) { return reference::Carried{}; })) {
    const Scene& scene = walled.scene();
    d_ = scene.domain.dimensions;
    dr_ = scene.spacing;
    support_ = walled.resolution.support_radius;
    for (std::size_t i = 0; i < walled.particles.size(); ++i) {
      if (interior()((*moments.divergence_of_position)[i]) > 0 || scene.walls.distance(walled.place(i)) < support_)
        continue;
      Vec3 normal{};
      for (int axis = 0; axis < d_; ++axis) normal[axis] = (*moments.normal[axis])[i];
      normal = multiply(1 / length(normal), normal);
      double content = 0;
      for (const Vec3& other : liquid_around(walled.place(i)))
        content += weight(subtract(other, walled.place(i)), normal);
      planes_.push_back({add(walled.place(i), multiply(dr_ * depth_of_column(d_, content), normal)), normal});
    }
    const std::vector<WallPoint>& points = walled.boundary.bodies()->all_points();
    for (std::size_t g = 0; g < points.size(); ++g) share_.push_back(share_of(points[g], g));
  }
  InteriorWeight interior() const { return interior_weight(d_, SurfaceOptions{}); }

  struct Count {
    double divergence_of_position = 0, depth = 0;
    Vec3 normal{};
  };
  Count count(const Vec3& place) const {
    Count count;
    std::vector<std::pair<Vec3, double>> seen;
    for (const Vec3& other : liquid_around(place)) seen.emplace_back(subtract(other, place), 1.0);
    const std::vector<WallPoint>& points = walled_.boundary.bodies()->all_points();
    for (std::size_t g = 0; g < points.size(); ++g)
      for (const auto& one : sums_.seen_of(points[g].position, {}, false)) {
        const Vec3 offset = subtract(one.place, place);
        if (length(offset) < support_) seen.emplace_back(offset, share_[g]);
      }
    for (const auto& [offset, share] : seen) {
      const double r = length(offset);
      if (r == 0) continue;
      const double g = share * sums_.g(r);
      count.divergence_of_position += g * r * r;
      count.normal = add(count.normal, multiply(-sums_.smoothing_length * g, offset));
    }
    const Vec3 normal = multiply(1 / length(count.normal), count.normal);
    double content = 0;
    for (const auto& [offset, share] : seen) content += share * weight(offset, normal);
    count.depth = dr_ * depth_of_column(d_, content);
    return count;
  }

 private:
  double weight(const Vec3& offset, const Vec3& normal) const {
    const double outwards = dot(offset, normal);
    const double aside2 = dot(offset, offset) - outwards * outwards;
    return column_weight(d_, std::sqrt(std::max(0.0, aside2)) / dr_, -outwards / dr_);
  }
  std::vector<Vec3> liquid_around(const Vec3& place) const {
    std::vector<Vec3> around;
    for (const Vec3& particle : sums_.particle)
      for (const auto& one : sums_.seen_of(particle, {}, false))
        if (length(subtract(one.place, place)) < support_) around.push_back(one.place);
    return around;
  }
  double share_of(const WallPoint& point, std::size_t g) const {
    const double reach = 2.2 * support_;
    double weights = 0, sum = 0;
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      const std::vector<reference::WallSums::Seen> through =
          sums_.seen_of(planes_[k].through, {0, planes_[k].normal}, false);
      for (const auto& one : through) {
        const Vec3 offset = subtract(point.position, one.place);
        const double q = length(offset) / reach;
        if (q >= 1) continue;
        const double w = WendlandC2::w(WendlandC2::support * q);
        weights += w;
        sum += w * std::clamp(0.5 - dot(offset, one.value.velocity) / dr_, 0.0, 1.0);
      }
    }
    if (weights > 0) return sum / weights;
    return walled_.boundary.bodies()->is_wet(g) ? 1 : 0;
  }

  const Walled& walled_;
  reference::WallSums sums_;
  int d_ = 2;
  double dr_ = 0, support_ = 0;
  std::vector<Plane> planes_;
  std::vector<double> share_;
};

}  // namespace

TEST(ContinuedLiquid, CountsAsSumsOverAllWallPointsDo) {
  for (const Layout& layout : surface_layouts()) {
    SCOPED_TRACE(layout.name);
    Walled walled(layout.text, 0.05);
    const int d = walled.particles.dimensions;
    const std::size_t n = walled.particles.size();
    MomentFields moments(walled.particles, {.normal = true, .fading = {}});
    moments.measure(walled.arrangement, walled.particles, walled.scene().spacing);
    const Twin twin(walled, moments);
    Array<float> before(n), counted(n);
    for (std::size_t i = 0; i < n; ++i) before[i] = counted[i] = (*moments.divergence_of_position)[i];
    ContinuedLiquid continued(walled.resolution, twin.interior());
    continued.find(walled.arrangement, moments, walled.boundary, walled.particles.position, counted);
    std::vector<bool> found(n);
    // Offsets are differences of floats: 1e-7 of the domain, which is 30 spacings.
    const double tolerance = 3e-5;
    ASSERT_GT(continued.depths().size(), 5U);
    for (const KnownDepth& known : continued.depths()) {
      const auto i = static_cast<std::size_t>(known.particle);
      found[i] = true;
      const Twin::Count count = twin.count(walled.place(i));
      EXPECT_NEAR(counted[i], count.divergence_of_position, tolerance);
      EXPECT_NEAR(known.depth, count.depth, tolerance * walled.scene().spacing * 10);
      for (int axis = 0; axis < d; ++axis) EXPECT_NEAR((*moments.normal[axis])[i], count.normal[axis], tolerance);
    }
    // All that see a body and are near the surface, and none that sees no body.
    for (std::size_t i = 0; i < n; ++i) {
      const double distance = walled.scene().walls.distance(walled.place(i));
      if (distance >= walled.resolution.support_radius) {
        EXPECT_FALSE(found[i]);
        EXPECT_EQ(counted[i], before[i]);
      } else if (twin.interior()(before[i]) < 1) {
        EXPECT_TRUE(found[i]);
      }
    }
  }
}

}  // namespace spume::test
