// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>

#include "spume/core/joined_lanes.hpp"
#include "spume/operators/sph_operators.hpp"
#include "symmetric_matrix.hpp"

namespace spume {
namespace {

using simd::f32n;

// The inverse is used while it amplifies by less than this: a plane surface needs 1.5 to 2, an edge about 4;
// beyond it the neighbours lie nearly in a plane or on a line and the inverse would amplify noise.
constexpr double largest_inverse = 6;

// The sums are positive semi-definite, and what passes the bound above has a determinant of 0.014 (2-D) or 9e-4 (3-D)
// at least: this only keeps zero and what rounding makes of it from being divided by.
constexpr double least_determinant = 1e-12;

// Of the tensile term, King (3.11) with W(dr) for W(0).
constexpr double tensile_factor = 0.25;

// Inverse of a symmetric matrix; false when it is singular or amplifies too much.
bool invert(const std::array<double, 6>& m, int dimensions, std::array<double, 6>& inverse) {
  double squares = 0;
  return invert_symmetric(m, dimensions, least_determinant, inverse, squares) &&
         squares < dimensions * largest_inverse * largest_inverse;
}

template <int dimensions>
void fade(double weight, std::array<double, 6>& inverse) {
  for (int a = 0, k = 0; a < dimensions; ++a)
    for (int c = a; c < dimensions; ++c, ++k) inverse[k] = (a == c ? 1 - weight : 0.0) + weight * inverse[k];
}

template <int dimensions, class Kernel, bool shifting, bool fading>
void moments(const SweepContext& context, PackedNeighbours& packed, const KernelMomentOptions& options,
             const KernelMoments& out) {
  constexpr int matrix = dimensions == 2 ? 3 : 6;
  const NeighbourList& list = *context.list;
  constexpr int payload = volume_slots<Kernel>;
  float* records = packed.prepare(context, payload);
  if constexpr (is_variable_h<Kernel>)
    pack_scalar(context, records, record_width(dimensions, payload), 0, context.volume_ratio);
  const KernelScale<dimensions, Kernel> common(context);
  const auto centre_value = static_cast<float>(Kernel::w(0.0));
  const auto inverse_reference = static_cast<float>(1 / Kernel::w(options.spacing / context.smoothing_length));

  sweep(list.particles(), [&](std::size_t i) {
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    f32n kernel_sum{}, laplacian_diagonal{};
    std::array<f32n, matrix> m{};
    std::array<f32n, dimensions> normal{}, concentration{};
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      const f32n w = Kernel::w(b.q);
      const f32n g = times_volume<Kernel>(-scale.gradient * Kernel::f(b.q), b);
      kernel_sum = kernel_sum + times_volume<Kernel>(w, b);
      laplacian_diagonal = laplacian_diagonal + g;
      int slot = 0;
      for (int a = 0; a < dimensions; ++a) {
        const f32n gd = g * b.d[a];
        normal[a] = normal[a] + gd;
        for (int c = a; c < dimensions; ++c) m[slot] = m[slot] + gd * b.d[c], ++slot;
      }
      if constexpr (shifting) {
        const f32n ratio = w * inverse_reference;
        const f32n ratio2 = ratio * ratio;
        const f32n tensile = g + static_cast<float>(tensile_factor) * g * ratio2 * ratio2;
        for (int a = 0; a < dimensions; ++a) concentration[a] = concentration[a] + tensile * b.d[a];
      }
    });
    // Fourteen sums one by one are a quarter of the instructions of a list of 75 neighbours.
    const auto sums = simd::sums_of(m, normal, concentration, std::array{kernel_sum, laplacian_diagonal});
    constexpr int first_normal = matrix, first_concentration = matrix + dimensions, others = matrix + 2 * dimensions;
    std::array<double, 6> sum{}, inverse{};
    for (int k = 0; k < matrix; ++k) sum[k] = sums[k];
    const double trace = dimensions == 2 ? sum[0] + sum[2] : sum[0] + sum[3] + sum[5];
    std::array<float, dimensions> outward;
    auto h = static_cast<float>(context.smoothing_length);
    if constexpr (is_variable_h<Kernel>) h *= context.length_ratio[i];
    for (int a = 0; a < dimensions; ++a) outward[a] = -h * sums[first_normal + a];
    if (out.uncorrected != nullptr) {
      const bool corrected = invert(sum, dimensions, inverse);
      if (!corrected)
        inverse = dimensions == 2 ? std::array<double, 6>{1, 0, 1} : std::array<double, 6>{1, 0, 0, 1, 0, 1};
      if constexpr (fading) {
        double squares = 0;
        for (const float component : outward) squares += double{component} * component;
        const double of_plane = options.fading.bulk - options.fading.missing * std::sqrt(squares);
        fade<dimensions>(options.fading.weight(std::max(trace, of_plane)), inverse);
      }
      for (int k = 0; k < matrix; ++k) out.correction[k][i] = static_cast<float>(inverse[k]);
      out.uncorrected[i] = corrected ? 0 : 1;
    }
    out.divergence_of_position[i] = static_cast<float>(trace);
    const float centre = scale.value * centre_value * own_volume<Kernel>(context, i);
    if (out.kernel_sum != nullptr) out.kernel_sum[i] = centre + scale.value * sums[others];
    if (out.laplacian_diagonal != nullptr) out.laplacian_diagonal[i] = 2 * sums[others + 1];
    for (int a = 0; a < dimensions; ++a) {
      if (options.normals) out.normal[a][i] = outward[a];
      if constexpr (shifting) out.concentration_gradient[a][i] = sums[first_concentration + a];
    }
  });
}

}  // namespace

