// SPDX-License-Identifier: MIT
// The free surface: which particles form it, how the shift ends on it, and p = 0 on it.
//
// p = 0 holds on the surface itself, a depth s above a particle i near it along the outward normal n = -m / |m|, with
// m = sum_j g_ij d_ij (see sph_operators.hpp). The liquid is mirrored there with the opposite pressure, which gives,
// weighted with 1 - b (b: interior weight, 0 at surface particles, 1 inside) and for q = p + potential of the
// acceleration a at i,
//
//   lap:    row i gains  E (p_i - p0_i),  E = 2 |m| / s,   p0_i = -s a . n  the hydrostatic pressure at depth s,
//   grad:   L' (sum_j g (q_j - q_i) d + 2 (p_i - p0_i) m),   L' = (M + (2 s / |m|) m m^T)^-1,  M = sum_j g d d^T.
//
// Both are exact for linear fields, whatever s, and on a lattice the gradient along n is sum_j g (p_i + p_j) d, the
// adjoint of the divergence sum_j g (u_j - u_i) . d: pressure does no work of its own at the surface.
//
// Elsewhere it does the work -int (s - s_V) u . grad p dS per time, where s_V is the depth at which the liquid between
// particle and surface has the volume that the particles hold. So s is found by volume: what a column along n holds
// beyond what it holds under a lattice. Half the distance of the layers, in place of it, is 15 % too little on the
// front of a breaking wave, where the surface shrinks and crowds its particles: such a wave of 100 spacings gained 3 %
// of its energy before it broke; by volume it gains 0.05 %.
//
// Particles that stand more than half a spacing before a solid lack neighbours as those of a surface do. Taken for
// such, they are pushed by the whole pressure of the depth: still water over a step between two layers reached 0.4
// sqrt(g H). A particle that has the neighbours of a flat layer and finds a solid along n where its own image would
// cease to be a neighbour, at half the support radius, is none of the surface, and within the support of a solid none
// is near it without a surface particle in the layer above. Surface particles beside bodies into which a surface
// continues (particles/continued_liquid.hpp) are those of the surface: taken for others, one beside a round wall sank.
#pragma once

#include <cmath>

#include "spume/operators/free_box.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/continued_liquid.hpp"
#include "spume/particles/moments.hpp"
#include "spume/particles/options.hpp"
#include "spume/scene/solid_union.hpp"

namespace spume {

// The acceleration whose potential is part of q: a uniform one and, where a force varies in space, that of a particle.
struct LocalAcceleration {
  LocalAcceleration(const Vec3& uniform_part, const FloatVectorScratch* beside = nullptr)  // NOLINT: most are uniform
      : uniform(uniform_part), varying(beside) {}
  Vec3 at(std::size_t i) const {
    Vec3 a = uniform;
    if (varying == nullptr) return a;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!(*varying)[axis].empty()) a[axis] += (*varying)[axis][i];
    return a;
  }
  Vec3 uniform;
  const FloatVectorScratch* varying;
};

struct SurfaceRow {
  double laplacian_diagonal = 0;    // added to the diagonal of the row
  double hydrostatic_pressure = 0;  // p0 over the density, of the potential at the plane
};

// b with thresholds of [surface]; a threshold of 0 is 2.3 in 3-D, 1.5 in 2-D.
InteriorWeight interior_weight(int dimensions, const SurfaceOptions& options);

// Ripples of 4 to 7 spacings on still water grow with 0.4 and less and decay with 0.5 and more (2-D, Wendland kernel):
// methods/les_sph/README.md.
inline constexpr double ripples_ahead = 0.75;

class FreeSurface {
 public:
  struct Options {
    InteriorWeight interior;      // b; surface particles are those below its threshold
    bool smooth_normals = false;  // of surface particles, for the shift
  };
  FreeSurface(const Resolution& resolution, const Options& options);

  // From the moments of the arrangement of the particles at `at`, with images of `boundary`.
  void find(Arrangement& arrangement, ParticleStore& particles, MomentFields& moments, const Boundary& boundary,
            const VectorField& at);

