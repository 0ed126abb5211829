// SPDX-License-Identifier: MIT
// Walls of weakly compressible SPH by averages over the liquid (S. Adami, X. Y. Hu and N. A. Adams, J. Comput. Phys.
// 231 (2012)). With W_gj between wall point g and particle j, c_j = W_gj / sum_k W_gk and d = r_g - r_j:
//
//   any value     f_g = sum_j c_j f_j                                        (22); velocities of walls: WallStencils
//   pressure      p_g = sum_j c_j (p_j + rho_0j (g - a_g) . d)               (27), a_g the acceleration of the wall
//   density       rho_g = sum_j c_j rho_0j
//   rate          (d ln rho / dt)_j += sum_g c_j v_g Q_g / v_j,  Q_g = sum_i v_i g_ig (u_i - u_g) . (r_g - r_i)
//
// The last is the part of the rate of density that is adjoint to p_g in the pressure force (wcsph_sums.hpp): with u_g
// the velocity of the wall, in Q_g and in the rate, sum_i V_i u_i . F_i = - sum_i V_i P_i (d ln rho / dt)_i holds pair
// by pair, images included, so that nothing but the wall's own motion and gravity does work there. With an extrapolated
// u_g in its place (Adami et al., (23)) sound grows in acute wedges and in slots, by e in 0.07 sqrt(H/g).
//
// j are particles of the lists, round periodic sides too; mirror images of liquid or wall count in Q_g alone. A point
// that nothing is near has zeros. Results do not depend on the thread count.
#pragma once

#include <array>
#include <vector>

#include "spume/core/vec3.hpp"
#include "spume/operators/pair_sweep.hpp"
#include "spume/operators/surface_force.hpp"
#include "spume/operators/wall_stencils.hpp"

namespace spume {

class WallAverages {
 public:
  // The particles that each wall point among the images may see, from the lists of the context: the entries of
  // `stencils`, whose points are there already. `reflection`: of vectors, per path of the images; it outlives this.
  // `rates`: for add_rates().
  void find_entries(const SweepContext& context, const std::vector<std::array<float, 3>>& reflection,
                    WallStencils& stencils, bool rates);
  // The coefficients c_j where particles and images are now.
  void weigh(const SweepContext& context, WallStencils& stencils) const;

  struct Liquid {
    const float* pressure = nullptr;
    const float* density = nullptr;                    // rho_0
    Vec3 gravity{};                                    // zero along periodic axes
    std::array<const double*, 3> wall_acceleration{};  // per wall point; null: none
  };
  void extrapolate(const SweepContext& context, const WallStencils& stencils, const Liquid& liquid, double* pressure,
                   double* density) const;

  // Adds the rate above where the coefficients are. `flow`: room for a number per wall point.
  void add_rates(const SweepContext& context, const WallStencils& stencils,
                 const std::array<const double*, 3>& velocity, const float* volume, double* flow, float* rate) const;

  // The particles that have wall points in their lists, in their order.
  const std::vector<std::int32_t>& near() const { return transposed_.particle; }
  double bytes() const;

 private:
  // Particles near each wall point that see an image of it in mirrors.
  struct Mirrored {
    Array<std::int64_t> first;  // per wall point
    Array<std::int32_t> particle, image;
  };
  // The entries of each particle that has some.
  struct Transposed {
    std::vector<std::int32_t> particle;
    std::vector<std::int64_t> first, entry;
    std::vector<std::int32_t> point;  // of the entry
  };
  double flow_to(const SweepContext& context, const WallStencils& stencils, std::size_t point, std::int32_t particle,
                 std::int32_t image, const std::array<const double*, 3>& velocity, const float* volume) const;

  const std::vector<std::array<float, 3>>* reflection_ = nullptr;
  Array<std::int32_t> image_;  // per entry: the point of the lists that stands for the wall point
  Mirrored mirrored_;
  Transposed transposed_;
};

struct WallForceFields {
  std::array<const double*, 3> velocity{};
  const float* pressure = nullptr;
  const float* volume = nullptr;     // v
  const float* viscosity = nullptr;  // mu; null: inviscid
  bool friction = false;             // at no-slip walls
  Vec3 gravity{}, left_out{};        // as in the pressure force
  // Per path of the images: of vectors, and of velocities under friction. Sides stand still.
  const std::vector<std::array<float, 3>>*reflection = nullptr, *held = nullptr;
  // Per wall point.
  const double* wall_pressure = nullptr;
  const double* wall_density = nullptr;
  std::array<const double*, 3> wall_position{};
  std::array<const double*, 3> arm{};  // where torques count it: beside the pivot of its body
  const std::int32_t* body = nullptr;
  const std::vector<std::int32_t>* near = nullptr;  // as of WallAverages: no other particles feel walls; null: any may
};
// What the liquid does to the walls, per body, `bodies` of them: the opposite of what wall points and their images add
// to the sums of pressure and viscosity (wcsph_sums.hpp), times the volumes of the particles.
std::vector<SurfaceForce> wall_forces(const SweepContext& context, const WallForceFields& fields, std::size_t bodies);

}  // namespace spume