float InteriorWeight::operator()(double divergence_of_position) const {
  const double above = divergence_of_position - threshold;
  if (above >= width) return 1;
  return above < 0 ? 0 : static_cast<float>(0.5 * (1 - std::cos(std::numbers::pi * above / width)));
}

void kernel_moment_sweep(const SweepContext& context, PackedNeighbours& packed, const KernelMomentOptions& options,
                         const KernelMoments& out) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    // Fading is code of its own: beside the sums it takes registers, 4 % of their time where no correction fades.
    const bool fading = options.fading.missing > 0;
    if (options.shifting && fading)
      moments<dimensions, Kernel, true, true>(context, packed, options, out);
    else if (options.shifting)
      moments<dimensions, Kernel, true, false>(context, packed, options, out);
    else if (fading)
      moments<dimensions, Kernel, false, true>(context, packed, options, out);
    else
      moments<dimensions, Kernel, false, false>(context, packed, options, out);
  });
}

std::vector<SurfaceLayer> lattice_surface(int dimensions, KernelKind kernel, double smoothing_ratio) {
  std::vector<SurfaceLayer> layers;
  with_plain_kernel(dimensions, kernel, [&]<int d, class Kernel>() {
    const double h = smoothing_ratio;
    const double scale = Kernel::normalisation(d) / std::pow(h, d);
    const double w_reference = Kernel::w(1 / h);
    const int n = static_cast<int>(Kernel::support * h) + 1;
    // Sums over one layer at distance k, in units of the spacing: W, g, g d_z with the tensile factor, g d.d.
    struct LayerSum {
      double w = 0, g = 0, tensile = 0, gr2 = 0;
    };
    std::vector<LayerSum> sum(static_cast<std::size_t>(n) + 1);
    for (int k = 0; k <= n; ++k)
      for (int j = d == 3 ? -n : 0; j <= (d == 3 ? n : 0); ++j)
        for (int i = -n; i <= n; ++i) {
          const double r2 = i * i + j * j + k * k;
          const double q = std::sqrt(r2) / h;
          LayerSum& layer = sum[static_cast<std::size_t>(k)];
          layer.w += scale * Kernel::w(q);
          if (r2 == 0) continue;
          const double g = -scale / (h * h) * Kernel::f(q);
          layer.g += g;
          layer.tensile += g * (1 + tensile_factor * std::pow(Kernel::w(q) / w_reference, 4));
          layer.gr2 += g * r2;
        }
    // Layer 0 lies at the surface; the layers above it are missing.
    const int depth = 2 * n + 1;
    for (int layer = 0; layer <= depth; ++layer) {
      SurfaceLayer result{};
      for (int k = -n; k <= n; ++k) {
        if (layer + k < 0) continue;
        const LayerSum& s = sum[static_cast<std::size_t>(std::abs(k))];
        result.normal += h * s.g * k;
        result.concentration_gradient += s.tensile * k;
        result.divergence_of_position += s.gr2;
      }
      layers.push_back(result);
    }
    // Shepard filter of what `from` gives per layer; below the last layer it is zero.
    const auto filter = [&](double SurfaceLayer::*from, double SurfaceLayer::*to) {
      for (int layer = 0; layer <= depth; ++layer) {
        double filtered = 0, weight = 0;
        for (int k = -n; k <= n; ++k) {
          if (layer + k < 0) continue;
          const double w = sum[static_cast<std::size_t>(std::abs(k))].w;
          weight += w;
          if (layer + k <= depth) filtered += w * layers[static_cast<std::size_t>(layer + k)].*from;
        }
        layers[static_cast<std::size_t>(layer)].*to = filtered / weight;
      }
    };
    filter(&SurfaceLayer::normal, &SurfaceLayer::smoothed_normal);
    filter(&SurfaceLayer::smoothed_normal, &SurfaceLayer::twice_smoothed_normal);
  });
  return layers;
}

