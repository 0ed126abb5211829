// SPDX-License-Identifier: MIT
// Arrangements of particles with lists, images and rules as a method builds them, beside their slow twin.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "neighbours/neighbourhood.hpp"
#include "reference/sph_sums.hpp"
#include "spume/operators/sph_operators.hpp"

namespace spume::test {

using reference::Boundaries;
using reference::PlainKernel;
using reference::Sum;

// Positions on a grid of 2^-20: float coordinates, their images and their differences are then exact, and a float
// sum differs from the twin by the rounding of its arithmetic alone.
inline std::vector<Point> on_float_grid(std::vector<Point> points) {
  for (Point& point : points)
    for (double& x : point) x = std::round(std::ldexp(x, 20)) / std::ldexp(1.0, 20);
  return points;
}

struct ArrangementSetup {
  std::string name = "open";
  int dimensions = 2;
  KernelKind kernel = KernelKind::wendland_c2;
  double spacing = 1.0 / 16;
  double smoothing_ratio = 1.3;
  bool sizes = false;  // of the particles differ
  std::vector<Point> points;
  Boundaries boundaries{{{{BoundaryKind::open, BoundaryKind::open},
                          {BoundaryKind::open, BoundaryKind::open},
                          {BoundaryKind::open, BoundaryKind::open}}},
                        {},
                        {}};

  void set_sides(int axis, BoundaryKind kind) { boundaries.sides[axis] = {kind, kind}; }
  double smoothing_length() const { return smoothing_ratio * spacing; }
  ImageRules rules() const {
    ImageRules result;
    result.dimensions = dimensions;
    result.upper = {1, 1, 1};
    result.support_radius = PlainKernel{kernel, dimensions}.support() * smoothing_length();
    for (int axis = 0; axis < dimensions; ++axis)
      for (int side = 0; side < 2; ++side) {
        const BoundaryKind kind = boundaries.sides[axis][side];
        result.sides[axis][side] = kind == BoundaryKind::open       ? ImageKind::none
                                   : kind == BoundaryKind::periodic ? ImageKind::periodic
                                                                    : ImageKind::mirror;
      }
    if (!boundaries.boxes.empty()) result.solids = unite(result, boundaries.boxes, spacing);
    return result;
  }
};

// Support radii are at most 1.3 times that of the grid.
inline constexpr double largest_length_ratio = 1.25;

// A third of the particles plain, the others with h_i up to a quarter longer and volumes from 0.4 to 1.6.
inline reference::SphSums::Sizes make_sizes(std::size_t n) {
  reference::SphSums::Sizes sizes;
  for (std::size_t i = 0; i < n; ++i) {
    const Point r = uniform(i, 31);
    sizes.length_ratio.push_back(i % 3 == 0 ? 1 : static_cast<float>(1 + (largest_length_ratio - 1) * r[0]));
    sizes.volume_ratio.push_back(i % 3 == 0 ? 1 : static_cast<float>(0.4 + 1.2 * r[1]));
  }
  return sizes;
}

struct Arrangement {
  ArrangementSetup setup;
  reference::SphSums::Sizes sizes;
  Neighbourhood hood;
  reference::SphSums twin;
  SweepContext context;
  PackedNeighbours packed;
  VelocityImageRule rule;
  std::vector<std::array<float, 3>> reflection;

  explicit Arrangement(const ArrangementSetup& given)
      : setup(given),
        sizes(given.sizes ? make_sizes(given.points.size()) : reference::SphSums::Sizes{}),
        hood(make_hood()),
        twin({given.kernel, given.dimensions}, given.smoothing_length(), std::pow(given.spacing, given.dimensions),
             sorted(), hood.rules, given.boundaries, sizes) {
    context.list = &hood.list;
    context.images = &hood.images;
    context.dimensions = setup.dimensions;
    context.kernel = setup.kernel;
    context.smoothing_length = setup.smoothing_length();
    context.volume = std::pow(setup.spacing, setup.dimensions);
    if (setup.sizes) {
      context.length_ratio = sizes.length_ratio.data();
      context.volume_ratio = sizes.volume_ratio.data();
    }
    make_rules();
  }
  Arrangement(const Arrangement&) = delete;
  Arrangement& operator=(const Arrangement&) = delete;

