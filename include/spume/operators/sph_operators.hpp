// SPDX-License-Identifier: MIT
// The SPH operators of the liquid (King et al. 2022, section 3.1.2), one sweep each, many sums in a sweep.
//
// With d = r_j - r_i and g_ij = -V F(q) sigma / h^(d+2) >= 0, the particle volume times the kernel gradient is
// V grad_i W_ij = g_ij d, and
//   corrected gradient   (3.8)   grad f  = L sum_j g (f_j - f_i) d,   L = (sum_j g d (x) d)^-1   (Bonet-Lok)
//   Morris Laplacian     (3.9)   lap f   = sum_j 2 g (f_j - f_i)
//   div-grad             (3.10)  div(k grad f) = sum_j 2 g k_ij (f_j - f_i), k_ij the harmonic mean
//   Shepard filter       (3.7)   f^ = (W(0) f_i + sum_j W f_j) / (W(0) + sum_j W)
// Arrays hold one entry per particle unless stated; symmetric matrices are xx, xy, yy in 2-D and
// xx, xy, xz, yy, yz, zz in 3-D. Results do not depend on the thread count.
#pragma once

#include <array>
#include <functional>
#include <span>

#include "spume/operators/image_values.hpp"
#include "spume/operators/pair_sweep.hpp"

