// SPDX-License-Identifier: MIT
// One evaluation of the tendency K, from transforms to acceptance. K is handed to the scheme mode by mode while it is
// in registers, with the last transform along x: a pass of its own over K would cost as much as the transform.
#include <algorithm>
#include <cmath>
#include <span>

#include "fair_rounding.hpp"
#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/fourier/lane_vector.hpp"
#include "spume/methods/spectral/flow.hpp"

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

std::span<const Stage2N> runge_kutta_stages(Integrator integrator) {
  if (integrator == Integrator::rk3) return williamson;
  return carpenter_kennedy;
}

// E - 1 of a mode from those along the axes. States become b + ((E - 1) b + ...), rounded once: the rounding of an E
// near 1 to single precision would be the same in every step (2e-4 of the energy in 1,500 steps).
template <class V, class T>
[[gnu::always_inline]] inline V decayed(T x, T y, V z) {
  const T across = x + y + x * y;
  return across + z + across * z;
}

// How much more than its limit a step may be when the speeds are known that it was chosen without. Of eight flows on
// 24^3 and 32^3 points, decaying and forced, with all integrators, the worst step was 1.034 times its limit: where half
// as much again is needed, speeds jump and the step does not follow them.
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
void Flow<T>::begin_start() {
  step_ = {.tendencies = 1};
}

template <class T>
void Flow<T>::begin_step(double dt) {
  step_ = {.dt = dt,
           .tendencies = 1,
           .start = budget_,
           .start_time = time_,
           .start_gain = integrated_gain_,
           .start_dissipation = integrated_dissipation_};
  if (options_.integrator != Integrator::ab2) {
    step_.scheme = Scheme::runge_kutta;
    step_.tendencies = static_cast<int>(runge_kutta_stages(options_.integrator).size());
  } else if (has_history_) {
    step_.scheme = Scheme::adams_bashforth;
  } else {
    step_.scheme = Scheme::midpoint;
    step_.tendencies = 2;
  }
  has_history_ = false;  // it is overwritten, also when the step is refused
}

template <class T>
bool Flow<T>::next_tendency() {
  step_.remainder = -1;
  step_.peak = {};
  return ++step_.tendency < step_.tendencies;
}

template <class T>
bool Flow<T>::next_remainder() {
  return ++step_.remainder < static_cast<int>(product_.remainders());
}

template <class T>
bool Flow<T>::last_remainder() const {
  return step_.remainder + 1 == static_cast<int>(product_.remainders());
}

template <class T>
void Flow<T>::keep_step_start() {
  parallel_blocks(layout_.size(), 1 << 14, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t c = 0; c < 3; ++c) std::copy(&potential_[c][first], &potential_[c][0] + last, &start_[c][first]);
  });
}

template <class T>
void Flow<T>::set_decay(Decay& decay, double dt) const {
  const auto factor = [&](std::size_t axis, std::size_t i) {
    const double k = layout_.wavenumber[axis][i];
    return static_cast<T>(std::expm1(-viscosity_ * k * k * dt));
  };
  decay.x.resize(layout_.points[0]);
  decay.y.resize(layout_.points[1]);
  decay.z.resize(layout_.row);
  for (std::size_t i = 0; i < decay.x.size(); ++i) decay.x[i] = factor(0, i);
  for (std::size_t i = 0; i < decay.y.size(); ++i) decay.y[i] = factor(1, i);
  for (std::size_t i = 0; i < decay.z.size(); ++i) decay.z[i] = {factor(2, i), factor(2, i)};
}

template <class T>
double Flow<T>::factor_bytes() const {
  const double axes = static_cast<double>(sizeof(T) * (decay_.x.size() + decay_.y.size()));
  const double one = axes + static_cast<double>(sizeof(Complex) * decay_.z.size());
  return step_.scheme == Scheme::adams_bashforth ? 2 * one : one;
}

template <class T>
void Flow<T>::set_integrating_factors() {
  switch (step_.scheme) {
    case Scheme::none:
      break;
    case Scheme::midpoint:
      set_decay(decay_, step_.dt / 2);
      break;
    case Scheme::adams_bashforth:
      set_decay(decay_, step_.dt);
      set_decay(earlier_decay_, earlier_dt_);
      break;
    case Scheme::runge_kutta: {
      const auto stages = runge_kutta_stages(options_.integrator);
      const auto s = static_cast<std::size_t>(step_.tendency);
      set_decay(decay_, ((s + 1 < stages.size() ? stages[s + 1].c : 1) - stages[s].c) * step_.dt);
      break;
    }
  }
}

