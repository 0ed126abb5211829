// SPDX-License-Identifier: MIT
// The state of a weakly compressible flow and the stages of its step, in the order of step.cpp. Numbers refer to the
// README of the method.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spume/methods/wcsph/options.hpp"
#include "spume/operators/wall_averages.hpp"
#include "spume/operators/wcsph_sums.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/phase_law.hpp"
#include "spume/particles/surface_tension.hpp"
#include "spume/physics/solutes/solutes.hpp"
#include "spume/scene/case.hpp"

namespace spume::wcsph {

// What a scene needs. Stages and arrays exist by these alone.
struct Features : BoundaryFeatures, SoluteFeatures {
  explicit Features(const LoadedCase& loaded);
  bool several = false;   // phases
  bool weighted = false;  // sums of pairs of different phases, by their densities
  bool layers = false;    // of phases, each heavier than what is above it, in a closed tank
  bool gravity = false;   // across sides
  bool viscosity = false;
  bool friction = false;  // at no-slip walls
  bool tension = false;
  bool diffusion = false, shepard = false;
  bool shifting = false;
  bool density_relaxation = false;
};

// Of gravity: what the start of layers leaves of accelerations.
inline constexpr double layers_at_rest = 0.005;

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
  const double skin;
  const double expected_speed;
  const std::vector<PhaseLaw> laws;
  const std::vector<float> phase_density;  // no two alike: it tells phases apart too
  const double background;
  const Vec3 wall_gravity;  // across sides: the pressure at walls follows it
  double start_excess = 0;  // mean of s' of the scene

  // --- State between steps: saved.
  double time = 0;
  std::int64_t steps = 0;
  ParticleStore particles;
  VectorField acceleration{};  // at the positions of the state
  VectorField listed{};        // where the lists were made
  VectorField shift{};         // velocity of shifting, delta u
  Array<double>* excess = nullptr;
  Array<std::int64_t>* phase_number = nullptr;
  Array<double>* lack = nullptr;  // of s, by the kernel sums, for the density relaxation
  Boundary boundary;
  double listed_time = 0;  // of the places of moving bodies in the lists
  double settled = 0;      // 1: settle() has been
  double unsettled = 0;    // the largest acceleration that it has left, over that of gravity
  double signal = 0;       // largest sum of sound speed and speed
  double largest_speed = 0;
  double surface_energy = 0;  // of the interfaces where the last forces were found
  double liquid_volume = 0;   // by the kernel sums that the density relaxation saw last

  // --- Lists of neighbours at `listed`, seen from where the particles are.
  Arrangement arrangement;
  ParticleSizes sizes;  // all alike
  bool has_lists = false;
  std::int64_t list_builds = 0;
  bool has_moved = false;                   // the lists are new in this step, since particles have moved
  WallAverages wall_averages;               // of the wall points of bodies
  std::unique_ptr<SurfaceTension> tension;  // null: none
  Solutes solutes;                          // their fields are state

  // --- Leased within a step.
  VectorScratch half_velocity, place;
  Array<double> next_excess, pressure, wall_pressure, wall_density;
  Array<float> volume, reduced_excess, rate, diffusion, carried, density, viscosity;
  FloatVectorScratch viscous_force, pressure_force, way, flux, concentration;
  // From the acceptance of a step until the last stage that carries what is dissolved.
  struct {
    FloatVectorScratch shift, normal;  // by which the shift moved; outward, times h
    Array<float> interior;             // weight
  } carried_solutes;

  std::size_t size() const { return particles.size(); }
  std::size_t phase_of(std::size_t i) const { return static_cast<std::size_t>((*phase_number)[i]); }
  const PhaseLaw& law(std::size_t i) const { return laws[phase_of(i)]; }
  double transport(int axis, double u, std::size_t i) const { return features.shifting ? u + (*shift[axis])[i] : u; }
  double mass(std::size_t i) const { return particles.volume * law(i).density; }
  double kinetic_energy() const;
  double potential_energy() const;  // across axes with sides
  double compression_energy() const;
  double largest_excess(std::size_t phase) const;
  double largest_kinematic_viscosity() const;
  std::string laws_in_words() const;

  // The stages.
  void settle();  // of layers, to where they are at rest
  void keep_lists(double dt);
  void relax_density();             // (12)
  void drift(double dt);            // (5), to the middle of the step
  void find_rates();                // (1), and the viscous part of (2)
  void advance_density(double dt);  // (1), (3), and (5) to the end of the step
  void filter_density();
  void start_tension();                       // the first pressures of whole phases jump by the mean tension
  void find_pressure_force();                 // (2), (4)
  void add_tension();                         // (11)
  void accept(double dt);                     // (2)
  std::int64_t transport_scalars(double dt);  // returns the number of sweeps
  void transfer_oxygen(double dt);

  // What the liquid does to each body, as it is.
  std::vector<WallForce> forces_on_bodies();

  double leased_bytes() const;

 private:
  void start_density();
  double reduced(std::size_t i) const;
  void start_volume();
  double share_of_way(double way) const;
  struct HalfStep {
    double velocity, place, way;
  };
  HalfStep half_step(int axis, std::size_t i, double dt) const;
  Vec3 held_velocity(std::size_t i, double dt, Vec3& r) const;
  SurfaceTension::Now tension_now();
  void build_lists();
  bool lists_hold(double dt) const;
  void move_images(const std::array<const double*, 3>& at, double t);
  void find_wall_pressure();
  // (8)
  struct Parting {
    std::size_t body = 0;
    Vec3 foot{}, force{};
  };
  double parting_force(std::size_t i, double distance, double gap, double head) const;
  std::optional<Parting> parting_from_bodies(std::size_t i, const Vec3& r) const;
  void part_from_walls();
  void add_parting_forces(std::vector<WallForce>& forces) const;
  // Density does not diffuse to wall points: they have a phase of their own.
  bool needs_phase() const { return features.several || (features.bodies && !features.shifting); }
  bool needs_viscosity() const { return features.viscosity && needs_phase(); }
  // Pressures of images have the weight of what is between them and their sources.
  bool needs_density() const { return features.several || features.bodies || features.gravity; }
  void lease_properties();
  void release_leased();
  void move_at_rest(std::size_t i, const Vec3& way);
  void raise_datum();
  void fit_gradient_scale();
  double step_towards_rest(VectorScratch& way);
  void find_shift(std::size_t i);
  void find_signal();
  void keep_shift(double dt);
};

}  // namespace spume::wcsph
