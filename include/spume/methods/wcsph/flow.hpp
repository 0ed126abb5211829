// SPDX-License-Identifier: MIT
// The state of a weakly compressible flow and the stages of its step, in the order of step.cpp. Numbers refer to the
// README of the method.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spume/core/go_on.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/wcsph/options.hpp"
#include "spume/operators/wcsph_sums.hpp"
#include "spume/particles/acoustic_layers.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/averaged_walls.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/buffer_layers.hpp"
#include "spume/particles/excess_relaxation.hpp"
#include "spume/particles/fastest.hpp"
#include "spume/particles/half_steps.hpp"
#include "spume/particles/list_life.hpp"
#include "spume/particles/phase_energies.hpp"
#include "spume/particles/phase_law.hpp"
#include "spume/particles/spill.hpp"
#include "spume/particles/start_at_rest.hpp"
#include "spume/particles/still_liquid.hpp"
#include "spume/particles/surface_tension.hpp"
#include "spume/particles/wall_contacts.hpp"
#include "spume/particles/wall_parting.hpp"
#include "spume/physics/solutes/measured_transport.hpp"
#include "spume/scene/case.hpp"

namespace spume::wcsph {

// What a scene needs. Stages and arrays exist by these alone.
struct Features : BoundaryFeatures, SoluteFeatures {
  explicit Features(const LoadedCase& loaded);
  bool several = false;   // phases
  bool weighted = false;  // sums of pairs of different phases, by their densities
  StartAtRest rest;
  bool gravity = false;  // across sides
  bool viscosity = false;
  bool friction = false;    // at no-slip walls
  bool wall_rates = false;  // of bodies: adjoint to the pressure there
  bool tension = false;
  bool diffusion = false, shepard = false;
  bool shifting = false;
  bool uneven = false;  // liquids that flow beside bodies, and by default are not shifted there
  bool density_relaxation = false;
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
  const double skin;
  const double expected_speed;
  const std::vector<PhaseLaw> laws;
  const std::vector<float> phase_density;  // distinct_densities()
  const Vec3 wall_gravity;                 // across sides: the pressure at walls follows it
  const StillLiquid still;                 // (16)
  const double lone_speed;                 // U of (7) in one liquid: where it fills its tank not that of a fall
  const double background;

  // --- State between steps: saved.
  double time = 0;
  std::int64_t steps = 0;
  ParticleStore particles;
  FloatVectorField acceleration{};  // at the positions of the state
  FloatVectorField listed{};        // where the lists were made, less the origin of the arrangement
  FloatVectorField shift{};         // velocity of shifting, delta u
  Array<double>* excess = nullptr;
  Array<std::int64_t>* phase_number = nullptr;  // empty of one phase without openings
  std::unique_ptr<BufferLayers> openings;       // null: none
  std::unique_ptr<AcousticLayers> acoustic;     // null: none
  Boundary boundary;
  Spill spill;
  double listed_time = 0;  // of the places of moving bodies in the lists
  std::string unsettled;   // what it says of accelerations that it has left
  double signal = 0;       // largest sum of sound speed and speed
  double largest_speed = 0;
  double strain = infinite;   // Fastest::strain, of layers behind openings too; infinite: not known
  double measured_way = 0;    // of the fastest particle since (12) was measured
  double surface_energy = 0;  // of the interfaces where the last forces were found

  // --- Lists of neighbours at `listed`, seen from where the particles are.
  Arrangement arrangement;
  ParticleSizes sizes;  // all alike
  ListLife list_life;
  std::int64_t started = 0;  // 1: the first forces are found
  bool has_lists = false;
  std::int64_t list_builds = 0;
  bool has_moved = false;                        // far enough for (12) to be measured anew
  AveragedWalls walls;                           // of bodies
  WallContacts contacts;                         // with bodies
  const WallParting parting;                     // (8)
  std::unique_ptr<ExcessRelaxation> relaxation;  // (12); null: none
  std::unique_ptr<SurfaceTension> tension;       // null: none
  Solutes solutes;                               // their fields are state
  MeasuredTransport solute_transport;

  // --- Leased within a step.
  VectorScratch half_velocity, place;
  Array<double> next_excess;
  Array<float> pressure, volume, reduced_excess, rate, diffusion, carried, density, viscosity;
  FloatVectorScratch force, flux, concentration;
  std::vector<std::uint8_t> held;  // whether a wall has held one of a block of particles

