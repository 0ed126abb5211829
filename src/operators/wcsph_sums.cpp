// SPDX-License-Identifier: MIT
#include "spume/operators/wcsph_sums.hpp"

#include <stdexcept>

#include "gfd_row.hpp"
#include "spume/core/joined_lanes.hpp"

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
enum class Drag { none, of_one_viscosity, of_viscosities };

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

// The sums of a block of particles that gradients (sum w d (x) (u_j - u_i)) (sum w d (x) d)^-1 follow from, w < 0,
// which are exact for linear velocities on any arrangement. A vector of particles at a time: one by one this takes a
// sixth of the sweep.
template <int dimensions, bool several>
class CorrectedGradients {
 public:
  static constexpr int symmetric = dimensions * (dimensions + 1) / 2;
  // Of one phase the symmetric part, that beside the diagonal twice.
  static constexpr int products = several ? dimensions * dimensions : symmetric;

  // sum: the products, then the moments.
  void keep(std::size_t k, const float* sum) {
    for (int c = 0; c < products + symmetric; ++c) sum_[c][k] = sum[c];
  }
  // As normalised_inverse() has them.
  void invert(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      double m[symmetric], trace = 0;
      for (int c = 0; c < symmetric; ++c) m[c] = -sum_[products + c][k];
      for (int a = 0; a < dimensions; ++a) trace += m[symmetric_index<dimensions>(a, a)];
      const double scale = trace > 0 ? dimensions / trace : 0;
      for (double& entry : m) entry *= scale;
      double cofactor[symmetric], determinant, squares;
      if constexpr (dimensions == 2) {
        cofactor[0] = m[2];
        cofactor[1] = -m[1];
        cofactor[2] = m[0];
        determinant = m[0] * m[2] - m[1] * m[1];
        squares = m[0] * m[0] + 2 * m[1] * m[1] + m[2] * m[2];
      } else {
        cofactor[0] = m[3] * m[5] - m[4] * m[4];
        cofactor[1] = m[2] * m[4] - m[1] * m[5];
        cofactor[2] = m[1] * m[4] - m[2] * m[3];
        cofactor[3] = m[0] * m[5] - m[2] * m[2];
        cofactor[4] = m[1] * m[2] - m[0] * m[4];
        cofactor[5] = m[0] * m[3] - m[1] * m[1];
        determinant = m[0] * cofactor[0] + m[1] * cofactor[1] + m[2] * cofactor[2];
        squares = cofactor[0] * cofactor[0] + cofactor[3] * cofactor[3] + cofactor[5] * cofactor[5] +
                  2 * (cofactor[1] * cofactor[1] + cofactor[2] * cofactor[2] + cofactor[4] * cofactor[4]);
      }
      constexpr double bound = dimensions * largest_correction * largest_correction;
      const bool inverted = (determinant > singular) & (squares < bound * determinant * determinant);
      const double factor = inverted ? scale / determinant : 0, identity = inverted ? 0 : scale;
      for (int c = 0; c < symmetric; ++c) inverse_[c][k] = factor * cofactor[c];
      for (int a = 0; a < dimensions; ++a) inverse_[symmetric_index<dimensions>(a, a)][k] += identity;
    }
  }
  float divergence(std::size_t k) const {
    double trace = 0;
    for (int a = 0; a < dimensions; ++a)
      for (int c = several ? 0 : a; c < dimensions; ++c) {
        const int at = symmetric_index<dimensions>(a, c);
        trace -= inverse_[at][k] * sum_[several ? a * dimensions + c : at][k];
      }
    return static_cast<float>(trace);
  }
  // (v . grad) u_c.
  float along(std::size_t k, const float* v, int c) const {
    double result = 0;
    for (int a = 0; a < dimensions; ++a)
      for (int b = 0; b < dimensions; ++b)
        result -= v[a] * inverse_[symmetric_index<dimensions>(a, b)][k] * sum_[b * dimensions + c][k];
    return static_cast<float>(result);
  }

 private:
  alignas(64) float sum_[products + symmetric][sweep_block];
  alignas(64) double inverse_[symmetric][sweep_block];
};

struct NoGradients {};

