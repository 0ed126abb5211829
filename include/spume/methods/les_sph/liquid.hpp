// SPDX-License-Identifier: MIT
// The liquid: state between steps, what a step computes on the way, and what the stages share. An array exists
// only when the plan names a stage that uses it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "spume/core/field_set.hpp"
#include "spume/methods/les_sph/options.hpp"
#include "spume/methods/les_sph/plan.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/images.hpp"
#include "spume/neighbours/neighbour_list.hpp"
#include "spume/operators/sph_operators.hpp"
#include "spume/physics/bubbles/options.hpp"
#include "spume/physics/turbulence/options.hpp"
#include "spume/scene/case.hpp"

namespace spume::les_sph {

// One array per dimension; null beyond the dimensions of the scene or when no stage needs the vector.
using VectorField = std::array<Array<double>*, 3>;
using FloatVectorField = std::array<Array<float>*, 3>;
using WallPositions = std::array<std::array<double, 2>, 3>;  // [axis][0 lower, 1 upper]

struct Liquid {
  explicit Liquid(const LoadedCase& loaded);

  const LoadedCase& loaded;
  const Case& options;
  const Scene& scene;
  const Plan plan;
  const int dimensions;
  const double smoothing_length;
  const double volume;             // of every particle
  const LatticeConstants lattice;  // sums on an undisturbed lattice
  const double largest_shift;      // coefficient of the shift at which it stirs a lattice instead of evening it out
  const double surface_threshold;  // div r below which a particle lies at the surface
  const Vec3 origin;               // of the float coordinates

  // State between steps (sorted, saved).
  double time = 0;
  std::int64_t steps = 0;
  bool started = false;  // the first pressure has been found
  FieldSet fields;
  VectorField position{}, velocity{};
  Array<double>* pressure = nullptr;
  Array<std::int64_t>* identifier = nullptr;
  std::array<Array<double>*, 2> lagrangian_average{};  // I_LM and I_MM of the Lagrangian dynamic closure
  WallPositions walls{};

  // With bubbles only. The next two are carried; the others belong to a step in which bubbles live.
  Array<double>* volume_fraction = nullptr;  // alpha
  VectorField material_acceleration{};       // Du/Dt of the last step
  bool varying = false;                      // bubbles live: particles differ in size
  double largest_length_ratio = 1;
  Array<float> next_volume_fraction;        // alpha^{n+1}
  Array<float> length_ratio, volume_ratio;  // h_i / h and V_i / V, as far as kernels expand
  Array<float> support_radius;              // support of h_i
  Array<float> bubble_viscosity;
  FloatVectorField exchange{};  // acceleration by the bubbles
  double width_at(std::size_t i) const { return varying ? smoothing_length * length_ratio[i] : smoothing_length; }
  double alpha_at(std::size_t i) const { return varying ? double{next_volume_fraction[i]} : 1.0; }

  // Found within a step. Acceleration, diffusivity, gradient_trace, coupling and, without bubbles, smoothed_normal lose
  // their contents in the pressure solve.
  VectorField intermediate{};                 // r* of step (i)
  VectorField predicted{};                    // u* and then u^{n+1}
  Array<double>* reduced_pressure = nullptr;  // q = p + potential
  Array<double>* potential = nullptr;         // -rho a . r*, null without uniform acceleration
  Array<float>* divergence_of_position = nullptr;
  Array<float>* kernel_sum = nullptr;
  Array<float>* laplacian_diagonal = nullptr;
  std::array<Array<float>*, 6> correction{};
  Array<std::uint8_t> uncorrected;  // gradient correction fell back to the identity
  Array<std::uint8_t> at_surface;
  Array<std::uint8_t> pressure_fixed;  // p = 0: at the surface with too few neighbours for a corrected gradient
  Array<float> interior_weight;        // b: 0 at the surface, 1 inside, smooth between
  Array<std::int32_t> surface_particles;
  Array<std::int32_t> near_surface;  // b < 1 and not held
  Array<float> surface_depth;        // of those: distance from the surface
  FloatVectorField normal{}, smoothed_normal{};
  Array<std::uint8_t> beside_edge;
  Array<std::int32_t> upper_particles;      // edge particles and those of the layer below them
  Array<std::array<float, 3>> layer_shift;  // of those: the normal shift that they share
  FloatVectorField shift{};                 // displacement; first the concentration gradient
  FloatVectorField shift_velocity{};        // what the shift adds to the velocity
  std::array<Array<float>*, 9> velocity_gradient{};
  Array<float>* gradient_trace = nullptr;         // tr(grad u . grad u)
  FloatVectorField filtered_velocity{};           // without bubbles in the arrays of the acceleration
  Array<float>* strain = nullptr;                 // |S| = sqrt(2 S:S)
  Array<float>* eddy_viscosity = nullptr;         // nu_t, in the units of nu
  Array<float>* diffusivity = nullptr;            // (nu + nu_t) scaled for the viscous sweep
  std::vector<Array<float>> test_filter_scratch;  // products of the dynamic closures and their filtered values
  FloatVectorField acceleration{};                // viscous; then the gradient of q
  WallPositions next_walls{};
  Vec3 uniform_acceleration{};   // along axes that are not periodic: part of the potential
  Vec3 periodic_acceleration{};  // along periodic axes: added to the velocity
  bool uniform_body_force = false;
  double largest_body_force = 0;  // per mass, of one that varies in space, at the end of the last step
  std::array<double, 2> last_steps{};
  double displacement = 0;  // displacement_fraction of the step

