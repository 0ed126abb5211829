// SPDX-License-Identifier: MIT
// What bubbles feel of the liquid, how they move, and what they return to it.
#include <algorithm>
#include <cmath>

#include "spume/core/random.hpp"
#include "spume/physics/bubbles/coupling.hpp"
#include "spume/physics/bubbles/fluctuations.hpp"

namespace spume::bubbles {
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
void BubbleCoupling::smooth_normals() {
  if (population_.merge_time == nullptr) return;
  parallel_select(carrier_.particles.size(), near_particles_, [&](std::size_t i) { return near_[i] != 0; });
  filter_vector_subset(carrier_.arrangement.context, carrier_.arrangement.packed, read(carrier_.moments.normal),
                       carrier_.boundary.reflection(), near_particles_, write(carrier_.surface->smoothed_normal));
  carrier_.arrangement.packed.take_traffic();  // it counts the lists of all particles
}

void BubbleCoupling::pack_liquid() {
  const std::size_t n = carrier_.particles.size(), m = carrier_.arrangement.images.size();
  liquid_records_.resize((n + m) * record);
  inverse_support_radius_.resize(n + m + simd::pair_lanes);
  const auto gradient_of = [this](int a, int b) -> const Array<float>& {
    return carrier_.velocity_gradient[static_cast<std::size_t>(a * 3 + b)];
  };
  const bool filtered = carrier_.filtered, eddies = carrier_.eddy_viscosity != nullptr;
  const bool normals = population_.merge_time != nullptr;
  // An image inside a box belongs to the face nearest to it: that of a particle may reach a bubble whose own does not
  // reach the particle.
  const bool around_boxes = carrier_.arrangement.images.inside_domain();
  // One value at a time: more arrays than the processor can read ahead of would be read at once otherwise.
  parallel_blocks(n, pack_block, [&](std::size_t, std::size_t first, std::size_t last) {
    const std::size_t size = last - first;
    bool near = false;
    for (std::size_t i = first; i < last; ++i) {
      inverse_support_radius_[i] = 1 / carrier_.sizes.support_radius[i];
      near = near || near_[i] != 0;
    }
    if (!near && !around_boxes) return;
    float* const records = liquid_records_.data() + first * record;
    float factor[pack_block];
    for (std::size_t k = 0; k < size; ++k) {
      const float inverse = 1 / carrier_.sizes.length_ratio[first + k];
      factor[k] = carrier_.sizes.volume_ratio[first + k] * inverse * inverse * inverse;
    }
    const auto put = [&](int slot, auto&& value) {
      for (std::size_t k = 0; k < size; ++k) records[k * record + slot] = factor[k] * value(k);
    };
    const auto nothing = [](std::size_t) { return 0.0F; };
    double energy[pack_block] = {};
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      const double *velocity = carrier_.velocity[a].data() + first,
                   *acceleration = material_acceleration[a]->data() + first;
      const float *up = gradient_of(c, b).data() + first, *down = gradient_of(b, c).data() + first;
      put(velocity_at + axis, [=](std::size_t k) { return static_cast<float>(velocity[k]); });
      put(vorticity_at + axis, [=](std::size_t k) { return up[k] - down[k]; });
      put(acceleration_at + axis, [=](std::size_t k) { return static_cast<float>(acceleration[k]); });
      if (normals) {
        const float* normal = carrier_.surface->smoothed_normal[a].data() + first;
        put(normal_at + axis, [=](std::size_t k) { return normal[k]; });
      } else {
        put(normal_at + axis, nothing);
      }
      if (!filtered) continue;
      const float* mean = carrier_.filtered_velocity[a].data() + first;
      for (std::size_t k = 0; k < size; ++k) {
        const double unresolved = velocity[k] - double{mean[k]};
        energy[k] += 0.5 * unresolved * unresolved;
      }
    }
    put(energy_at, [&](std::size_t k) { return static_cast<float>(energy[k]); });
    if (eddies) {
      const float *viscosity = carrier_.eddy_viscosity->data() + first, *strain = carrier_.strain.data() + first;
      put(dissipation_at, [=](std::size_t k) { return viscosity[k] * strain[k] * strain[k]; });
    } else {
      put(dissipation_at, nothing);
    }
    put(factor_at, [](std::size_t) { return 1.0F; });
    put(length_at, [&](std::size_t k) { return carrier_.sizes.length_ratio[first + k]; });
  });
  // Mirrored velocities and what follows from them: at a no-slip wall the vorticity keeps its sign.
  const ImageMap map = carrier_.boundary.image_map(carrier_.arrangement.images);
  parallel_for(m, [&](std::size_t k) {
    const std::size_t source = map.source(k);
    inverse_support_radius_[n + k] = inverse_support_radius_[source];
    if (!around_boxes && near_[source] == 0) return;
    float* value = liquid_records_.data() + (n + k) * record;
    std::copy_n(liquid_records_.data() + source * record, record, value);
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      value[velocity_at + a] *= map.velocity_sign(k, a);
      if (map.walls_move()) value[velocity_at + a] += value[factor_at] * map.wall_velocity(k, a);
      value[vorticity_at + a] =
          value[factor_at] * (map.velocity_sign(k, c) * map.vector_sign(k, b) * gradient_of(c, b)[source] -
                              map.velocity_sign(k, b) * map.vector_sign(k, c) * gradient_of(b, c)[source]);
      value[acceleration_at + a] *= map.velocity_sign(k, a);
      value[normal_at + a] *= map.vector_sign(k, a);
    }
  });
}

