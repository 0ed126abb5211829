// SPDX-License-Identifier: MIT
// Bubbles in a liquid of particles (King et al. 2022, sections 3.1.1 and 3.3): the volume they take, the liquid they
// feel, the forces they return.
//
// Every pair of a bubble and a particle within the reach of the particle is looked at from both: from the bubble to
// interpolate to it, from the particle to sum up from bubbles without races. Weights are
//   phi_ib = V_i W(r_b - r_i, h_i) / sum_k V_k W(r_b - r_k, h_k),
// so that what all particles receive from a bubble is what it gave, also below a surface, and a uniform field is
// interpolated exactly. Mirrored particles count; what they receive goes to their source.
//
// h_i follows the volume fraction of the step before, alpha the bubbles of this step: alpha = 1 - sum_b W V_b, the
// fixed point of King (3.1). Below 1/2, where the fixed point fails, alpha is continued by 1 / (4 sum); kernels expand
// as if alpha were 1/2; volumes of bubbles stay exact.
//
// Momentum: a particle carries a constant mass, so alpha du/dt = -grad(alpha p) + ... and not d(alpha u)/dt as printed
// in (2.3), which is not Galilean invariant; (3.17) follows from this form. With q the pressure less its hydrostatic
// part both momentum forms receive the full reaction of the bubbles: the buoyancy taken out of M and (1 - alpha) g of
// the mixture cancel. They differ in the coefficient of grad q alone, 1/alpha (mixture-pressure) or 1 (two-fluid).
//
// F_fs holds a bubble below the surface. King (3.33) returns it to the liquid around the bubble, which is then as light
// as if the bubble rose, and turns over for as long as the bubble rests; a film that bears the bubble by its own
// deformation, which is not resolved, leaves the liquid at rest. The latter is the default (surface_reaction).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "spume/core/array_info.hpp"
#include "spume/core/saved_state.hpp"
#include "spume/io/record_table.hpp"
#include "spume/operators/cross_sums.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/reports.hpp"
#include "spume/particles/step_limits.hpp"
#include "spume/particles/surface.hpp"
#include "spume/physics/bubbles/breakup.hpp"
#include "spume/physics/bubbles/entrainment.hpp"
#include "spume/physics/bubbles/forces.hpp"
#include "spume/physics/bubbles/options.hpp"
#include "spume/physics/bubbles/population.hpp"
#include "spume/physics/bubbles/sources.hpp"
#include "spume/physics/bubbles/statistics.hpp"
#include "spume/physics/bubbles/surface_interaction.hpp"
#include "spume/physics/oxygen/supply.hpp"
#include "spume/physics/oxygen/transfer.hpp"

namespace spume::bubbles {

// What bubbles see of the liquid that carries them: they read it, and write what they own or what a stage hands them.
// Everything lives as long as the coupling.
struct Carrier {
  const Scene& scene;
  const Arrangement& arrangement;
  const Boundary& boundary;  // which keeps bubbles inside, and makes their images
  const Resolution& resolution;
  const ParticleSizes& sizes;
  const double particle_volume;
  const Array<std::int64_t>& identifier;
  const ConstVectorField position, velocity;     // at the start of the step
  const VectorScratch& advecting_velocity;       // that moves the liquid in the step
  const ConstVectorField intermediate_position;  // r*
  const ConstVectorField material_acceleration;  // Du/Dt of the last step
  const std::array<Array<float>, 9>& velocity_gradient;
  const Array<float>& strain;                   // |S|
  const FloatVectorScratch* filtered_velocity;  // null: none
  const Array<float>* eddy_viscosity;           // null: none
  const ConstFloatVectorField normal;           // outward, times h; of a liquid with a surface
  const FreeSurface* surface;                   // null: the liquid has none
  const ConstFloatVectorField shift;            // of the last step; null: none
  const double& time;                           // of the state
  const std::int64_t& steps;
  const Speeds& speeds;
  const oxygen::Gas* gas = nullptr;          // exchanged with the liquid; null: none
  const Array<double>* dissolved = nullptr;  // concentration of the particles, with `gas`

  std::size_t size() const { return identifier.size(); }
};

class BubbleCoupling final : public oxygen::Supply {
 public:
  // Adds the volume fraction to the state of the particles, and the exchange to their fields.
  BubbleCoupling(ParticleStore& particles, const Carrier& carrier, const BubbleOptions& options,
                 const BubbleSources& sources);

  // The stages of a step, in its order. Without living bubbles each returns at once, and particles are all alike.
  void move(double dt, ParticleSizes& sizes);  // bubbles to r_b^{n+1}, sorted; h_i of the particles
  void share_volume(ParticleSizes& sizes);     // alpha^{n+1} and V_i; precondition: images of the particles at h_i
  // Velocities of the bubbles, forces on the liquid; `packed` serves its sweeps.
  void exchange_momentum(double dt, PackedNeighbours& packed);
  void accept(double dt);  // takes the step over; births and deaths

