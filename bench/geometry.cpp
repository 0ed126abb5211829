// SPDX-License-Identifier: MIT
// Distances of points from bodies: a closed form, a mesh of 100,000 triangles, and the field that stands for it.
// Arguments: 0 points anywhere in the box around the body, 1 points within 2 % of its size of the surface.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "spume/core/random.hpp"
#include "spume/geometry/distance_field.hpp"
#include "spume/geometry/mesh.hpp"
#include "spume/geometry/shapes.hpp"

namespace spume {
namespace {

const Bounds box{{-1, -1, -1}, {1, 1, 1}};

// An ellipsoid: of a ball all triangles are as near from the centre, which no body of use has.
ShapePointer closed_form() {
  return make_ellipsoid({0.9, 0.5, 0.3}, 3);
}
const ShapePointer& mesh() {
  // 316 facets around and 158 down, fewer at the poles, make 99,538 triangles.
  static const ShapePointer made = make_mesh(closed_form()->surface(box, 0.9 * 2 * std::numbers::pi / 316));
  return made;
}

std::vector<Vec3> points(bool near) {
  constexpr std::size_t count = 10000;
  const ShapePointer shape = closed_form();
  std::vector<Vec3> chosen;
  for (std::uint64_t i = 0; chosen.size() < count; ++i) {
    const auto u = random_uniform(3, RandomPurpose::test, i, 0, 0);
    const Vec3 p{2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
    if (!near || std::abs(shape->distance(p)) < 0.04) chosen.push_back(p);
  }
  return chosen;
}

void ask(benchmark::State& state, const Shape& shape) {
  const std::vector<Vec3> all = points(state.range(0) == 1);
  double sum = 0, error = 0;
  for (auto _ : state)
    for (const Vec3& p : all) sum += shape.distance(p);
  benchmark::DoNotOptimize(sum);
  for (const Vec3& p : all) error = std::max(error, std::abs(shape.distance(p) - mesh()->distance(p)));
  state.counters["per_query"] = benchmark::Counter(
      static_cast<double>(all.size()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["off_the_mesh"] = error;
}

void distance_closed_form(benchmark::State& state) {
  ask(state, *closed_form());
}
void distance_mesh(benchmark::State& state) {
  ask(state, *mesh());
}
// 101 nodes a side.
void distance_field(benchmark::State& state) {
  static const ShapePointer field = make_distance_field(mesh(), box, 0.02, 3);
  ask(state, *field);
}

void build_mesh(benchmark::State& state) {
  const TriangleSurface surface = mesh()->surface(box, 1);
  for (auto _ : state) benchmark::DoNotOptimize(make_mesh(surface));
  state.counters["triangles"] = static_cast<double>(surface.triangles.size());
}
void check_mesh(benchmark::State& state) {
  const TriangleSurface surface = mesh()->surface(box, 1);
  for (auto _ : state) benchmark::DoNotOptimize(mesh_faults(surface));
  state.counters["triangles"] = static_cast<double>(surface.triangles.size());
}
void build_level_set(benchmark::State& state) {
  const auto value = [](const Vec3& p) { return 0.49 - p[0] * p[0] - p[1] * p[1] - p[2] * p[2]; };
  for (auto _ : state) benchmark::DoNotOptimize(make_level_set(value, box, 0.04, 3));
  state.counters["nodes"] = 101.0 * 101 * 101;
}

BENCHMARK(distance_closed_form)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(distance_mesh)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(distance_field)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(build_mesh)->Unit(benchmark::kMillisecond);
BENCHMARK(check_mesh)->Unit(benchmark::kMillisecond);
BENCHMARK(build_level_set)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spume
