// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "spume/core/joined_lanes.hpp"
#include "spume/operators/sph_operators.hpp"
#include "symmetric_matrix.hpp"
#include "tensile_gradient.hpp"

namespace spume {
namespace {

using simd::f32n;

// The inverse is used while it amplifies by less than this: a plane surface needs 1.5 to 2, an edge about 4;
// beyond it the neighbours lie nearly in a plane or on a line and the inverse would amplify noise.
constexpr double largest_inverse = 6;

// The sums are positive semi-definite, and what passes the bound above has a determinant of 0.014 (2-D) or 9e-4 (3-D)
// at least: this only keeps zero and what rounding makes of it from being divided by.
constexpr double least_determinant = 1e-12;

// The corrections of a block of particles: inverses of their sums d (x) d, the identity where that is singular or
// amplifies too much. A vector of particles at a time: one by one they add 7 % to the sweep.
template <int dimensions>
class Corrections {
 public:
  static constexpr int entries = symmetric_entries<dimensions>;

  void keep(std::size_t k, const float* sum) {
    for (int c = 0; c < entries; ++c) sum_[c][k] = sum[c];
  }
  void invert(std::size_t count) {
    constexpr double most_squares = dimensions * largest_inverse * largest_inverse;
    for (std::size_t k = 0; k < count; ++k) {
      double m[entries], inverse[entries], squares;
      for (int c = 0; c < entries; ++c) m[c] = sum_[c][k];
      const double determinant = inverse_of<dimensions>(m, inverse, squares);
      const bool corrected = (determinant > least_determinant) & (squares < most_squares);
      for (int c = 0; c < entries; ++c) inverse_[c][k] = corrected ? inverse[c] : identity(c);
      uncorrected_[k] = corrected ? 0 : 1;
    }
  }
  void fade(std::size_t k, double weight) {
    for (int c = 0; c < entries; ++c) inverse_[c][k] = (1 - weight) * identity(c) + weight * inverse_[c][k];
  }
  void store(std::size_t first, std::size_t count, const KernelMoments& out) const {
    for (int c = 0; c < entries; ++c)
      for (std::size_t k = 0; k < count; ++k) out.correction[c][first + k] = static_cast<float>(inverse_[c][k]);
    for (std::size_t k = 0; k < count; ++k) out.uncorrected[first + k] = static_cast<std::uint8_t>(uncorrected_[k]);
  }

 private:
  static constexpr double identity(int c) {
    for (int a = 0; a < dimensions; ++a)
      if (c == symmetric_index<dimensions>(a, a)) return 1;
    return 0;
  }
  alignas(64) float sum_[entries][sweep_block];
  alignas(64) double inverse_[entries][sweep_block];
  std::int64_t uncorrected_[sweep_block];  // as wide as what it follows from
};

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
  const TensileGradient<Kernel> with_tension(context, options.spacing);
  const double fades_below = options.fading.weight.threshold + options.fading.weight.width;

  const auto sums_of_particle = [&](std::size_t i) __attribute__((always_inline)) {
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
        const f32n tensile = with_tension(g, w);
        for (int a = 0; a < dimensions; ++a) concentration[a] = concentration[a] + tensile * b.d[a];
      }
    });
    // Fourteen sums one by one are a quarter of the instructions of a list of 75 neighbours.
    const auto sums = simd::sums_of(m, normal, concentration, std::array{kernel_sum, laplacian_diagonal});
    constexpr int first_normal = matrix, first_concentration = matrix + dimensions, others = matrix + 2 * dimensions;
    const double trace = dimensions == 2 ? double{sums[0]} + sums[2] : double{sums[0]} + sums[3] + sums[5];
    std::array<float, dimensions> outward;
    auto h = static_cast<float>(context.smoothing_length);
    if constexpr (is_variable_h<Kernel>) h *= context.length_ratio[i];
    for (int a = 0; a < dimensions; ++a) outward[a] = -h * sums[first_normal + a];
    out.divergence_of_position[i] = static_cast<float>(trace);
    const float centre = scale.value * centre_value * own_volume<Kernel>(context, i);
    if (out.kernel_sum != nullptr) out.kernel_sum[i] = centre + scale.value * sums[others];
    if (out.laplacian_diagonal != nullptr) out.laplacian_diagonal[i] = 2 * sums[others + 1];
    for (int a = 0; a < dimensions; ++a) {
      if (options.normals) out.normal[a][i] = outward[a];
      if constexpr (shifting) out.concentration_gradient[a][i] = sums[first_concentration + a];
    }
    // By how much the neighbourhood is full, as the fading takes it.
    double full = trace;
    if (fading && trace < fades_below) {
      double squares = 0;
      for (const float component : outward) squares += double{component} * component;
      full = std::max(trace, options.fading.bulk - options.fading.missing * std::sqrt(squares));
    }
    return std::pair(sums, full);
  };
  sweep_blocks(list.particles(), [&](std::size_t first, std::size_t last) {
    Corrections<dimensions> corrections;
    std::array<double, sweep_block> full;
    for (std::size_t i = first; i < last; ++i) {
      const auto [sums, own_full] = sums_of_particle(i);
      corrections.keep(i - first, sums.data());
      full[i - first] = own_full;
    }
    if (out.uncorrected == nullptr) return;
    corrections.invert(last - first);
    if constexpr (fading)
      for (std::size_t k = 0; k < last - first; ++k)
        if (full[k] < fades_below) corrections.fade(k, options.fading.weight(full[k]));
    corrections.store(first, last - first, out);
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
