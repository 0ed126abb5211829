// SPDX-License-Identifier: MIT
// Eddy-viscosity closures of large-eddy simulation as formulas for one particle. The caller supplies velocity
// gradients and filtered values; nothing here visits neighbours. All formulas are dimensional: lengths, speeds and
// viscosities in one unit system (with density 1 and viscosity 1 / Re in non-dimensional cases). The ratio nu_S of
// King et al. is nu_t / nu.
//
// Real is double, float or a SIMD type with sqrt found by argument-dependent lookup, except where noted.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace spume::turbulence {

// gradient[a * D + b] = d u_a / d x_b.
template <int D, class Real = double>
using Gradient = std::array<Real, D * D>;

// Upper triangle by rows: xx, xy, yy in two dimensions; xx, xy, xz, yy, yz, zz in three.
template <int D, class Real = double>
using Symmetric = std::array<Real, D*(D + 1) / 2>;

template <int D>
constexpr std::size_t symmetric_index(int a, int b) {
  return static_cast<std::size_t>(a <= b ? a * D - a * (a - 1) / 2 + b - a : symmetric_index<D>(b, a));
}

// A : B = sum_ab A_ab B_ab.
template <int D, class Real>
Real contraction(const Symmetric<D, Real>& a, const Symmetric<D, Real>& b) {
  Real sum = Real(0);
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j) {
      const std::size_t n = symmetric_index<D>(i, j);
      sum += a[n] * b[n] * Real(i == j ? 1 : 2);
    }
  return sum;
}

// S_ab = (d u_a / d x_b + d u_b / d x_a) / 2.
template <int D, class Real>
Symmetric<D, Real> strain_rate(const Gradient<D, Real>& gradient) {
  Symmetric<D, Real> strain;
  for (int a = 0; a < D; ++a)
    for (int b = a; b < D; ++b)
      strain[symmetric_index<D>(a, b)] =
          (gradient[static_cast<std::size_t>(a * D + b)] + gradient[static_cast<std::size_t>(b * D + a)]) * Real(0.5);
  return strain;
}

// |S| = sqrt(2 S : S), 1 / time.
template <int D, class Real>
Real strain_magnitude(const Symmetric<D, Real>& strain) {
  using std::sqrt;
  return sqrt(contraction<D, Real>(strain, strain) * Real(2));
}

// Standard Smagorinsky: nu_t = (C_s Delta)^2 |S|.
template <class Real>
Real smagorinsky_viscosity(Real strain_magnitude, Real filter_width, Real coefficient = Real(0.18)) {
  return coefficient * coefficient * filter_width * filter_width * strain_magnitude;
}

// q_c^2 = |u - u_hat|^2 / 2, the kinetic energy per mass between the particle scale and the test filter; also the
// sub-resolution energy k_srs of King et al. (2.14).
template <int D, class Real>
Real test_filter_energy(const std::array<Real, D>& velocity, const std::array<Real, D>& filtered_velocity) {
  Real sum = Real(0);
  for (std::size_t a = 0; a < D; ++a) {
    const Real difference = velocity[a] - filtered_velocity[a];
    sum += difference * difference;
  }
  return sum * Real(0.5);
}

// Mixed scale (Lubin et al. 2006; King et al. (2.4) with xi = 1/2, where the printed power of |S| belongs to 2 S : S):
//   nu_t = C_M Delta^(3/2) |S|^(1/2) (q_c^2)^(1/4).
template <class Real>
Real mixed_scale_viscosity(Real strain_magnitude, Real test_filter_energy, Real filter_width,
                           Real coefficient = Real(0.06)) {
  using std::sqrt;
  return coefficient * filter_width * sqrt(filter_width * strain_magnitude * sqrt(test_filter_energy));
}

// alpha = Delta_hat / Delta. Variances of filters applied in sequence add, and a box of width Delta has the variance
// Delta^2 / 12, so a test filter of variance s^2 on top of the implicit filter makes Delta_hat^2 = Delta^2 + 12 s^2.
// With Delta = h and the Wendland kernel: alpha = 2.08 in two dimensions, 2.05 in three, next to Germano's 2.
inline double test_filter_width_ratio(double filter_width, double test_filter_variance) {
  return std::sqrt(1 + 12 * test_filter_variance / (filter_width * filter_width));
}

// Test-filtered (hat) quantities of the dynamic model. The filter must reproduce constants, as Shepard's does:
// otherwise L depends on the frame of reference.
template <int D, class Real = double>
struct TestFiltered {
  std::array<Real, D> velocity;               // hat(u_a)
  Symmetric<D, Real> velocity_product;        // hat(u_a u_b)
  Symmetric<D, Real> strain;                  // hat(S_ab)
  Symmetric<D, Real> strain_times_magnitude;  // hat(|S| S_ab)
};

// Leonard stress L_ab = hat(u_a u_b) - hat(u_a) hat(u_b).
template <int D, class Real>
Symmetric<D, Real> leonard_stress(const TestFiltered<D, Real>& filtered) {
  Symmetric<D, Real> stress;
  for (int a = 0; a < D; ++a)
    for (int b = a; b < D; ++b)
      stress[symmetric_index<D>(a, b)] =
          filtered.velocity_product[symmetric_index<D>(a, b)] -
          filtered.velocity[static_cast<std::size_t>(a)] * filtered.velocity[static_cast<std::size_t>(b)];
  return stress;
}