// Where the sums over the neighbours stand: those of the rate and the diffusion, the viscous force, what the shift
// carries, of one phase its flux, products of distances with changes of velocity (of one phase their symmetric part,
// the diagonal once), products of distances.
template <int dimensions, bool several, bool viscous, bool shifted>
struct ContinuitySums {
  using Gradients = CorrectedGradients<dimensions, several>;
  static constexpr int diffusion = 0, rate = 1, force = rate + (shifted ? 0 : 1);
  static constexpr int carried = force + (viscous ? dimensions : 0), flux = carried + (shifted ? 1 : 0);
  static constexpr int gradient = flux + (shifted && !several ? dimensions : 0);
  static constexpr int moment = gradient + (shifted ? Gradients::products : 0);
  static constexpr int count = moment + (shifted ? Gradients::symmetric : 0);
};

// Payload of the continuity records: u, v, s', and then what the scene has: mu and the number of phases that differ,
// the velocity under friction, the shifting velocity.
template <int dimensions, bool several, bool viscosities, bool friction, bool shifted>
struct ContinuityLayout {
  static constexpr int velocity = 0, volume = dimensions, excess = dimensions + 1;
  static constexpr int viscosity = excess + 1, phase = viscosity + (viscosities ? 1 : 0);
  static constexpr int held = phase + (several ? 1 : 0);
  static constexpr int shift = held + (friction ? dimensions : 0);
  static constexpr int payload = shift + (shifted ? dimensions : 0);
  static constexpr int width = record_width(dimensions, payload);
};

float own_viscosity(const ContinuityFields& fields, std::size_t i) {
  return fields.viscosity == nullptr ? fields.common_viscosity : fields.viscosity[i];
}