  std::size_t size() const { return hood.n; }
  int dimensions() const { return setup.dimensions; }
  std::vector<Point> sorted() const {
    auto points = hood.all();
    points.resize(hood.n);
    return points;
  }
  template <class Function>
  Array<double> sample(Function&& function) const {
    Array<double> values(size());
    for (std::size_t i = 0; i < size(); ++i) values[i] = function(Point{hood.x[i], hood.y[i], hood.z[i]});
    return values;
  }
  // Uniform random numbers in [-1, 1) per particle and component.
  Array<double> random(std::uint32_t draw) const {
    Array<double> values(size());
    for (std::size_t i = 0; i < size(); ++i) values[i] = 2 * uniform(i, draw)[0] - 1;
    return values;
  }

 private:
  // With sizes the grid keeps the least support, as in a run; images and lists look farther.
  Neighbourhood make_hood() const {
    Neighbourhood made(setup.rules(), on_float_grid(setup.points));
    if (!setup.sizes) return made;
    std::vector<float> support_radius;
    for (const float ratio : sizes.length_ratio)
      support_radius.push_back(static_cast<float>(made.rules.support_radius) * ratio);
    made.rules.support_radius *= largest_length_ratio;
    made.images.build(made.rules, made.grid, made.x.data(), made.y.data(), made.z.data(), made.n);
    made.list.build(made.grid, made.table, made.x.data(), made.y.data(), made.z.data(), made.n, made.images,
                    made.origin, support_radius.data(), made.rules.support_radius);
    return made;
  }
  void make_rules() {
    bool moving = false;
    for (const auto& sides : setup.boundaries.wall)
      for (const Vec3& wall : sides) moving = moving || wall != Vec3{};
    const auto& paths = hood.images.paths();
    const auto transformed = [&](std::size_t path) {
      const ImagePath& p = paths[path];
      return reference::SphSums::transformed({{}, 0, p}, setup.boundaries);
    };
    for (std::size_t p = 0; p < paths.size(); ++p) {
      const auto point = transformed(p);
      rule.sign.push_back(
          {float(point.velocity_sign[0]), float(point.velocity_sign[1]), float(point.velocity_sign[2])});
      reflection.push_back({float(point.reflection[0]), float(point.reflection[1]), float(point.reflection[2])});
    }
    if (!moving) return;
    for (int axis = 0; axis < setup.dimensions; ++axis) {
      rule.offset[axis].resize(hood.images.size());
      for (std::size_t k = 0; k < hood.images.size(); ++k)
        rule.offset[axis][k] =
            static_cast<float>(transformed(static_cast<std::size_t>(hood.images.path()[k])).velocity_offset[axis]);
    }
  }
};

// The results of the sweep of the kernel moments, all of them.
struct Moments {
  Array<float> kernel_sum, divergence_of_position, laplacian_diagonal;
  std::array<Array<float>, 6> correction;
  Array<std::uint8_t> uncorrected;
  std::array<Array<float>, 3> concentration_gradient, normal;

