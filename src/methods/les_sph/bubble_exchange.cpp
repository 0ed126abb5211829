// SPDX-License-Identifier: MIT
// What bubbles feel of the liquid, how they move, and what they return to it.
#include <algorithm>
#include <cmath>

#include "spume/core/random.hpp"
#include "spume/methods/les_sph/bubble_coupling.hpp"
#include "spume/physics/bubbles/fluctuations.hpp"

namespace spume::les_sph {
namespace {

// What bubbles see of a particle, times its volume times its kernel's normalisation over h_i^3, in units of V / h^3:
// one line of cache. The factor itself is among them, so that its sum comes with the others; the last is h_i / h.
constexpr int velocity_at = 0, vorticity_at = 3, acceleration_at = 6, energy_at = 9, dissipation_at = 10,
              normal_at = 11, factor_at = 14, length_at = 15, record = line_floats;

constexpr std::size_t pack_block = 64;

Vec3 vector_at(const float* from, int slot) {
  return {from[slot], from[slot + 1], from[slot + 2]};
}

}  // namespace

// Normals filtered once where bubbles look at them.
void BubbleCoupling::smooth_normals(Liquid& liquid) {
  if (population_.merge_time == nullptr) return;
  parallel_select(liquid.size(), near_particles_, [&](std::size_t i) { return near_[i] != 0; });
  filter_vector_subset(liquid.context, liquid.records, liquid.read(liquid.normal), liquid.reflection, near_particles_,
                       liquid.write(liquid.smoothed_normal));
}

void BubbleCoupling::pack_liquid(Liquid& liquid) {
  const std::size_t n = liquid.size(), m = liquid.images.size();
  liquid_records_.resize((n + m) * record);
  inverse_support_radius_.resize(n + m + simd::pair_lanes);
  const auto& gradient = liquid.velocity_gradient;
  const bool filtered = liquid.plan.test_filter, eddies = liquid.eddy_viscosity != nullptr;
  const bool normals = population_.merge_time != nullptr;
  // An image inside a box belongs to the face nearest to it: that of a particle may reach a bubble whose own does not
  // reach the particle.
  const bool around_boxes = liquid.images.inside_domain();
  // One value at a time: more arrays than the processor can read ahead of would be read at once otherwise.
  parallel_blocks(n, pack_block, [&](std::size_t, std::size_t first, std::size_t last) {
    const std::size_t size = last - first;
    bool near = false;
    for (std::size_t i = first; i < last; ++i) {
      inverse_support_radius_[i] = 1 / liquid.support_radius[i];
      near = near || near_[i] != 0;
    }
    if (!near && !around_boxes) return;
    float* const records = liquid_records_.data() + first * record;
    float factor[pack_block];
    for (std::size_t k = 0; k < size; ++k) {
      const float inverse = 1 / liquid.length_ratio[first + k];
      factor[k] = liquid.volume_ratio[first + k] * inverse * inverse * inverse;
    }
    const auto put = [&](int slot, auto&& value) {
      for (std::size_t k = 0; k < size; ++k) records[k * record + slot] = factor[k] * value(k);
    };
    const auto nothing = [](std::size_t) { return 0.0F; };
    double energy[pack_block] = {};
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis), b = (a + 1) % 3, c = (a + 2) % 3;
      const double *velocity = liquid.velocity[a]->data() + first,
                   *acceleration = liquid.material_acceleration[a]->data() + first;
      const float *up = gradient[c * 3 + b]->data() + first, *down = gradient[b * 3 + c]->data() + first;
      put(velocity_at + axis, [=](std::size_t k) { return static_cast<float>(velocity[k]); });
      put(vorticity_at + axis, [=](std::size_t k) { return up[k] - down[k]; });
      put(acceleration_at + axis, [=](std::size_t k) { return static_cast<float>(acceleration[k]); });
      if (normals) {
        const float* normal = liquid.smoothed_normal[a]->data() + first;
        put(normal_at + axis, [=](std::size_t k) { return normal[k]; });
      } else {
        put(normal_at + axis, nothing);
      }
      if (!filtered) continue;
      const float* mean = liquid.filtered_velocity[a]->data() + first;
      for (std::size_t k = 0; k < size; ++k) {
        const double unresolved = velocity[k] - double{mean[k]};
        energy[k] += 0.5 * unresolved * unresolved;
      }
    }
    put(energy_at, [&](std::size_t k) { return static_cast<float>(energy[k]); });
    if (eddies) {
      const float *viscosity = liquid.eddy_viscosity->data() + first, *strain = liquid.strain->data() + first;
      put(dissipation_at, [=](std::size_t k) { return viscosity[k] * strain[k] * strain[k]; });
    } else {
      put(dissipation_at, nothing);
    }
    put(factor_at, [](std::size_t) { return 1.0F; });
    put(length_at, [&](std::size_t k) { return liquid.length_ratio[first + k]; });
  });
  // Mirrored velocities and what follows from them: at a no-slip wall the vorticity keeps its sign.
  parallel_for(m, [&](std::size_t k) {
    const auto source = static_cast<std::size_t>(liquid.images.source()[k]);
    inverse_support_radius_[n + k] = inverse_support_radius_[source];
    if (!around_boxes && near_[source] == 0) return;
    const auto path = static_cast<std::size_t>(liquid.images.path()[k]);
    float* value = liquid_records_.data() + (n + k) * record;
    std::copy_n(liquid_records_.data() + source * record, record, value);
    const auto& sign = liquid.velocity_rule.sign[path];
    const auto& mirror = liquid.reflection[path];
    for (std::size_t a = 0; a < 3; ++a) {
      value[velocity_at + a] *= sign[a];
      if (!liquid.velocity_rule.offset[a].empty())
        value[velocity_at + a] += value[factor_at] * liquid.velocity_rule.offset[a][k];
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      value[vorticity_at + a] =
          value[factor_at] * (sign[c] * mirror[b] * (*liquid.velocity_gradient[c * 3 + b])[source] -
                              sign[b] * mirror[c] * (*liquid.velocity_gradient[b * 3 + c])[source]);
      value[acceleration_at + a] *= sign[a];
      value[normal_at + a] *= mirror[a];
    }
  });
}