  void place_clouds();            // of the start
  void accept_volume_fraction();  // alpha of the step, while bubbles live

  const Population& population() const { return population_; }
  const History& history() const { return history_; }
  double max_speed() const { return max_speed_; }

  // What all bubbles gave to the liquid in the last exchange: sum of M_b, over the density of the liquid.
  Vec3 total_reaction() const;
  // Vorticity of the liquid at bubble b in the last exchange.
  Vec3 vorticity_at_bubble(std::size_t b) const;
  // h_i of the liquid around bubble b, the width of its filter, in units of h.
  double filter_width_at_bubble(std::size_t b) const;

  // Of the particles: alpha of the last step; and while bubbles live the acceleration of the liquid by them and the
  // viscosity that they induce.
  const Array<double>& volume_fraction() const { return *volume_fraction_; }
  ConstFloatVectorField exchange() const { return constant(exchange_); }
  const Array<float>& viscosity() const { return viscosity_; }
  // Of the last exchange, with a gas: what bubbles changed of the concentrations, by float sums, and the amount
  // exactly.
  const Array<float>& dissolution() const { return dissolution_; }
  double dissolved_amount() const { return next_gas_totals_.given; }
  double conductance() const override { return population_.empty() ? 0 : gas_totals_.conductance; }  // sum of k_L A
  // What spargers feed of oxygen at the time of the state, g per time.
  double oxygen_feed() const override;
  void each(const Each& see) const override;
  // What bubbles would give to a liquid without oxygen, g per time.
  double transfer_capacity() const override { return population_.empty() ? 0 : gas_totals_.capacity; }
  bool mixture_pressure() const { return options_.momentum_form == MomentumForm::mixture_pressure; }

  void add_columns(SeriesTable& table) const;
  ParticleSnapshot snapshot();
  std::vector<RecordTable> tables() const;
  void table_rows(const std::string& name, std::vector<double>& rows);
  std::string note();  // of what happened since the last call; "" for nothing
  std::vector<ArrayInfo> arrays() const;
  double image_traffic() const { return static_cast<double>(images_.size()) * (3 * 8 + 4 + 4); }
  void save(StateWriter& writer) const;
  void load(StateReader& reader);

 private:
  void measure_sizes(ParticleSizes& sizes) const;
  void place_bubbles();
  CrossSearch bubble_search() const;  // bubbles and their images
  CrossSearch liquid_search() const;  // particles and their images
  CrossTargets particle_targets() const;
  void pack_liquid();
  void pack_particles(std::size_t first, std::size_t last);
  void pack_images();
  void select_normals();
  void smooth_normals(PackedNeighbours& packed);
  void move_bubbles(double dt);
  void move_bubble(std::size_t b, double dt);
  Vec3 advance_fluctuation_at(std::size_t b, const Vec3& slip, double dt);
  Braking brake_at_surface(std::size_t b, const Vec3& slip, double radius, double dt);
  struct Moved {
    Vec3 velocity{}, reaction{};
  };
  Moved accelerate(const Gas& gas, std::size_t b, const Surroundings& around, const Vec3& u, double radius,
                   const Braking& braking, double dt) const;
  void interpolate();
  // Bursts inside the liquid (inner_bursts.cpp).
  double mixture_at(const CrossSearch& search, const std::array<float, 3>& place) const;
  bool faces_liquid(const CrossSearch& search, std::size_t b) const;
  std::int64_t count_inner_bursts() const;
  // Walls (walls.cpp).
  bool beside_bodies() const { return carrier_.boundary.bodies() != nullptr; }
  void reflect_bubbles(const ImageRules& rules);
  WallPointView reflections() const;
  template <class Factor, class Take>
  void weigh_beside_walls(const std::array<const float*, 3>& point, const Factor& factor, const Take& take) const;
  void weigh_reflections();
  float share_of_image(std::size_t k) const;
  void weigh_received();
  void mirror_record(const ImageMap& map, std::size_t k, std::size_t point, float* value) const;
  struct Stop {
    Vec3 normal;
    double least;
  };
  std::optional<Stop> stop_before(const Vec3& at, const Vec3& velocity, double dt) const;
  void slide_along_walls(std::size_t b, const Surroundings& around, const Vec3& u, double radius,
                         const Braking& braking, double dt, Moved& moved) const;
  void keep_new_bubbles_outside(std::size_t first);
  template <int components>
  void deposit();
  void remove_dead(double t);
  void break_up(double dt);
  // Gas that bubbles exchange with the liquid (gas.cpp).
  bool exchanges_gas() const { return carrier_.gas != nullptr; }
  void pack_dissolved();
  int dissolved_slot() const;  // of the liquid's records that nothing else needs; -1: none
  float sum_of_dissolved(const CrossSearch::Found& found) const;
  float dissolve(std::size_t b, double radius, double slip, double dt);
  bool dissolves_whole(const oxygen::Contents& contents, double height) const;
  void sum_gas();
  void accept_gas();
  void fill_new_bubbles(double fraction);
  void add_gas_columns(SeriesTable& table) const;
  void entrain(double dt);
  double smoothed_dissipation(std::size_t i) const;
  void remark(const std::string& text);  // for the next note()
  // Without surface tension there is none, and no sizes about it.
  bool has_hinze_radius() const { return options_.hinze_radius > 0; }

