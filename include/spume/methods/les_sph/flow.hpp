// SPDX-License-Identifier: MIT
// The liquid of les-sph: its state between steps, what a step finds, and the stages that find it. Parts that every
// particle method has stand on the particles floor; here is what King et al. (2022) do with them. The list of stages is
// in step.cpp, the equations are in README.md beside it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "spume/methods/les_sph/features.hpp"
#include "spume/particles/blocks.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/energy_guard.hpp"
#include "spume/particles/floating_bodies.hpp"
#include "spume/particles/force_potential.hpp"
#include "spume/particles/moments.hpp"
#include "spume/particles/point_sampler.hpp"
#include "spume/particles/projection_solver.hpp"
#include "spume/particles/shift.hpp"
#include "spume/particles/spill.hpp"
#include "spume/particles/step_limits.hpp"
#include "spume/particles/surface.hpp"
#include "spume/particles/wall_bends.hpp"
#include "spume/physics/bubbles/coupling.hpp"
#include "spume/physics/solutes/solutes.hpp"
#include "spume/physics/turbulence/eddy_viscosity.hpp"
#include "spume/scene/case.hpp"

namespace spume::les_sph {

// Particles of regions with a level surface that stand above each other at the start, columns of a region one after the
// other.
struct StartColumns {
  explicit StartColumns(const Scene& scene);
  struct Column {
    std::size_t first = 0, last = 0;  // of `order`, the uppermost first
    std::int32_t region = 0;
  };
  std::vector<std::int32_t> order;  // identifiers
  std::vector<Column> columns;
  std::size_t regions = 0;
  std::vector<double> level;         // of the surface of each region, once found
  std::vector<std::int32_t> region;  // by identifier
};

// Of liquid that starts at rest beside solids (rest.cpp); null elsewhere.
struct RestMemory {
  Array<float>* share = nullptr;  // 1 where a particle still stands as at the start, 0 a spacing of its way later
  Array<float>* lift = nullptr;   // FreeSurface::lift, times the share
};

// Sums over the particles that a row of the series reads.
struct FlowTotals {
  double kinetic = 0, potential = 0;  // energies; potential of gravity across axes with sides
  double mass = 0;                    // between the walls, at finite places. Liquid above an open top falls back
  double unresolved_dissipation = 0;  // rho nu_t |S|^2, integral
  Vec3 momentum{};
};

struct Flow {
  explicit Flow(const LoadedCase& loaded_case);
  Flow(const Flow&) = delete;
  Flow& operator=(const Flow&) = delete;

  const LoadedCase& loaded;
  const Case& options;
  const Scene& scene;
  const Features features;
  const Resolution resolution;
  // Of a body force that varies in space, if it has one.
  const std::optional<ForcePotential> force_potential;
  const double largest_shift;  // coefficient of the shift at which it stirs a lattice instead of evening it out
  const int dimensions;
  const CorrectionFading fading;  // beside voids of a closed liquid; none with a free surface or solids

  double weight = 0;  // of the liquid where it starts: sizes of gravity and of the body force, integral

  // Until the start has levelled and balanced them; null without solids and bodies, and where no surface is free.
  std::unique_ptr<StartColumns> start_columns;

  // --- State between steps: saved.
  double time = 0;
  std::int64_t steps = 0;
  bool started = false;     // the first pressure has been found
  ParticleStore particles;  // and the fields of lifetime `state` of closures and bubbles
  Array<double>* pressure = nullptr;
  RestMemory rest;
  FloatVectorField acceleration{};      // Du/Dt at the end of the last step; null without centring
  VectorField material_acceleration{};  // Du/Dt over the last step, for bubbles: null without
  Boundary boundary;                    // positions and speed of the walls
  Spill spill;
  EnergyGuard energy;  // what the flow may hold
  double work = 0;     // of forces.body, gravity along periodic axes and sponges since the start
  Speeds speeds;       // of the particles
  double max_eddy_viscosity = 0;
  double max_divergence = 0;      // of u*
  double dissipation = 0;         // integral of rho (nu + nu_t) |S|^2
  double largest_body_force = 0;  // per mass, of one that varies in space, at the end of the last step
  std::array<double, 2> last_steps{};