  Array<std::uint8_t> at_surface;
  Array<std::uint8_t> pressure_fixed;  // p = 0: at the surface with too few neighbours for a corrected gradient
  Array<float> interior_weight;        // b
  bool closed_off = false;  // some particle that meets few others or none is none of the surface: in a pocket of bodies
  Array<std::int32_t> surface_particles;
  Array<std::int32_t> near_surface;  // b < 1 and not of fixed pressure
  Array<float> depth;                // s, of the latter
  // How much higher than `depth` says the surface lies over each particle; null: nowhere. A particle that would lie
  // off it by more than half a spacing has none, whatever it lacks of neighbours. Where the pressure is fixed it is
  // that of this depth.
  const Array<float>* lift = nullptr;
  double lift_of(std::size_t i) const { return lift == nullptr ? 0.0 : double{(*lift)[i]}; }
  bool is_covered(std::size_t i) const { return std::abs(lift_of(i)) > 0.5 * resolution_.spacing; }
  Array<float> rise;  // of the surface above where depth says, of the latter: find_rise()
  // Shepard-filtered normals of surface particles. Leased by find() and released by the shift.
  FloatVectorScratch smoothed_normal;
  void release_smoothed_normals(ParticleStore& particles);

  // How much more than that around it the surface above each near-surface particle rises in three quarters of `dt`:
  // 0.75 dt (w_i - sum_j o_j K_ij w_j / sum_j o_j K_ij), w = u . n_i, o = 1 - b, over near-surface particles, i among
  // them, and their images, K = (1 - r^2 / R^2)^2 with R the radius of the support. Its pressure resists short waves:
  // in steps of 0.3 sqrt(h / g) one of 5 spacings loses half of its height in a period to it, of 20 spacings 2 %, of 50
  // spacings 0.2 %. find() sets it to 0.
  void find_rise(const Arrangement& arrangement, const MomentFields& moments, const VectorField& velocity,
                 const std::vector<std::array<float, 3>>& reflection, double dt);
  // At the surface beside a body, into which the surface of the liquid around continues; with a surface around.
  bool continues_into_body(std::size_t i) const { return continued_.sees_surface(i); }
  bool has_planes_around(std::size_t i) const { return continued_.sees_planes(i); }
  bool is_near(const MomentFields& moments, std::size_t i) const {
    return interior_weight[i] < 1 && moments.uncorrected[i] == 0;
  }

  // The row of the k-th particle near the surface.
  SurfaceRow row(const MomentFields& moments, const ParticleSizes& sizes, const LocalAcceleration& acceleration,
                 std::size_t k) const;
  // Adds to the corrected gradients of q what mirrored liquid above the surface contributes. `potential`: null without.
  void complete_gradient(const MomentFields& moments, const ParticleSizes& sizes, const LocalAcceleration& acceleration,
                         const Array<double>& reduced_pressure, const Array<double>* potential,
                         FloatVectorScratch& gradient) const;

  double bytes() const;
  double traffic() const;  // compulsory (core/ledger.hpp), of what find() writes

 private:
  void count_in_boxes(const Arrangement& arrangement, MomentFields& moments, const VectorField& at,
                      const SolidUnion& solids);
  bool faces_solid(const Boundary& boundary, const MomentFields& moments, const VectorField& at, std::size_t i) const;
  bool is_in_pocket(const Arrangement& arrangement, const Boundary& boundary, const MomentFields& moments,
                    const VectorField& at, std::size_t i) const;
  void continue_into_bodies(const Arrangement& arrangement, MomentFields& moments, const Boundary& boundary,
                            const VectorField& at);
  void pass_over_gaps(const Arrangement& arrangement, const VectorField& at, const Boundary& boundary);
  double pressure_of_depth(std::size_t k, const Vec3& acceleration, const Vec3& inwards) const;
  Vec3 moment_of(const MomentFields& moments, const ParticleSizes& sizes, std::size_t i) const;
  const Resolution& resolution_;
  Options options_;
  // Particles beside edges of solids, their boxes, and what these hold.
  Array<std::int32_t> beside_edges_;
  std::vector<FreeBox> boxes_;
  std::vector<BoxMoments> box_moments_;
  Array<float> counted_;  // div r of the surface rule
  ContinuedLiquid continued_;
};

}  // namespace spume
