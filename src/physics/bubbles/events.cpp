// SPDX-License-Identifier: MIT
// Bubbles after an accepted step: their new state, bursting, breakup, entrainment, sources.
#include <algorithm>
#include <cmath>

#include "spume/core/random.hpp"
#include "spume/physics/bubbles/coupling.hpp"

namespace spume::bubbles {
namespace {
// When bursts of a step are remarked on: this many, and this share of the bubbles. The last few of a scene are no news.
constexpr double noted_bursts = 5, noted_share = 0.5;
// A remark is made again when what it tells has grown this much: a run makes a handful of each.
constexpr int growth_between_remarks = 2;
// More gas than liquid: below this volume fraction the closures do not hold.
constexpr double overfull_fraction = 0.5;
// King (3.18): entrainment is calibrated per step of this Courant number.
constexpr double courant_of_entrainment = 0.2;
}  // namespace

void BubbleCoupling::accept(double dt) {
  const double t = carrier_.time;  // the end of the step
  const std::size_t n = carrier_.size(), nb = population_.size();
  history_before_ = history_;
  last_step_ = dt;
  overfull_ = 0;
  least_volume_fraction_ = 1;
  mean_slip_ = 0;
  if (nb > 0) {
    mean_slip_ = parallel_sum(nb, [&](std::size_t b) { return next_slip_[b]; }) / static_cast<double>(nb);
    accept_volume_fraction();
    least_volume_fraction_ = -parallel_max(n, -1.0, [&](std::size_t i) { return -(*volume_fraction_)[i]; });
    overfull_ = static_cast<std::int64_t>(
        parallel_sum(n, [&](std::size_t i) { return (*volume_fraction_)[i] < overfull_fraction ? 1.0 : 0.0; }));
    parallel_for(nb, [&](std::size_t b) {
      Vec3 r, u;
      for (std::size_t a = 0; a < 3; ++a) {
        r[a] = (*population_.next_position[a])[b];
        u[a] = (*population_.next_velocity[a])[b];
      }
      carrier_.boundary.apply_walls(carrier_.boundary.walls, r, &u);
      for (std::size_t a = 0; a < 3; ++a) {
        (*population_.position[a])[b] = r[a];
        (*population_.velocity[a])[b] = u[a];
        if (population_.fluctuation[a] != nullptr)
          (*population_.fluctuation[a])[b] = (*population_.next_fluctuation[a])[b];
      }
      (*population_.at_rest_in_liquid)[b] = 0;
      (*population_.slip)[b] = next_slip_[b];
      if (population_.merge_time != nullptr) (*population_.merge_time)[b] = next_merge_time_[b];
    });
    if (exchanges_gas()) accept_gas();
    if (population_.deformation != nullptr) break_up(dt);
    remove_dead(t);
    history_.inner_bursts += next_inner_bursts_;
  }
  // A liquid that was left by its last bubble.
  if (population_.empty() && nb > 0) parallel_for(n, [&](std::size_t i) { (*volume_fraction_)[i] = 1; });
  if (options_.entrainment && has_surface()) entrain(dt);
  if (exchanges_gas()) fill_new_bubbles(oxygen::oxygen_of_air);
  const std::size_t before = population_.size();
  Released released = sources_.release(population_, t - dt, dt);
  const Released cloud = sources_.place_clouds(population_, t);
  released.bubbles += cloud.bubbles;
  released.volume += cloud.volume;
  if (beside_bodies()) keep_new_bubbles_outside(before);
  history_.injected += static_cast<std::int64_t>(released.bubbles);
  history_.injected_volume += released.volume;
  if (exchanges_gas()) fill_new_bubbles(carrier_.gas->fraction);
  max_speed_ = std::sqrt(parallel_max(population_.size(), 0.0, [&](std::size_t b) {
    double speed2 = 0;
    for (std::size_t a = 0; a < 3; ++a) speed2 += (*population_.velocity[a])[b] * (*population_.velocity[a])[b];
    return speed2;
  }));
  if (overfull_ > growth_between_remarks * most_overfull_) {
    most_overfull_ = overfull_;
    remark(std::to_string(overfull_) + " particles hold more gas than liquid (alpha down to " +
           std::to_string(least_volume_fraction_) + " at t = " + std::to_string(t) +
           "): the closures of the forces do not hold there");
  }
  if (history_.inner_bursts >= growth_between_remarks * most_inner_bursts_) {
    most_inner_bursts_ = history_.inner_bursts;
    remark(
        std::to_string(history_.inner_bursts) + " of " + std::to_string(history_.bursts) +
        " bursts until t = " + std::to_string(t) +
        " were of bubbles with liquid before them: they burst in gaps of the liquid, or deeper than a surface reaches");
  }
  if (population_.size() >= growth_between_remarks * most_alive_) {
    most_alive_ = population_.size();
    remark(std::to_string(most_alive_) + " bubbles live at t = " + std::to_string(t) +
           ": each costs as much as a particle of the liquid, however small");
  }
}

void BubbleCoupling::remark(const std::string& text) {
  note_ += (note_.empty() ? "" : "; ") + text;
}

// King section 3.4.2. A parent becomes its first child; the second is born.
void BubbleCoupling::break_up(double dt) {
  const double t = carrier_.time;
  const auto step = static_cast<std::uint32_t>(carrier_.steps);
  const std::size_t nb = population_.size();
  history_.breakups += static_cast<
      std::int64_t>(population_.give_birth(nb, t, [&](std::size_t b, std::vector<NewBubble>& made) {
    const double radius = population_.radius(b);
    double& deformation = (*population_.deformation)[b];
    double& integral = (*population_.dissipation_integral)[b];
    deformation = std::max(0.0, deformation + dt * deformation_velocity(breakup_, radius, dissipation_[b]));
    integral += dt * dissipation_[b];
    if (dead_[b] != 0 || !(deformation > 2 * radius)) return;
    const double age = t - (*population_.birth_time)[b];
    const double ratio = stable_ratio(breakup_, radius, integral / std::max(age, dt));
    if (!(ratio < critical_ratio())) return;
    const auto u = random_uniform(carrier_.scene.seed, RandomPurpose::bubble_breakup,
                                  static_cast<std::uint64_t>((*population_.identifier)[b]), step, 0);
    const auto children = split((*population_.volume)[b], child_sizes_[0](u[0], ratio), u[1], u[2]);
    NewBubble second;
    Vec3 place{}, parent{};
    for (std::size_t a = 0; a < 3; ++a) {
      parent[a] = (*population_.position[a])[b];
      place[a] = parent[a] + children.first_offset[a];
      second.position[a] = parent[a] + children.second_offset[a];
      second.velocity[a] = (*population_.velocity[a])[b];
      if (population_.fluctuation[a] != nullptr) second.fluctuation[a] = (*population_.fluctuation[a])[b];
    }
    carrier_.boundary.apply_walls(carrier_.boundary.walls, place, nullptr);
    carrier_.boundary.apply_walls(carrier_.boundary.walls, second.position, nullptr);
    second.volume = children.second_volume;
    if (exchanges_gas()) {
      const double share = children.second_volume / (children.first_volume + children.second_volume);
      for (auto [child, gas] : {std::pair{&second.oxygen, population_.oxygen}, {&second.inert, population_.inert}}) {
        *child = share * (*gas)[b];
        (*gas)[b] -= *child;
      }
    }
    made.push_back(second);
    for (std::size_t a = 0; a < 3; ++a) (*population_.position[a])[b] = place[a];
    (*population_.volume)[b] = children.first_volume;
    (*population_.birth_time)[b] = t;
    deformation = integral = 0;
  }));
  if (population_.size() > nb) {
    const std::size_t before = dead_.size();
    dead_.resize(population_.size());
    for (std::size_t b = before; b < dead_.size(); ++b) dead_[b] = 0;
  }
}

void BubbleCoupling::remove_dead(double t) {
  const std::size_t nb = population_.size();
  const double gone = parallel_sum(nb, [&](std::size_t b) { return dead_[b] != 0 ? 1.0 : 0.0; });
  if (gone == 0) return;
  if (gone >= noted_bursts && gone >= noted_share * static_cast<double>(nb) &&
      gone > growth_between_remarks * most_bursts_) {
    most_bursts_ = gone;
    remark(std::to_string(static_cast<std::int64_t>(gone)) + " of " + std::to_string(nb) +
           " bubbles burst in the step to t = " + std::to_string(t));
  }
  const double dissolved =
      exchanges_gas() && carrier_.gas->shrinks
          ? parallel_sum(nb, [&](std::size_t i) { return (*population_.volume)[i] == 0 ? 1.0 : 0.0; })
          : 0;
  history_.bursts += static_cast<std::int64_t>(gone - dissolved);
  history_.burst_volume +=
      parallel_sum(nb, [&](std::size_t b) { return dead_[b] != 0 ? (*population_.volume)[b] : 0.0; });
  if (exchanges_gas())
    oxygen_.left += oxygen::molar_mass *
                    parallel_sum(nb, [&](std::size_t b) { return dead_[b] != 0 ? (*population_.oxygen)[b] : 0.0; });
  population_.remove(dead_);
}

// Shepard average of the unresolved dissipation: what the threshold of entrainment was calibrated with.
double BubbleCoupling::smoothed_dissipation(std::size_t i) const {
  double result = 0;
  const float* x[3] = {carrier_.arrangement.list.coordinate(0), carrier_.arrangement.list.coordinate(1),
                       carrier_.arrangement.list.coordinate(2)};
  const double h = carrier_.sizes.smoothing_length(carrier_.resolution, i);
  const auto value = [&](std::size_t j) {
    const double strain = carrier_.strain[j];
    return (*carrier_.eddy_viscosity)[j] * strain * strain;
  };
  with_kernel(carrier_.arrangement.context, [&]<int d, class Kernel>() {
    double weights = Kernel::w(0.0) * own_volume<Kernel>(carrier_.arrangement.context, i), sum = weights * value(i);
    for (const std::int32_t j : carrier_.arrangement.list.of(i)) {
      const std::size_t source = carrier_.arrangement.particle_of(j);
      double r2 = 0;
      for (int a = 0; a < d; ++a) r2 += (double{x[a][j]} - x[a][i]) * (double{x[a][j]} - x[a][i]);
      const double w = Kernel::w(std::sqrt(r2) / h) * own_volume<Kernel>(carrier_.arrangement.context, source);
      weights += w;
      sum += w * value(source);
    }
    result = sum / weights;
  });
  return result;
}

void BubbleCoupling::entrain(double dt) {
  if (!(carrier_.speeds.limiting > 0)) return;
  const double period = courant_of_entrainment * carrier_.resolution.smoothing_length / carrier_.speeds.limiting;
  double peak = 0;
  with_kernel(carrier_.arrangement.context,
              [&]<int d, class Kernel>() { peak = Kernel::normalisation(3) * Kernel::w(0.0); });
  const std::size_t before = population_.size();
  const auto step = static_cast<std::uint32_t>(carrier_.steps);
  const std::size_t born = population_.give_birth(
      carrier_.surface->surface_particles.size(), carrier_.time, [&](std::size_t s, std::vector<NewBubble>& made) {
        const auto i = static_cast<std::size_t>(carrier_.surface->surface_particles[s]);
        EntrainingParticle particle;
        particle.dissipation = smoothed_dissipation(i);
        if (!(particle.dissipation > entrainment_.threshold)) return;
        for (std::size_t a = 0; a < 3; ++a) {
          particle.position[a] = (*carrier_.position[a])[i];
          particle.velocity[a] = (*carrier_.velocity[a])[i];
        }
        const double h = carrier_.sizes.smoothing_length(carrier_.resolution, i);
        particle.volume_fraction = carrier_.sizes.alpha(i);
        particle.volume = carrier_.particle_volume / particle.volume_fraction;
        particle.kernel_peak = peak / (h * h * h);
        particle.identifier = carrier_.identifier[i];
        const std::size_t first = made.size();
        bubbles::entrain(entrainment_, particle, dt, period, step, made);
        for (std::size_t k = first; k < made.size(); ++k)
          carrier_.boundary.apply_walls(carrier_.boundary.walls, made[k].position, &made[k].velocity);
      });
  history_.entrained += static_cast<std::int64_t>(born);
  history_.entrained_volume += parallel_sum(born, [&](std::size_t k) { return (*population_.volume)[before + k]; });
}

}  // namespace spume::bubbles
