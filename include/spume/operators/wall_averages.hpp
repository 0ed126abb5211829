// SPDX-License-Identifier: MIT
// Walls of weakly compressible SPH by averages over the liquid (S. Adami, X. Y. Hu and N. A. Adams, J. Comput. Phys.
// 231 (2012)). With W_gj between wall point g and particle j, c_j = W_gj / sum_k W_gk and d = r_g - r_j:
//
//   any value     f_g = sum_j c_j f_j                                        (22); velocities of walls: WallStencils
//   pressure      p_g = sum_j c_j (p_j + rho_0j (g - a_g) . d)               (27), a_g the acceleration of the wall
//   density       rho_g = sum_j c_j rho_0j
//
// j are particles of the lists, round periodic sides too; mirror images of liquid or wall do not count. A point that
// nothing is near has zeros. Results do not depend on the thread count.
#pragma once

#include <array>
#include <vector>

#include "spume/core/vec3.hpp"
#include "spume/operators/pair_sweep.hpp"
#include "spume/operators/wall_stencils.hpp"

namespace spume {

class WallAverages {
 public:
  // The particles that each wall point among the images may see, from the lists of the context: the entries of
  // `stencils`, whose points are there already. `reflection`: of vectors, per path of the images.
  void find_entries(const SweepContext& context, const std::vector<std::array<float, 3>>& reflection,
                    WallStencils& stencils);
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

  double bytes() const { return image_.bytes(); }

 private:
  Array<std::int32_t> image_;  // per entry: the point of the lists that stands for the wall point
};

// What the liquid does to the walls: the opposite of what wall points and their images add to the sums of pressure and
// viscosity (wcsph_sums.hpp), times the volumes of the particles.
struct WallForce {
  Vec3 pressure{}, viscous{}, pressure_torque{}, viscous_torque{};  // torques about the origin
};
struct WallForceFields {
  std::array<const double*, 3> velocity{};
  const float* pressure = nullptr;
  const float* volume = nullptr;     // v
  const float* viscosity = nullptr;  // mu; null: inviscid
  bool friction = false;             // at no-slip walls
  Vec3 gravity{};                    // as in the pressure force
  // Per path of the images: of vectors, and of velocities under friction. Sides stand still.
  const std::vector<std::array<float, 3>>*reflection = nullptr, *held = nullptr;
  // Per wall point.
  const double* wall_pressure = nullptr;
  const double* wall_density = nullptr;
  std::array<const double*, 3> wall_position{};
  const std::int32_t* body = nullptr;
};
// Per body; `bodies` of them.
std::vector<WallForce> wall_forces(const SweepContext& context, const WallForceFields& fields, std::size_t bodies);

}  // namespace spume
