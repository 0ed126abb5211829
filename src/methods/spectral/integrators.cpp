// SPDX-License-Identifier: MIT
// Time integration with the viscous term exact: Adams-Bashforth 2 (A10) for steps of any length, a midpoint step in
// place of its missing history, and Runge-Kutta schemes of two registers.
#include <algorithm>
#include <cmath>
#include <span>

#include "flow_evaluate.hpp"
#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"

namespace spume::spectral {
namespace {

// q <- a q + dt K(b), b <- b + b_weight q, at times t + c dt.
struct Stage2N {
  double a, b, c;
};
// Williamson (1980), third order.
constexpr Stage2N williamson[] = {{0, 1.0 / 3, 0}, {-5.0 / 9, 15.0 / 16, 1.0 / 3}, {-153.0 / 128, 8.0 / 15, 3.0 / 4}};
// Carpenter and Kennedy (1994), fourth order in five stages.
constexpr Stage2N carpenter_kennedy[] = {
    {0, 1432997174477.0 / 9575080441755.0, 0},
    {-567301805773.0 / 1357537059087.0, 5161836677717.0 / 13612068292357.0, 1432997174477.0 / 9575080441755.0},
    {-2404267990393.0 / 2016746695238.0, 1720146321549.0 / 2090206949498.0, 2526269341429.0 / 6820363962896.0},
    {-3550918686646.0 / 2091501179385.0, 3134564353537.0 / 4481467310338.0, 2006345519317.0 / 3224310063776.0},
    {-1275806237668.0 / 842570457699.0, 2277821191437.0 / 14882151754819.0, 2802321613138.0 / 2924317926251.0}};

// How much more than its limit a step may be when the speeds are known that it was chosen without.
constexpr double tolerated_excess = 1.5;

// Adds the modes of one vector.
template <class Tally, class V>
[[gnu::always_inline]] inline void add_to(Tally& tally, const V b[3], V k2, V weight) {
  const V square = k2 * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]) * weight, enstrophy = k2 * square;
  for (std::size_t l = 0; l < tally.square.size(); ++l) {
    tally.square[l] += static_cast<double>(square[l]);
    tally.enstrophy[l] += static_cast<double>(enstrophy[l]);
  }
}

}  // namespace

template <class T>
void Flow<T>::set_decay(Decay& decay, double dt) const {
  const auto factor = [&](std::size_t axis, std::size_t i) {
    const double k = layout_.wavenumber[axis][i];
    return static_cast<T>(std::exp(-viscosity_ * k * k * dt));
  };
  decay.x.resize(layout_.points[0]);
  decay.y.resize(layout_.points[1]);
  decay.z.resize(layout_.row);
  for (std::size_t i = 0; i < decay.x.size(); ++i) decay.x[i] = factor(0, i);
  for (std::size_t i = 0; i < decay.y.size(); ++i) decay.y[i] = factor(1, i);
  for (std::size_t i = 0; i < decay.z.size(); ++i) decay.z[i] = {factor(2, i), factor(2, i)};
}

template <class T>
void Flow<T>::advance(double dt) {
  if (options_.integrator != Integrator::ab2)
    runge_kutta(dt);
  else if (has_history_)
    adams_bashforth(dt);
  else
    self_start(dt);
  join_conjugates();
}

// Speeds are those of the step's start, the fresh energy that of its end.
template <class T>
void Flow<T>::require_acceptable(double dt, const EnergyBudget& fresh) const {
  const StepLimit limit = limit_for(peak_);
  if (!std::isfinite(peak_.rate) || !std::isfinite(fresh.energy) || !std::isfinite(fresh.dissipation))
    throw StepFailure({"the velocity is no longer finite", "time.courant", -1, {0, 0, 0}, peak_.speed});
  if (limit.limited_by != "max_step" && dt > tolerated_excess * limit.dt)
    throw StepFailure({"the flow has become too fast for the step (limit of " + limit.limited_by + ")",
                       "time.courant",
                       -1,
                       {0, 0, 0},
                       peak_.speed});
}

