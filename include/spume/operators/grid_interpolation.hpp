// SPDX-License-Identifier: MIT
// Interpolation of particle fields onto a uniform grid with a fourth-order consistent meshfree stencil.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "spume/core/array.hpp"
#include "spume/core/uniform_grid.hpp"

namespace spume {

struct GridInterpolationInput {
  std::array<std::span<const double>, 3> position;  // z is not read in two dimensions
  std::span<const double* const> fields;            // one pointer per field, to one value per particle
  double spacing = 0;                               // mean particle spacing
  std::array<bool, 3> periodic{};                   // positions are wrapped into the box along periodic axes
};

struct GridInterpolationOptions {
  // Radius of the stencil in particle spacings: 21 particles for 10 conditions in two dimensions, 74 for 20 in three.
  // The error grows as its fourth power. At 2.4 a lattice jittered by 0.4 spacings in two dimensions and stencils
  // beside a wall in three are refused here and there; at 2.6 none but in corners and edges.
  double support = 2.6;
  // A stencil is refused when sum |w_j|, the factor by which it can amplify noise of the field, exceeds this.
  // Inside the liquid it is between 1 and 2; extrapolation across a free surface makes it large.
  double largest_amplification = 5;
};

// How many grid points got which stencil.
struct GridInterpolationReport {
  std::int64_t cubic = 0;    // exact for cubic polynomials: error O(spacing^4)
  std::int64_t linear = 0;   // exact for linear ones, where the cubic stencil is ill-conditioned
  std::int64_t shepard = 0;  // the weighted mean, where the linear one is as well
  std::int64_t outside = 0;  // outside the liquid: value 0
};

// At every grid point x_g, with xi_j = (x_j - x_g) / R and the Wendland C2 weight W_j = (1 - |xi_j|)^4 (1 + 4 |xi_j|)
// of radius R = support * spacing, a field becomes
//   f(x_g) = sum_j w_j f_j,   w_j = W_j p(xi_j)^T M^-1 p(0),   M = sum_j W_j p(xi_j) p(xi_j)^T,
// p holding all monomials up to degree 3 (moving least squares, which is the minimiser of sum w_j^2 / W_j among all
// weights exact for cubics; King et al. 2020 solve the same consistency conditions on another basis). No particle
// volumes enter. Where a cubic stencil does not exist or is refused, the linear one is tried, then the weighted mean.
//
// A grid point is in the liquid when a particle lies within sqrt(dimensions) / 2 spacings, the farthest a point can
// be from a lattice, or when particles fill half of the kernel: spacing^dimensions sum_j W_j / integral W >= 1/2.
//
// values[f]: grid.size() values of field f, 0 outside the liquid. mask: 1 in the liquid, else 0; empty when not wanted.
// Bit-identical for any number of threads. Throws InputError for an invalid grid, arrays of different sizes, a spacing
// that is not positive, or a periodic length below R (a particle would enter its own stencil twice).
GridInterpolationReport interpolate_to_grid(const UniformGrid& grid, const GridInterpolationInput& particles,
                                            std::span<double* const> values, std::span<std::uint8_t> mask = {},
                                            const GridInterpolationOptions& options = {});

}  // namespace spume
