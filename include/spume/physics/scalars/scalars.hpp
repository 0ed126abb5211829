// SPDX-License-Identifier: MIT
// Scalars that particles carry: dc/dt = div((D + nu_t / Sc_t) grad c) along the motion of the liquid.
//
// The amount of a scalar is the sum of c V over the particles, V their volume of liquid. It changes by the rounding of
// doubles alone, where no liquid enters or leaves:
//   - Diffusion exchanges between pairs (operators/scalar_transport.hpp). What the float sums of a sweep leave of their
//     total is taken out of the rates in proportion to their size.
//   - A shift changes values by s . grad c. Where the gains exceed the losses the gains are scaled down to them, and
//   the
//     other way round: the factor is at most 1.
// A step changes no value beyond those of its neighbours: each part is bounded by half of the differences. Explicit
// diffusion is so up to dt sum_j w_ij = 1/2, beyond which the step is divided.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "spume/operators/scalar_transport.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/open_gates.hpp"
#include "spume/particles/reports.hpp"
#include "spume/particles/resolution.hpp"
#include "spume/physics/scalars/options.hpp"
#include "spume/physics/scalars/walls.hpp"
#include "spume/scene/method_declaration.hpp"

namespace spume {

class Scalars {
 public:
  // Adds a field of state, "scalar_<name>", per scalar. All that is given outlives it.
  Scalars(ParticleStore& particles, const Resolution& resolution, const Domain& domain, const ScalarOptions& options,
          const ScalarWalls& walls);

  // The values of `initial` where the particles are now.
  void set_initial();

  struct Carrier {
    Arrangement& arrangement;
    const float* divergence_of_position;
    std::array<const float*, 6> correction;             // L; read with a shift
    const Array<float>* eddy_viscosity = nullptr;       // null: none
    const VectorField& places;                          // of the particles
    const std::array<std::array<double, 2>, 3>& walls;  // sides at [axis][end]
    double time = 0;                                    // at the start of the step
    FloatVectorField shift{};                           // of the step; null: none
    const float* interior = nullptr;                    // factor of the change by the shift, 0 to 1; null: 1
  };
  // Whether some scalar diffuses in a liquid without eddies, or a wall gives some.
  bool diffuse() const;
  // Lets the first scalars, as many as may, ride on the viscous sweep of a step, where diffusion needs no parts of the
  // step `dt` and no wall has a value. What is found there replaces what transport() of this step would find, as no
  // value changes until then. A step that is refused in between is begun again with another sweep.
  struct Carriage {
    double viscosity = 0;                       // the same everywhere; particles are of one size
    std::span<const float> laplacian_diagonal;  // sum_j 2 g
    FloatVectorField shift{};                   // as of the carrier
    std::array<const float*, 6> correction{};
  };
  RidingScalars ride(double dt, const Carriage& carriage);
  double ridden_bytes() const;  // that it streams beside the records of that sweep
  // Diffusion over dt, what walls give and the change by the shift, at the positions of the lists. Returns the number
  // of sweeps, without that on which some rode.
  std::int64_t transport(double dt, const Carrier& carrier);

  // Sources over dt from time t on, at the places of the particles: what they add counts to added().
  void add_sources(double t, double dt);
  // What a source added to the amount by another way.
  void count_source(std::size_t scalar, double amount) { added_[scalar] += amount; }
  // Adds `change` to the values of a scalar; what its float sum differs from `amount` is taken out in proportion to the
  // size of the changes, so that the amount of the scalar changes by `amount`.
  void add(std::size_t scalar, const Array<float>& change, double amount);
  Array<double>& values(std::size_t scalar) { return *fields_[scalar]; }
  std::size_t particles() const { return particles_.size(); }
  double liquid_volume() const;