  std::size_t size() const { return particles.size(); }
  std::size_t phase_of(std::size_t i) const {
    return features.several ? static_cast<std::size_t>((*phase_number)[i]) : 0;
  }
  const PhaseLaw& law(std::size_t i) const { return laws[phase_of(i)]; }
  ParticleLaws law_of_particles() const { return {laws, *phase_number}; }
  double pressure_at(double s, std::size_t i) const { return law(i).pressure(s) + background; }
  double listed_at(int axis, std::size_t i) const { return arrangement.origin[axis] + double{(*listed[axis])[i]}; }
  bool in_domain(std::size_t i) const { return openings == nullptr || !openings->holds(i); }
  double mass() const {
    return parallel_sum(size(), [this](std::size_t i) { return mass(i); });
  }
  double mass(std::size_t i) const { return in_domain(i) ? particles.volume * law(i).density : 0; }
  // Of particles of layers behind openings: 0 or more. Null: there are none.
  const std::int64_t* layer() const { return openings == nullptr ? nullptr : openings->column().data(); }
  double volume_spilt() const { return particles.volume * static_cast<double>(spill.count()); }
  double volume_spilt(std::size_t phase) const { return particles.volume * static_cast<double>(spill.count(phase)); }
  double mass_spilt() const;
  PhaseEnergies energies() const;  // potential across axes with sides
  // Without the layers behind openings.
  double largest_excess(std::size_t phase) const {
    return spume::largest_excess(phase, *phase_number, *excess, layer());
  }

  // The stages.
  void move_layers(double dt);     // behind openings
  void settle(const GoOn& go_on);  // to where the liquid is at rest
  void keep_lists(double dt);
  void measure_volume();            // (12)
  void drift(double dt);            // (5), to the middle of the step
  void find_rates(double dt);       // (1), and the viscous part of (2)
  void advance_density(double dt);  // (1), (3), and (5) to the end of the step
  void filter_density();
  void find_pressure_behind(double dt);  // openings
  void start_tension();                  // the first pressures of whole phases jump by the mean tension
  void find_pressure_force();            // (2), (4)
  void add_tension();                    // (11)
  void accept(double dt);                // (2)
  // The place that particle i is on its way to and its velocity there, as walls let them.
  void hold(std::size_t i, Vec3& r, Vec3& u) const;
  std::int64_t transport_scalars(double dt);
  void transfer_oxygen(double dt) { solute_transport.transfer_oxygen(time, dt); }

  // What the liquid does to each body, as it is.
  std::vector<SurfaceForce> forces_on_bodies();

  double leased_bytes() const;

  // Something else than gravity across sides works on the liquid, or some of it leaves.
  bool driven() const {
    return features.moving_walls || features.moving_bodies || features.openings || scene.body_force ||
           scene.fluid.gravity != wall_gravity || spill.possible();
  }

 private:
  Array<std::int64_t> no_numbers_;
  void start_density();
  void fill_layers();                      // what stands behind openings at the start
  void lead_scalars();                     // layers of inflows have what these bring
  HalfSteps half_steps(double dt) const {  // (5), (6)
    return {dt, read(particles.position), read(particles.velocity), read(acceleration), read(shift)};
  }
  bool arrive(const HalfSteps& half, std::size_t first, std::size_t last);
  void accept_block(const HalfSteps& half, const VectorExpression& given, std::size_t first, std::size_t last);
  void apply_walls(std::size_t i, Vec3& r, Vec3* u, const Vec3* from) const;
  SurfaceTension::Now tension_now() {
    return {arrangement, resolution, boundary.reflection(), particles, volume.data()};
  }
  void build_lists();
  bool lists_hold(double dt);
  void move_images(const std::array<const double*, 3>& at, double t);
  WallParting::Liquid parted(const std::array<const double*, 3>& at) const;
  // Of the fastest particle, splashes that pass what (3) is made for apart.
  double present_speed() const { return std::min(largest_speed, expected_speed); }
  // U of (7). The noise that a shift makes at interfaces goes with it: of several liquids, which buoyancy moves slowly,
  // it is the largest present speed. Those of 1010 and 1000 kg/m3 that exchange a tank turn over to -0.64 of their
  // start with that, to -0.32 with the speed of a free fall, by the method of finite differences to -0.66. One liquid
  // that fills its tank may become faster than its start tells, under a lid that sets out from rest.
  double shift_speed() const {
    return features.several && !features.tension ? present_speed() : std::max(lone_speed, present_speed());
  }
  // Density does not diffuse to wall points: they have a phase of their own.
  bool needs_phase() const { return features.several || (features.bodies && !features.shifting); }
  bool needs_viscosity() const { return features.viscosity && features.several; }
  // Pressures of images have the weight of what is between them and their sources.
  bool needs_density() const { return features.several || features.bodies || features.gravity; }
  void lease_properties();
  void release_leased();
  void find_signal();
  Fastest::State moving(const double* density_excess) const;
  void take(const Fastest& fastest);
};

}  // namespace spume::wcsph
