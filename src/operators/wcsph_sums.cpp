// SPDX-License-Identifier: MIT
#include "spume/operators/wcsph_sums.hpp"

#include <stdexcept>

#include "gfd_row.hpp"

namespace spume {
namespace {

using simd::f32n;
using Kernel = WendlandC2;

template <class Body>
void with_wcsph_dimensions(const SweepContext& context, Body&& body) {
  if (context.length_ratio != nullptr || context.kernel != KernelKind::wendland_c2)
    throw std::logic_error("weakly compressible sums take particles of one size and the kernel of Wendland");
  if (context.dimensions == 2)
    body.template operator()<2>();
  else
    body.template operator()<3>();
}

// What pairs differ in: nothing; phases; or also walls, which are of the phase of the particle that they meet.
enum class Phases { one, several, beside_walls };

// In the place of a property, which is never negative.
constexpr float of_wall = -1;

// Walls have the property of the particle itself.
void mark_walls(const SweepContext& context, float* records, int width, int slot) {
  const std::size_t n = context.list->particles();
  const std::int32_t* point = context.images->wall_point();
  if (point == nullptr) return;
  parallel_for(context.images->size(), [&](std::size_t k) {
    if (point[k] >= 0) records[(n + k) * width + context.dimensions + slot] = of_wall;
  });
}

// kappa_ij of the densities of two phases.
[[gnu::always_inline]] inline f32n contrast(f32n own, f32n other) {
  return (other - own) / (other + own);
}

[[gnu::always_inline]] inline f32n equals(f32n a, f32n b, f32n then) {
  return a == b ? then : f32n{};
}

// The gradient (sum w d (x) (u_j - u_i)) (sum w d (x) d)^-1, w < 0, exact for linear velocities on any arrangement: its
// trace, and its product with a vector.
template <int dimensions>
class CorrectedGradient {
 public:
  CorrectedGradient(const std::array<f32n, dimensions * dimensions>& velocity_sum,
                    const std::array<f32n, 6>& moment_sum) {
    std::array<double, 6> m{};
    for (int k = 0; k < dimensions * (dimensions + 1) / 2; ++k) m[k] = -simd::sum(moment_sum[k]);
    scale_ = normalised_inverse<dimensions>(m, inverse_).scale;
    for (int k = 0; k < dimensions * dimensions; ++k) sum_[k] = simd::sum(velocity_sum[k]);
  }
  float divergence() const {
    double trace = 0;
    for (int a = 0; a < dimensions; ++a)
      for (int c = 0; c < dimensions; ++c)
        trace -= inverse_[symmetric_index<dimensions>(a, c)] * sum_[a * dimensions + c];
    return static_cast<float>(scale_ * trace);
  }
  // (v . grad) u_c.
  float along(const float* v, int c) const {
    double result = 0;
    for (int a = 0; a < dimensions; ++a)
      for (int b = 0; b < dimensions; ++b)
        result -= v[a] * inverse_[symmetric_index<dimensions>(a, b)] * sum_[b * dimensions + c];
    return static_cast<float>(scale_ * result);
  }