namespace spume {

struct RidingScalars;  // scalar_transport.hpp

// Shape of the particle arrangement around each particle. Null pointers are not computed; L and `uncorrected` go
// together, div r is always wanted.
struct KernelMoments {
  float* kernel_sum = nullptr;                     // sum_j V W, itself included
  float* divergence_of_position = nullptr;         // tr(sum g d (x) d): d in the bulk, less at a surface
  float* laplacian_diagonal = nullptr;             // sum_j 2 g: diagonal of the negative Laplacian
  std::array<float*, 6> correction{};              // L; the identity where the sum is near singular
  std::uint8_t* uncorrected = nullptr;             // 1 where L fell back to the identity
  std::array<float*, 3> concentration_gradient{};  // (3.11): sum_j (1 + 1/4 (W/W(dr))^4) V grad W
  std::array<float*, 3> normal{};                  // (3.13) times h, outward: -h sum_j V grad W
};
// The interior weight b of a particle: 0 where div r is below `threshold`, neighbours missing on one side, 1 above
// `threshold + width`, and a half wave of the cosine between.
struct InteriorWeight {
  double threshold = 0, width = 0;
  float operator()(double divergence_of_position) const;
};
// Where neighbours are missing on one side L fades to the identity: b L + (1 - b) I, with b of the larger of div r and
// the div r that a plane surface of the same normal has, bulk - missing h |m|. An arrangement that is stretched alike
// on both sides keeps its L.
//
// The projection subtracts L times the gradient that the pressure's Laplacian stands for. Where L exceeds 2, below one
// layer of a surface, it overshoots by more than it removes, and beside a void in a closed liquid energy grows step by
// step. At a free surface the mirrored liquid completes both, and nothing fades.
struct CorrectionFading {
  InteriorWeight weight;
  double bulk = 0, missing = 0;  // div r of a lattice; what its upper layer lacks of it over its h |m|; zero: no fading
};
struct KernelMomentOptions {
  bool shifting = true;
  bool normals = true;
  double spacing = 0;  // dr of the tensile term's W(dr)
  CorrectionFading fading;
};
void kernel_moment_sweep(const SweepContext& context, PackedNeighbours& packed, const KernelMomentOptions& options,
                         const KernelMoments& out);

// Neighbours of a lattice show 0.91 of a linear change in the worst direction (support of 2.6 spacings, in space), of a
// lattice jittered by a fifth of a spacing 0.86 in 99.8 % of them and 0.80 in the worst.
constexpr float allowed_change = 1 / 0.86F;

// grad u (component-major: [a * dimensions + b] = d u_a / d x_b) and what follows from it; null where nobody asks.
struct VelocityGradientOut {
  std::array<float*, 9> gradient{};
  std::array<float*, 3> filtered{};  // the Shepard filter of u
  float* strain = nullptr;           // |S| = sqrt(2 S:S)
  float* trace = nullptr;            // tr(grad u . grad u)
  // change_a = displacement_b d u_a / d x_b, cut to what single neighbours and images show of it, those ahead along the
  // displacement s as well as those behind: in both the largest (s . d) / d^2 (u_j - u_i)_a, times `allowed_change`. A
  // smooth field is not cut. Where velocities bend within a spacing the gradient says nothing of the way that the
  // particle goes: beside a no-slip wall whose layer is thinner it is that from liquid to image, while a particle comes
  // to the wall at the speed of the liquid; carried away from the wall by the displacement again and again it would
  // gain speed without bound.
  std::array<const float*, 3> displacement{};
  std::array<float*, 3> change{};
};
void velocity_gradient_sweep(const SweepContext& context, PackedNeighbours& packed,
                             const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                             const std::array<const float*, 6>& correction, const VelocityGradientOut& out);

// tr(grad u . grad u) with the gradient of velocity_gradient_sweep.
void gradient_trace_sweep(const SweepContext& context, PackedNeighbours& packed,
                          const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                          const std::array<const float*, 6>& correction, float* trace);

// Adds the second-order Taylor term of a displacement s: out_a += 1/2 s_b s_c d2 u_a / (d x_b d x_c), from the
// corrected derivative along s of the velocity gradient. `rule` is that of the velocity, `reflection` that of geometric
// vectors.
void shift_curvature_sweep(const SweepContext& context, PackedNeighbours& packed,
                           const std::array<const float*, 9>& gradient, const VelocityImageRule& rule,
                           const std::vector<std::array<float, 3>>& reflection,
                           const std::array<const float*, 3>& shift, const std::array<const float*, 6>& correction,
                           const std::array<float*, 3>& out);

// What (3.10) makes of a linear velocity, to be taken off where it should be zero: kappa times the gradient of u, by
// sums corrected with L, times sum_j 2 g d, which is zero only where neighbours are spread evenly. Beside a wall they
// stand in rows.
struct LinearPart {
  const float* share = nullptr;              // of it, per particle; null: none is taken off
  std::array<const float*, 6> correction{};  // L
};
// (3.10) on each velocity component with coefficient kappa per particle; out: acceleration.
// With `stress` set, div(2 kappa S) in the pair form of Monaghan & Gingold (1983) and Cleary (1998),
//   sum_j 2 (d + 2) g k_ij ((u_j - u_i) . d) d / |d|^2 = k (lap u + 2 grad div u)
// for constant k: its dissipation is 2 k S:S up to a free surface, which it leaves without shear stress. The Laplacian
// dissipates k |grad u|^2, half as much in an irrotational wave. On a lattice the shear terms d_a d_b u_b, a != b, come
// out too small: by 19 % in 2-D and 13 % in 3-D with the Wendland kernel at h = 1.3 spacings, 4 % and 2 % at h = 2.
// A scalar that rides on the sweep changes no bit of the acceleration. With particles of different sizes none can:
// std::logic_error.
void viscous_sweep(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
                   const VelocityImageRule& rule, const float* kappa, const std::array<float*, 3>& out,
                   bool stress = false, const LinearPart& taken_off = {}, const RidingScalars* scalars = nullptr);

// Corrected divergence of u, and -lap of a scalar potential in the same pass (potential may be null).
void divergence_sweep(const SweepContext& context, PackedNeighbours& packed,
                      const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                      const std::array<const float*, 6>& correction, const double* potential, double* divergence,
                      float* negative_laplacian);

// Corrected gradient of the pressure q, which behind openings is what is given there. Differences are formed from value
// - reference in float, so that a large constant part costs no digits.
void gradient_sweep(const SweepContext& context, PackedNeighbours& packed, const double* values, double reference,
                    const std::array<const float*, 6>& correction, const std::array<float*, 3>& out);

// Shepard filter of a geometric vector, for all particles or for the listed ones only.
void filter_vector(const SweepContext& context, PackedNeighbours& packed, const std::array<const float*, 3>& values,
                   const std::vector<std::array<float, 3>>& reflection, const std::array<float*, 3>& out);
void filter_vector_subset(const SweepContext& context, PackedNeighbours& packed,
                          const std::array<const float*, 3>& values,
                          const std::vector<std::array<float, 3>>& reflection, std::span<const std::int32_t> subset,
                          const std::array<float*, 3>& out);

// Shepard filter of scalars, two at a time at the cost of one pass. Images take the values of their sources, or
// image_value(k, m): of the k-th scalar at image m.
using ImageValue = std::function<float(std::size_t k, std::size_t m)>;
void filter_scalars(const SweepContext& context, PackedNeighbours& packed, std::span<const float* const> values,
                    std::span<float* const> out, const ImageValue& image_value = {});

// Values of the kernel moments on an infinite lattice at this kernel and h / dr.
struct LatticeConstants {
  double divergence_of_position;  // about 2.94 in 3-D at h / dr = 1.3
  double kernel_sum;
  double laplacian_diagonal;  // sum_j 2 g times dr^2
};
// The sums below a plane surface of a lattice, layer by layer from the surface down to where they vanish. Layers are
// told apart by the smoothed normal, which falls with depth.
struct SurfaceLayer {
  double smoothed_normal;         // |n^|, dimensionless
  double twice_smoothed_normal;   // interpolated from the smoothed one
  double normal;                  // |n*| times h
  double concentration_gradient;  // magnitude times dr, towards the liquid
  double divergence_of_position;
};
std::vector<SurfaceLayer> lattice_surface(int dimensions, KernelKind kernel, double smoothing_ratio);
CorrectionFading correction_fading(int dimensions, KernelKind kernel, double smoothing_ratio,
                                   const InteriorWeight& weight);

LatticeConstants lattice_constants(int dimensions, KernelKind kernel, double smoothing_ratio);

// The coefficient C at which the shift -C h^2 grad c of King (3.11), (3.12) turns one of the plane waves along an axis
// of a lattice into its negative: repeated, it takes all of them back below C, fastest at about C / 2, and stirs the
// lattice beyond. C = 2 / max_k lambda(k), grad c = lambda / h^2 times the displacement. 0.42 (2-D) and 0.53 (3-D)
// for Wendland C2 at h / dr = 1.3, `without_mean` if the Shepard average of the shift is subtracted from it; 0.35 and
// 0.44 otherwise.
double largest_stable_shift(int dimensions, KernelKind kernel, double smoothing_ratio, bool without_mean);

}  // namespace spume