// The potential that K is taken of: the predicted one in the second half of a midpoint step.
template <class T>
const Modes<T>& Flow<T>::argument() const {
  return step_.scheme == Scheme::midpoint && step_.tendency == 1 ? tendency_ : potential_;
}

// Where partial sums of its transforms go.
template <class T>
std::array<std::complex<T>*, 3> Flow<T>::partial_sums() {
  Modes<T>& sum = &argument() == &tendency_ ? earlier_ : tendency_;
  return {sum[0].data(), sum[1].data(), sum[2].data()};
}

template <class T>
void Flow<T>::inverse_x() {
  product_.inverse_x(static_cast<std::size_t>(step_.remainder), view<T>(argument()));
}

template <class T>
void Flow<T>::form_product() {
  product_.form_planes(step_.peak);
  if (step_.tendency == 0 && last_remainder()) peak_ = step_.peak;
}

template <class T>
void Flow<T>::forward_x() {
  product_.forward_x(static_cast<std::size_t>(step_.remainder), partial_sums(), {});
}

// Calls update(ix, iy, at, iz, k2, K) for every vector of modes: `at` is its place in the arrays, iz its first index
// along z, k2 and K[3] vectors. The update may write its own modes anywhere.
template <class T>
template <class Update>
void Flow<T>::forward_x_with(Update&& update) {
  using V = fourier::Vector<T>;
  using fourier::load;
  using fourier::times_i;
  const Modes<T>& potential = argument();
  const T coefficient = static_cast<T>(forcing_coefficient_);
  const bool shell = forcing_.kind == ForcingKind::shell, linear = forcing_.kind == ForcingKind::linear;
  const bool cut = options_.dealiasing == Dealiasing::two_thirds;
  const bool force = force_[0] != nullptr;
  // Compared in double: in single precision rounding must not move a mode across the edge of the shell.
  const auto finish = [&](std::size_t ix, std::size_t iy, std::size_t first, const Complex* const product[3]) {
    const T kx = wavenumber_[0][ix], ky = wavenumber_[1][iy];
    const bool inside = std::abs(layout_.wavenumber[0][ix]) < cut_[0] && std::abs(layout_.wavenumber[1][iy]) < cut_[1];
    const double plane2 =
        layout_.wavenumber[0][ix] * layout_.wavenumber[0][ix] + layout_.wavenumber[1][iy] * layout_.wavenumber[1][iy];
    const bool near_shell = shell && plane2 < shell_high_;
    // The next block of what the update reads: its lines lie planes apart.
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t next = ix * layout_.plane + iy * layout_.row + first + lanes<T>;
      fourier::prefetch_block(potential_[c].data() + next);
      fourier::prefetch_block(earlier_[c].data() + next);
    }
    for (std::size_t q = 0; q < lanes<T>; q += fourier::vector_width<T>) {
      const std::size_t iz = first + q, at = ix * layout_.plane + iy * layout_.row + iz;
      const V kz = load(lane_wavenumber_.data() + iz);
      const V k2 = kx * kx + ky * ky + kz * kz;
      const V none{};
      const V inverse = k2 > none ? T(1) / k2 : none;
      V n[3];
      for (std::size_t c = 0; c < 3; ++c) n[c] = load(product[c] + q);
      if (force)
        for (std::size_t c = 0; c < 3; ++c) n[c] += load(force_[c] + at);
      V k[3] = {times_i<T>((ky * n[2] - kz * n[1]) * inverse), times_i<T>((kz * n[0] - kx * n[2]) * inverse),
                times_i<T>((kx * n[1] - ky * n[0]) * inverse)};
      if (cut) {
        const V keep = inside ? (kz < static_cast<T>(cut_[2]) ? none + T(1) : none) : none;
        for (auto& value : k) value *= keep;
      }
      // Of what forces are in proportion to, the part along k drives no velocity: forced, its rounding would grow
      // unseen.
      const auto add_force = [&](const V factor) {
        const V b[3] = {load(&potential[0][at]), load(&potential[1][at]), load(&potential[2][at])};
        const V along = (kx * b[0] + ky * b[1] + kz * b[2]) * inverse;
        k[0] += factor * (b[0] - kx * along);
        k[1] += factor * (b[1] - ky * along);
        k[2] += factor * (b[2] - kz * along);
      };
      if (linear) {
        add_force(k2 > none ? none + coefficient : none);
      } else if (near_shell) {
        V factor{};
        for (std::size_t l = 0; l < fourier::vector_width<T>; ++l) {
          const double square = plane2 + layout_.wavenumber[2][iz + l] * layout_.wavenumber[2][iz + l];
          if (square >= shell_low_ && square < shell_high_ && square > 0)
            factor[2 * l] = factor[2 * l + 1] = coefficient;
        }
        add_force(factor);
      }
      // The mean velocity takes the mean of the force as it is.
      if (force && at == 0)
        for (std::size_t c = 0; c < 3; ++c) k[c][0] = force_[c][0].real(), k[c][1] = 0;
      update(ix, iy, at, iz, k2, k);
    }
  };
  product_.forward_x(static_cast<std::size_t>(step_.remainder), partial_sums(), finish);
}

