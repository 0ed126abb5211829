// SPDX-License-Identifier: MIT
// The step of de Wit et al. (2024), with the numbers of its equations: the force of the particles from the step before
// (II A), the flow (appendix A), the particles over the same step (III). Stages marked `both` make the start as well.
#include "reasons.hpp"
#include "spume/methods/spectral/spectral.hpp"

namespace spume::spectral {

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
  flow_.begin_step(dt);
  plan_.run_step(dt, static_cast<double>(particle_count()), ledger);
}

template <class T>
Plan Spectral<T>::make_plan() {
  using Arrays = std::vector<ArrayUse>;
  const auto both = StagePart::both;
  const Case& options = loaded_.options;
  const bool ab2 = options.spectral.integrator == Integrator::ab2, forced = options.forcing.kind != ForcingKind::none;
  const bool viscous = flow_.viscosity() > 0;
  const Modes<T>&b = flow_.potential(), &K = flow_.tendency(), &earlier = flow_.earlier();  // as in (A10)
  const auto& planes = flow_.planes();
  const Arrays product = {planes[0], planes[1], planes[2]};
  Suspension<T>* const p = suspension_.get();
  const Modes<T>* const force = p ? &p->force() : nullptr;

  Plan plan;
  const auto add = [&](std::string name, std::string reason, bool on, std::function<void(StageRun&)> work,
                       Arrays reads = {}, Arrays writes = {}, StagePart part = StagePart::step,
                       std::function<bool()> due = {}) {
    plan.add({std::move(name), std::move(reason), on, std::move(work), std::move(reads), std::move(writes), part, due});
  };
  const auto per_particle = [p](auto work) {  // the other stages handle points of the grid
    return [p, work](StageRun& run) {
      run.particles = static_cast<double>(p->system().size());
      work(run);
    };
  };

  add(
      "initial state", "[initial]", true, [this](auto&) { set_initial_state(); }, {}, {b}, StagePart::start);
  if (p) {  // f_p, from where and how the particles moved in the step before
    const bool couples = p->system().couples();
    const std::string why = reason::feedback(p->system());
    add("particle feedback", why, couples, per_particle([p](auto&) { p->spread_force(); }),
        {p->system().particles().position, p->system().amounts()}, {p->field()});
    add("force to modes", couples ? "(A5): f_p" : why, couples, [p](auto&) { p->force_to_modes(); }, {p->field()},
        {force});
  }
  add("copy of the state", ab2 ? "spectral.integrator = \"ab2\"" : "for a step that is refused", !ab2,
      [this](auto&) { flow_.keep_step_start(); }, {b}, {flow_.step_start()});
  plan.repeat([this] { return flow_.next_tendency(); },
              [&] {
                add("forcing", reason::forcing(options), forced, [this](auto&) { flow_.set_forcing_coefficient(); });
                add("viscosity", viscous ? "(A8): exact, by an integrating factor" : "inviscid", viscous,
                    [this](auto&) { flow_.set_integrating_factors(); });
                plan.repeat([this] { return flow_.next_remainder(); },
                            [&] {
                              add(
                                  "inverse transforms in x", "(A6): u = curl b and two gradients, in planes of x", true,
                                  [this](auto&) { flow_.inverse_x(); }, {b}, {planes}, both);
                              add(
                                  "product in planes", reason::product(options), true,
                                  [this](auto&) { flow_.form_product(); }, {planes}, product, both);
                              add(
                                  "forward transforms in x", "(A5): F[u x omega], partial sums", true,
                                  [this](auto&) { flow_.forward_x(); }, {planes[0], planes[1], planes[2], K}, {K},
                                  StagePart::step, [this] { return !flow_.last_remainder(); });
                              add(
                                  "forward transforms in x, update", reason::update(options), true,
                                  [this](auto&) { flow_.update(); },
                                  {planes[0], planes[1], planes[2], b, K, earlier, force}, {earlier, ab2 ? K : b},
                                  StagePart::step, [this] { return flow_.last_remainder(); });
                            });
                add("acceptance", "step limit and finite values", true, [this](auto&) { flow_.accept_tendency(); });
              });
  add("energy balance", "injection and work of the forces", true, [this](auto&) { flow_.measure_balance(); },
      {p && p->system().couples() ? &b : nullptr, force});
  add("conjugate modes", forced ? "their rounding would be forced" : "forcing.kind = \"none\"", forced,
      [this](auto&) { flow_.join_conjugates(); });
  if (!p) return plan;

  ParticleSystem& system = p->system();
  const Particles& particles = system.particles();
  const ArrayUse state([&particles] { return particles.fields.bytes(); });
  const ArrayUse records([&system] { return system.record_bytes(); });
  add(
      "velocity at points", "divided by the prefilter of the splines", true, [p](auto&) { p->velocity_to_points(); },
      {b}, {p->field()}, both);
  add("particle sort", "every " + std::to_string(system.options().sort_every) + " steps", true,
      per_particle([&system](auto&) { system.sort(); }), {state}, {state}, both,
      [&system] { return system.sort_due(); });
  add("particle records", "velocities of two times side by side, for (15)", true,
      per_particle([p](auto&) { p->fill_records(); }), {p->field()}, {records}, both);
  add("particle start", "velocity of the fluid", true, per_particle([p](auto&) { p->start_particles(); }), {records},
      {particles.velocity}, StagePart::start);
  add("particle motion", reason::motion(system), true, per_particle([&system](StageRun& run) { system.move(run.dt); }),
      {particles.position, particles.velocity, particles.force, records},
      {particles.position, particles.velocity, particles.force, system.amounts()});
  add("particle exclusion", reason::exclusion(system), system.collides(),
      per_particle([&system](auto&) { system.collide(); }), {particles.position, particles.identifier},
      {particles.position});
  const bool follows = p->follows_exponents();
  add("Lyapunov exponents", follows ? "shadow trajectories" : "particles.lyapunov = 0", follows,
      [p](StageRun& run) { p->follow_exponents(run); }, {records});
  return plan;
}

template void Spectral<double>::start();
template void Spectral<float>::start();
template void Spectral<double>::step(double, Ledger&);
template void Spectral<float>::step(double, Ledger&);
template Plan Spectral<double>::make_plan();
template Plan Spectral<float>::make_plan();

}  // namespace spume::spectral
