// SPDX-License-Identifier: MIT
#include "spume/scene/plates.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

// Length over thickness of a plate, along the principal axes of the solid. What is shorter and hides liquid by its
// thickness alone, such as a square pillar, stays as thick bodies are: four spacings wide on the floor of a tank it
// left weakly compressible layers with accelerations of 1.6 g.
constexpr double slender = 2;

// Moments of places within a solid.
struct Moments {
  double count = 0;
  Vec3 sum{};
  std::array<Vec3, 3> product{};

  void add(const Vec3& place) {
    ++count;
    for (std::size_t a = 0; a < 3; ++a) {
      sum[a] += place[a];
      for (std::size_t b = 0; b < 3; ++b) product[a][b] += place[a] * place[b];
    }
  }
  void add(const Moments& other) {
    count += other.count;
    for (std::size_t a = 0; a < 3; ++a) {
      sum[a] += other.sum[a];
      for (std::size_t b = 0; b < 3; ++b) product[a][b] += other.product[a][b];
    }
  }
  // Of the box that has the same second moments, which a box is however it is turned.
  double longest_edge() const {
    if (!(count > 0)) return 0;
    Eigen::Matrix3d covariance;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        covariance(a, b) = product[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] / count -
                           sum[static_cast<std::size_t>(a)] / count * (sum[static_cast<std::size_t>(b)] / count);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
    return std::sqrt(12 * std::max(axes.eigenvalues()[2], 0.0));
  }
};

// How deep a solid is around one of its places that is the deepest of a lattice, by steps of half the length after
// steps that lead no deeper: a lattice itself misses up to half its diagonal.
double deepest_around(const Shape& solid, Vec3 place, double step, int dimensions) {
  constexpr int halves = 8;
  double depth = -solid.distance(place);
  for (int half = 0; half < halves;) {
    const Vec3 from = place;
    for (int axis = 0; axis < dimensions; ++axis)
      for (const double way : {-step, step}) {
        Vec3 beside = place;
        beside[axis] += way;
        if (const double own = -solid.distance(beside); own > depth) {
          depth = own;
          place = beside;
        }
      }
    if (place != from) continue;
    step /= 2;
    ++half;
  }
  return depth;
}

}  // namespace

Bounds window_around(const Scene& scene, const Body& body, double reach) {
  const Bounds bounds = body.shape->bounds();
  Bounds window{scene.domain.lower, scene.domain.upper};
  for (int axis = 0; axis < scene.domain.dimensions; ++axis) {
    window.lower[axis] -= reach;
    window.upper[axis] += reach;
    if (body.motion && std::isfinite(bounds.lower[axis])) window.lower[axis] = bounds.lower[axis] - reach;
    if (body.motion && std::isfinite(bounds.upper[axis])) window.upper[axis] = bounds.upper[axis] + reach;
    if (!body.inside) continue;
    window.lower[axis] = std::max(window.lower[axis], bounds.lower[axis] - reach);
    window.upper[axis] = std::min(window.upper[axis], bounds.upper[axis] + reach);
  }
  return window;
}

bool is_plate(const Scene& scene, const Body& body, double spacing, double reach) {
  const int d = scene.domain.dimensions;
  const ShapePointer& solid = body.motion ? body.alone : body.solid;
  const Bounds window = window_around(scene, body, reach);
  const double step = spacing / 2;
  std::array<std::size_t, 3> count{1, 1, 1};
  for (int axis = 0; axis < d; ++axis) {
    if (!(window.upper[axis] > window.lower[axis])) return false;
    count[axis] = static_cast<std::size_t>(std::ceil((window.upper[axis] - window.lower[axis]) / step)) + 1;
  }
  struct Found {
    bool deep = false;
    double depth = 0;  // of the deepest place
    Vec3 deepest{};
    Moments inside;  // about the lower corner of the window
  };
  // Of a body that stands still liquid meets the part in the domain.
  const auto is_met = [&](const Vec3& place) {
    for (int axis = 0; axis < d; ++axis)
      if (!body.motion && (place[axis] < scene.domain.lower[axis] || place[axis] > scene.domain.upper[axis]))
        return false;
    return true;
  };
  const Found all = parallel_reduce(
      count[1] * count[2], Found{},
      [&](std::size_t first, std::size_t last) {
        Found found;
        for (std::size_t row = first; row < last; ++row) {
          Vec3 place{window.lower[0], window.lower[1] + step * static_cast<double>(row % count[1]),
                     d == 3 ? window.lower[2] + step * static_cast<double>(row / count[1]) : 0.0};
          while (place[0] <= window.upper[0] + step) {
            const double distance = solid->distance(place);
            if (-distance > found.depth) {
              found.depth = -distance;
              found.deepest = place;
            }
            found.deep = distance < -reach;
            if (found.deep) return found;
            if (distance < 0 && is_met(place)) found.inside.add(subtract(place, window.lower));
            place[0] += std::max(step, distance);  // the surface is not nearer
          }
        }
        return found;
      },
      [](const Found& a, const Found& b) {
        const Found& deeper = b.depth > a.depth ? b : a;
        Found both{a.deep || b.deep, deeper.depth, deeper.deepest, a.inside};
        both.inside.add(b.inside);
        return both;
      });
  if (all.deep) return false;
  const double depth = deepest_around(*solid, all.deepest, step / 2, d);
  return depth <= reach && (2 * depth < reach || all.inside.longest_edge() > slender * 2 * depth);
}

}  // namespace spume