template <class T>
void Flow<T>::update() {
  std::fill(tallies_.begin(), tallies_.end(), Tally{});
  switch (step_.scheme) {
    case Scheme::none:
      break;
    case Scheme::midpoint:
      step_.tendency == 0 ? predict_midpoint() : correct_from_midpoint();
      break;
    case Scheme::adams_bashforth:
      adams_bashforth();
      break;
    case Scheme::runge_kutta:
      runge_kutta();
      break;
  }
}

// b^{n+1} = E b + dt (1 + r/2) E K_n - dt r/2 E E' K_{n-1}, r = dt / dt', E = exp(-nu k^2 dt), E' that of the step
// before: (A10) for steps of unequal length. b^{n+1} is written over K_{n-1}, so that three sets suffice and a refused
// step leaves b as it was.
template <class T>
void Flow<T>::adams_bashforth() {
  using V = fourier::Vector<T>;
  using fourier::load;
  const double dt = step_.dt, ratio = dt / earlier_dt_;
  const T now = static_cast<T>(dt * (1 + ratio / 2)), before = static_cast<T>(-dt * ratio / 2);
  const FairRounding<T> rounded(steps_, 0);
  forward_x_with([&](std::size_t ix, std::size_t iy, std::size_t at, std::size_t iz, const V k2, const V k[3]) {
    const V lost = decayed(decay_.x[ix], decay_.y[iy], load(decay_.z.data() + iz)), decay = T(1) + lost;
    const V earlier =
        before * (T(1) + decayed(earlier_decay_.x[ix], earlier_decay_.y[iy], load(earlier_decay_.z.data() + iz)));
    V b[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const V old = load(&potential_[c][at]);
      b[c] = rounded.sum(old, lost * old + decay * (now * k[c] + earlier * load(&earlier_[c][at])), at, c);
      fourier::store<T>(&earlier_[c][at], b[c]);
      fourier::store<T>(&tendency_[c][at], k[c]);
    }
    add_to(tallies_[iy], b, k2, load(lane_weight_.data() + iz));
  });
}

// The first step has no K_{n-1} and is one of the midpoint rule: b_h = E_h (b + dt/2 K_n), E_h = exp(-nu k^2 dt/2) ...
template <class T>
void Flow<T>::predict_midpoint() {
  using V = fourier::Vector<T>;
  using fourier::load;
  const T half = static_cast<T>(step_.dt / 2);
  forward_x_with([&](std::size_t ix, std::size_t iy, std::size_t at, std::size_t iz, const V, const V k[3]) {
    const V lost = decayed(decay_.x[ix], decay_.y[iy], load(decay_.z.data() + iz)), decay = T(1) + lost;
    for (std::size_t c = 0; c < 3; ++c)
      fourier::store<T>(&tendency_[c][at], decay * (load(&potential_[c][at]) + half * k[c]));
  });
}

// ... and b^{n+1} = E b + dt E_h K(b_h), written over b_h. K(b_h) stays as the history, half a step old.
template <class T>
void Flow<T>::correct_from_midpoint() {
  using V = fourier::Vector<T>;
  using fourier::load;
  const T whole = static_cast<T>(step_.dt);
  forward_x_with([&](std::size_t ix, std::size_t iy, std::size_t at, std::size_t iz, const V k2, const V k[3]) {
    const V lost = decayed(decay_.x[ix], decay_.y[iy], load(decay_.z.data() + iz)), decay = T(1) + lost;
    V b[3];
    for (std::size_t c = 0; c < 3; ++c) {
      b[c] = decay * (decay * load(&potential_[c][at]) + whole * k[c]);
      fourier::store<T>(&tendency_[c][at], b[c]);
      fourier::store<T>(&earlier_[c][at], k[c]);
    }
    add_to(tallies_[iy], b, k2, load(lane_weight_.data() + iz));
  });
}

