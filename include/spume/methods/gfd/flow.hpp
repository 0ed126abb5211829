// SPDX-License-Identifier: MIT
// The state of a multiphase flow and the stages of its step, in the order of step.cpp. Numbers refer to Joubert, Wilke
// and Pizette.
//
// Pressure, tension and gravity act pairwise (operators/interface_jump.hpp). The unknown is the reduced pressure
//
//   pi = p - rho g . (x - x_0) - sum_n <phi^n> c^n,
//
// with the density rho and c^n of the particle, 1 in phase n and 0 elsewhere. It is continuous across an interface in
// balance; what the mean potentials <phi^n> leave out is the force. A flat interface at rest and a drop of uniform
// curvature have pi = 0 and no force.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "spume/methods/gfd/options.hpp"
#include "spume/operators/gfd_pressure.hpp"
#include "spume/operators/interface_jump.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/buffer_layers.hpp"
#include "spume/particles/interface_potential.hpp"
#include "spume/particles/layer_stencils.hpp"
#include "spume/particles/moments.hpp"
#include "spume/particles/projection_solver.hpp"
#include "spume/particles/shift.hpp"
#include "spume/particles/step_limits.hpp"
#include "spume/scene/case.hpp"
#include "spume/solvers/implicit_diffusion.hpp"

namespace spume::gfd {

// The output field of the viscous acceleration.
inline constexpr const char* diffusion_field = "diffusion";

// What a scene needs. Stages and arrays exist by these alone.
struct Features : BoundaryFeatures {
  explicit Features(const LoadedCase& loaded);
  bool interfaces = false;    // several phases
  bool density_jump = false;  // of them
  bool tension = false;
  bool gravity = false;  // across sides: part of the reduced pressure
  bool forces = false;   // added to the velocity: forces.body, gravity along a periodic axis
  bool viscosity = false;
  bool viscosity_jump = false;  // between phases
  bool shifting = false;
  bool shift_correction = false;
  bool density_relaxation = false;
  bool writes_diffusion = false;  // output.fields
};

// Whether steps are implicit in the viscosity. By itself where the viscous limit of explicit steps is less than a fifth
// of the others, that of the speed taken at the one that the scene lets expect.
struct ViscousChoice {
  ViscousChoice(const LoadedCase& loaded, const Resolution& resolution);
  double limit = 0;  // of an explicit step; 0: without viscosity
  double speed = 0;  // that the scene lets expect; 0: nothing tells
  bool implicit = false;
  std::string reason;
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
  const int dimensions;
  const double largest_shift;  // coefficient of the shift at which it stirs a lattice instead of evening it out
  const std::vector<double> densities, viscosities;  // of the phases; dynamic

  const ViscousChoice viscous;
  const double kept_pressure;  // share of the last pressure that implicit steps start from

  double weight = 0;  // sum of m |g|, of gravity across sides

  // --- State between steps: saved.
  double time = 0;
  std::int64_t steps = 0;
  ParticleStore particles;
  Array<double>* pressure = nullptr;  // p
  Array<std::int64_t>* phase_number = nullptr;
  Array<float>* last_density = nullptr;    // rho~ of the last step; null: densities of the phases are alike
  std::unique_ptr<BufferLayers> openings;  // null: none
  Boundary boundary;
  Speeds speeds;
  double energy_supply = 0;          // mechanical energy at the start and that of the interfaces
  std::vector<double> first_volume;  // of the phases at the start
  std::int64_t packed = 0;           // beside bodies: done once

  // --- Results of the last step, at the positions that it started from.
  Arrangement arrangement;
  ParticleSizes sizes;  // all alike
  MomentFields moments;
  std::unique_ptr<Shift> shift;               // null: no shifting
  std::unique_ptr<LayerStencils> layers;      // behind openings; null: none
  std::array<Array<float>*, 6> correction{};  // B
  FloatVectorField offset{};                  // o
  Array<float>* laplacian_factor = nullptr;   // f
  Array<std::uint8_t> phase;
  InterfaceBands bands;
  std::vector<Colour> colours;
  std::vector<std::pair<std::size_t, Vec3>> exchanged;  // velocities before the mass exchange of the present step
  Array<float>* density = nullptr;                      // rho~
  Array<float>* viscosity = nullptr;                    // mu~; null without viscosity
  VectorField diffusion{};  // the viscous acceleration, where the case writes it; null: it does not
  double displacement = 0, volume_ratio = 1;
  double max_divergence = 0;
  std::vector<double> phase_volume;  // shares of the domain, by kernel sums
  ProjectionSolver solver;
  GfdPressureOperator matrix;
  ImplicitDiffusion implicit_diffusion;
  bool incremental = false;  // the pressure of the present step is that of the last one and a change