template <int dimensions, Phases phases, bool weighted, Drag of, bool friction, bool shifted>
void continuity(const SweepContext& context, PackedNeighbours& packed, const ContinuityFields& fields,
                const ContinuityOut& out) {
  constexpr bool several = phases != Phases::one, walls = phases == Phases::beside_walls;
  constexpr bool viscous = of != Drag::none, viscosities = of == Drag::of_viscosities;
  using At = ContinuityLayout<dimensions, several, viscosities, friction, shifted>;
  using In = ContinuitySums<dimensions, several, viscous, shifted>;
  constexpr int width = At::width;
  float* records = packed.prepare(context, At::payload);
  const auto pack = [&](int slot, const VelocityImageRule& rule, bool of_walls) {
    if (fields.acceleration[0] == nullptr)
      pack_velocity(context, records, width, slot, fields.velocity, rule, of_walls);
    else
      pack_velocity(context, records, width, slot, fields.velocity, fields.acceleration, fields.ahead, rule);
  };
  pack(At::velocity, *fields.mirror, fields.walls_move);
  pack_scalar(context, records, width, At::volume, fields.volume);
  pack_scalar(context, records, width, At::excess, fields.excess);
  if constexpr (viscosities) pack_scalar(context, records, width, At::viscosity, fields.viscosity);
  if constexpr (several) pack_scalar(context, records, width, At::phase, fields.phase);
  if constexpr (walls && viscosities) mark_walls(context, records, width, At::viscosity);
  if constexpr (walls) mark_walls(context, records, width, At::phase);
  if constexpr (friction) pack(At::held, *fields.friction, false);
  if constexpr (shifted) pack_vector(context, records, width, At::shift, fields.shift, *fields.reflection);
  const KernelScale<dimensions, Kernel> scale(context);
  const auto of_particle = [&](std::size_t i, [[maybe_unused]] auto& gradients, [[maybe_unused]] std::size_t k) {
    const float* own = records + i * width + dimensions;
    std::array<f32n, In::count> sum{};
    for_each_batch<dimensions, At::payload>(
        *context.list, records, i, scale.inverse_h, [&](const auto& b) __attribute__((always_inline)) {
          const f32n weight = Kernel::f(b.q) * b.payload[At::volume];
          f32n approach{};
          std::array<f32n, dimensions> change;
          unrolled<dimensions>([&](auto a) __attribute__((always_inline)) {
            change[a] = b.payload[At::velocity + a] - own[a];
            approach = approach + change[a] * b.d[a];
          });
          if constexpr (weighted) {
            const f32n own_density = simd::splat<f32n>(own[At::phase]);
            f32n other = b.payload[At::phase];
            if constexpr (walls)
              other = simd::max(other, f32n{}) + equals(other, simd::splat<f32n>(of_wall), own_density);
            approach = approach + contrast(own_density, other) * approach;
          }
          if constexpr (!shifted) sum[In::rate] = sum[In::rate] + weight * approach;
          f32n same = weight;
          if constexpr (several) same = equals(b.payload[At::phase], simd::splat<f32n>(own[At::phase]), weight);
          const f32n rise = b.payload[At::excess] - own[At::excess];
          sum[In::diffusion] = sum[In::diffusion] + same * rise;
          if constexpr (viscous) {
            f32n drag = weight;
            if constexpr (viscosities) {
              const f32n own_viscosity = simd::splat<f32n>(own[At::viscosity]), other = b.payload[At::viscosity];
              if constexpr (walls)
                drag = drag * (harmonic_mean(own_viscosity, simd::max(other, f32n{})) +
                               equals(other, simd::splat<f32n>(of_wall), own_viscosity));
              else
                drag = drag * harmonic_mean(own_viscosity, other);
            }
            unrolled<dimensions>([&](auto a) __attribute__((always_inline)) {
              f32n slip = change[a];
              if constexpr (friction) slip = b.payload[At::held + a] - own[a];
              sum[In::force + a] = sum[In::force + a] + drag * slip;
            });
          }
          if constexpr (shifted) {
            f32n own_way{}, other_way{};
            unrolled<dimensions>([&](auto a) __attribute__((always_inline)) {
              own_way = own_way + own[At::shift + a] * b.d[a];
              other_way = other_way + b.payload[At::shift + a] * b.d[a];
              const f32n along = weight * b.d[a];
              unrolled<dimensions>([&](auto c) __attribute__((always_inline)) {
                constexpr int at = symmetric_index<dimensions>(a, c);
                f32n& product = sum[In::gradient + (several ? a * dimensions + c : at)];
                product = product + along * change[c];
                if constexpr (a <= c) sum[In::moment + at] = sum[In::moment + at] + along * b.d[c];
              });
            });
            own_way = weight * own_way;
            other_way = weight * other_way;
            f32n within = own_way;
            if constexpr (several) within = equals(b.payload[At::phase], simd::splat<f32n>(own[At::phase]), own_way);
            sum[In::carried] = sum[In::carried] + within * rise;
            if constexpr (!several)
              unrolled<dimensions>([&](auto a) __attribute__((always_inline)) {
                sum[In::flux + a] = sum[In::flux + a] + own_way * own[a] + other_way * b.payload[At::velocity + a];
              });
          }
        });
    const std::array<float, In::count> total = simd::sums_of(sum);
    if constexpr (!shifted) out.rate[i] = scale.gradient * total[In::rate];
    out.diffusion[i] = -2 * scale.gradient * total[In::diffusion];
    if constexpr (viscous) {
      const float factor = -2 * scale.gradient * (viscosities ? 1 : own_viscosity(fields, i));
      for (int a = 0; a < dimensions; ++a) out.viscous[a][i] = factor * total[In::force + a];
    }
    if constexpr (shifted) {
      out.carried[i] = -scale.gradient * total[In::carried];
      if constexpr (!several)
        for (int a = 0; a < dimensions; ++a) out.flux[a][i] = -scale.gradient * total[In::flux + a];
      gradients.keep(k, total.data() + In::gradient);
    }
  };
  sweep_blocks(context.list->particles(), [&](std::size_t first, std::size_t last) {
    if constexpr (shifted) {
      typename In::Gradients gradients;
      for (std::size_t i = first; i < last; ++i) of_particle(i, gradients, i - first);
      gradients.invert(last - first);
      for (std::size_t i = first; i < last; ++i) out.rate[i] = -gradients.divergence(i - first);
      if constexpr (several)
        for (std::size_t i = first; i < last; ++i)
          for (int a = 0; a < dimensions; ++a)
            out.flux[a][i] = gradients.along(i - first, records + i * width + dimensions + At::shift, a);
    } else {
      NoGradients none;
      for (std::size_t i = first; i < last; ++i) of_particle(i, none, 0);
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
    double head = 0, out_of_it = 0;
    for (int a = 0; a < dimensions; ++a) {
      if (fields.gravity[a] == 0) continue;
      const double way = context.images->position(a)[k] - from[a][source];
      head += fields.gravity[a] * way;
      out_of_it += fields.left_out[a] * way;
    }
    records[(n + k) * width + dimensions + 1] =
        of_point ? static_cast<float>(fields.wall_pressure[source] + fields.wall_density[source] * head - out_of_it)
                 : static_cast<float>(double{fields.pressure[source]} +
                                      (head == 0 ? 0 : fields.density[source] * head - out_of_it));
  });
  if constexpr (several) pack_scalar(context, records, width, 2, fields.density);
  if constexpr (phases == Phases::beside_walls) mark_walls(context, records, width, 2);
  std::array<float, dimensions> left_out;
  for (int a = 0; a < dimensions; ++a) left_out[a] = static_cast<float>(fields.left_out[a]);
  const auto h = static_cast<float>(context.smoothing_length);
  const KernelScale<dimensions, Kernel> scale(context);
  sweep(n, [&](std::size_t i) {
    const float* own = records + i * width + dimensions;
    std::array<f32n, concentrated ? 2 * dimensions : dimensions> sum{};
    for_each_batch<dimensions, payload>(
        *context.list, records, i, scale.inverse_h, [&](const auto& b) __attribute__((always_inline)) {
          f32n both = b.payload[1] + own[1];
          if constexpr (several) {
            const f32n zero{}, own_density = simd::splat<f32n>(own[2]);
            f32n other = b.payload[2];
            if constexpr (phases == Phases::beside_walls)
              other = simd::max(other, zero) + equals(other, simd::splat<f32n>(of_wall), own_density);
            if constexpr (weighted) {
              const f32n kappa = contrast(own_density, other);
              f32n difference = own[1] - b.payload[1];
              unrolled<dimensions>([&](auto a) __attribute__((always_inline)) {
                difference = difference - left_out[a] * b.d[a];
              });
              both = both + kappa * difference;
              both = both + fields.repulsion * simd::max(kappa, zero - kappa) * simd::max(both, zero - both);
            } else {
              const f32n jump = simd::max(other - own_density, own_density - other);
              both = both + fields.repulsion * (jump / (other + own_density)) * simd::max(both, zero - both);
            }
          }
          const f32n gradient = Kernel::f(b.q);
          if constexpr (concentrated) {
            const f32n share = gradient * b.payload[0];
            unrolled<dimensions>([&](auto a) __attribute__((always_inline)) {
              sum[dimensions + a] = sum[dimensions + a] + share * b.d[a];
            });
          }
          // The kernel comes last of what this waits for.
          const f32n weight = gradient * (b.payload[0] * both);
          unrolled<dimensions>([&](auto a) __attribute__((always_inline)) { sum[a] = sum[a] + weight * b.d[a]; });
        });
    const auto total = simd::sums_of(sum);
    for (int a = 0; a < dimensions; ++a) {
      const float other = fields.others[a] == nullptr ? 0 : fields.others[a][i];
      out[a][i] = other + scale.gradient * total[a];
      if constexpr (concentrated) concentration[a][i] = -h * scale.gradient * total[dimensions + a];
    }
  });
}

}  // namespace