 private:
  std::array<double, 6> inverse_{};
  std::array<double, dimensions * dimensions> sum_{};
  double scale_ = 0;
};

// Payload of the continuity records: u, v, s', and then what the scene has: mu and the number of phases that differ,
// the velocity under friction, the shifting velocity.
template <int dimensions, bool several, bool viscous, bool friction, bool shifted>
struct ContinuityLayout {
  static constexpr int velocity = 0, volume = dimensions, excess = dimensions + 1;
  static constexpr int viscosity = excess + 1, phase = viscosity + (viscous && several ? 1 : 0);
  static constexpr int held = phase + (several ? 1 : 0);
  static constexpr int shift = held + (friction ? dimensions : 0);
  static constexpr int payload = shift + (shifted ? dimensions : 0);
  static constexpr int width = record_width(dimensions, payload);
};

float own_viscosity(const ContinuityFields& fields, std::size_t i) {
  return fields.viscosity == nullptr ? fields.common_viscosity : fields.viscosity[i];
}

template <int dimensions, Phases phases, bool weighted, bool viscous, bool friction, bool shifted>
void continuity(const SweepContext& context, PackedNeighbours& packed, const ContinuityFields& fields,
                const ContinuityOut& out) {
  constexpr bool several = phases != Phases::one, walls = phases == Phases::beside_walls;
  using At = ContinuityLayout<dimensions, several, viscous, friction, shifted>;
  constexpr int width = At::width;
  float* records = packed.prepare(context, At::payload);
  const auto pack = [&](int slot, const VelocityImageRule& rule) {
    if (fields.acceleration[0] == nullptr)
      pack_velocity(context, records, width, slot, fields.velocity, rule);
    else
      pack_velocity(context, records, width, slot, fields.velocity, fields.acceleration, fields.ahead, rule);
  };
  pack(At::velocity, *fields.mirror);
  pack_scalar(context, records, width, At::volume, fields.volume);
  pack_scalar(context, records, width, At::excess, fields.excess);
  if constexpr (viscous && several) pack_scalar(context, records, width, At::viscosity, fields.viscosity);
  if constexpr (several) pack_scalar(context, records, width, At::phase, fields.phase);
  if constexpr (walls && viscous) mark_walls(context, records, width, At::viscosity);
  if constexpr (walls) mark_walls(context, records, width, At::phase);
  if constexpr (friction) pack(At::held, *fields.friction);
  if constexpr (shifted) pack_vector(context, records, width, At::shift, fields.shift, *fields.reflection);
  const KernelScale<dimensions, Kernel> scale(context);
  sweep(context.list->particles(), [&](std::size_t i) {
    const float* own = records + i * width + dimensions;
    f32n rate{}, diffusion{}, carried{};
    std::array<f32n, dimensions> force{}, flux{};
    std::array<f32n, dimensions * dimensions> velocity_sum{};
    std::array<f32n, 6> moment_sum{};
    for_each_batch<dimensions, At::payload>(*context.list, records, i, scale.inverse_h, [&](const auto& b) {
      const f32n weight = Kernel::f(b.q) * b.payload[At::volume];
      f32n approach{};
      for (int a = 0; a < dimensions; ++a) approach = approach + (b.payload[At::velocity + a] - own[a]) * b.d[a];
      if constexpr (weighted) {
        const f32n own_density = simd::splat<f32n>(own[At::phase]);
        f32n other = b.payload[At::phase];
        if constexpr (walls) other = simd::max(other, f32n{}) + equals(other, simd::splat<f32n>(of_wall), own_density);
        approach = approach + contrast(own_density, other) * approach;
      }
      rate = rate + weight * approach;
      f32n same = weight;
      if constexpr (several) same = equals(b.payload[At::phase], simd::splat<f32n>(own[At::phase]), weight);
      diffusion = diffusion + same * (b.payload[At::excess] - own[At::excess]);
      if constexpr (viscous) {
        f32n drag = weight;
        if constexpr (several) {
          const f32n own_viscosity = simd::splat<f32n>(own[At::viscosity]), other = b.payload[At::viscosity];
          if constexpr (walls)
            drag = drag * (harmonic_mean(own_viscosity, simd::max(other, f32n{})) +
                           equals(other, simd::splat<f32n>(of_wall), own_viscosity));
          else
            drag = drag * harmonic_mean(own_viscosity, other);
        }
        constexpr int u = friction ? At::held : At::velocity;
        for (int a = 0; a < dimensions; ++a) force[a] = force[a] + drag * (b.payload[u + a] - own[a]);
      }
      if constexpr (shifted) {
        f32n own_way{}, other_way{};
        for (int a = 0; a < dimensions; ++a) {
          own_way = own_way + own[At::shift + a] * b.d[a];
          other_way = other_way + b.payload[At::shift + a] * b.d[a];
          const f32n along = weight * b.d[a];
          for (int c = 0; c < dimensions; ++c)
            velocity_sum[a * dimensions + c] =
                velocity_sum[a * dimensions + c] + along * (b.payload[At::velocity + c] - own[c]);
          for (int c = a; c < dimensions; ++c) {
            f32n& sum = moment_sum[symmetric_index<dimensions>(a, c)];
            sum = sum + along * b.d[c];
          }
        }
        own_way = weight * own_way;
        other_way = weight * other_way;
        f32n within = own_way;
        if constexpr (several) within = equals(b.payload[At::phase], simd::splat<f32n>(own[At::phase]), own_way);
        carried = carried + within * (b.payload[At::excess] - own[At::excess]);
        if constexpr (!several)
          for (int a = 0; a < dimensions; ++a)
            flux[a] = flux[a] + own_way * own[a] + other_way * b.payload[At::velocity + a];
      }
    });
    out.rate[i] = scale.gradient * simd::sum(rate);
    out.diffusion[i] = -2 * scale.gradient * simd::sum(diffusion);
    if constexpr (viscous) {
      const float factor = -2 * scale.gradient * (several ? 1 : own_viscosity(fields, i));
      for (int a = 0; a < dimensions; ++a) out.viscous[a][i] = factor * simd::sum(force[a]);
    }
    if constexpr (shifted) {
      const CorrectedGradient<dimensions> gradient(velocity_sum, moment_sum);
      out.rate[i] = -gradient.divergence();
      out.carried[i] = -scale.gradient * simd::sum(carried);
      for (int a = 0; a < dimensions; ++a)
        out.flux[a][i] = several ? gradient.along(own + At::shift, a) : -scale.gradient * simd::sum(flux[a]);
    }
  });
}

template <int dimensions, Phases phases, bool weighted, bool concentrated>
void pressure_force(const SweepContext& context, PackedNeighbours& packed, const PressureFields& fields,
                    const std::array<float*, 3>& out, const std::array<float*, 3>& concentration) {
  constexpr bool several = phases != Phases::one;
  constexpr int payload = several ? 3 : 2, width = record_width(dimensions, payload);
  const std::size_t n = context.list->particles();
  float* records = packed.prepare(context, payload);
  pack_scalar(context, records, width, 0, fields.volume);
  parallel_for(n, [&](std::size_t i) { records[i * width + dimensions + 1] = fields.pressure[i]; });
  const std::int32_t* point = context.walls == nullptr ? nullptr : context.images->wall_point();
  parallel_for(context.images->size(), [&](std::size_t k) {
    const bool of_point = point != nullptr && point[k] >= 0;
    const auto source = static_cast<std::size_t>(of_point ? point[k] : context.images->source()[k]);
    const auto& from = of_point ? fields.wall_position : fields.position;
    double head = 0;
    for (int a = 0; a < dimensions; ++a)
      if (fields.gravity[a] != 0) head += fields.gravity[a] * (context.images->position(a)[k] - from[a][source]);
    records[(n + k) * width + dimensions + 1] =
        of_point
            ? static_cast<float>(fields.wall_pressure[source] + fields.wall_density[source] * head)
            : static_cast<float>(double{fields.pressure[source]} + (head == 0 ? 0 : fields.density[source] * head));
  });
  if constexpr (several) pack_scalar(context, records, width, 2, fields.density);
  if constexpr (phases == Phases::beside_walls) mark_walls(context, records, width, 2);
  const auto h = static_cast<float>(context.smoothing_length);
  const KernelScale<dimensions, Kernel> scale(context);
  sweep(n, [&](std::size_t i) {
    const float* own = records + i * width + dimensions;
    std::array<f32n, dimensions> force{}, crowd{};
    for_each_batch<dimensions, payload>(*context.list, records, i, scale.inverse_h, [&](const auto& b) {
      f32n both = b.payload[1] + own[1];
      if constexpr (several) {
        const f32n zero{}, own_density = simd::splat<f32n>(own[2]);
        f32n other = b.payload[2];
        if constexpr (phases == Phases::beside_walls)
          other = simd::max(other, zero) + equals(other, simd::splat<f32n>(of_wall), own_density);
        if constexpr (weighted) {
          const f32n kappa = contrast(own_density, other);
          both = both + kappa * (own[1] - b.payload[1]);
          both = both + fields.repulsion * simd::max(kappa, zero - kappa) * simd::max(both, zero - both);
        } else {
          const f32n jump = simd::max(other - own_density, own_density - other);
          both = both + fields.repulsion * (jump / (other + own_density)) * simd::max(both, zero - both);
        }
      }
      const f32n share = Kernel::f(b.q) * b.payload[0];
      if constexpr (concentrated)
        for (int a = 0; a < dimensions; ++a) crowd[a] = crowd[a] + share * b.d[a];
      const f32n weight = share * both;
      for (int a = 0; a < dimensions; ++a) force[a] = force[a] + weight * b.d[a];
    });
    for (int a = 0; a < dimensions; ++a) {
      const float other = fields.others[a] == nullptr ? 0 : fields.others[a][i];
      out[a][i] = other + scale.gradient * simd::sum(force[a]);
    }
    if constexpr (concentrated)
      for (int a = 0; a < dimensions; ++a) concentration[a][i] = -h * scale.gradient * simd::sum(crowd[a]);
  });
}

}  // namespace

void continuity_sweep(const SweepContext& context, PackedNeighbours& packed, const ContinuityFields& fields,
                      const ContinuityOut& out) {
  with_wcsph_dimensions(context, [&]<int dimensions>() {
    const auto run = [&]<Phases phases, bool weighted, bool shifted>() {
      if (fields.viscosity == nullptr && fields.common_viscosity == 0)
        continuity<dimensions, phases, weighted, false, false, shifted>(context, packed, fields, out);
      else if (fields.friction == nullptr)
        continuity<dimensions, phases, weighted, true, false, shifted>(context, packed, fields, out);
      else
        continuity<dimensions, phases, weighted, true, true, shifted>(context, packed, fields, out);
    };
    const auto of = [&]<Phases phases>() {
      if (fields.shift[0] != nullptr)
        run.template operator()<phases, false, true>();
      else if (phases != Phases::one && fields.weighted)
        run.template operator()<phases, phases != Phases::one, false>();
      else
        run.template operator()<phases, false, false>();
    };
    if (fields.phase == nullptr)
      of.template operator()<Phases::one>();
    else if (context.walls != nullptr)
      of.template operator()<Phases::beside_walls>();
    else
      of.template operator()<Phases::several>();
  });
}

void pressure_force_sweep(const SweepContext& context, PackedNeighbours& packed, const PressureFields& fields,
                          const std::array<float*, 3>& out, const std::array<float*, 3>& concentration) {
  with_wcsph_dimensions(context, [&]<int dimensions>() {
    const auto of = [&]<Phases phases>() {
      if (concentration[0] != nullptr)
        pressure_force<dimensions, phases, false, true>(context, packed, fields, out, concentration);
      else if (phases != Phases::one && fields.weighted)
        pressure_force<dimensions, phases, phases != Phases::one, false>(context, packed, fields, out, concentration);
      else
        pressure_force<dimensions, phases, false, false>(context, packed, fields, out, concentration);
    };
    if (!fields.several)
      of.template operator()<Phases::one>();
    else if (context.walls != nullptr)
      of.template operator()<Phases::beside_walls>();
    else
      of.template operator()<Phases::several>();
  });
}

void tension_force_sweep(const SweepContext& context, PackedNeighbours& packed, const InterfaceBands& bands,
                         const TensionFields& fields, const std::array<float*, 3>& out) {
  if (bands.mixed().empty()) return;
  if (context.walls != nullptr) throw std::logic_error("tension has no values at wall points");
  with_wcsph_dimensions(context, [&]<int dimensions>() {
    constexpr int width = record_width(dimensions, 3);
    float* records = packed.prepare(context, 3);
    pack_scalar(context, records, width, 0, fields.volume);
    pack_scalar(context, records, width, 1, fields.colour);
    pack_scalar(context, records, width, 2, fields.potential);
    const KernelScale<dimensions, Kernel> scale(context);
    sweep(bands.mixed().size(), [&](std::size_t s) {
      const auto i = static_cast<std::size_t>(bands.mixed()[s]);
      const float* own = records + i * width + dimensions;
      std::array<f32n, dimensions> force{};
      for_each_batch<dimensions, 3>(*context.list, records, i, scale.inverse_h, [&](const auto& b) {
        const f32n weight = Kernel::f(b.q) * b.payload[0] * (b.payload[2] + own[2]) * (b.payload[1] - own[1]);
        for (int a = 0; a < dimensions; ++a) force[a] = force[a] + weight * b.d[a];
      });
      // The mean of the potentials has a factor 1/2.
      for (int a = 0; a < dimensions; ++a) out[a][i] -= scale.gradient / 2 * simd::sum(force[a]);
    });
  });
}

void density_filter_sweep(const SweepContext& context, PackedNeighbours& packed, const float* volume,
                          const float* phase, float* out) {
  with_wcsph_dimensions(context, [&]<int dimensions>() {
    constexpr int width = record_width(dimensions, 2);
    float* records = packed.prepare(context, 2);
    pack_scalar(context, records, width, 0, volume);
    pack_scalar(context, records, width, 1, phase);
    const KernelScale<dimensions, Kernel> scale(context);
    sweep(context.list->particles(), [&](std::size_t i) {
      const float* own = records + i * width + dimensions;
      f32n lack{}, sum{};
      for_each_batch<dimensions, 2>(*context.list, records, i, scale.inverse_h, [&](const auto& b) {
        const f32n w = equals(b.payload[1], simd::splat<f32n>(own[1]), Kernel::w(b.q));
        sum = sum + w * b.payload[0];
        lack = lack + w * (1.0F - b.payload[0]);
      });
      out[i] = (simd::sum(lack) + (1 - own[0])) / (simd::sum(sum) + own[0]);
    });
  });
}

}  // namespace spume