// (3.6) over the sum of its weights; the sum itself tells how much liquid there is.
void BubbleCoupling::interpolate(const Liquid& liquid) {
  const std::size_t nb = population_.size(), n = liquid.size();
  interpolated_.resize(nb * record);
  dead_.resize(nb);
  const CrossSearch::Points sets[] = {{&liquid.table, n}, images_as_points(liquid.images)};
  const CrossSearch search(liquid.grid, liquid.origin,
                           {liquid.list.coordinate(0), liquid.list.coordinate(1), liquid.list.coordinate(2)}, sets);
  const auto largest_support_radius = static_cast<float>(liquid.grid.support_radius() * liquid.largest_length_ratio);
  with_kernel(liquid.context, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      const float scale = KernelScale<3, Kernel>(liquid.context).value;
      parallel_blocks_dynamic(nb, 64, [&](std::size_t, std::size_t first, std::size_t last) {
        thread_local CrossSearch::Found thread_found;
        CrossSearch::Found& found = thread_found;
        for (std::size_t b = first; b < last; ++b) {
          search.near_place({bubble_point_[0][b], bubble_point_[1][b], bubble_point_[2][b]}, largest_support_radius,
                            inverse_support_radius_.data(), found);
          const auto [first_half, second_half] = sum_of_lines<Kernel>(found, liquid_records_.data());
          // In spray: few particles, all at the surface.
          bool dead = found.size < 20 && liquid.plan.free_surface;
          for (std::size_t k = 0; dead && k < found.size; ++k) {
            const auto j = static_cast<std::size_t>(found.index[k]);
            const std::size_t i = j < n ? j : static_cast<std::size_t>(liquid.images.source()[j - n]);
            dead = liquid.at_surface[i] != 0;
          }
          dead_[b] = dead ? 1 : 0;
          const float sum = second_half[factor_at - simd::lanes], share = sum > 0 ? 1 / sum : 0;
          float* out = interpolated_.data() + b * record;
          simd::store(out, first_half * share);
          simd::store(out + simd::lanes, second_half * share);
          out[factor_at] = scale * sum;
        }
      });
    }
  });
}

