// SPDX-License-Identifier: MIT
// What bubbles feel of the liquid, how they move, and what they return to it.
#include <algorithm>
#include <cmath>

#include "spume/core/random.hpp"
#include "spume/methods/les_sph/bubble_coupling.hpp"
#include "spume/physics/bubbles/fluctuations.hpp"

namespace spume::les_sph {
namespace {

using simd::f32x8;

// A point of the liquid for bubbles: x y z 1/h | V/V_l (h0/h)^3 and padding | 16 values.
constexpr int record = 24, values_at = 8, values = 16;
// The values: velocity, vorticity, Du/Dt, unresolved energy, dissipation, normal.
constexpr int velocity_at = 0, vorticity_at = 3, acceleration_at = 6, energy_at = 9, dissipation_at = 10,
              normal_at = 11;
// Per bubble: kernel sum, then the interpolated values.
constexpr int interpolated = 1 + values;

Vec3 vector_at(const float* from, int slot) {
  return {from[slot], from[slot + 1], from[slot + 2]};
}

}  // namespace

// Normals filtered once where bubbles look at them.
void BubbleCoupling::smooth_normals(Liquid& liquid) {
  if (population_.merge_time == nullptr) return;
  // In particle order, by blocks: counted, then written.
  const std::size_t n = liquid.size();
  std::array<std::size_t, max_reduction_blocks + 1> start{};
  const std::size_t size = std::max<std::size_t>(4096, (n + max_reduction_blocks - 1) / max_reduction_blocks);
  parallel_blocks(n, size, [&](std::size_t block, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) start[block + 1] += bubbles_of_.count(i) > 0 ? 1 : 0;
  });
  for (std::size_t block = 0; block < block_count(n, size); ++block) start[block + 1] += start[block];
  near_bubbles_.resize(start[block_count(n, size)]);
  parallel_blocks(n, size, [&](std::size_t block, std::size_t first, std::size_t last) {
    std::size_t slot = start[block];
    for (std::size_t i = first; i < last; ++i)
      if (bubbles_of_.count(i) > 0) near_bubbles_[slot++] = static_cast<std::int32_t>(i);
  });
  filter_vector_subset(liquid.context, liquid.records, liquid.read(liquid.normal), liquid.reflection, near_bubbles_,
                       liquid.write(liquid.smoothed_normal));
}

void BubbleCoupling::pack_liquid(Liquid& liquid) {
  const std::size_t n = liquid.size(), m = liquid.images.size();
  liquid_records_.resize((n + m) * record);
  const auto& gradient = liquid.velocity_gradient;
  const bool filtered = liquid.plan.test_filter, eddies = liquid.eddy_viscosity != nullptr;
  const bool normals = population_.merge_time != nullptr;
  const auto inverse_h = static_cast<float>(1 / liquid.smoothing_length);
  parallel_for(n, [&](std::size_t i) {
    if (bubbles_of_.count(i) == 0) return;
    float* out = liquid_records_.data() + i * record;
    const float inverse = 1 / liquid.length_ratio[i];
    for (std::size_t a = 0; a < 3; ++a) out[a] = point_[a][i];
    out[3] = inverse * inverse_h;
    out[4] = liquid.volume_ratio[i] * inverse * inverse * inverse;
    float* value = out + values_at;
    double energy = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      value[velocity_at + a] = static_cast<float>((*liquid.velocity[a])[i]);
      value[vorticity_at + a] = (*gradient[c * 3 + b])[i] - (*gradient[b * 3 + c])[i];
      value[acceleration_at + a] = static_cast<float>((*liquid.material_acceleration[a])[i]);
      value[normal_at + a] = normals ? (*liquid.smoothed_normal[a])[i] : 0.0F;
      if (!filtered) continue;
      const double unresolved = (*liquid.velocity[a])[i] - double{(*liquid.filtered_velocity[a])[i]};
      energy += 0.5 * unresolved * unresolved;
    }
    const float strain = (*liquid.strain)[i];
    value[energy_at] = static_cast<float>(energy);
    value[dissipation_at] = eddies ? (*liquid.eddy_viscosity)[i] * strain * strain : 0.0F;
    value[14] = value[15] = 0;
  });
  // Mirrored velocities, and pseudo-vectors the other way.
  parallel_for(m, [&](std::size_t k) {
    const auto source = static_cast<std::size_t>(liquid.images.source()[k]);
    if (bubbles_of_.count(source) == 0) return;
    const auto path = static_cast<std::size_t>(liquid.images.path()[k]);
    float* out = liquid_records_.data() + (n + k) * record;
    const float* in = liquid_records_.data() + source * record;
    std::copy_n(in, record, out);
    const auto& sign = liquid.velocity_rule.sign[path];
    const auto& mirror = liquid.reflection[path];
    const float handedness = mirror[0] * mirror[1] * mirror[2];
    for (std::size_t a = 0; a < 3; ++a) {
      out[a] = point_[a][n + k];
      float* value = out + values_at;
      value[velocity_at + a] *= sign[a];
      if (!liquid.velocity_rule.offset[a].empty()) value[velocity_at + a] += liquid.velocity_rule.offset[a][k];
      value[vorticity_at + a] *= handedness * mirror[a];
      value[acceleration_at + a] *= sign[a];
      value[normal_at + a] *= mirror[a];
    }
  });
}

