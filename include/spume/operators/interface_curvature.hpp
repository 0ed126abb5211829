// SPDX-License-Identifier: MIT
// Normals, curvature and tension of an interface: Joubert et al., equations (14) to (17). With d = r_j - r_i,
//
//   N     = <grad C / rho> = B sum_j (C_j - C_i) / rho_ij W d,  rho_ij = (rho_i + rho_j) / 2         (14)
//   n     = N / |N| where rho_i |N| > eps / h, on the band; 0 elsewhere                               (15)
//   kappa = -div n = -sum_{j in band} W (n_j - n_i) . B' d                                            (16)
//   s     = sigma kappa N                                                                             (17)
//
// n points towards the phase of C, whose drop has a positive curvature: 1 / R in two dimensions, 2 / R in three. (16)
// as printed takes B of all neighbours for a sum over the band, which biases its edges; here B' is that of the sum over
// the band, so that kappa is exact for linear n. Where the band around a particle is too thin for B', neighbours nearly
// on a line or in a plane, B' is isotropic as in gfd_moments.hpp.
#pragma once

#include "spume/operators/gfd_gradient.hpp"
#include "spume/operators/interface_bands.hpp"

namespace spume {

// The paper's eps of (15), found suitable for all its simulations.
inline constexpr double band_threshold = 0.01;

// (14) and (15), per particle; zero off the band. h is the smoothing length.
struct InterfaceNormals {
  std::array<float*, 3> gradient{};  // N
  std::array<float*, 3> normal{};    // n
};
// colour: C of the phase, density: filtered; correction: B.
void interface_normal_sweep(const SweepContext& context, PackedNeighbours& packed, const InterfaceBands& bands,
                            const float* colour, const float* density, const std::array<const float*, 6>& correction,
                            double threshold, const InterfaceNormals& out);

// (16) of the normals at the particles `subset`, zero elsewhere and off the band. reflection: of geometric vectors, per
// path of an image.
void curvature_sweep(const SweepContext& context, PackedNeighbours& packed, std::span<const std::int32_t> subset,
                     const std::array<const float*, 3>& normal, const std::vector<std::array<float, 3>>& reflection,
                     float* curvature);

// (17): an acceleration, zero off the band. tension: sigma, force per length.
void tension_acceleration(const SweepContext& context, const InterfaceBands& bands, double tension,
                          const float* curvature, const std::array<const float*, 3>& gradient,
                          const std::array<float*, 3>& out);

}  // namespace spume