Vec3 BubbleCoupling::vorticity_at_bubble(std::size_t b) const {
  return vector_at(interpolated_.data() + b * record, vorticity_at);
}

double BubbleCoupling::filter_width_at_bubble(std::size_t b) const {
  return interpolated_[b * record + length_at];
}

void BubbleCoupling::move_bubbles(Liquid& liquid, double dt) {
  const std::size_t nb = population_.size();
  const double t = liquid.time + dt;
  const bool two_fluid = !liquid.plan.mixture_pressure;
  const bool surface_bears = options_.surface_reaction == SurfaceReaction::surface;
  const bool surface = population_.merge_time != nullptr, turbulent = population_.fluctuation[0] != nullptr;
  const auto step = static_cast<std::uint32_t>(liquid.steps);
  dissipation_.resize(nb);
  next_slip_.resize(nb);
  if (surface) next_merge_time_.resize(nb);
  for (auto& component : reaction_) component.resize(nb);
  float* records = bubble_records_.data();  // x y z, M / N (3), viscosity, nothing
  parallel_blocks_dynamic(nb, 256, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      const float* values_here = interpolated_.data() + b * record;
      const double sum = values_here[factor_at];
      bubbles::Surroundings around{vector_at(values_here, velocity_at), vector_at(values_here, vorticity_at),
                                   vector_at(values_here, acceleration_at)};
      const double volume = (*population_.volume)[b], radius = bubbles::radius_of(volume);
      Vec3 u;
      for (std::size_t a = 0; a < 3; ++a) u[a] = (*population_.velocity[a])[b];
      if ((*population_.at_rest_in_liquid)[b] != 0) u = around.velocity;
      if (turbulent) {
        const auto noise = random_normal(liquid.scene.seed, RandomPurpose::bubble_fluctuation,
                                         static_cast<std::uint64_t>((*population_.identifier)[b]), step, 0);
        Vec3 fluctuation, slip;
        for (std::size_t a = 0; a < 3; ++a) {
          fluctuation[a] = (*population_.fluctuation[a])[b];
          slip[a] = around.velocity[a] - u[a];
        }
        const double width = liquid.smoothing_length * filter_width_at_bubble(b);
        fluctuation = bubbles::advance_fluctuation(fluctuation, slip, values_here[energy_at], width,
                                                   options_.fluctuation_constant, dt, {noise[0], noise[1], noise[2]});
        for (std::size_t a = 0; a < 3; ++a) {
          (*population_.next_fluctuation[a])[b] = fluctuation[a];
          around.velocity[a] += fluctuation[a];
        }
      }
      const Vec3 resolved = vector_at(values_here, velocity_at);
      bubbles::Braking braking;
      if (surface) {
        Vec3 normal = vector_at(values_here, normal_at), slip;
        const double length = std::hypot(normal[0], normal[1], normal[2]);
        for (std::size_t a = 0; a < 3; ++a) {
          normal[a] = length > 0 ? normal[a] / length : 0;
          slip[a] = around.velocity[a] - u[a];
        }
        const bubbles::SurfaceContact contact =
            bubbles::approach_surface(surface_, length / normal_at_surface_, normal, slip, radius,
                                      t - (*population_.birth_time)[b], (*population_.merge_time)[b], t, dt);
        braking = contact.braking;
        next_merge_time_[b] = contact.merge_time;
        if (contact.bursts) dead_[b] = 1;
      }
      Vec3 next = u, change{}, reaction{};
      if (sum > 0) {
        next = options_.integrator == BubbleIntegrator::stable
                   ? bubbles::advance_stable(gas_, radius, around, u, dt, braking)
                   : bubbles::advance_substepped(gas_, radius, around, u, dt, liquid.scene.spacing, braking);
        for (std::size_t a = 0; a < 3; ++a) change[a] = next[a] - u[a];
        reaction = bubbles::reaction(gas_, volume, around, change, dt, two_fluid);
        if (surface_bears && braking.share > 0) {
          double slip_normal = 0;
          for (std::size_t a = 0; a < 3; ++a) slip_normal += (around.velocity[a] - u[a]) * braking.normal[a];
          const Vec3 borne = bubbles::braking_force(gas_, radius, around, next, slip_normal, dt, braking);
          for (std::size_t a = 0; a < 3; ++a) reaction[a] += volume * borne[a];
        }
      }
      double slip2 = 0, resolved_slip2 = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        (*population_.next_velocity[a])[b] = next[a];
        reaction_[a][b] = reaction[a];
        records[b * 8 + a] = bubble_point_[a][b];
        records[b * 8 + 3 + a] = sum > 0 ? static_cast<float>(reaction[a] / sum) : 0.0F;
        slip2 += (around.velocity[a] - next[a]) * (around.velocity[a] - next[a]);
        resolved_slip2 += (resolved[a] - next[a]) * (resolved[a] - next[a]);
      }
      next_slip_[b] = std::sqrt(resolved_slip2);
      // Sato & Sekoguchi, King (2.23) with the units of nu.
      records[b * 8 + 6] = static_cast<float>(options_.viscosity_constant * volume * 2 * radius * std::sqrt(slip2));
      records[b * 8 + 7] = 0;
      dissipation_[b] = values_here[dissipation_at];
    }
  });
  parallel_for(images_.size(), [&](std::size_t k) {
    float* out = records + (nb + k) * 8;
    std::copy_n(records + static_cast<std::size_t>(images_.source()[k]) * 8, 8, out);
    for (std::size_t a = 0; a < 3; ++a) out[a] = bubble_point_[a][nb + k];
  });
}

