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

#include <string>
#include <vector>

#include "spume/core/array_info.hpp"
#include "spume/core/saved_state.hpp"
#include "spume/io/record_table.hpp"
#include "spume/operators/cross_sums.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/moments.hpp"
#include "spume/particles/reports.hpp"
#include "spume/particles/step_limits.hpp"
#include "spume/particles/surface.hpp"
#include "spume/physics/bubbles/breakup.hpp"
#include "spume/physics/bubbles/entrainment.hpp"
#include "spume/physics/bubbles/forces.hpp"
#include "spume/physics/bubbles/population.hpp"
#include "spume/physics/bubbles/sources.hpp"
#include "spume/physics/bubbles/statistics.hpp"
#include "spume/physics/bubbles/surface_interaction.hpp"

namespace spume::bubbles {

// What bubbles see of the liquid that carries them, and the sizes of its particles, which they set. Everything lives as
// long as the coupling.
struct Carrier {
  const Scene& scene;
  Arrangement& arrangement;
  Boundary& boundary;
  ParticleStore& particles;
  const Resolution& resolution;
  ParticleSizes& sizes;
  const MomentFields& moments;
  FreeSurface* surface = nullptr;            // null: the liquid has none
  const VectorField& intermediate_position;  // r*
  const VectorScratch& velocity;             // that moves the liquid in this step
  const std::array<Array<float>, 9>& velocity_gradient;
  const FloatVectorScratch& filtered_velocity;
  bool filtered = false;                         // whether there is such
  const Array<float>* eddy_viscosity = nullptr;  // null: none
  const Array<float>& strain;                    // |S|
  const FloatVectorField* shift = nullptr;       // of the last step; null: none
  const double& time;                            // of the state
  const std::int64_t& steps;
  const Speeds& speeds;
};

class BubbleCoupling {
 public:
  // Adds the volume fraction and Du/Dt to the state of the particles.
  BubbleCoupling(const Carrier& carrier, const BubbleOptions& options);

  // The stages of a step, in its order. Without living bubbles each returns at once.
  void move(double dt);               // bubbles to r_b^{n+1}, sorted; sizes h_i of the particles
  void share_volume();                // alpha^{n+1}
  void exchange_momentum(double dt);  // velocities of the bubbles, forces on the liquid
  void accept(double dt);             // takes the step over; births and deaths

  // Clouds of the start, and the volume fraction that they make.
  void start();

  const Population& population() const { return population_; }
  Population& population() { return population_; }
  const History& history() const { return history_; }
  double max_speed() const { return max_speed_; }

  // What all bubbles gave to the liquid in the last exchange: sum of M_b, over the density of the liquid.
  Vec3 total_reaction() const;
  // Vorticity of the liquid at bubble b in the last exchange.
  Vec3 vorticity_at_bubble(std::size_t b) const;
  // h_i of the liquid around bubble b, the width of its filter, in units of h.
  double filter_width_at_bubble(std::size_t b) const;

  // State of the particles.
  VectorField material_acceleration{};       // Du/Dt of the last step
  Array<double>* volume_fraction = nullptr;  // alpha
  // Results, while bubbles live.
  FloatVectorField exchange{};  // acceleration of the liquid by the bubbles
  Array<float> viscosity;       // that bubbles induce
  bool mixture_pressure() const { return options_.momentum_form == MomentumForm::mixture_pressure; }

  void add_columns(SeriesTable& table) const;
  ParticleSnapshot snapshot();
  std::vector<RecordTable> tables() const;
  void table_rows(const std::string& name, std::vector<double>& rows);
  std::string note();  // of what happened since the last call; "" for nothing
  std::vector<ArrayInfo> arrays() const;
  void save(StateWriter& writer) const;
  void load(StateReader& reader);

 private:
  void measure_sizes();
  void place_bubbles();
  CrossSearch bubble_search() const;  // bubbles and their images
  CrossTargets particle_targets() const;
  void pack_liquid();
  void smooth_normals();
  void move_bubbles(double dt);
  void interpolate();
  void deposit();
  void remove_dead(double t);
  void break_up(double dt);
  void entrain(double dt);
  double smoothed_dissipation(std::size_t i) const;
  void remark(const std::string& text);  // for the next note()
  // Without surface tension there is none, and no sizes about it.
  bool has_hinze_radius() const { return options_.hinze_radius > 0; }

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

  Population population_;
  Sources sources_;
  History history_, history_before_;  // now, and before the last step
  double last_step_ = 0;
  double max_speed_ = 0;
  double mean_slip_ = 0;
  double least_volume_fraction_ = 1;
  std::int64_t overfull_ = 0, most_overfull_ = 0;
  // What was last remarked on; the next time is when it has doubled.
  double most_bursts_ = 0;
  std::size_t most_alive_ = 500'000;
  std::int64_t trace_due_ = 0;
  std::string note_;

  Images images_;
  std::array<Array<float>, 3> bubble_point_;  // bubbles and images, relative to the origin of the liquid
  Array<float> inverse_support_radius_;       // of particles and images
  Array<float> liquid_records_, bubble_records_;
  Array<float> interpolated_;  // per bubble the liquid at it and the kernel sum
  Array<double> dissipation_, next_merge_time_, next_slip_;
  std::array<Array<double>, 3> reaction_;  // M_b
  Array<std::uint8_t> dead_;
  Array<std::uint8_t> near_;            // particles with bubbles in their reach
  Array<std::int32_t> near_particles_;  // the same as a list
  SnapshotTable snapshot_;
};

}  // namespace spume::bubbles