  explicit Moments(Arrangement& a, bool shifting = true, bool normals = true, CorrectionFading fading = {}) {
    const std::size_t n = a.size();
    KernelMoments out;
    for (auto* array : {&kernel_sum, &divergence_of_position, &laplacian_diagonal}) array->resize(n);
    uncorrected.resize(n);
    out.kernel_sum = kernel_sum.data();
    out.divergence_of_position = divergence_of_position.data();
    out.laplacian_diagonal = laplacian_diagonal.data();
    out.uncorrected = uncorrected.data();
    for (int k = 0; k < a.dimensions() * (a.dimensions() + 1) / 2; ++k) {
      correction[k].resize(n);
      out.correction[k] = correction[k].data();
    }
    for (int axis = 0; axis < a.dimensions(); ++axis) {
      concentration_gradient[axis].resize(shifting ? n : 0);
      normal[axis].resize(normals ? n : 0);
      out.concentration_gradient[axis] = shifting ? concentration_gradient[axis].data() : nullptr;
      out.normal[axis] = normals ? normal[axis].data() : nullptr;
    }
    kernel_moment_sweep(a.context, a.packed, {shifting, normals, a.setup.spacing, fading}, out);
  }
  std::array<const float*, 6> read_correction() const {
    std::array<const float*, 6> pointers{};
    for (int k = 0; k < 6; ++k) pointers[k] = correction[k].empty() ? nullptr : correction[k].data();
    return pointers;
  }
  // The float correction of particle i as a full matrix: what the other sweeps were given.
  reference::Matrix correction_of(std::size_t i, int dimensions) const {
    reference::Matrix m{};
    int slot = 0;
    for (int a = 0; a < dimensions; ++a)
      for (int b = a; b < dimensions; ++b, ++slot) m[a][b] = m[b][a] = correction[slot][i];
    return m;
  }
};

// A vector field of doubles or floats, one array per dimension.
template <class T>
struct VectorArrays {
  std::array<Array<T>, 3> component;
  VectorArrays() = default;
  VectorArrays(std::size_t n, int dimensions) {
    for (int a = 0; a < dimensions; ++a) component[a].resize(n);
  }
  Array<T>& operator[](int a) { return component[a]; }
  const Array<T>& operator[](int a) const { return component[a]; }
  std::array<const T*, 3> read() const { return {component[0].data(), component[1].data(), component[2].data()}; }
  std::array<T*, 3> write() { return {component[0].data(), component[1].data(), component[2].data()}; }
};

// Holds float results against sums of the twin; the worst ratio of error to bound is checked once, at the end.
class Comparison {
 public:
  explicit Comparison(std::string subject) : subject_(std::move(subject)) {}
  ~Comparison() { EXPECT_LE(worst_, 1) << subject_ << ", " << where_; }
  void add(double fast, const Sum& sum, double tolerance, std::size_t i) {
    const double bound = tolerance * sum.magnitude + 1e-30;
    add_error(std::abs(fast - sum.value), bound, fast, sum.value, i);
  }
  void add_error(double error, double bound, double fast, double slow, std::size_t i) {
    if (error / bound <= worst_) return;  // a NaN is an error
    worst_ = std::isnan(error) ? 1e300 : error / bound;
    where_ = "particle " + std::to_string(i) + ": " + std::to_string(fast) + " instead of " + std::to_string(slow) +
             ", bound " + std::to_string(bound);
  }
  double worst() const { return worst_; }

