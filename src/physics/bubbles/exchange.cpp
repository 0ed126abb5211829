// SPDX-License-Identifier: MIT
// What bubbles feel of the liquid, how they move, and what they return to it.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "liquid_record.hpp"
#include "spume/core/random.hpp"
#include "spume/physics/bubbles/coupling.hpp"
#include "spume/physics/bubbles/fluctuations.hpp"

namespace spume::bubbles {
namespace {

using namespace liquid_record;

constexpr std::size_t pack_block = 64;

Vec3 vector_at(const float* from, int slot) {
  return {from[slot], from[slot + 1], from[slot + 2]};
}

Vec3 difference(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

}  // namespace

// Normals of the particles whose kernel a surface cuts: surface particles and their neighbours. Elsewhere the sum of
// (3.13) is the gradient of how crowded the mixture is: at the front of a swarm, where particles that have taken in gas
// have not moved apart yet, its interpolated length reached 0.17 |n0|, and bubbles burst 20 spacings below the surface.
void BubbleCoupling::select_normals() {
  const FreeSurface& surface = *carrier_.surface;
  const NeighbourList& list = carrier_.arrangement.list;
  beside_surface_.resize(carrier_.size());
  beside_surface_.fill(0);
  parallel_for(surface.surface_particles.size(), [&](std::size_t k) {
    const auto mark = [&](std::size_t i) {
      std::atomic_ref<std::uint8_t>(beside_surface_[i]).store(1, std::memory_order_relaxed);
    };
    const auto i = static_cast<std::size_t>(surface.surface_particles[k]);
    mark(i);
    for (const std::int32_t j : list.of(i)) mark(carrier_.arrangement.particle_of(j));
  });
  for (std::size_t a = 0; a < 3; ++a) {
    const float* normal = carrier_.normal[a]->data();
    surface_normal_[a].resize(carrier_.size());
    parallel_for(carrier_.size(),
                 [&](std::size_t i) { surface_normal_[a][i] = beside_surface_[i] != 0 ? normal[i] : 0; });
  }
}

// Normals filtered once where bubbles look at them.
void BubbleCoupling::smooth_normals(PackedNeighbours& packed) {
  if (population_.merge_time == nullptr) return;
  select_normals();
  const bool all = seen_beyond_reach();
  parallel_select(carrier_.size(), near_particles_, [&](std::size_t i) { return all || near_[i] != 0; });
  for (auto& component : smoothed_normal_) component.resize(carrier_.size());
  filter_vector_subset(carrier_.arrangement.context, packed, read(surface_normal_), carrier_.boundary.reflection(),
                       near_particles_, write(smoothed_normal_));
  packed.take_traffic();  // it counts the lists of all particles
}

void BubbleCoupling::pack_liquid() {
  const std::size_t n = carrier_.size(), m = carrier_.arrangement.images.size();
  liquid_records_.resize((n + m) * record);
  inverse_support_radius_.resize(n + m + simd::pair_lanes);
  parallel_blocks(n, pack_block,
                  [&](std::size_t, std::size_t first, std::size_t last) { pack_particles(first, last); });
  pack_images();
}

// One value at a time: more arrays than the processor can read ahead of would be read at once otherwise.
void BubbleCoupling::pack_particles(std::size_t first, std::size_t last) {
  const std::size_t size = last - first;
  bool near = false;
  for (std::size_t i = first; i < last; ++i) {
    inverse_support_radius_[i] = 1 / carrier_.sizes.support_radius[i];
    near = near || near_[i] != 0;
  }
  if (!near && !seen_beyond_reach()) return;
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
    const double *velocity = carrier_.advecting_velocity[a].data() + first,
                 *acceleration = carrier_.material_acceleration[a]->data() + first;
    const float *up = gradient_component(c, b).data() + first, *down = gradient_component(b, c).data() + first;
    put(velocity_at + axis, [=](std::size_t k) { return static_cast<float>(velocity[k]); });
    put(vorticity_at + axis, [=](std::size_t k) { return up[k] - down[k]; });
    put(acceleration_at + axis, [=](std::size_t k) { return static_cast<float>(acceleration[k]); });
    if (population_.merge_time != nullptr) {
      const float* normal = smoothed_normal_[a].data() + first;
      put(normal_at + axis, [=](std::size_t k) { return normal[k]; });
    } else {
      put(normal_at + axis, nothing);
    }
    if (population_.fluctuation[0] == nullptr) continue;
    const float* mean = (*carrier_.filtered_velocity)[a].data() + first;
    for (std::size_t k = 0; k < size; ++k) {
      const double unresolved = velocity[k] - double{mean[k]};
      energy[k] += 0.5 * unresolved * unresolved;
    }
  }
  put(energy_at, [&](std::size_t k) { return static_cast<float>(energy[k]); });
  if (options_.breakup && carrier_.eddy_viscosity != nullptr) {
    const float *viscosity = carrier_.eddy_viscosity->data() + first, *strain = carrier_.strain.data() + first;
    put(dissipation_at, [=](std::size_t k) { return viscosity[k] * strain[k] * strain[k]; });
  } else {
    put(dissipation_at, nothing);
  }
  if (dissolved_slot() >= 0) {
    const double* dissolved = carrier_.dissolved->data() + first;
    put(dissolved_slot(), [=](std::size_t k) { return static_cast<float>(dissolved[k]); });
  }
  put(factor_at, [](std::size_t) { return 1.0F; });
  put(length_at, [&](std::size_t k) { return carrier_.sizes.length_ratio[first + k]; });
}

// Mirrored velocities and what follows from them: at a no-slip wall the vorticity keeps its sign.
void BubbleCoupling::pack_images() {
  const std::size_t n = carrier_.size(), m = carrier_.arrangement.images.size();
  const bool around_boxes = seen_beyond_reach();
  const ImageMap map = carrier_.boundary.image_map(carrier_.arrangement.images);
  const std::int32_t* wall_point =
      carrier_.arrangement.context.walls == nullptr ? nullptr : carrier_.arrangement.images.wall_point();
  parallel_for(m, [&](std::size_t k) {
    const std::size_t source = map.source(k);
    // Other images overlap those, and no place is nearer to one than a support radius of nothing.
    const bool nearest = carrier_.arrangement.images.paths()[map.path(k)].nearest;
    inverse_support_radius_[n + k] = nearest ? inverse_support_radius_[source] : 1e30F;
    if (!around_boxes && near_[source] == 0) return;
    float* value = liquid_records_.data() + (n + k) * record;
    std::copy_n(liquid_records_.data() + source * record, record, value);
    if (wall_point != nullptr && wall_point[k] >= 0)
      return mirror_record(map, k, static_cast<std::size_t>(wall_point[k]), value);
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      value[velocity_at + a] *= map.velocity_sign(k, a);
      if (map.walls_move()) value[velocity_at + a] += value[factor_at] * map.wall_velocity(k, a);
      value[vorticity_at + a] =
          value[factor_at] * (map.velocity_sign(k, c) * map.vector_sign(k, b) * gradient_component(c, b)[source] -
                              map.velocity_sign(k, b) * map.vector_sign(k, c) * gradient_component(b, c)[source]);
      value[acceleration_at + a] *= map.velocity_sign(k, a);
      value[normal_at + a] *= map.vector_sign(k, a);
    }
  });
}

