// SPDX-License-Identifier: MIT
// Sums over the particles near a free surface and those of the layer below them. Only lists of the particles named are
// read.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "spume/operators/free_box.hpp"
#include "spume/operators/pair_sweep.hpp"

namespace spume {

// How deep a particle lies below the surface, found elsewhere.
struct KnownDepth {
  std::int32_t particle = 0;
  float depth = 0;
};

// Near-surface particles, and vectors at all particles that point out of the liquid there, of any length.
struct NearSurface {
  double spacing = 0;
  std::span<const std::int32_t> particles;
  std::array<const float*, 3> normal{};
  const SolidUnion* solids = nullptr;   // null without
  std::span<const FreeBox> boxes = {};  // of particles beside edges of solids
  std::span<const KnownDepth> known = {};
};

// How deep each near-surface particle lies below the surface: half a spacing and what a column around it holds more
// than it would at the surface of a lattice, s = dr (1/2 + sum_j V_j / V A(x_ij) B(z_ij) - the same on a lattice),
// between 0.25 and 2 dr; x is the distance from the normal through the particle, z that below it, in spacings. A is a
// cubic B-spline of support 2, whose sums do not depend on how rows stand to each other and hardly on how dense they
// are (1 % at 1.3 spacings; a kernel of the sweeps would weigh a crowded row twice); B is 1 within 0.2 spacings of the
// particle's layer and above it, and falls to 0 at 2.2: on a lattice, its own row and most of the next. Then edge
// particles of one layer (within half a spacing of it) share their depths, weighted by W. By its own depth alone a
// particle that rises from its layer would lie less deep by as much, and nothing would press it back: still water on a
// cubic lattice heaved. Where the normal vanishes s = dr.
//
// of_particle: scratch, one per particle. depth: one per near-surface particle.
//
// Images of wall points share no depths: theirs would be fits to values that only near-surface particles have.
void surface_depths(const SweepContext& context, PackedNeighbours& packed, const NearSurface& near_surface,
                    std::span<float> of_particle, std::span<float> depth);

// A(aside) B(below), in spacings, and the depth, in spacings, of the particle whose column holds `content`.
double column_weight(int dimensions, double aside, double below);
double depth_of_column(int dimensions, double content);

// Near-surface particles and those of the layer below them: which, or an image of which, lie within `layer_distance`
// spacings of a near-surface particle. On a lattice the layer below has neighbours in the surface layer at 1 and 1.41
// spacings, the next one at 2.
inline constexpr double layer_distance = 1.8;

// Sets `beside` to 1 for them, to 0 for others; one per particle.
void mark_upper_layers(const SweepContext& context, double spacing, std::span<const std::int32_t> near_surface,
                       std::span<std::uint8_t> beside);

// The part along the normal that particles of the two upper layers share with their layer of a vector v:
//
//   out = c n (sum_j W_ij (1 - |z_ij|)+ v_j . n) / (sum_j W_ij (1 - |z_ij|)+),
//
// n the mean unit normal of the near-surface particles around, weighted by (1 - r^2 / (1.8 dr)^2)+^2, z the distance
// along it in spacings; the sums include the particle. c is 1 at near-surface particles that have a normal; elsewhere
// min(1, sum of the weights of n / 0.4): 0.4 is half of what the layer below has on a square lattice (0.77; 1.08 on a
// cubic one).
//
// unit_normal: 0 at particles that are not near-surface particles. upper: particles as marked. out: one per upper
// particle; beyond the dimensions nothing is written.
void shared_along_normal(const SweepContext& context, PackedNeighbours& packed, double spacing,
                         const std::array<const float*, 3>& unit_normal, const std::array<const float*, 3>& vector,
                         const std::vector<std::array<float, 3>>& reflection, std::span<const std::int32_t> upper,
                         std::span<std::array<float, 3>> out);

}  // namespace spume