// Energy and dissipation that the last update found; the mean velocity is not among its wavenumbers.
template <class T>
EnergyBudget Flow<T>::tallied(const Modes<T>& potential) const {
  EnergyBudget budget;
  for (const Tally& tally : tallies_)
    for (std::size_t l = 0; l < tally.square.size(); ++l) {
      budget.energy += tally.square[l] / 2;
      budget.dissipation += viscosity_ * tally.enstrophy[l];
    }
  for (const auto& field : potential) budget.energy += std::norm(std::complex<double>(field[0])) / 2;
  return budget;
}

template <class T>
void Flow<T>::accept(double dt, const EnergyBudget& fresh) {
  const auto gain = [](const EnergyBudget& b) { return b.injection + b.work - b.dissipation; };
  integrated_gain_ += dt / 2 * (gain(budget_) + gain(fresh));
  integrated_dissipation_ += dt / 2 * (budget_.dissipation + fresh.dissipation);
  budget_ = fresh;
  time_ += dt;
  ++steps_;
}

// b^{n+1} = E b + dt (1 + r/2) E K_n - dt r/2 E E' K_{n-1}, r = dt / dt', E = exp(-nu k^2 dt), E' that of the step
// before: (A10) for steps of unequal length.
template <class T>
void Flow<T>::adams_bashforth(double dt) {
  using V = fourier::Vector<T>;
  using fourier::load;
  set_decay(decay_, dt);
  set_decay(earlier_decay_, earlier_dt_);
  const double ratio = dt / earlier_dt_;
  const T now = static_cast<T>(dt * (1 + ratio / 2)), before = static_cast<T>(-dt * ratio / 2);
  std::fill(tallies_.begin(), tallies_.end(), Tally{});
  has_history_ = false;  // what stands in earlier_ is overwritten, also when the step is refused
  has_previous_ = false;
  peak_ = evaluate(potential_, tendency_,
                   [&](std::size_t ix, std::size_t iy, std::size_t at, std::size_t iz, const V k2, const V k[3]) {
                     const V decay = decay_.x[ix] * decay_.y[iy] * load(decay_.z.data() + iz);
                     const V earlier = earlier_decay_.x[ix] * earlier_decay_.y[iy] * load(earlier_decay_.z.data() + iz);
                     V b[3];
                     for (std::size_t c = 0; c < 3; ++c) {
                       b[c] =
                           decay * (load(&potential_[c][at]) + now * k[c] + before * earlier * load(&earlier_[c][at]));
                       fourier::store<T>(&earlier_[c][at], b[c]);
                       fourier::store<T>(&tendency_[c][at], k[c]);
                     }
                     add_to(tallies_[iy], b, k2, load(lane_weight_.data() + iz));
                   });
  tendency_ready_ = true;
  const EnergyBudget fresh = tallied(earlier_);
  require_acceptable(dt, fresh);
  // earlier_ holds b^{n+1}, tendency_ K_n, potential_ b^n: each set moves one place on.
  potential_.swap(earlier_);
  earlier_.swap(tendency_);
  tendency_ready_ = false;
  has_history_ = has_previous_ = true;
  earlier_dt_ = dt;
  accept(dt, with_forces(fresh));
}

