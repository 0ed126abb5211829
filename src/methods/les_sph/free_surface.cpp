// SPDX-License-Identifier: MIT
#include "spume/methods/les_sph/free_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"

namespace spume::les_sph {
namespace {

// In spacings. A drop or a sheet of one layer holds less than the column of a lattice; at the second layer the
// surface is 1.5 away.
constexpr double shallowest = 0.25, deepest = 2;

// m = sum_j g d, from the outward normal -h m.
Vec3 moment_of(const Liquid& liquid, std::size_t i) {
  Vec3 m{};
  for (int axis = 0; axis < liquid.dimensions; ++axis) m[axis] = -(*liquid.normal[axis])[i] / liquid.width_at(i);
  return m;
}

double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The column that measures the depth: a cubic B-spline across, of support 2 spacings, whose sums do not depend on how
// rows stand to each other and hardly on how dense they are (1 % at 1.3 spacings; a kernel of the sweeps would weigh a
// crowded row twice); down the normal all of what lies within 0.2 spacings of the particle's layer or above it, and
// smoothly nothing below 2.2: on a lattice, its own row and most of the next.
double across(double distance, int dimensions) {
  const double x = distance;
  const double value = x < 1 ? 2.0 / 3 - x * x + x * x * x / 2 : x < 2 ? (2 - x) * (2 - x) * (2 - x) / 6 : 0.0;
  return dimensions == 2 ? value : 15 / (7 * std::numbers::pi) * value;
}
double along(double depth) {
  const double s = std::clamp(depth - 1.2, -1.0, 1.0);
  return s < 0 ? 1 - (1 + s) * (1 + s) / 2 : (1 - s) * (1 - s) / 2;
}

// What the column holds below a flat lattice surface, in spacings.
double lattice_column(int dimensions) {
  double sum = 0;
  for (int layer = 0; layer <= 2; ++layer)
    for (int j = dimensions == 3 ? -1 : 0; j <= (dimensions == 3 ? 1 : 0); ++j)
      for (int i = -1; i <= 1; ++i) sum += across(std::hypot(i, j), dimensions) * along(layer);
  return sum;
}

double depth_of(const Liquid& liquid, std::size_t i, double of_lattice) {
  const double spacing = liquid.scene.spacing;
  const int d = liquid.dimensions;
  const Vec3 m = moment_of(liquid, i);
  const double size = std::sqrt(dot(m, m));
  if (!(size > 0)) return spacing;
  const auto volume_of = [&](std::size_t j) { return liquid.varying ? double{liquid.volume_ratio[j]} : 1.0; };
  double held = volume_of(i) * across(0, d) * along(0);
  for (const std::int32_t j : liquid.list.of(i)) {
    double r2 = 0, down = 0;
    for (int axis = 0; axis < d; ++axis) {
      const float* x = liquid.list.coordinate(axis);
      const double distance = (double{x[j]} - double{x[i]}) / spacing;
      r2 += distance * distance;
      down += distance * m[axis] / size;
    }
    held += volume_of(liquid.particle_of(j)) * across(std::sqrt(std::max(0.0, r2 - down * down)), d) * along(down);
  }
  return spacing * std::clamp(0.5 + held - of_lattice, shallowest, deepest);
}

// What edge particles of one layer (within half a spacing of it) share of their depths. By its own depth alone a
// particle that rises from its layer would lie less deep by as much, and nothing would press it back: still water on a
// cubic lattice heaved: see DisturbedWaterCalmsDownInThreeDimensions in the tests.
void find_depths(Liquid& liquid) {
  const double of_lattice = lattice_column(liquid.dimensions);
  const std::size_t edges = liquid.edge_particles.size();
  float* of_particle = liquid.acceleration[0]->data();  // free until the viscous sweep
  liquid.edge_depth.resize(edges);
  parallel_for(edges, [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(liquid.edge_particles[k]);
    of_particle[i] = static_cast<float>(depth_of(liquid, i, of_lattice));
  });
  with_kernel(liquid.context, [&]<int dimensions, class Kernel>() {
    parallel_for(edges, [&](std::size_t k) {
      const auto i = static_cast<std::size_t>(liquid.edge_particles[k]);
      const double inverse_h = 1 / liquid.width_at(i);
      const Vec3 m = moment_of(liquid, i);
      const double size = std::sqrt(dot(m, m));
      double total = Kernel::w(0.0), sum = total * of_particle[i];
      for (const std::int32_t j : liquid.list.of(i)) {
        const auto source = liquid.particle_of(j);
        if (!liquid.is_edge(source)) continue;
        double r2 = 0, along = 0;
        for (int axis = 0; axis < dimensions; ++axis) {
          const float* x = liquid.list.coordinate(axis);
          const double distance = double{x[j]} - double{x[i]};
          r2 += distance * distance;
          along += distance * m[axis];
        }
        const double out_of_layer = size > 0 ? std::abs(along) / (size * liquid.scene.spacing) : 1;
        if (out_of_layer >= 0.5) continue;
        const double weight = Kernel::w(std::sqrt(r2) * inverse_h) * (1 - 2 * out_of_layer);
        total += weight;
        sum += weight * of_particle[source];
      }
      liquid.edge_depth[k] = static_cast<float>(sum / total);
    });
  });
}

}  // namespace

void find_surface(Liquid& liquid) {
  const std::size_t n = liquid.size();
  liquid.at_surface.resize(n);
  liquid.held.resize(n);
  liquid.interior_weight.resize(n);
  const double width = liquid.options.surface.blend_width;
  parallel_for(n, [&](std::size_t i) {
    const double above = (*liquid.divergence_of_position)[i] - liquid.surface_threshold;
    liquid.at_surface[i] = above < 0 ? 1 : 0;
    liquid.held[i] = above < 0 && liquid.uncorrected[i] != 0 ? 1 : 0;
    liquid.interior_weight[i] = above < 0 ? 0.0F
                                : above < width
                                    ? static_cast<float>(0.5 * (1 - std::cos(std::numbers::pi * above / width)))
                                    : 1.0F;
  });
  parallel_select(n, liquid.surface_particles, [&](std::size_t i) { return liquid.at_surface[i] != 0; });
  parallel_select(n, liquid.edge_particles, [&](std::size_t i) { return liquid.is_edge(i); });
  find_depths(liquid);
  if (liquid.plan.shifting)
    filter_vector_subset(liquid.context, liquid.records, liquid.read(liquid.normal), liquid.reflection,
                         liquid.surface_particles, liquid.write(liquid.smoothed_normal));
}

SurfaceRow surface_row(const Liquid& liquid, std::size_t k) {
  const auto i = static_cast<std::size_t>(liquid.edge_particles[k]);
  const double outside = 1 - double{liquid.interior_weight[i]};
  const double depth = liquid.edge_depth[k];
  const Vec3 m = moment_of(liquid, i);
  const double size = std::sqrt(dot(m, m));
  // In a thin sheet |m| vanishes although the surface is near on both sides: there the pairs that are missing hold p =
  // 0.
  const double full = liquid.lattice.coupling / (liquid.scene.spacing * liquid.scene.spacing);
  const double missing = std::max(0.0, full - double{(*liquid.coupling)[i]});
  SurfaceRow row;
  row.coupling = outside * std::max(2 * size / depth, missing);
  if (size > 0) row.hydrostatic_pressure = depth * dot(liquid.uniform_acceleration, m) / size;
  return row;
}

void complete_surface_gradient(Liquid& liquid) {
  const int d = liquid.dimensions;
  parallel_for(liquid.edge_particles.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(liquid.edge_particles[k]);
    const Vec3 m = moment_of(liquid, i);
    const double size = std::sqrt(dot(m, m));
    if (!(size > 0)) return;
    const double outside = 1 - double{liquid.interior_weight[i]};
    const double depth = liquid.edge_depth[k];
    const double potential = liquid.potential == nullptr ? 0.0 : (*liquid.potential)[i];
    const double excess =
        (*liquid.reduced_pressure)[i] - potential - depth * dot(liquid.uniform_acceleration, m) / size;
    // L' by Sherman-Morrison: with v = L m and c = 2 s / |m|, L' x = L x - c v (v . x) / (1 + c m . v).
    Vec3 v{}, gradient{};
    int slot = 0;
    for (int a = 0; a < d; ++a) {
      gradient[a] = (*liquid.acceleration[a])[i];
      for (int b = a; b < d; ++b, ++slot) {
        const double entry = (*liquid.correction[slot])[i];
        v[a] += entry * m[b];
        if (b != a) v[b] += entry * m[a];
      }
    }
    const double c = 2 * outside * depth / size;
    const double factor = (2 * outside * excess - c * dot(m, gradient)) / (1 + c * dot(m, v));
    for (int a = 0; a < d; ++a) (*liquid.acceleration[a])[i] = static_cast<float>(gradient[a] + factor * v[a]);
  });
}

}  // namespace spume::les_sph