CorrectionFading correction_fading(int dimensions, KernelKind kernel, double smoothing_ratio,
                                   const InteriorWeight& weight) {
  const double bulk = lattice_constants(dimensions, kernel, smoothing_ratio).divergence_of_position;
  const SurfaceLayer upper = lattice_surface(dimensions, kernel, smoothing_ratio).front();
  return {weight, bulk, (bulk - upper.divergence_of_position) / upper.normal};
}

namespace {

// visit(i, j, k) of every lattice point in the support of the one at the origin, itself included.
template <int dimensions, class Visit>
void visit_lattice(double support, Visit&& visit) {
  const int n = static_cast<int>(support) + 1;
  for (int k = dimensions == 3 ? -n : 0; k <= (dimensions == 3 ? n : 0); ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) visit(i, j, k);
}

}  // namespace

LatticeConstants lattice_constants(int dimensions, KernelKind kernel, double smoothing_ratio) {
  LatticeConstants result{};
  with_plain_kernel(dimensions, kernel, [&]<int d, class Kernel>() {
    const double h = smoothing_ratio;
    const double scale = Kernel::normalisation(d) / std::pow(h, d);
    visit_lattice<d>(Kernel::support * h, [&](int i, int j, int k) {
      const double r2 = i * i + j * j + k * k;
      const double q = std::sqrt(r2) / h;
      result.kernel_sum += scale * Kernel::w(q);
      if (r2 > 0) result.laplacian_diagonal -= 2 * scale / (h * h) * Kernel::f(q);
      result.divergence_of_position -= scale / (h * h) * Kernel::f(q) * r2;
    });
  });
  return result;
}

double largest_stable_shift(int dimensions, KernelKind kernel, double smoothing_ratio, bool without_mean) {
  double fastest = 0;
  with_plain_kernel(dimensions, kernel, [&]<int d, class Kernel>() {
    const double h = smoothing_ratio;
    const double scale = Kernel::normalisation(d) / std::pow(h, d);
    const double reference = Kernel::w(1 / h);
    constexpr double displaced = 1e-4;  // spacings; what is left out is of second order
    constexpr int waves = 32;
    for (int wave = 1; wave <= waves; ++wave) {
      double gradient = 0, weights = 0, mean = 0;
      visit_lattice<d>(Kernel::support * h, [&](int i, int j, int k) {
        const double across2 = j * j + k * k;
        const double phase = std::cos(std::numbers::pi * wave / waves * i);
        const double kernel_value = Kernel::w(std::sqrt(i * i + across2) / h);
        weights += kernel_value;
        mean += kernel_value * phase;
        if (i == 0) return;  // moves with the particle at the crest
        const double x = i + displaced * (phase - 1);
        const double q = std::sqrt(x * x + across2) / h;
        const double tensile = 1 + tensile_factor * std::pow(Kernel::w(q) / reference, 4);
        gradient -= scale * tensile * Kernel::f(q) * x;
      });
      fastest = std::max(fastest, gradient / displaced * (without_mean ? 1 - mean / weights : 1.0));
    }
  });
  return 2 / fastest;
}

}  // namespace spume