// Midpoint rule: b_h = E_h (b + dt/2 K_n), b^{n+1} = E b + dt E_h K(b_h) with E_h = exp(-nu k^2 dt/2). b_h is written
// over K_n and b^{n+1} over b_h, so that three sets suffice here too; K(b_h) stays as the history, half a step old.
template <class T>
void Flow<T>::self_start(double dt) {
  using V = fourier::Vector<T>;
  using fourier::load;
  evaluate_tendency();
  require_acceptable(dt, budget_);
  set_decay(decay_, dt / 2);
  const T half = static_cast<T>(dt / 2), whole = static_cast<T>(dt);
  tendency_ready_ = false;
  parallel_blocks(layout_.points[0] * layout_.points[1], 16, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t line = begin; line < end; ++line) {
      const std::size_t ix = line / layout_.points[1], iy = line % layout_.points[1];
      for (std::size_t iz = 0; iz < layout_.row; iz += fourier::vector_width<T>) {
        const std::size_t at = ix * layout_.plane + iy * layout_.row + iz;
        const V decay = decay_.x[ix] * decay_.y[iy] * load(decay_.z.data() + iz);
        for (std::size_t c = 0; c < 3; ++c)
          fourier::store<T>(&tendency_[c][at], decay * (load(&potential_[c][at]) + half * load(&tendency_[c][at])));
      }
    }
  });
  std::fill(tallies_.begin(), tallies_.end(), Tally{});
  evaluate(tendency_, earlier_,
           [&](std::size_t ix, std::size_t iy, std::size_t at, std::size_t iz, const V k2, const V k[3]) {
             const V decay = decay_.x[ix] * decay_.y[iy] * load(decay_.z.data() + iz);
             V b[3];
             for (std::size_t c = 0; c < 3; ++c) {
               b[c] = decay * (decay * load(&potential_[c][at]) + whole * k[c]);
               fourier::store<T>(&tendency_[c][at], b[c]);
               fourier::store<T>(&earlier_[c][at], k[c]);
             }
             add_to(tallies_[iy], b, k2, load(lane_weight_.data() + iz));
           });
  const EnergyBudget fresh = tallied(tendency_);
  require_acceptable(dt, fresh);
  potential_.swap(tendency_);
  has_history_ = has_previous_ = true;
  earlier_dt_ = dt / 2;
  accept(dt, with_forces(fresh));
}

template <class T>
void Flow<T>::runge_kutta(double dt) {
  using V = fourier::Vector<T>;
  using fourier::load;
  const bool third = options_.integrator == Integrator::rk3;
  const std::span<const Stage2N> scheme = third ? std::span<const Stage2N>(williamson) : carpenter_kennedy;
  has_previous_ = false;
  parallel_blocks(layout_.size(), 1 << 14, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t c = 0; c < 3; ++c) std::copy(&potential_[c][first], &potential_[c][0] + last, &start_[c][first]);
  });
  const auto restore = [&] { potential_.swap(start_); };
  EnergyBudget fresh;
  for (std::size_t s = 0; s < scheme.size(); ++s) {
    const double next = s + 1 < scheme.size() ? scheme[s + 1].c : 1;
    set_decay(decay_, (next - scheme[s].c) * dt);
    const T a = static_cast<T>(scheme[s].a), weight = static_cast<T>(scheme[s].b), step = static_cast<T>(dt);
    std::fill(tallies_.begin(), tallies_.end(), Tally{});
    const VelocityPeak peak =
        evaluate(potential_, tendency_,
                 [&](std::size_t ix, std::size_t iy, std::size_t at, std::size_t iz, const V k2, const V k[3]) {
                   const V decay = decay_.x[ix] * decay_.y[iy] * load(decay_.z.data() + iz);
                   V b[3];
                   for (std::size_t c = 0; c < 3; ++c) {
                     V q = step * k[c];
                     if (s > 0) q += a * load(&earlier_[c][at]);
                     b[c] = decay * (load(&potential_[c][at]) + weight * q);
                     fourier::store<T>(&earlier_[c][at], decay * q);
                     fourier::store<T>(&potential_[c][at], b[c]);
                   }
                   add_to(tallies_[iy], b, k2, load(lane_weight_.data() + iz));
                 });
    if (s == 0) peak_ = peak;
    fresh = tallied(potential_);
    try {
      require_acceptable(dt, fresh);
    } catch (const StepFailure&) {
      restore();
      throw;
    }
  }
  has_previous_ = true;
  accept(dt, with_forces(fresh));
}

// Forcing and work at the end of the step, with the force of particles that the step had: see Flow::budget.
template <class T>
EnergyBudget Flow<T>::with_forces(EnergyBudget fresh) const {
  if (force_[0] != nullptr) return measure_budget();
  if (forcing_.kind == ForcingKind::shell)
    fresh.injection = forcing_coefficient(potential_) > 0 ? forcing_.injection : 0;
  if (forcing_.kind == ForcingKind::linear) {
    double mean = 0;
    for (const auto& field : potential_) mean += std::norm(std::complex<double>(field[0])) / 2;
    fresh.injection = 2 * forcing_.rate * (fresh.energy - mean);
  }
  return fresh;
}

template void Flow<double>::advance(double);
template void Flow<float>::advance(double);

}  // namespace spume::spectral
