// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "spume/particles/boundary.hpp"
#include "spume/particles/moments.hpp"
#include "spume/particles/surface.hpp"

namespace spume {

// Smoothing lengths that a step moves the fastest particle by when the liquid is rearranged as the options say,
// whatever time.courant is: rearranged in full at every step of courant 0.1 a collapsing column blew up where it met a
// wall.
inline constexpr double full_displacement = 0.2;

// Below a surface whatever expands lifts what lies above it: at the full rate a breaking wave at 1/25 gained 9 % of its
// kinetic energy, at a tenth of it 1.3 %, without relaxation 1.0 %. Liquid that closes a void gives energy away, and
// may do so at once: the wave's gain is the same 1.3 %.
inline constexpr double more_steps_below_surface = 10;

// Of what div r lacks, h |m| where liquid is as thin on all sides; tells_density() has what surfaces and foam have.
inline constexpr double largest_isotropic_normal = 1.0 / 3;

// How far the liquid moves over dt, relative to its mean velocity and without spray, over 0.2 h; at most 2, and the
// same in every frame. A liquid at rest needs no care for its arrangement, and over the same distance small steps no
// more of it than large ones.
double displacement_fraction(const Arrangement& arrangement, const ParticleStore& particles,
                             const Resolution& resolution, double dt);

struct DensityRelaxation {
  double steps = 0;         // pressure.density_relaxation
  double displacement = 0;  // displacement_fraction() of the step
  double dt = 0;
  const Array<float>* still = nullptr;            // shares of particles that are left alone as they stand; null: 0
  const Array<std::int64_t>* left_out = nullptr;  // particles with 0 or more do not count; null: all do
};

// Subtracts from `divergence` that which evens out the number density over N = `pressure.density_relaxation` steps of
// courant 0.2:
//   div u^{n+1} = displacement / (dt M) (<c> - b(<c>, 0.002)) + displacement / (dt N_i) (e_i - c_i),  c = b(e, 0.02),
//   e = S / (S of the lattice) - 1 within -0.5 and 0.1,  S = sum_j V_j W_ij,  b(x, a) = min(max(x, -a), a).
// N_i = N, less in a void: N 0.05 / |e_i| where e_i < -0.05. M = N. In a scene with a surface expansion lifts what lies
// above it: M = 10 N, and N_i = 10 N where e_i > 0. Beside an obstacle, within two support radii of an edge that the
// liquid goes around and farther than the support from a surface, N_i is at most 0.03 / (|e_i| - 0.02) where
// e_i < -0.02, and 1 where e_i < -0.05: a stream opens voids behind edges within a spacing, which is four steps; closed
// in tens of steps they let jets in. Streams past a triangle, a free-slip box and boxes of 5 to 13 spacings (2-D,
// Re = 3e4) double their energy with N_i = N and one of two boxes does with N_i = 2; with 1 none of these does. Rows of
// bars 4 spacings wide with slots of 3 to 6 do in 9 of 12 runs. S tells the density and hardly the strain of a lattice
// (at 1.2 by 1/1.2 it rises by 0.3 %, div r by 1.5 %, which would lift the crest of a wave) or a surface one layer off
// (0.4 %). Velocities free of divergence keep the density only as far as their discrete divergence tells the volume of
// a moving arrangement: without this voids open in a lid-driven cavity. What is let be is what the disorder of an
// arrangement makes of S: 0.002 in the mean (0.0017 in a cavity), which must not raise the level of a liquid with a
// surface, and 0.02 from particle to particle. Particles of the uppermost layer, which lack neighbours, and those
// within reach of both a surface and a solid box are left alone, and so is what lacks room (pockets.hpp): beside a
// pocket, and below a surface in one layer between two walls. Returns the volume that the particles take by their
// kernel sums, over that of one on the lattice: the sum of 1 / (1 + e_i), 1 for those left alone. `surface`: null
// without one. `at`: where the moments were measured.
double even_out_density(const DensityRelaxation& relaxation, const Arrangement& arrangement, const Boundary& boundary,
                        const VectorField& at, const Resolution& resolution, const MomentFields& moments,
                        const FreeSurface* surface, std::span<double> divergence);

}  // namespace spume
