// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/spectral.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/methods/spectral/initial_state.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::spectral {

template <class T>
Spectral<T>::Spectral(const LoadedCase& loaded) : loaded_(loaded), flow_(loaded) {
  if (loaded.options.get<ParticleCaseOptions>().any()) suspension_ = std::make_unique<Suspension<T>>(loaded, flow_);
  plan_ = make_plan();
  const ParticleCaseOptions& particles = loaded.options.get<ParticleCaseOptions>();
  if (suspension_ && suspension_->system().couples() && particles.remove_self_disturbance &&
      !suspension_->system().removes_self_disturbance()) {
    Remark& remark = remarks_.emplace_back();
    remark.text =
        "particles.remove_self_disturbance has no effect: the particles are too large for the spacing (1.2 of it), "
        "their response time is too short for their diameter, or the fluid has no viscosity; they see the velocity "
        "that their own force makes";
  }
}

template <class T>
void Spectral<T>::set_initial_state() {
  flow_.set_potential(initial_potential(loaded_, flow_));
  // The force is proportional to the velocity of its shell: from rounding alone it would raise rounding.
  // Of the energy: a hundred roundings of the velocity.
  const double noise = 1e4 * std::pow(std::numeric_limits<T>::epsilon(), 2);
  if (loaded_.options.get<ForcingOptions>().kind == ForcingKind::shell &&
      !(flow_.forced_energy() > noise * flow_.measure_budget().energy))
    throw refusal(loaded_.options, "forcing",
                  "the forced shell holds no energy at the start, so that no force could inject any; choose "
                  "[initial] or [forcing] so that the wavenumbers meet (they count in 2 pi / longest length)");
}

template <class T>
void Spectral<T>::start() {
  Ledger untimed;
  flow_.begin_start();
  plan_.run_start(static_cast<double>(particle_count()), untimed);
  if (suspension_) suspension_->require_possible(flow_.step_limit());
  started_ = true;
}

template <class T>
void Spectral<T>::step(double dt, Ledger& ledger) {
  ensure_started();
  const auto run_step = [&](Ledger& timed) {
    flow_.begin_step(dt);
    plan_.run_step(dt, static_cast<double>(particle_count()), timed);
  };
  // The force of the first step is known once it is made; without it the coupled motion would be of first order in dt.
  if (suspension_ && suspension_->lacks_force()) {
    const auto start = suspension_->copy_state();
    Ledger untimed;
    run_step(untimed);
    flow_.take_back_first_step();
    suspension_->take_back_first_step(start);
  }
  run_step(ledger);
}

template <class T>
void Spectral<T>::ensure_started() {
  if (!started_) start();
}

template <class T>
std::size_t Spectral<T>::particle_count() const {
  const auto& points = flow_.layout().points;
  return points[0] * points[1] * points[2];
}

template <class T>
StepLimit Spectral<T>::step_limit() const {
  return suspension_ ? suspension_->limited(flow_.step_limit()) : flow_.step_limit();
}

template <class T>
std::vector<ArrayInfo> Spectral<T>::arrays() const {
  std::vector<ArrayInfo> list = flow_.arrays();
  double drawn = static_cast<double>(total_pressure_.capacity() * sizeof(std::complex<T>));
  for (const auto& [name, components] : drawn_)
    for (const auto& field : components) drawn += static_cast<double>(field.capacity() * sizeof(float));
  if (suspension_) suspension_->add_arrays(list);
  if (drawn > 0) list.push_back({"snapshots and probes", drawn});
  return list;
}

template <class T>
std::vector<Invariant> Spectral<T>::invariants() const {
  std::vector<Invariant> list = suspension_ ? suspension_->invariants() : std::vector<Invariant>{};
  const Case& options = loaded_.options;
  const Coupling coupling = options.get<ParticleCaseOptions>().coupling;
  if (suspension_ && acts_on_flow(coupling)) return list;
  if (options.get<ForcingOptions>().kind == ForcingKind::none && !loaded_.scene.body_force)
    // The energy of an unforced flow falls: taylor_green_1600 grows by 0.
    list.push_back({.quantity = "energy_growth",
                    .kind = Invariant::Kind::growth,
                    .column = "mean_energy",
                    .bound = 0.01,
                    .scale_column = "mean_energy"});
  else
    list.push_back({.quantity = "energy_balance", .column = "balance_residual", .bound = 0.02});
  return list;
}

template <class T>
void Spectral<T>::save(StateWriter& writer) const {
  flow_.save(writer);
  writer.f64("balance", row_);
  if (suspension_) suspension_->save(writer);
}

template <class T>
void Spectral<T>::load(StateReader& reader) {
  flow_.load(reader);
  Array<double> row;
  reader.f64("balance", row);
  if (row.size() != row_.size()) throw FileError("the checkpoint was written by another version of the method");
  std::copy(row.begin(), row.end(), row_.begin());
  if (suspension_) suspension_->load(reader);
  started_ = true;
  total_pressure_step_ = -1;
}

template class Spectral<double>;
template class Spectral<float>;

}  // namespace spume::spectral