// (3.6) over the sum of its weights; the sum itself tells how much liquid there is.
void BubbleCoupling::interpolate() {
  const std::size_t nb = population_.size();
  interpolated_.resize(nb * record);
  if (exchanges_gas()) dissolved_at_bubble_.resize(nb);
  dead_.resize(nb);
  const int slot = dissolved_slot();
  const CrossSearch search = liquid_search();
  const auto largest_support_radius =
      static_cast<float>(carrier_.arrangement.grid.support_radius() * carrier_.sizes.largest_length_ratio);
  with_kernel(carrier_.arrangement.context, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      const float scale = KernelScale<3, Kernel>(carrier_.arrangement.context).value;
      parallel_blocks(nb, 64, [&](std::size_t, std::size_t first, std::size_t last) {
        thread_local CrossSearch::Found thread_found;
        CrossSearch::Found& found = thread_found;
        for (std::size_t b = first; b < last; ++b) {
          search.near_place({bubble_point_[0][b], bubble_point_[1][b], bubble_point_[2][b]}, largest_support_radius,
                            inverse_support_radius_.data(), found);
          const auto [first_half, second_half] = sum_of_lines<Kernel>(found, liquid_records_.data());
          // In spray: few particles, all at the surface.
          bool dead = found.size < 20 && has_surface();
          for (std::size_t k = 0; dead && k < found.size; ++k) {
            dead = carrier_.surface->at_surface[carrier_.arrangement.particle_of(found.index[k])] != 0;
          }
          dead_[b] = dead ? 1 : 0;
          const float sum = second_half[factor_at - simd::lanes], share = sum > 0 ? 1 / sum : 0;
          float* out = interpolated_.data() + b * record;
          simd::store(out, first_half * share);
          simd::store(out + simd::lanes, second_half * share);
          if (exchanges_gas()) dissolved_at_bubble_[b] = slot >= 0 ? out[slot] : share * sum_of_dissolved(found);
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

// u' of the liquid at bubble b, which sees it pass at `slip`.
Vec3 BubbleCoupling::advance_fluctuation_at(std::size_t b, const Vec3& slip, double dt) {
  const auto noise = random_normal(carrier_.scene.seed, RandomPurpose::bubble_fluctuation,
                                   static_cast<std::uint64_t>((*population_.identifier)[b]),
                                   static_cast<std::uint32_t>(carrier_.steps), 0);
  Vec3 fluctuation;
  for (std::size_t a = 0; a < 3; ++a) fluctuation[a] = (*population_.fluctuation[a])[b];
  const double width = carrier_.resolution.smoothing_length * filter_width_at_bubble(b);
  fluctuation = advance_fluctuation(fluctuation, slip, interpolated_[b * record + energy_at], width,
                                    options_.fluctuation_constant, dt, {noise[0], noise[1], noise[2]});
  for (std::size_t a = 0; a < 3; ++a) (*population_.next_fluctuation[a])[b] = fluctuation[a];
  return fluctuation;
}

// What the surface holds of bubble b; it may burst there.
Braking BubbleCoupling::brake_at_surface(std::size_t b, const Vec3& slip, double radius, double dt) {
  const double t = carrier_.time + dt;
  Vec3 normal = vector_at(interpolated_.data() + b * record, normal_at);
  const double length = std::hypot(normal[0], normal[1], normal[2]);
  for (double& component : normal) component = length > 0 ? component / length : 0;
  const SurfaceContact contact =
      approach_surface(surface_, length / normal_at_surface_, normal, slip, radius, t - (*population_.birth_time)[b],
                       (*population_.merge_time)[b], t, dt);
  next_merge_time_[b] = contact.merge_time;
  if (contact.bursts) dead_[b] = 1;
  return contact.braking;
}

// The next velocity of bubble b, which has u, and what it gives to the liquid.
BubbleCoupling::Moved BubbleCoupling::accelerate(const Gas& gas, std::size_t b, const Surroundings& around,
                                                 const Vec3& u, double radius, const Braking& braking,
                                                 double dt) const {
  const double volume = (*population_.volume)[b];
  Moved moved;
  moved.velocity = options_.integrator == BubbleIntegrator::stable
                       ? advance_stable(gas, radius, around, u, dt, braking)
                       : advance_substepped(gas, radius, around, u, dt, carrier_.resolution.spacing, braking);
  moved.reaction = bubbles::reaction(gas, volume, around, difference(moved.velocity, u), dt,
                                     /*pressure_holds_inertia=*/!mixture_pressure());
  if (options_.surface_reaction == SurfaceReaction::surface && braking.share > 0) {
    double slip_normal = 0;
    for (std::size_t a = 0; a < 3; ++a) slip_normal += (around.velocity[a] - u[a]) * braking.normal[a];
    const Vec3 borne = braking_force(gas, radius, around, moved.velocity, slip_normal, dt, braking);
    for (std::size_t a = 0; a < 3; ++a) moved.reaction[a] += volume * borne[a];
  }
  return moved;
}

void BubbleCoupling::move_bubble(std::size_t b, double dt) {
  const float* here = interpolated_.data() + b * record;
  const double sum = beside_bodies() ? received_weight_[b] : here[factor_at], volume = (*population_.volume)[b],
               radius = radius_of(volume);
  const Vec3 resolved = vector_at(here, velocity_at);
  Surroundings around{resolved, vector_at(here, vorticity_at), vector_at(here, acceleration_at)};
  Vec3 u = resolved;
  if ((*population_.at_rest_in_liquid)[b] == 0)
    for (std::size_t a = 0; a < 3; ++a) u[a] = (*population_.velocity[a])[b];
  if (population_.fluctuation[0] != nullptr) {
    const Vec3 fluctuation = advance_fluctuation_at(b, difference(around.velocity, u), dt);
    for (std::size_t a = 0; a < 3; ++a) around.velocity[a] += fluctuation[a];
  }
  Braking braking;
  if (population_.merge_time != nullptr) braking = brake_at_surface(b, difference(around.velocity, u), radius, dt);
  Moved moved{u, {}};
  if (exchanges_gas()) next_gas_[b] = {{(*population_.oxygen)[b], (*population_.inert)[b]}};
  if (sum > 0) moved = accelerate(gas_, b, around, u, radius, braking, dt);
  if (sum > 0) slide_along_walls(b, around, u, radius, braking, dt, moved);

  float* record_of = bubble_records_.data() + b * 8;  // x y z, M / N (3), viscosity, oxygen / N
  double slip2 = 0, resolved_slip2 = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    (*population_.next_velocity[a])[b] = moved.velocity[a];
    reaction_[a][b] = moved.reaction[a];
    record_of[a] = bubble_point_[a][b];
    record_of[3 + a] = sum > 0 ? static_cast<float>(moved.reaction[a] / sum) : 0.0F;
    slip2 += (around.velocity[a] - moved.velocity[a]) * (around.velocity[a] - moved.velocity[a]);
    resolved_slip2 += (resolved[a] - moved.velocity[a]) * (resolved[a] - moved.velocity[a]);
  }
  next_slip_[b] = std::sqrt(resolved_slip2);
  // Sato & Sekoguchi, King (2.23) with the units of nu.
  record_of[6] = static_cast<float>(options_.viscosity_constant * volume * 2 * radius * std::sqrt(slip2));
  record_of[7] =
      exchanges_gas() && sum > 0 ? dissolve(b, radius, std::sqrt(slip2), dt) / static_cast<float>(sum) : 0.0F;
  if (options_.breakup) dissipation_[b] = here[dissipation_at];
}

void BubbleCoupling::move_bubbles(double dt) {
  const std::size_t nb = population_.size();
  if (options_.breakup) dissipation_.resize(nb);
  next_slip_.resize(nb);
  if (population_.merge_time != nullptr) next_merge_time_.resize(nb);
  for (auto& component : reaction_) component.resize(nb);
  next_gas_.resize(exchanges_gas() ? nb : 0);
  parallel_blocks(nb, 256, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) move_bubble(b, dt);
  });
  float* records = bubble_records_.data();
  parallel_for(images_.size(), [&](std::size_t k) {
    float* out = records + (nb + k) * 8;
    std::copy_n(records + static_cast<std::size_t>(images_.source()[k]) * 8, 8, out);
    if (beside_bodies())
      for (int value = 3; value < 8; ++value) out[value] *= share_of_image(k);
    for (std::size_t a = 0; a < 3; ++a) out[a] = bubble_point_[a][nb + k];
  });
}

template <int components>
void BubbleCoupling::deposit() {
  viscosity_.resize(carrier_.size());
  with_kernel(carrier_.arrangement.context, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      const double h = carrier_.resolution.smoothing_length;
      const auto peak = static_cast<float>(Kernel::normalisation(3) / (h * h * h));
      const auto store = [&](std::size_t i, const float* sums) {
        if (sums == nullptr) {
          for (auto* component : exchange_) (*component)[i] = 0;
          viscosity_[i] = 0;
          if (components > 4) dissolution_[i] = 0;
          return;
        }
        const float inverse = 1 / carrier_.sizes.length_ratio[i], scale = peak * inverse * inverse * inverse;
        // Mass times acceleration is V_i times what arrives per volume: V_i / V_l of it.
        for (std::size_t a = 0; a < 3; ++a) (*exchange_[a])[i] = carrier_.sizes.volume_ratio[i] * (scale * sums[a]);
        viscosity_[i] = scale * sums[3];
        if constexpr (components > 4) dissolution_[i] = carrier_.sizes.volume_ratio[i] * (scale * sums[4]);
      };
      sum_over_points<components, Kernel>(particle_targets(), bubble_search(),
                                          carrier_.arrangement.grid.support_radius(), bubble_records_.data(), store);
    }
  });
}

void BubbleCoupling::exchange_momentum(double dt, PackedNeighbours& packed) {
  if (population_.empty()) {
    for (auto& component : reaction_) component.resize(0);
    next_inner_bursts_ = 0;
    return;
  }
  smooth_normals(packed);
  pack_liquid();
  if (exchanges_gas() && dissolved_slot() < 0) pack_dissolved();
  interpolate();
  if (beside_bodies()) weigh_received();
  move_bubbles(dt);
  next_inner_bursts_ = count_inner_bursts();
  if (!exchanges_gas()) return deposit<4>();
  dissolution_.resize(carrier_.size());
  deposit<5>();
  sum_gas();
}

Vec3 BubbleCoupling::total_reaction() const {
  Vec3 total;
  for (std::size_t a = 0; a < 3; ++a)
    total[a] = parallel_sum(reaction_[a].size(), [&](std::size_t b) { return reaction_[a][b]; });
  return total;
}

}  // namespace spume::bubbles
