// SPDX-License-Identifier: MIT
#include "spume/particles/excess_relaxation.hpp"

#include <algorithm>

#include "spume/core/parallel.hpp"
#include "spume/operators/sph_operators.hpp"
#include "spume/particles/surface.hpp"

namespace spume {
namespace {

// Of the kernel sums, what the relaxation believes at most. A particle in a gap between walls has half of its sum too
// much from their points: its density followed to 1.5, and it left at three times the speed of a free fall (a collapse
// over a cone, 764 steps refused; none with 0.03 and 0.06). Beside a slanted face sums are truly off by more than 0.03:
// still water over a wedge moves with 0.06 sqrt(gH) after 20 sqrt(H/g) with that, with 0.009 with 0.06.
constexpr double believed_excess = 0.06;
// What the disorder of an arrangement makes of single kernel sums: their standard deviation is 0.006 in the stirred
// tank. Evening out less than 0.005 damps: a standing wave 25 spacings deep keeps 0.19 of its kinetic energy after ten
// periods without relaxation and with 0.01, 0.15 if nothing is let be.
constexpr double disorder_of_sums = 0.01;

}  // namespace

ExcessRelaxation::ExcessRelaxation(const Liquid& liquid, double way)
    : volume(liquid.particles.volume * static_cast<double>(liquid.particles.size())),
      liquid_(liquid),
      way_(way * liquid.resolution.spacing),
      start_(parallel_sum(liquid.particles.size(), [&](std::size_t i) { return reduced(i); }) /
             static_cast<double>(std::max<std::size_t>(liquid.particles.size(), 1))),
      lack_(&liquid.particles.fields.add<double>("density_lack", Lifetime::state)) {
  parallel_for(lack_->size(), [&](std::size_t i) { (*lack_)[i] = 0; });
}

double ExcessRelaxation::reduced(std::size_t i) const {
  double head = 0;
  for (int axis = 0; axis < liquid_.particles.dimensions; ++axis)
    head += liquid_.gravity[axis] * ((*liquid_.particles.position[axis])[i] - liquid_.arrangement.origin[axis]);
  const double c = liquid_.law(i).sound_speed;
  return liquid_.excess[i] - head / (c * c);
}

void ExcessRelaxation::measure() {
  ParticleStore& particles = liquid_.particles;
  const std::size_t n = particles.size();
  ScratchPool& scratch = particles.scratch();
  ScratchArray<float> kernel_sum(scratch, n), divergence_of_position(scratch, n);
  KernelMoments moments;
  moments.kernel_sum = kernel_sum.data();
  moments.divergence_of_position = divergence_of_position.data();
  kernel_moment_sweep(liquid_.arrangement.context, liquid_.arrangement.packed,
                      {.shifting = false, .normals = false, .spacing = liquid_.resolution.spacing, .fading = {}},
                      moments);
  const InteriorWeight interior = interior_weight(particles.dimensions, SurfaceOptions{});
  const auto geometric = [&](std::size_t i) { return kernel_sum[i] / liquid_.resolution.lattice.kernel_sum - 1; };
  const auto difference = [&](std::size_t i) {
    return std::clamp(geometric(i), -believed_excess, believed_excess) - (reduced(i) - start_) - rest;
  };
  const auto in_domain = [&](std::size_t i) { return liquid_.left_out == nullptr || (*liquid_.left_out)[i] < 0; };
  struct Sum {
    double weight = 0, difference = 0, volume = 0;
  };
  const Sum total = parallel_reduce(
      n, Sum{},
      [&](std::size_t first, std::size_t last) {
        Sum sum;
        for (std::size_t i = first; i < last; ++i) {
          if (!in_domain(i)) continue;
          const double weight = interior(divergence_of_position[i]);
          sum.weight += weight;
          sum.difference += weight * difference(i);
          sum.volume += weight / (1 + geometric(i)) + 1 - weight;
        }
        return sum;
      },
      [](const Sum& a, const Sum& b) {
        return Sum{a.weight + b.weight, a.difference + b.difference, a.volume + b.volume};
      });
  volume = particles.volume * total.volume;
  const double mean = mean_ = total.difference / std::max(total.weight, 1.0);
  parallel_for(n, [&](std::size_t i) {
    if (!in_domain(i)) return;
    const double local = difference(i) - mean;
    const double uneven = local - std::clamp(local, -disorder_of_sums, disorder_of_sums);
    (*lack_)[i] = mean + interior(divergence_of_position[i]) * uneven;
  });
}

void ExcessRelaxation::take_as_rest() {
  measure();
  rest += mean_;
  measure();
}

double ExcessRelaxation::share_of(double way) const {
  return std::min(1.0, way / way_);
}

}  // namespace spume