// (3.6) over the sum of its weights; the sum itself tells how much liquid there is.
void BubbleCoupling::interpolate(const Liquid& liquid) {
  const std::size_t nb = population_.size(), n = liquid.size();
  interpolated_.resize(nb * interpolated);
  dead_.resize(nb);
  const float* records = liquid_records_.data();
  with_kernel(liquid.context, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      const KernelScale<3, Kernel> scale(liquid.context);
      parallel_blocks_dynamic(nb, 64, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b) {
          const float x = bubble_point_[0][b], y = bubble_point_[1][b], z = bubble_point_[2][b];
          f32x8 low{}, high{};
          float sum = 0;
          bool all_at_surface = true;
          const auto list = particles_of_.of(b);
          for (std::size_t from = 0; from < list.size(); from += simd::lanes) {
            // Eight weights at a time, then the values of each.
            std::int32_t index[simd::lanes];
            const std::size_t part = std::min<std::size_t>(simd::lanes, list.size() - from);
            for (std::size_t l = 0; l < simd::lanes; ++l) index[l] = list[from + (l < part ? l : 0)];
            f32x8 place[4], rest[4];
            simd::load_records<record>(records, index, 0, place);
            simd::load_records<record>(records, index, 1, rest);
            const f32x8 dx = place[0] - x, dy = place[1] - y, dz = place[2] - z;
            const f32x8 weight = rest[0] * Kernel::w(simd::sqrt(dx * dx + dy * dy + dz * dz) * place[3]) * scale.value;
            for (std::size_t l = 0; l < part; ++l) {
              const float* value = records + static_cast<std::int64_t>(index[l]) * record + values_at;
              const float w = weight[static_cast<int>(l)];
              sum += w;
              low = low + w * simd::load(value);
              high = high + w * simd::load(value + simd::lanes);
            }
          }
          // In spray: few particles, all at the surface.
          const bool few = list.size() < 20 && liquid.plan.free_surface;
          for (std::size_t l = 0; few && l < list.size() && all_at_surface; ++l) {
            const auto j = static_cast<std::size_t>(list[l]);
            const std::size_t i = j < n ? j : static_cast<std::size_t>(liquid.images.source()[j - n]);
            all_at_surface = liquid.at_surface[i] != 0;
          }
          dead_[b] = few && all_at_surface ? 1 : 0;
          float* out = interpolated_.data() + b * interpolated;
          out[0] = sum;
          const float share = sum > 0 ? 1 / sum : 0;
          simd::store(out + 1, low * share);
          simd::store(out + 1 + simd::lanes, high * share);
        }
      });
    }
  });
}

void BubbleCoupling::move_bubbles(Liquid& liquid, double dt) {
  const std::size_t nb = population_.size();
  const double t = liquid.time + dt;
  const bool two_fluid = !liquid.plan.mixture_pressure;
  const bool surface = population_.merge_time != nullptr, turbulent = population_.fluctuation[0] != nullptr;
  const double width = liquid.smoothing_length;
  const auto step = static_cast<std::uint32_t>(liquid.steps);
  dissipation_.resize(nb);
  next_slip_.resize(nb);
  if (surface) next_merge_time_.resize(nb);
  for (auto& component : reaction_) component.resize(nb);
  float* records = bubble_records_.data();  // x y z, M / N (3), viscosity, nothing
  parallel_blocks_dynamic(nb, 256, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      const float* values_here = interpolated_.data() + b * interpolated + 1;
      const double sum = interpolated_[b * interpolated];
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
  float* nobody = records + (nb + images_.size()) * 8;
  for (int c = 0; c < 8; ++c) nobody[c] = c < 3 ? 1e6F * liquid.reach[0] : 0.0F;
}

void BubbleCoupling::deposit(Liquid& liquid) {
  const std::size_t n = liquid.size();
  const float* records = bubble_records_.data();
  liquid.bubble_viscosity.resize(n);
  with_kernel(liquid.context, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      const double h = liquid.smoothing_length;
      const auto peak = static_cast<float>(Kernel::normalisation(3) / (h * h * h));
      sweep(n, [&](std::size_t i) {
        std::array<float, 4> total{};
        if (bubbles_of_.count(i) > 0) {
          const float inverse = 1 / liquid.length_ratio[i];
          const float inverse_h = inverse / static_cast<float>(h);
          std::array<f32x8, 4> sum{};
          for (const std::int32_t* k = bubbles_of_.begin(i); k != bubbles_of_.padded_end(i); k += simd::lanes) {
            f32x8 v[8];
            simd::load_records<8>(records, k, 0, v);
            simd::load_records<8>(records, k, 1, v + 4);
            f32x8 r2{};
            for (std::size_t a = 0; a < 3; ++a) {
              const f32x8 offset = v[a] - point_[a][i];
              r2 = r2 + offset * offset;
            }
            const f32x8 w = Kernel::w(simd::sqrt(r2) * inverse_h);
            for (std::size_t c = 0; c < 4; ++c) sum[c] = sum[c] + w * v[3 + c];
          }
          const float scale = peak * inverse * inverse * inverse;
          for (std::size_t c = 0; c < 4; ++c) total[c] = scale * simd::sum(sum[c]);
        }
        // Mass times acceleration is V_i times what arrives per volume: V_i / V_l of it.
        for (std::size_t a = 0; a < 3; ++a) (*liquid.exchange[a])[i] = liquid.volume_ratio[i] * total[a];
        liquid.bubble_viscosity[i] = total[3];
      });
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