  const Array<float>& gradient_component(int a, int b) const {
    return carrier_.velocity_gradient[static_cast<std::size_t>(a * 3 + b)];
  }
  // An image inside a box belongs to the face nearest to it: that of a particle may reach a bubble whose own does not
  // reach the particle. So may a wall point of a body.
  bool seen_beyond_reach() const { return carrier_.arrangement.images.inside_domain(); }
  bool has_surface() const { return carrier_.surface != nullptr; }
  double per_time(double change) const;
  double shift_speed() const;
  void add_snapshot_fields();

  const Carrier carrier_;
  const BubbleOptions options_;
  Gas gas_;
  SurfaceModel surface_;
  BreakupModel breakup_;
  EntrainmentModel entrainment_;
  double normal_at_surface_ = 0;             // |n0|
  std::vector<ChildSizeTable> child_sizes_;  // one with breakup, else none

  Array<double>* volume_fraction_ = nullptr;
  FloatVectorField exchange_{};
  Array<float> viscosity_;

  Population population_;
  Sources sources_;
  History history_, history_before_;  // now, and before the last step
  double last_step_ = 0;
  double max_speed_ = 0;
  double mean_slip_ = 0;
  double least_volume_fraction_ = 1;
  std::int64_t overfull_ = 0, most_overfull_ = 0;
  static constexpr std::int64_t noted_inner_bursts = 10;  // fewer are no news
  // What was last remarked on; the next time is when it has doubled.
  double most_bursts_ = 0;
  std::int64_t most_inner_bursts_ = noted_inner_bursts / 2, next_inner_bursts_ = 0;  // the latter of this step
  std::size_t most_alive_ = 500'000;  // the first remark comes at a million, as many as particles of a large case
  std::int64_t trace_due_ = 0;
  std::string note_;

  Images images_;
  std::array<Array<float>, 3> bubble_point_;  // bubbles and images, relative to the origin of the liquid
  Array<float> inverse_support_radius_;       // of particles and images
  Array<float> liquid_records_, bubble_records_;
  Array<float> interpolated_;  // per bubble the liquid at it and the kernel sum
  Array<double> dissipation_, next_merge_time_, next_slip_;
  std::array<Array<double>, 3> reaction_;  // M_b
  Array<float> dissolved_;                 // of particles and images, times the factor of their records
  Array<float> dissolution_;
  Array<double> dissolved_at_bubble_;  // over the sum of the weights
  struct GasState {
    oxygen::Contents contents;
    double given = 0, conductance = 0, capacity = 0;
  };
  std::vector<GasState> next_gas_;  // per bubble
  struct GasTotals {
    double given = 0, conductance = 0, capacity = 0, area = 0;
  };
  GasTotals gas_totals_, next_gas_totals_;  // of the last step, and of this one until it is accepted
  struct {
    double released = 0, given = 0, left = 0;  // g of oxygen since the start
    double dissolved = 0;                      // bubbles that dissolved whole
  } oxygen_;
  Array<std::uint8_t> dead_;
  Array<std::uint8_t> near_;            // particles with bubbles in their reach
  Array<std::int32_t> near_particles_;  // those whose normals are seen
  Array<std::uint8_t> beside_surface_;  // surface particles and their neighbours
  FloatVectorScratch surface_normal_;   // of these, else 0
  FloatVectorScratch smoothed_normal_;  // Shepard-filtered, of those that are seen
  // Beside walls of bodies; empty without. Per bubble: whether it is near one, its mirrored place, what it is divided
  // by.
  Array<std::uint8_t> wall_near_;
  std::array<Array<double>, 3> mirrored_place_;
  Array<float> received_weight_;
  // Per bubble that is.
  Array<std::int32_t> beside_walls_;
  std::array<Array<double>, 3> reflection_;
  Array<float> reflection_share_;
  std::array<Array<float>, 3> liquid_point_;  // of particles and images
  SnapshotTable snapshot_;
};

}  // namespace spume::bubbles