  // --- Leased within a step.
  FloatVectorScratch viscosity_gradient;  // <grad mu / rho>
  FloatVectorScratch viscous_acceleration, force_acceleration, shift_velocity;
  VectorScratch intermediate_velocity, next_velocity;
  Array<double> divergence, reduced_pressure;
  Array<float> reciprocal_density;
  PressureRows rows;

  std::size_t size() const { return particles.size(); }
  double spacing() const { return resolution.spacing; }
  bool in_domain(std::size_t i) const { return openings == nullptr || !openings->holds(i); }
  std::size_t particles_of(std::size_t n) const;  // of a phase, in the domain
  const Array<std::int64_t>* left_out() const { return openings == nullptr ? nullptr : &openings->column(); }
  double mass(std::size_t i) const {
    return particles.volume * densities[static_cast<std::size_t>((*phase_number)[i])];
  }
  GfdStencils stencils() const;
  PhaseProperty density_property() const { return {density->data(), bands.varies()}; }
  FloatVectorField displacement_by_shift() const { return shift == nullptr ? FloatVectorField{} : shift->displacement; }
  bool takes_viscosity_gradient() const;
  double gravity_potential(const Vec3& place) const;  // -g . (x - x_0), of gravity across sides
  double gravity_potential(std::size_t i) const;
  double hydrostatic_part(std::size_t i) const;                             // p - pi
  double hydrostatic_part(const Vec3& place, std::uint8_t of_phase) const;  // of a particle there
  double guess_rounding() const;
  double last_reduced(std::size_t i) const { return (*pressure)[i] - hydrostatic_part(i); }  // pi of the last step
  double largest_speed() const;                                                              // in the domain
  double kinetic_energy() const;
  double potential_energy() const;          // across axes with sides
  double energy_without_potential() const;  // kinetic, and of the interfaces
  double mass() const;                      // this and the next: in the domain
  double momentum(int axis) const;
  bool keeps_momentum(int axis) const;  // nothing acts along it
  // Forces, walls, bodies unless theirs is known, and openings whose work is not followed do not act.
  bool gains_no_energy(bool work_of_bodies_is_known = false) const;
  double roundness() const;  // of the second of two phases: surface of a ball of its volume over that area
  // What the guard of the energy measures by; after the first interfaces have been found.
  void start_pressure();
  void start_energy();  // of a run that begins

  // The stages.
  void renew_layers(double dt);  // behind openings
  void sort_particles();
  void pack();  // at the start, beside bodies
  void make_images(double dt);
  void find_neighbours(double dt);
  void find_layers(double dt);  // where they mirror the liquid
  void measure_stencils();      // (10), (11)
  void find_bands();
  void blend_properties();           // (6), (7)
  void exchange_mass();              // momentum with the mass that the filter passes on
  void exchange_first_mass();        // of a run that begins: from the sharp densities
  void keep_exchange();              // in an accepted step
  void undo_exchange();              // in a refused one
  void find_potentials();            // (14) to (17), pairwise
  void find_viscosity_gradient();    // (18)
  void find_viscous_acceleration();  // (9), (12), (13), (19)
  void measure_diffusion();          // of the initial state
  void predict_velocity(double dt);  // (20)
  void diffuse_implicitly(double dt);
  void predict_layers(double dt);
  void find_divergence();
  void relax_density(double dt);
  void compute_shift();
  void correct_for_shift();
  void set_matrix(double dt);  // (23)
  void prepare_solver();
  void solve_pressure();             // (24)
  void project_velocity(double dt);  // (21), (22)
  void accept(double dt);            // (25)

  double leased_bytes() const;

 private:
  void accept_block(double dt, std::size_t first, std::size_t last);
  void refuse_energy_from_nothing() const;
  void refuse_unconverged_diffusion() const;
  double last_norm();
  void find_potential(Colour& colour);
  void filter_properties();
  void add_interface_forces(const InterfaceForce& out);
  DiffusionProperties diffusion_properties() const;
  void blend_viscosity(std::span<const float* const> colour);
};

}  // namespace spume::gfd