// (3.6) over the sum of its weights; the sum itself tells how much liquid there is.
void BubbleCoupling::interpolate() {
  const std::size_t nb = population_.size(), n = carrier_.particles.size();
  interpolated_.resize(nb * record);
  dead_.resize(nb);
  const CrossSearch::Points sets[] = {{&carrier_.arrangement.table, n}, images_as_points(carrier_.arrangement.images)};
  const CrossSearch search(carrier_.arrangement.grid, carrier_.arrangement.origin,
                           {carrier_.arrangement.list.coordinate(0), carrier_.arrangement.list.coordinate(1),
                            carrier_.arrangement.list.coordinate(2)},
                           sets);
  const auto largest_support_radius =
      static_cast<float>(carrier_.arrangement.grid.support_radius() * carrier_.sizes.largest_length_ratio);
  with_kernel(carrier_.arrangement.context, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      const float scale = KernelScale<3, Kernel>(carrier_.arrangement.context).value;
      parallel_blocks_dynamic(nb, 64, [&](std::size_t, std::size_t first, std::size_t last) {
        thread_local CrossSearch::Found thread_found;
        CrossSearch::Found& found = thread_found;
        for (std::size_t b = first; b < last; ++b) {
          search.near_place({bubble_point_[0][b], bubble_point_[1][b], bubble_point_[2][b]}, largest_support_radius,
                            inverse_support_radius_.data(), found);
          const auto [first_half, second_half] = sum_of_lines<Kernel>(found, liquid_records_.data());
          // In spray: few particles, all at the surface.
          bool dead = found.size < 20 && has_surface();
          for (std::size_t k = 0; dead && k < found.size; ++k) {
            const auto j = static_cast<std::size_t>(found.index[k]);
            const std::size_t i = j < n ? j : static_cast<std::size_t>(carrier_.arrangement.images.source()[j - n]);
            dead = carrier_.surface->at_surface[i] != 0;
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

void BubbleCoupling::move_bubbles(double dt) {
  const std::size_t nb = population_.size();
  const double t = carrier_.time + dt;
  const bool two_fluid = !mixture_pressure();
  const bool surface_bears = options_.surface_reaction == SurfaceReaction::surface;
  const bool surface = population_.merge_time != nullptr, turbulent = population_.fluctuation[0] != nullptr;
  const auto step = static_cast<std::uint32_t>(carrier_.steps);
  dissipation_.resize(nb);
  next_slip_.resize(nb);
  if (surface) next_merge_time_.resize(nb);
  for (auto& component : reaction_) component.resize(nb);
  float* records = bubble_records_.data();  // x y z, M / N (3), viscosity, nothing
  parallel_blocks_dynamic(nb, 256, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      const float* values_here = interpolated_.data() + b * record;
      const double sum = values_here[factor_at];
      Surroundings around{vector_at(values_here, velocity_at), vector_at(values_here, vorticity_at),
                          vector_at(values_here, acceleration_at)};
      const double volume = (*population_.volume)[b], radius = radius_of(volume);
      Vec3 u;
      for (std::size_t a = 0; a < 3; ++a) u[a] = (*population_.velocity[a])[b];
      if ((*population_.at_rest_in_liquid)[b] != 0) u = around.velocity;
      if (turbulent) {
        const auto noise = random_normal(carrier_.scene.seed, RandomPurpose::bubble_fluctuation,
                                         static_cast<std::uint64_t>((*population_.identifier)[b]), step, 0);
        Vec3 fluctuation, slip;
        for (std::size_t a = 0; a < 3; ++a) {
          fluctuation[a] = (*population_.fluctuation[a])[b];
          slip[a] = around.velocity[a] - u[a];
        }
        const double width = carrier_.resolution.smoothing_length * filter_width_at_bubble(b);
        fluctuation = advance_fluctuation(fluctuation, slip, values_here[energy_at], width,
                                          options_.fluctuation_constant, dt, {noise[0], noise[1], noise[2]});
        for (std::size_t a = 0; a < 3; ++a) {
          (*population_.next_fluctuation[a])[b] = fluctuation[a];
          around.velocity[a] += fluctuation[a];
        }
      }
      const Vec3 resolved = vector_at(values_here, velocity_at);
      Braking braking;
      if (surface) {
        Vec3 normal = vector_at(values_here, normal_at), slip;
        const double length = std::hypot(normal[0], normal[1], normal[2]);
        for (std::size_t a = 0; a < 3; ++a) {
          normal[a] = length > 0 ? normal[a] / length : 0;
          slip[a] = around.velocity[a] - u[a];
        }
        const SurfaceContact contact =
            approach_surface(surface_, length / normal_at_surface_, normal, slip, radius,
                             t - (*population_.birth_time)[b], (*population_.merge_time)[b], t, dt);
        braking = contact.braking;
        next_merge_time_[b] = contact.merge_time;
        if (contact.bursts) dead_[b] = 1;
      }
      Vec3 next = u, change{}, reaction{};
      if (sum > 0) {
        next = options_.integrator == BubbleIntegrator::stable
                   ? advance_stable(gas_, radius, around, u, dt, braking)
                   : advance_substepped(gas_, radius, around, u, dt, carrier_.resolution.spacing, braking);
        for (std::size_t a = 0; a < 3; ++a) change[a] = next[a] - u[a];
        reaction = bubbles::reaction(gas_, volume, around, change, dt, two_fluid);
        if (surface_bears && braking.share > 0) {
          double slip_normal = 0;
          for (std::size_t a = 0; a < 3; ++a) slip_normal += (around.velocity[a] - u[a]) * braking.normal[a];
          const Vec3 borne = braking_force(gas_, radius, around, next, slip_normal, dt, braking);
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

void BubbleCoupling::deposit() {
  viscosity.resize(carrier_.particles.size());
  with_kernel(carrier_.arrangement.context, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      const double h = carrier_.resolution.smoothing_length;
      const auto peak = static_cast<float>(Kernel::normalisation(3) / (h * h * h));
      const auto store = [&](std::size_t i, const float* sums) {
        if (sums == nullptr) {
          for (auto* component : exchange) (*component)[i] = 0;
          viscosity[i] = 0;
          return;
        }
        const float inverse = 1 / carrier_.sizes.length_ratio[i], scale = peak * inverse * inverse * inverse;
        // Mass times acceleration is V_i times what arrives per volume: V_i / V_l of it.
        for (std::size_t a = 0; a < 3; ++a) (*exchange[a])[i] = carrier_.sizes.volume_ratio[i] * (scale * sums[a]);
        viscosity[i] = scale * sums[3];
      };
      sum_over_points<4, Kernel>(particle_targets(), bubble_search(), carrier_.arrangement.grid.support_radius(),
                                 bubble_records_.data(), store);
    }
  });
}

void BubbleCoupling::exchange_momentum(double dt) {
  if (population_.empty()) {
    for (auto& component : reaction_) component.resize(0);
    return;
  }
  smooth_normals();
  pack_liquid();
  interpolate();
  move_bubbles(dt);
  deposit();
}

Vec3 BubbleCoupling::total_reaction() const {
  Vec3 total;
  for (std::size_t a = 0; a < 3; ++a)
    total[a] = parallel_sum(reaction_[a].size(), [&](std::size_t b) { return reaction_[a][b]; });
  return total;
}

}  // namespace spume::bubbles