 private:
  std::string subject_, where_;
  double worst_ = 0;
};

// Every kind of arrangement in both dimensions, with both kernels, of equal particles and of particles of different
// sizes.
inline std::vector<ArrangementSetup> all_setups() {
  std::vector<ArrangementSetup> setups;
  for (const int d : {2, 3})
    for (const KernelKind kernel : {KernelKind::wendland_c2, KernelKind::quintic_spline}) {
      const int m = d == 2 ? 16 : 7;
      ArrangementSetup base;
      base.dimensions = d;
      base.kernel = kernel;
      base.spacing = 1.0 / m;
      const auto lattice = lattice_points(m, d, 0.5);
      const int last = d - 1;
      const auto add = [&](const std::string& name, const std::vector<Point>& points, auto&& change) {
        ArrangementSetup setup = base;
        setup.name =
            name + (d == 2 ? ", 2-D, " : ", 3-D, ") + (kernel == KernelKind::wendland_c2 ? "Wendland" : "quintic");
        setup.points = points;
        change(setup);
        setups.push_back(setup);
      };
      add("random, open", random_points(lattice.size(), d), [](ArrangementSetup&) {});
      add("jittered, periodic", lattice, [&](ArrangementSetup& s) {
        for (int axis = 0; axis < d; ++axis) s.set_sides(axis, BoundaryKind::periodic);
      });
      add("clustered, walls and open", clustered_points(200, d, 0.2), [&](ArrangementSetup& s) {
        s.boundaries.sides[0] = {BoundaryKind::free_slip, BoundaryKind::open};
        s.boundaries.sides[1] = {BoundaryKind::no_slip, BoundaryKind::free_slip};
      });
      add("jittered, moving walls", lattice, [&](ArrangementSetup& s) {
        s.set_sides(0, BoundaryKind::no_slip);
        s.set_sides(last, BoundaryKind::no_slip);
        s.boundaries.sides[0][1] = BoundaryKind::free_slip;
        s.boundaries.wall[last][1] = {1.5, 0, 0};
        s.boundaries.wall[last][0][0] = -0.5;
        s.boundaries.wall[0][0] = {0.25, d == 3 ? 0.5 : -0.75, 0};
        s.boundaries.wall[0][1] = {-0.5, 0, 0};
        if (d == 3) s.set_sides(1, BoundaryKind::periodic);
      });
      std::vector<Point> half;
      for (const Point& p : lattice)
        if (p[last] < 0.6) half.push_back(p);
      add("free surface", half, [&](ArrangementSetup& s) {
        s.set_sides(0, BoundaryKind::periodic);
        if (d == 3) s.set_sides(1, BoundaryKind::free_slip);
        s.boundaries.sides[last] = {BoundaryKind::free_slip, BoundaryKind::open};
      });
      // A box standing on the bottom.
      SolidBox box;
      box.lower = {0.4, 0.35, 0.3};
      box.upper = {0.72, 0.7, 0.8};
      box.lower[last] = 0;
      std::vector<Point> around;
      for (const Point& p : lattice) {
        bool inside = true;
        for (int axis = 0; axis < d; ++axis) inside = inside && p[axis] > box.lower[axis] && p[axis] < box.upper[axis];
        if (!inside) around.push_back(p);
      }
      for (const BoundaryKind kind : {BoundaryKind::free_slip, BoundaryKind::no_slip})
        add(kind == BoundaryKind::no_slip ? "no-slip solid" : "free-slip solid", around, [&](ArrangementSetup& s) {
          s.boundaries.boxes = {box};
          s.boundaries.boxes[0].kind = kind;
          s.set_sides(0, BoundaryKind::periodic);
          for (int axis = 1; axis < d; ++axis) s.set_sides(axis, BoundaryKind::no_slip);
          s.boundaries.sides[last][1] = BoundaryKind::open;
        });
    }
  const std::size_t plain = setups.size();
  for (std::size_t k = 0; k < plain; ++k) {
    setups.push_back(setups[k]);
    setups.back().name += ", sizes";
    setups.back().sizes = true;
  }
  return setups;
}

// Arrangements are kept for the life of the program: building a twin's images takes longer than a sum.
inline std::deque<Arrangement>& all_arrangements() {
  static std::deque<Arrangement> arrangements;
  if (arrangements.empty())
    for (const ArrangementSetup& setup : all_setups()) arrangements.emplace_back(setup);
  return arrangements;
}

template <class T>
Array<float> to_float(const Array<T>& values) {
  Array<float> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) result[i] = static_cast<float>(values[i]);
  return result;
}

inline VectorArrays<double> random_velocity(const Arrangement& a, std::uint32_t draw) {
  VectorArrays<double> u;
  for (int axis = 0; axis < a.dimensions(); ++axis) u[axis] = a.random(draw + static_cast<std::uint32_t>(axis));
  return u;
}

}  // namespace spume::test