  // --- Results of the last step.
  ParticleSizes sizes;
  Arrangement arrangement;
  MomentFields moments;
  std::unique_ptr<FreeSurface> surface;       // null: the liquid fills the domain
  std::unique_ptr<Shift> shift;               // null: no shifting
  std::unique_ptr<WallBends> wall_bends;      // null: no friction at no-slip sides, or a closure
  VectorField intermediate_position{};        // r*
  Array<double>* reduced_pressure = nullptr;  // q = p / rho + potential
  Array<double>* potential = nullptr;         // of the accelerations that have one, at r*; null without forces
  Array<float>* strain = nullptr;             // |S| = sqrt(2 S:S)
  Vec3 uniform_acceleration{};                // along axes that are not periodic: part of the potential
  Vec3 periodic_acceleration{};               // along periodic axes: added to the velocity
  double displacement = 0;                    // displacement_fraction of the step
  double next_max_divergence = 0, next_largest_body_force = 0;  // of the step, taken over when it is accepted
  double work_of_sponges = 0;                                   // of the step
  double volume = 0;                                            // that the liquid takes, by its kernel sums
  ProjectionSolver solver;
  std::unique_ptr<turbulence::EddyViscosity> closure;  // null: none
  std::unique_ptr<bubbles::BubbleCoupling> bubbles;    // null: none
  Solutes solutes;                                     // their fields are state
  double speed_of_bodies = infinite;                   // what the scene may drive those that float with
  std::unique_ptr<FloatingBodies> floating;            // null: none; its places are state
  WallTimes wall_times;                                // of the step
  std::unique_ptr<PointSampler> gauge;                 // of walls that take up waves; null: none

  // --- Leased within a step: by the stage that writes one until the stage that reads it last.
  std::array<Array<float>, 9> velocity_gradient;
  Array<float> gradient_trace;           // tr(grad u . grad u)
  FloatVectorScratch filtered_velocity;  // Shepard filter of u
  FloatVectorScratch shift_velocity;     // what the shift adds to the velocity
  FloatVectorScratch viscous_acceleration;
  VectorScratch advecting_velocity;     // u^{n+1/2}, which moves the particles
  FloatVectorScratch varying_force;     // the body force at r*, where it varies in space and has a potential
  VectorScratch intermediate_velocity;  // u*
  VectorScratch next_velocity;          // u^{n+3/2}; without centring u^{n+1}
  Array<double> divergence;          // that the pressure removes: of u*, centred and relaxed by the stages that are on
  Array<double> first_source;        // of the first pressure
  Array<float> potential_laplacian;  // -lap of the potential by the sums of the matrix
  PressureRows rows;
  Array<double> surface_source;  // per particle near the surface
  struct {
    double helmholtz = 0;  // 1 / (c dt)^2
    double source_scale = 0;
    const Array<double>* source = nullptr;  // the divergence, or the first source
  } equation;

  std::size_t size() const { return particles.size(); }
  double density() const { return scene.fluid.density; }
  double viscosity() const { return scene.fluid.kinematic_viscosity; }
  double particle_mass() const { return density() * particles.volume; }
  double potential_at(const Vec3& r) const;  // -a . (r - origin)
  LocalAcceleration acceleration_in_potential() const { return {uniform_acceleration, &varying_force}; }
  double potential_of(std::size_t i) const { return potential == nullptr ? 0.0 : (*potential)[i]; }
  // Null without shifting, without a closure, and without bubbles.
  FloatVectorField displacement_by_shift() const { return shift == nullptr ? FloatVectorField{} : shift->displacement; }
  const Array<float>* eddy_viscosity() const { return closure == nullptr ? nullptr : &closure->viscosity(); }
  const Array<double>* volume_fraction() const { return bubbles == nullptr ? nullptr : &bubbles->volume_fraction(); }
  ConstFloatVectorField bubble_exchange() const {
    return bubbles == nullptr ? ConstFloatVectorField{} : bubbles->exchange();
  }
  const Array<float>* bubble_viscosity() const { return bubbles == nullptr ? nullptr : &bubbles->viscosity(); }
  double eddy_viscosity_of(std::size_t i) const { return closure == nullptr ? 0.0 : closure->viscosity()[i]; }
  // div(2 nu S) spreads the divergence of the velocity three times as fast as div(nu grad u) does.
  double diffusion_rate() const { return features.viscous_stress ? 3 : 1; }
  FlowTotals totals() const;
  double leased_bytes() const;  // scratch memory of a step, leased now or idle
  // What the pressure stores in a compressible liquid: the integral of p^2 / (2 rho c^2).
  double stored_energy() const;

  std::size_t remove_left();  // through open sides

