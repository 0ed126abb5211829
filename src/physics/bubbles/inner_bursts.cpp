// SPDX-License-Identifier: MIT
// Bubbles that burst although there is liquid before them.
#include <algorithm>
#include <cmath>

#include "liquid_record.hpp"
#include "spume/core/vectors.hpp"
#include "spume/physics/bubbles/coupling.hpp"

namespace spume::bubbles {
namespace {

// Places looked at, a smoothing length (1.3 spacings) apart. Bubbles feel a plane surface from 3 spacings below it, so
// that the third place and those behind it lie in the air.
constexpr int places = 5;
// That many outside of the liquid, one after the other, are air: a gap of 3 spacings and more, which kernels from both
// sides do not bridge.
constexpr int places_of_air = 2;
// The kernel sum over the volumes of particles and their gas is 1 in the mixture and 1/2 on its surface.
constexpr double surface_sum = 0.5;

}  // namespace

// sum_i V_i W(r - r_i, h_i) at r = origin + place.
double BubbleCoupling::mixture_at(const CrossSearch& search, const std::array<float, 3>& place) const {
  thread_local CrossSearch::Found thread_found;
  CrossSearch::Found& found = thread_found;
  const ParticleSizes& sizes = carrier_.sizes;
  search.near_place(place, static_cast<float>(carrier_.arrangement.grid.support_radius() * sizes.largest_length_ratio),
                    inverse_support_radius_.data(), found);
  double sum = 0;
  with_kernel(carrier_.arrangement.context, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      for (std::size_t k = 0; k < found.size; ++k) {
        const std::size_t i = carrier_.arrangement.particle_of(found.index[k]);
        const double width = sizes.length_ratio[i];
        sum +=
            sizes.volume_ratio[i] / (width * width * width) * Kernel::w(Kernel::support * std::sqrt(found.share2[k]));
      }
      sum *= KernelScale<3, Kernel>(carrier_.arrangement.context).value;
    }
  });
  return sum;
}

// Along the normal at bubble b, upwards where there is none.
bool BubbleCoupling::faces_liquid(const CrossSearch& search, std::size_t b) const {
  Vec3 ahead = multiply(-1, gas_.gravity);
  if (population_.merge_time != nullptr) {
    const float* here = interpolated_.data() + b * liquid_record::record + liquid_record::normal_at;
    const Vec3 normal{here[0], here[1], here[2]};
    if (length(normal) > 0) ahead = normal;
  }
  if (!(length(ahead) > 0)) return false;
  ahead = multiply(carrier_.resolution.smoothing_length / length(ahead), ahead);
  int outside = 0;
  for (int k = 1; k <= places; ++k) {
    Vec3 r = add(vector_at(population_.next_position, 3, b), multiply(k, ahead));
    carrier_.boundary.apply_walls(carrier_.boundary.next_walls, r, nullptr);
    std::array<float, 3> place;
    for (std::size_t a = 0; a < 3; ++a) place[a] = static_cast<float>(r[a] - carrier_.arrangement.origin[a]);
    outside = mixture_at(search, place) < surface_sum ? outside + 1 : 0;
    if (outside == places_of_air) return false;
  }
  return true;
}

std::int64_t BubbleCoupling::count_inner_bursts() const {
  const std::size_t nb = population_.size();
  if (parallel_sum(nb, [&](std::size_t b) { return dead_[b] != 0 ? 1.0 : 0.0; }) == 0) return 0;
  const CrossSearch search = liquid_search();
  return static_cast<std::int64_t>(
      parallel_sum(nb, [&](std::size_t b) { return dead_[b] != 0 && faces_liquid(search, b) ? 1.0 : 0.0; }));
}

}  // namespace spume::bubbles