  CellGrid grid;
  CellTable table;
  Images images;
  NeighbourList list;
  PackedNeighbours records;
  SweepContext context;
  VelocityImageRule velocity_rule;
  VelocityImageRule mirror_rule;  // the same without friction; in a scene with no-slip walls alone
  std::vector<std::array<float, 3>> reflection;

  // Of the accepted state.
  double max_speed = 0;
  double limiting_speed = 0;  // without spray, which only falls
  double wall_speed = 0;      // largest of the moving walls where images see them
  double max_eddy_viscosity = 0;
  double max_divergence = 0;
  double dissipation = 0;    // integral of rho (nu + nu_t) |S|^2
  double energy_supply = 0;  // energy at the start and the work of uniform forces other than gravity since

  std::size_t size() const { return fields.size(); }
  // The particle at a listed point: itself, or the source of an image.
  std::size_t particle_of(std::int32_t point) const {
    const auto n = static_cast<std::int32_t>(size());
    return static_cast<std::size_t>(point < n ? point : images.source()[point - n]);
  }
  // How images move, walls holding the liquid back along their normals alone: what mass and volume depend on. Rates of
  // volume under the rule of friction are not adjoint to the pressure gradient, which sees mirror images: liquid in the
  // edge of two no-slip walls below a surface gained speed without bound, and that in a cavity left its lid (by an
  // eighth of its density, which took 4 % off the circulation at 40 x 40, against 0.4 %).
  const VelocityImageRule& volume_rule() const { return plan.no_slip ? mirror_rule : velocity_rule; }
  bool is_edge(std::size_t i) const { return interior_weight[i] < 1 && uncorrected[i] == 0; }
  bool dynamic_closure() const;
  std::array<const double*, 3> read(const VectorField& v) const;
  std::array<const float*, 3> read(const FloatVectorField& v) const;
  std::array<float*, 3> write(const FloatVectorField& v) const;
  std::array<const float*, 6> read_correction() const;
  double potential_at(const Vec3& r) const;  // -rho a . r
};

// The stages of a step, in its order. Each reads and writes the liquid; numbers refer to King et al., section 3.3.

void move_to_intermediate(Liquid& liquid, double dt);  // (i)
void sort_particles(Liquid& liquid);
void make_images(Liquid& liquid, double dt);  // (ii)
void find_neighbours(Liquid& liquid);         // (ii)
void measure_kernel_moments(Liquid& liquid);
void compute_shift(Liquid& liquid);           // (iii)
void differentiate_velocity(Liquid& liquid);  // (v)
void find_shift_curvature(Liquid& liquid);
void find_eddy_viscosity(Liquid& liquid, double dt);
// Gravity and a uniform body force at time t, along axes without periodicity and along the others. Throws StepFailure.
void find_uniform_acceleration(Liquid& liquid, double t);
void predict_velocity(Liquid& liquid, double dt);  // (viii)
void project_velocity(Liquid& liquid, double dt);  // (x)
void accept(Liquid& liquid, double dt);            // (xi)

// Boundaries.
ImageRules image_rules(const Liquid& liquid, const WallPositions& walls);
// Wall planes at t + dt, from the time integral of the walls' normal velocities.
WallPositions advanced_walls(const Liquid& liquid, double dt);
// How images change velocities, and the reflections of geometric vectors, for walls at time t.
void update_image_rules(Liquid& liquid, double t);
// Periodic wrap; a point beyond a wall or inside a solid is reflected back, its velocity too when given.
void apply_walls(const Liquid& liquid, const WallPositions& walls, Vec3& position, Vec3* velocity);

// Particles with fewer neighbours than a surface gives are spray: they exchange next to nothing.
constexpr int spray_neighbours(int dimensions) {
  return dimensions == 3 ? 8 : 3;
}

// The energy that a flow may hold: kinetic, potential and stored in the pressure at the start (start_energy), and the
// work of uniform forces. limited_energy_supply gives it at the end of a step and throws StepFailure if the kinetic
// energy of the predicted velocities is more than twice the supply less the present potential energy. A consistent
// scheme stays below once the supply; what an instability makes passes twice soon. Bubbles and moving walls add what
// they may give at most; with forces that vary in space there is no limit.
void start_energy(Liquid& liquid);
double limited_energy_supply(const Liquid& liquid, double dt);
// What the pressure stores in a compressible liquid: the integral of p^2 / (2 rho c^2).
double stored_energy(const Liquid& liquid);

// Largest speed and eddy viscosity of the present state, for the step limit.
void update_extremes(Liquid& liquid);

}  // namespace spume::les_sph
