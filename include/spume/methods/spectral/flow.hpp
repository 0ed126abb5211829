// SPDX-License-Identifier: MIT
// The flow of the spectral method: vector potential b with u = curl b, in a triply periodic box (de Wit et al. 2024,
// appendix A):
//   db/dt = -nu k^2 b + K,   K = k^-2 i k x (F[u x omega] + f)                                        (A5, A7)
// The mode k = 0 of b holds the mean velocity itself, which only a force with a mean changes. The viscous term is
// integrated exactly by the factor exp(-nu k^2 t).
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "spume/fourier/box_transform.hpp"
#include "spume/fourier/cross_product.hpp"
#include "spume/methods/method.hpp"
#include "spume/methods/spectral/options.hpp"
#include "spume/scene/case.hpp"

namespace spume::spectral {

template <class T>
using Modes = std::array<Array<std::complex<T>>, 3>;

template <class T>
std::array<const std::complex<T>*, 3> view(const Modes<T>& modes) {
  return {modes[0].data(), modes[1].data(), modes[2].data()};
}

// Rates of the energy of the mean square velocity, per mass.
struct EnergyBudget {
  double energy = 0;       // mean of u^2 / 2
  double dissipation = 0;  // nu sum k^2 u_k^2
  double injection = 0;    // by [forcing]
  double work = 0;         // by the external force (particles)
};

template <class T>
class Flow {
 public:
  using Complex = std::complex<T>;

  // Arrays are made here; throws InputError when they cannot fit into the memory of the machine.
  explicit Flow(const LoadedCase& loaded);

  // The arrays of the state, set to zero, for the state that set_potential is to put in: no second set is in memory.
  // Until then the flow has no state.
  Modes<T> take_potential();

  // Replaces the state by a field with div b = 0 and forgets the history of the integrator.
  void set_potential(Modes<T>&& potential);

  // The start, of which the largest speeds are found, or a step, begins: the parts below follow, in this order. In
  // between the present state and its budget are those before the step.
  void begin_start();
  void begin_step(double dt);
  void keep_step_start();  // of Runge-Kutta schemes, whose stages overwrite b
  bool next_tendency();    // false when the scheme needs no more of them in this step
  // For each tendency, of the potential that the scheme takes it of:
  void set_forcing_coefficient();  // of a shell
  void set_integrating_factors();  // exp(c dt) - 1, c = -nu k^2; not called for an inviscid flow
  bool next_remainder();           // of the points of the product, see CrossProduct; false after the last
  bool last_remainder() const;
  void inverse_x();
  void form_product();
  void forward_x();        // for every remainder but the last,
  void update();           // which hands K to the scheme, mode by mode
  void accept_tendency();  // throws StepFailure, and the potential is what it was; after the last the step is made
  // Takes the first step back, once it is made; the force that was set stays.
  void take_back_first_step();
  // After the last tendency.
  void measure_balance();  // of the energy, over the step
  void join_conjugates();  // with a force in proportion to the velocity

  // A force f per mass on the modes, for the next steps, projected on its solenoidal part by K; null pointers: none.
  // The arrays stay the caller's and must live as long as they are set.
  void set_force(const std::array<const Complex*, 3>& force) { force_ = force; }

  const ModeLayout& layout() const { return layout_; }
  const Modes<T>& potential() const { return potential_; }
  // What else the parts of a step read and write: K, then K of the step before or the register of a Runge-Kutta scheme,
  // b at the start of a Runge-Kutta step, and the planes of the product.
  const Modes<T>& tendency() const { return tendency_; }
  const Modes<T>& earlier() const { return earlier_; }
  const Modes<T>& step_start() const { return start_; }
  const std::array<Array<Complex>, 5>& planes() const { return product_.planes(); }
  // Squares of the updated modes, summed row by row.
  const auto& tallies() const { return tallies_; }
  // Bytes of the integrating factors that a tendency takes, of the modes of b in a forced shell, and of those that
  // join_conjugates() passes over.
  double factor_bytes() const;
  double shell_bytes() const;
  double joined_bytes() const;
  double time() const { return time_; }
  std::int64_t steps() const { return steps_; }
  double viscosity() const { return viscosity_; }
  const VelocityPeak& peak() const { return peak_; }
  StepLimit step_limit() const;
  // Kinetic energy per mass of the wavenumbers that the force of a shell acts on; 0 without one.
  double forced_energy() const;

  // Transforms to and from the points of the grid, for use between steps.
  BoxTransform<T>& box() { return box_; }