// Stage s of a scheme in 2N storage; b and q both decay to the time of the next stage.
template <class T>
void Flow<T>::runge_kutta() {
  using V = fourier::Vector<T>;
  using fourier::load;
  const auto s = static_cast<std::size_t>(step_.tendency);
  const Stage2N& stage = runge_kutta_stages(options_.integrator)[s];
  const T a = static_cast<T>(stage.a), weight = static_cast<T>(stage.b), step = static_cast<T>(step_.dt);
  const FairRounding<T> rounded(steps_, s);
  forward_x_with([&](std::size_t ix, std::size_t iy, std::size_t at, std::size_t iz, const V k2, const V k[3]) {
    const V lost = decayed(decay_.x[ix], decay_.y[iy], load(decay_.z.data() + iz)), decay = T(1) + lost;
    V b[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const V old = load(&potential_[c][at]);
      V q = step * k[c];
      if (s > 0) q += a * load(&earlier_[c][at]);
      b[c] = rounded.sum(old, lost * old + decay * (weight * q), at, c);
      fourier::store<T>(&earlier_[c][at], decay * q);
      fourier::store<T>(&potential_[c][at], b[c]);
    }
    add_to(tallies_[iy], b, k2, load(lane_weight_.data() + iz));
  });
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

// Where the update left the potential that it found.
template <class T>
const Modes<T>& Flow<T>::updated() const {
  switch (step_.scheme) {
    case Scheme::midpoint:
      return tendency_;
    case Scheme::adams_bashforth:
      return earlier_;
    default:
      return potential_;
  }
}

template <class T>
void Flow<T>::accept_tendency() {
  const bool predicted = step_.scheme == Scheme::midpoint && step_.tendency == 0;
  try {
    require_acceptable(step_.dt, predicted ? budget_ : tallied(updated()));
  } catch (const StepFailure&) {
    if (step_.scheme == Scheme::runge_kutta) potential_.swap(start_);
    throw;
  }
  if (step_.tendency + 1 < step_.tendencies) return;
  // Each set moves to its place: the new b, the b before it, K of the step.
  if (step_.scheme == Scheme::midpoint) potential_.swap(tendency_);
  if (step_.scheme == Scheme::adams_bashforth) {
    potential_.swap(earlier_);
    earlier_.swap(tendency_);
  }
  if (step_.scheme != Scheme::runge_kutta) {
    has_history_ = true;
    earlier_dt_ = step_.scheme == Scheme::midpoint ? step_.dt / 2 : step_.dt;
  }
  time_ += step_.dt;
  ++steps_;
}

// The midpoint rule leaves b of the step's start where its prediction was.
template <class T>
void Flow<T>::take_back_first_step() {
  potential_.swap(step_.scheme == Scheme::runge_kutta ? start_ : tendency_);
  has_history_ = false;
  time_ = step_.start_time;
  --steps_;
  budget_ = step_.start;
  integrated_gain_ = step_.start_gain;
  integrated_dissipation_ = step_.start_dissipation;
}

template void Flow<double>::begin_start();
template void Flow<float>::begin_start();
template void Flow<double>::begin_step(double);
template void Flow<float>::begin_step(double);
template bool Flow<double>::next_tendency();
template bool Flow<float>::next_tendency();
template bool Flow<double>::next_remainder();
template bool Flow<float>::next_remainder();
template bool Flow<double>::last_remainder() const;
template bool Flow<float>::last_remainder() const;
template void Flow<double>::keep_step_start();
template void Flow<float>::keep_step_start();
template void Flow<double>::set_decay(Decay&, double) const;
template void Flow<float>::set_decay(Decay&, double) const;
template double Flow<double>::factor_bytes() const;
template double Flow<float>::factor_bytes() const;
template void Flow<double>::set_integrating_factors();
template void Flow<float>::set_integrating_factors();
template const Modes<double>& Flow<double>::argument() const;
template const Modes<float>& Flow<float>::argument() const;
template void Flow<double>::inverse_x();
template void Flow<float>::inverse_x();
template void Flow<double>::form_product();
template void Flow<float>::form_product();
template void Flow<double>::forward_x();
template void Flow<float>::forward_x();
template void Flow<double>::update();
template void Flow<float>::update();
template void Flow<double>::take_back_first_step();
template void Flow<float>::take_back_first_step();
template void Flow<double>::accept_tendency();
template void Flow<float>::accept_tendency();

}  // namespace spume::spectral