  // Gives particles of identifiers in [first, last) what inflows bring at time t.
  void enter(std::int64_t first, std::int64_t last, double t);
  // Of layers behind openings: particles with column[i] >= 0 keep their values and belong to no amount. The liquid
  // exchanges with them as with its own, which counts as given by the openings.
  void leave_out(const Array<std::int64_t>& column) { left_out_ = &column; }
  const Array<std::int64_t>* left_out() const { return left_out_; }
  bool counts(std::size_t i) const { return left_out_ == nullptr || (*left_out_)[i] < 0; }
  // Gives particles behind inflows what these bring when they pass: after depth / speed from time t on, but what
  // diffuses through the support faster than it flows, speed R < D, no later than it diffuses to the side,
  // depth^2 / (2 D), and what does not diffuse no later than `end`. Of what does not flow it is the present.
  void lead(const std::vector<Coming>& coming, double t, double end, double support_radius);
  // Gives particle i the values that no inflow gives of particle `like`.
  void follow(std::size_t i, std::size_t like);
  bool follows() const;  // whether there are such
  // With openings what they gave, less what they took, is counted: the amounts around an exchange with them.
  void expect_openings() { from_openings_.resize(size()); }
  std::vector<double> amounts() const;
  void count_openings(const std::vector<double>& before);

  std::size_t size() const { return fields_.size(); }
  const ScalarOption& option(std::size_t scalar) const { return options_.scalars[scalar]; }
  const Array<double>& values(std::size_t scalar) const { return *fields_[scalar]; }
  double amount(std::size_t scalar) const;
  // Parts into which diffusion divided the last step.
  std::int64_t substeps() const { return substeps_; }

  // Columns "amount_of_<name>", "source_of_<name>", "walls_gave_<name>" and "openings_gave_<name>" where there are
  // some, and "scalar_substeps".
  void add_columns(SeriesTable& series) const;
  void add_fields(SnapshotTable& snapshot) const;
  void save(StateWriter& writer) const;
  void load(StateReader& reader);

 private:
  // Of rates and changes by the shift.
  struct Sums {
    double net = 0, moved = 0;
    double gains = 0, losses = 0;
  };
  void find_packed(std::size_t first, std::size_t last);
  std::int64_t sweep(std::size_t first, const Carrier& carrier, bool shifted);
  void find_normalisation(const Carrier& carrier);
  double largest_exchange_of(const Carrier& carrier) const;
  bool wall_has_value() const;
  bool ride_pays(double dt, const Carriage& carriage) const;
  Sums sums_of(std::size_t scalar, const float* interior, bool shifted) const;
  void apply(double dt, const float* interior, bool shifted);
  double distance_from(const ScalarWall& wall, const Carrier& carrier, std::size_t i) const;
  double wall_rate(const ScalarWall& wall, const Carrier& carrier, std::size_t i) const;
  void find_wall_changes(double t, double dt, const Carrier& carrier);
  void apply_wall_changes();
  void lease(std::size_t scalars);
  void release();

  Vec3 place_of(std::size_t i) const;  // of a particle, inside along periodic axes

  ParticleStore& particles_;
  const Domain& domain_;
  const ScalarOptions& options_;
  const double bulk_;  // div r of the lattice
  std::vector<Array<double>*> fields_;
  std::vector<Array<float>> rate_, change_;  // leased from ride() or transport() to its end
  Array<float> exchange_, normalisation_;
  std::size_t ridden_ = 0;  // scalars that rode on the viscous sweep of the step
  bool ridden_shift_ = false;
  struct {  // of a sweep, per scalar: kept, as a step allocates nothing
    std::vector<const double*> values;
    std::vector<double> reference;
    std::vector<float> diffusivity, inverse_schmidt;
    std::vector<float*> rate, change;
  } packed_;
  std::int64_t substeps_ = 0;
  std::vector<double> added_;  // per scalar: by its source since the start
  const ScalarWalls& walls_;
  std::unique_ptr<const WallProfile> wall_profile_;  // null without walls
  std::vector<Array<double>> wall_change_;           // per wall, of a part of a step
  double nearest_to_wall_;
  std::vector<double> from_walls_;     // per scalar, since the start
  std::vector<double> from_openings_;  // the same; empty without openings
  const Array<std::int64_t>* left_out_ = nullptr;
};

// The output fields of scalars behind those of the method.
void add_scalar_fields(const ScalarOptions& options, std::vector<OutputFieldInfo>& infos);

}  // namespace spume