  // The stages, in the order of step.cpp. Numbers refer to King et al., section 3.3.
  void move_to_intermediate_position(double dt);  // (i)
  void sort_particles();
  void pack();           // of the start
  void level_surface();  // of the start
  void find_advecting_velocity(double dt);
  void make_images(double dt);  // (ii)
  void find_neighbours(double dt);
  void measure_moments();
  void find_surface();
  void balance_rest();  // of the start
  void find_ripples(double dt);
  void compute_shift();                 // (iii)
  void differentiate_velocity();        // (v)
  void differentiate_first_velocity();  // of the start
  bool shifts_without_bends() const;    // the change by the shift takes a sweep of its own
  void find_shift_curvature();
  void find_eddy_viscosity(double dt);
  // Gravity and a uniform body force at time t, along axes without periodicity and along the others. Throws
  // StepFailure.
  void find_uniform_acceleration(double t);
  void find_potential(double dt);  // at the end of the step
  void find_wall_bends();
  void find_viscous_acceleration(double dt);
  // Of the particles that see a no-slip body, how far inside the liquid they are: of them the viscous term takes off
  // what it makes of linear velocities. A constant viscosity only: one that varies makes something of them.
  void find_held_by_bodies(float* share) const;
  double inside(std::size_t i) const;  // the interior weight: 0 at a surface and beside voids, 1 in the bulk
  // Bubbles, and the sizes of the particles that make room for them.
  void place_clouds();
  void move_bubbles(double dt);
  void share_volume();
  void exchange_with_bubbles(double dt);
  void accept_bubbles(double dt);    // what becomes of them after the step
  void predict_velocity(double dt);  // (viii)
  void damp_velocity(double dt);     // in sponges
  void find_divergence(double dt);
  void centre_divergence(double dt);
  void relax_density(double dt);
  void measure_waves();           // at walls that take them up
  void exchange_with_openings();  // particles enter and leave, where they stand at the start of the step
  void set_in_motion();           // of the start, with what enters
  void find_first_forces();
  void set_first_source();
  void find_matrix(double dt);
  void prepare_solver();
  void factorise();
  void solve_pressure();        // (x)
  void solve_first_pressure();  // lap p = div F - tr(grad u . grad u)
  void set_first_acceleration();
  void project_velocity(double dt);
  void accept(double dt);  // (xi)
  // Scalars over the step that was accepted, at the positions of its lists. Returns the number of sweeps.
  std::int64_t transport_scalars(double dt);
  RidingScalars scalars_beside_viscosity(double dt);  // what the viscous sweep finds for that step
  FloatVectorField shift_of_scalars() const;          // null: none
  void transfer_oxygen(double dt);                    // from bubbles and through the surface, of the same step

  void forget_rest(std::size_t i, double way);  // that particle i has gone in a step

  // Of a step dt that starts from the present state; the work of its forces where `dt` is not zero.
  EnergyBalance energy_balance(double dt) const;
  void find_extremes();  // largest speeds and eddy viscosity of the present state

 private:
  void differentiate(const std::array<const double*, 3>& velocity, bool first);
  void give_pressures(double t);  // behind openings
  void set_matrix();
  // u^{n+1/2} = u^n + dt/2 Du/Dt; without centring u^n.
  Vec3 advecting_velocity_of(std::size_t i, double dt) const;
  void advecting_velocities(int axis, double dt, std::size_t first, std::size_t last, double* out) const;
  // Parts of accept(), of particles first .. last - 1 of one block, whose values `before` and `ahead` of the pressure
  // force and place r the blocks hold from their start on.
  void accept_block(double dt, std::size_t first, std::size_t last);
  void stop_free_particles(double dt, std::size_t first, std::size_t last, VectorBlock& before,
                           VectorBlock& ahead) const;
  void limit_approach(double dt, std::size_t first, std::size_t last, const VectorBlock& r, const VectorBlock& before,
                      VectorBlock& ahead) const;
  void hold_at_end(std::size_t n, VectorBlock& r, VectorBlock& ahead, VectorBlock& u) const;  // of n particles
  void add_body_force(double t, double dt);
  void add_force_potential(double t);
  double work_of_step(double dt) const;
  double weight_at_start() const;
  void add_gradient_trace(const std::array<const double*, 3>& velocity, double factor, Array<double>& sum);
  double row_scale(std::size_t i) const;
  double fixed_pressure(std::size_t i) const;
  void set_weights();
  void set_right_hand_side();
  void solve(const char* name);
};

}  // namespace spume::les_sph