  // Of the present state, but for `work`: the force of particles on it is known with the next step alone, so that the
  // work after a step is that of the force which the step had on the velocity at its end.
  const EnergyBudget& budget() const { return budget_; }
  // Integral of injection + work - dissipation, and of dissipation, over time since the start.
  double integrated_gain() const { return integrated_gain_; }
  double integrated_dissipation() const { return integrated_dissipation_; }

  // Sum over all modes of Re(conj(i k x b) . f) for the present state: the work of a force.
  EnergyBudget measure_budget() const;

  // Bernoulli's p + u^2/2 (up to a constant), whose Laplacian is div(u x omega + f), as modes. Costs one tendency. f is
  // the force last set: with particles that at the start of the last step.
  void total_pressure(Array<Complex>& modes);

  std::vector<ArrayInfo> arrays() const;
  void save(StateWriter& writer) const;
  void load(StateReader& reader);
  // Where the modes end, the least along the axes: pi / spacing, or two thirds of it; the last modes kept lie one
  // below.
  double largest_wavenumber() const;
  bool keeps(std::size_t ix, std::size_t iy, std::size_t iz) const;  // not cut by the two-thirds rule

 private:
  struct alignas(64) Tally {  // of a row of modes: u^2 and k^2 u^2, summed by place in a vector
    std::array<double, 32 / sizeof(T)> square{}, enstrophy{};
  };
  enum class Scheme { none, midpoint, adams_bashforth, runge_kutta };
  struct Step {
    Scheme scheme = Scheme::none;  // none: the start
    double dt = 0;
    int tendencies = 0, tendency = -1, remainder = -1;
    VelocityPeak peak = {};  // of the potential that the tendency is taken of
    EnergyBudget start = {};
    double start_time = 0, start_gain = 0, start_dissipation = 0;
  };
  const Modes<T>& argument() const;
  const Modes<T>& updated() const;
  std::array<Complex*, 3> partial_sums();
  template <class Update>
  void forward_x_with(Update&& update);
  void adams_bashforth();
  void predict_midpoint();
  void correct_from_midpoint();
  void runge_kutta();
  void require_acceptable(double dt, const EnergyBudget& fresh) const;
  EnergyBudget tallied(const Modes<T>& potential) const;
  EnergyBudget fresh_budget() const;
  bool joins(double k2) const { return forcing_.kind == ForcingKind::linear || k2 < shell_high_; }
  double forcing_coefficient(const Modes<T>& potential) const;
  StepLimit limit_for(const VelocityPeak& peak) const;
  // exp(-nu k_i^2 dt) - 1 per index of an axis; along z twice each, as vectors take it.
  struct Decay {
    std::vector<T> x, y;
    Array<Complex> z;
  };
  void set_decay(Decay& decay, double dt) const;

  ModeLayout layout_;
  SpectralOptions options_;
  ForcingOptions forcing_;
  TimeOptions limits_;
  double viscosity_;
  CrossProduct<T> product_;
  BoxTransform<T> box_;  // works in the memory of the product
  std::array<std::vector<T>, 3> wavenumber_;
  Array<Complex> lane_wavenumber_, lane_weight_;  // of a row of modes, in both parts
  std::array<double, 3> cut_{};                   // two-thirds rule: |k| below it stays
  double kept_grid_wavenumber_ = 0;               // largest wavenumber kept times spacing, of all axes
  double shell_low_ = 0, shell_high_ = 0;         // squares of the forced wavenumbers
  double forced_decay_ = 0;                       // nu k^2 of the largest wavenumber of a forced shell

  // Adams-Bashforth: b, K of the present and K of the previous step. The update writes b of the next step over the
  // old K, so that three sets suffice and a refused step leaves b as it was.
  // Runge-Kutta: b, K, the register q of the 2N-storage scheme, and b of the step's start.
  Modes<T> potential_, tendency_, earlier_, start_;
  std::array<const Complex*, 3> force_{};
  Step step_;
  double forcing_coefficient_ = 0;
  bool has_history_ = false;  // earlier_ holds K of the previous step
  double earlier_dt_ = 0;
  double time_ = 0;
  std::int64_t steps_ = 0;
  VelocityPeak peak_;
  EnergyBudget budget_;
  double integrated_gain_ = 0, integrated_dissipation_ = 0;
  Array<Tally> tallies_;
  Decay decay_, earlier_decay_;
};

// Memory of the modes of one component on a grid, in bytes.
double mode_bytes(const std::array<std::size_t, 3>& grid, FieldPrecision precision);

// Memory that a flow on a grid takes at most, in bytes, before anything is allocated.
double flow_bytes(const std::array<std::size_t, 3>& grid, const SpectralOptions& options);

}  // namespace spume::spectral