void BubbleCoupling::deposit(Liquid& liquid) {
  liquid.bubble_viscosity.resize(liquid.size());
  with_kernel(liquid.context, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      const double h = liquid.smoothing_length;
      const auto peak = static_cast<float>(Kernel::normalisation(3) / (h * h * h));
      const auto store = [&](std::size_t i, const float* sums) {
        if (sums == nullptr) {
          for (auto* component : liquid.exchange) (*component)[i] = 0;
          liquid.bubble_viscosity[i] = 0;
          return;
        }
        const float inverse = 1 / liquid.length_ratio[i], scale = peak * inverse * inverse * inverse;
        // Mass times acceleration is V_i times what arrives per volume: V_i / V_l of it.
        for (std::size_t a = 0; a < 3; ++a) (*liquid.exchange[a])[i] = liquid.volume_ratio[i] * (scale * sums[a]);
        liquid.bubble_viscosity[i] = scale * sums[3];
      };
      sum_over_points<4, Kernel>(particle_targets(liquid), bubble_search(liquid), liquid.grid.support_radius(),
                                 bubble_records_.data(), store);
    }
  });
}

void BubbleCoupling::exchange_momentum(Liquid& liquid, double dt) {
  if (population_.empty()) {
    for (auto& component : reaction_) component.resize(0);
    return;
  }
  smooth_normals(liquid);
  pack_liquid(liquid);
  interpolate(liquid);
  move_bubbles(liquid, dt);
  deposit(liquid);
}

Vec3 BubbleCoupling::total_reaction() const {
  Vec3 total;
  for (std::size_t a = 0; a < 3; ++a)
    total[a] = parallel_sum(reaction_[a].size(), [&](std::size_t b) { return reaction_[a][b]; });
  return total;
}

}  // namespace spume::les_sph