// M_ab = 2 Delta^2 (hat(|S| S_ab) - alpha^2 |hat S| hat S_ab), trace removed: Germano's identity with
// nu_t = C Delta^2 |S| says that the deviatoric part of L is C M. The trace, zero in incompressible flow, is left
// from the slight compressibility of the liquid and belongs to the pressure.
template <int D, class Real>
Symmetric<D, Real> germano_tensor(const TestFiltered<D, Real>& filtered, Real filter_width, Real width_ratio) {
  const Real twice_square = Real(2) * filter_width * filter_width;
  const Real test_magnitude = strain_magnitude<D, Real>(filtered.strain) * width_ratio * width_ratio;
  Symmetric<D, Real> tensor;
  for (std::size_t n = 0; n < tensor.size(); ++n)
    tensor[n] = twice_square * (filtered.strain_times_magnitude[n] - test_magnitude * filtered.strain[n]);
  Real trace = Real(0);
  for (int a = 0; a < D; ++a) trace += tensor[symmetric_index<D>(a, a)];
  for (int a = 0; a < D; ++a) tensor[symmetric_index<D>(a, a)] -= trace * Real(1.0 / D);
  return tensor;
}

// L : M and M : M, speed to the fourth power. Lilly's least squares: C = <L : M> / <M : M>.
template <class Real = double>
struct GermanoContractions {
  Real leonard_germano;
  Real germano_germano;
};

template <int D, class Real>
GermanoContractions<Real> germano_contractions(const TestFiltered<D, Real>& filtered, Real filter_width,
                                               Real width_ratio) {
  const Symmetric<D, Real> tensor = germano_tensor<D, Real>(filtered, filter_width, width_ratio);
  return {contraction<D, Real>(leonard_stress<D, Real>(filtered), tensor), contraction<D, Real>(tensor, tensor)};
}

// C = averaged L : M over averaged M : M; 0 where the denominator vanishes (no strain). Averages: both contractions
// Shepard-filtered over the particles by the caller (DSS), or the Lagrangian memory below (DSL). C is C_s squared and
// may be negative with Shepard averages. Where the liquid moves almost uniformly the denominator is nothing but
// rounding and C would be anything: it is at most dynamic_largest, C_s = 0.5, three times what Lilly derives for
// isotropic turbulence.
inline constexpr double dynamic_largest = 0.25;
inline double dynamic_coefficient(const GermanoContractions<double>& averaged) {
  return averaged.germano_germano > 0 ? std::min(averaged.leonard_germano / averaged.germano_germano, dynamic_largest)
                                      : 0.0;
}

// nu_t = C Delta^2 |S|, clipped so that nu + nu_t >= 0: backscatter may cancel the molecular viscosity but not make
// the diffusion of momentum unstable.
inline double dynamic_viscosity(const GermanoContractions<double>& averaged, double strain_magnitude,
                                double filter_width, double molecular_viscosity) {
  return std::max(dynamic_coefficient(averaged) * filter_width * filter_width * strain_magnitude, -molecular_viscosity);
}

// C at which the Lagrangian memory starts, 0.16^2 (Meneveau et al. 1996), and the floor that keeps its time scale
// finite: their T diverges with I_LM = 0, so that a particle that reached zero would never leave it. At the floor
// C_s = 1e-4, which is no eddy viscosity, and T is (1e-8)^(-1/8) = 10 times the scale of I_MM alone.
inline constexpr double lagrangian_start = 0.0256;
inline constexpr double lagrangian_floor = 1e-8;

// Lagrangian averaging along the particle's path over one step dt (Meneveau et al. 1996, their (3.21)-(3.23) without
// interpolation upstream: the particle carries its memory):
//   I <- I + e (value - I),  e = (dt / T) / (1 + dt / T),  T = 1.5 Delta (I_LM I_MM)^(-1/8),
// I_LM clipped from below to lagrangian_floor I_MM. A memory with I_MM <= 0 (the first step, or a particle that never
// saw strain) starts from the current value: I_MM = M : M, I_LM = lagrangian_start I_MM.
inline GermanoContractions<double> lagrangian_average(const GermanoContractions<double>& memory,
                                                      const GermanoContractions<double>& current, double filter_width,
                                                      double dt) {
  if (!(memory.germano_germano > 0)) return {lagrangian_start * current.germano_germano, current.germano_germano};
  // The eighth root is taken of each factor: their product can underflow.
  const auto eighth_root = [](double value) { return std::sqrt(std::sqrt(std::sqrt(value))); };
  const double remembered = std::max(memory.leonard_germano, lagrangian_floor * memory.germano_germano);
  const double rate = dt * eighth_root(remembered) * eighth_root(memory.germano_germano) / (1.5 * filter_width);
  const double share = rate / (1 + rate);
  const double germano = memory.germano_germano + share * (current.germano_germano - memory.germano_germano);
  const double leonard = remembered + share * (current.leonard_germano - remembered);
  return {std::max(leonard, lagrangian_floor * germano), germano};
}

}  // namespace spume::turbulence