void continuity_sweep(const SweepContext& context, PackedNeighbours& packed, const ContinuityFields& fields,
                      const ContinuityOut& out) {
  with_wcsph_dimensions(context, [&]<int dimensions>() {
    const auto run = [&]<Phases phases, bool weighted, bool shifted>() {
      const auto with = [&]<Drag of, bool friction>() {
        continuity<dimensions, phases, weighted, of, friction, shifted>(context, packed, fields, out);
      };
      if (fields.viscosity == nullptr && fields.common_viscosity == 0)
        return with.template operator()<Drag::none, false>();
      if constexpr (phases != Phases::one)
        if (phases == Phases::several || fields.viscosity != nullptr)
          return fields.friction == nullptr ? with.template operator()<Drag::of_viscosities, false>()
                                            : with.template operator()<Drag::of_viscosities, true>();
      if constexpr (phases != Phases::several)
        return fields.friction == nullptr ? with.template operator()<Drag::of_one_viscosity, false>()
                                          : with.template operator()<Drag::of_one_viscosity, true>();
    };
    const auto of = [&]<Phases phases>() {
      if (fields.shift[0] != nullptr)
        run.template operator()<phases, false, true>();
      else if (phases != Phases::one && fields.weighted)
        run.template operator()<phases, phases != Phases::one, false>();
      else
        run.template operator()<phases, false, false>();
    };
    // A viscosity of all is that of one phase, in which without walls nothing differs.
    const bool of_one_phase = fields.viscosity == nullptr && fields.common_viscosity > 0;
    if (fields.phase == nullptr || (of_one_phase && context.walls == nullptr))
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
      if (concentration[0] != nullptr && phases != Phases::one && fields.weighted)
        pressure_force<dimensions, phases, phases != Phases::one, true>(context, packed, fields, out, concentration);
      else if (concentration[0] != nullptr)
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
