// SPDX-License-Identifier: MIT
// The step of de Wit et al. (2024), with the numbers of its equations: the force of the particles from the step before
// (II A), the flow (appendix A), the particles over the same step (III). Stages marked `both` make the start as well.
#include "reasons.hpp"
#include "spume/methods/spectral/spectral.hpp"

namespace spume::spectral {
template <class T>
Plan Spectral<T>::make_plan() {
  Plan plan;
  using Work = std::function<void(StageRun&)>;
  using Condition = std::function<bool()>;
  const auto both = StagePart::both;
  const auto add = [&plan](std::string name, std::string reason, bool on, Work work, Arrays reads = {},
                           Arrays writes = {}, StagePart part = StagePart::step, Condition due = {}) {
    plan.add({std::move(name), std::move(reason), on, std::move(work), std::move(reads), std::move(writes), part,
              std::move(due)});
  };
  const auto run = [](auto& owner, auto verb) -> Work {
    return [&owner, verb](StageRun& stage) {
      if constexpr (requires { (owner.*verb)(stage); })
        (owner.*verb)(stage);
      else
        (owner.*verb)();
    };
  };
  const auto flow = [this, run](void (Flow<T>::*verb)()) { return run(flow_, verb); };
  const Case& options = loaded_.options;
  const bool ab2 = options.get<SpectralOptions>().integrator == Integrator::ab2;
  const ForcingKind forcing = options.get<ForcingOptions>().kind;
  const bool forced = forcing != ForcingKind::none, in_shell = forcing == ForcingKind::shell;
  const bool viscous = flow_.viscosity() > 0;
  const Modes<T>&b = flow_.potential(), &K = flow_.tendency(), &earlier = flow_.earlier();  // as in (A10)
  const auto& planes = flow_.planes();
  const auto& sums = flow_.tallies();
  const ArrayUse factors([this] { return flow_.factor_bytes(); });
  const ArrayUse shell([bytes = in_shell ? flow_.shell_bytes() : 0] { return bytes; });
  const ArrayUse joined([bytes = flow_.joined_bytes()] { return bytes; });
  Suspension<T>* const p = suspension_.get();
  const auto per_particle = [p](const Work& work) -> Work {  // the other stages handle points of the grid
    return [p, work](StageRun& stage) {
      stage.particles = static_cast<double>(p->system().size());
      work(stage);
    };
  };
  const bool couples = p && p->system().couples();
  const Modes<T>* const force = couples ? &p->force() : nullptr;

  add("initial state", "[initial]", true, run(*this, &Spectral<T>::set_initial_state), {}, {b}, StagePart::start);
  if (p) {  // f_p, from where and how the particles moved in the step before
    const std::string why = reason::feedback(p->system());
    add("particle feedback", why, couples, per_particle(run(*p, &Suspension<T>::spread_force)),
        {p->system().particles().position, p->system().amounts()}, {p->field()});
    add("force to modes", couples ? "(A5): f_p" : why, couples, run(*p, &Suspension<T>::force_to_modes), {p->field()},
        {force});
  }
  add("copy of the state", ab2 ? "spectral.integrator = \"ab2\"" : "for a step that is refused", !ab2,
      flow(&Flow<T>::keep_step_start), {b}, {flow_.step_start()});
  const Condition tendencies = [this] { return flow_.next_tendency(); };
  const Condition remainders = [this] { return flow_.next_remainder(); };
  const Condition last = [this] { return flow_.last_remainder(); }, not_last = [last] { return !last(); };
  plan.repeat(tendencies, [&] {
    add("forcing coefficient", reason::forcing(options), in_shell, flow(&Flow<T>::set_forcing_coefficient), {shell});
    add("viscosity", viscous ? "(A8): exact, by an integrating factor" : "inviscid", viscous,
        flow(&Flow<T>::set_integrating_factors), {}, {factors});
    plan.repeat(remainders, [&] {
      add("inverse transforms in x", "(A6): u = curl b and two gradients, in planes of x", true,
          flow(&Flow<T>::inverse_x), {b}, {planes}, both);
      add("product in planes", reason::product(options), true, flow(&Flow<T>::form_product), {planes},
          {planes[0], planes[1], planes[2]}, both);
      add("forward transforms in x", "(A5): F[u x omega], partial sums", true, flow(&Flow<T>::forward_x),
          {planes[0], planes[1], planes[2], K}, {K}, StagePart::step, not_last);
      add("forward transforms in x, update", reason::update(options), true, flow(&Flow<T>::update),
          {planes[0], planes[1], planes[2], b, K, earlier, force, factors}, {earlier, ab2 ? K : b, sums},
          StagePart::step, last);
    });
    add("acceptance", "step limit and finite values", true, flow(&Flow<T>::accept_tendency), {sums});
  });
  add("energy balance", "injection and work of the forces", true, flow(&Flow<T>::measure_balance),
      couples ? Arrays{b, force} : Arrays{sums, shell});
  add("conjugate modes", forced ? "their rounding would be forced" : "forcing.kind = \"none\"", forced,
      flow(&Flow<T>::join_conjugates), {joined}, {joined});
  if (!p) return plan;

  ParticleSystem& system = p->system();
  const Particles& particles = system.particles();
  const ArrayUse state([&particles] { return particles.fields.bytes(); });
  const ArrayUse records([&system] { return system.record_bytes(); });
  add("particle separation", "random places overlap", system.collides(),
      per_particle(run(*p, &Suspension<T>::separate_particles)), {particles.position, particles.identifier},
      {particles.position}, StagePart::start);
  const Condition sort_due = [&system] { return system.sort_due(); };
  add("velocity at points", "divided by the prefilter of the splines", true,
      run(*p, &Suspension<T>::velocity_to_points), {b}, {p->field()}, both);
  add("particle sort", "every " + std::to_string(system.options().sort_every) + " steps", true,
      per_particle(run(system, &ParticleSystem::sort)), {state}, {state}, both, sort_due);
  add("particle records", "velocities of two times side by side, for (15)", true,
      per_particle(run(*p, &Suspension<T>::fill_records)), {p->field()}, {records}, both);
  add("particle start", "velocity of the fluid", true, per_particle(run(*p, &Suspension<T>::start_particles)),
      {records}, {particles.velocity}, StagePart::start);
  add("particle motion", reason::motion(system), true,
      per_particle([&system](StageRun& stage) { system.move(stage.dt); }),
      {particles.position, particles.velocity, particles.force, records},
      {particles.position, particles.velocity, particles.force, system.amounts()});
  add("particle exclusion", reason::exclusion(system), system.collides(),
      per_particle(run(system, &ParticleSystem::collide)), {particles.position, particles.identifier},
      {particles.position});
  add("Lyapunov exponents", reason::exponents(options), p->follows_exponents(),
      run(*p, &Suspension<T>::follow_exponents), {records});
  return plan;
}

template Plan Spectral<double>::make_plan();
template Plan Spectral<float>::make_plan();

}  // namespace spume::spectral
