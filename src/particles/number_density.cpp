// SPDX-License-Identifier: MIT
#include "spume/particles/number_density.hpp"

#include <algorithm>
#include <cmath>

#include "salient_edges.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/blocks.hpp"
#include "spume/particles/pockets.hpp"

namespace spume {
namespace {

// Steps of courant 0.4, and in proportion between: rearranged as at courant 0.2, taylor_green_2d at 1/50 blew up at
// courant 0.3 without viscosity and lost 7 % of its decay rate at Re = 100 and courant 0.4; with this it loses 1.2 %.
constexpr double most_displacement = 2;
// Of the density, what the relaxation sees at most, lest single kernel sums that are far off dominate. In
// taylor_green_2d at 1/50, whose lattice becomes disordered, an excess of 0.05 costs 0.2 % of the energy by t = 0.15
// and 1 leaves 0.09 % more; a lack of 0.1 adds 0.3 % in a cavity at 1/40, and 0.9 leaves the bits of both. dam_break_3d
// at 0.03 has the same bits with an excess of 1 and a lack of 0.9 up to t = 0.6.
constexpr double largest_excess = 0.1, largest_lack = 0.5;
// Liquid thinner than this closes faster in proportion: a void in a closed box, where no surface tells the pressure of
// it, is widened by the flow within tens of steps. Without this the cavity opened one under its lid at N = 50, with it
// none at N = 100.
constexpr double thin_as_void = 0.05;
// What disorder changes the kernel sums by without any liquid being denser: their mean, and those of single particles,
// whose standard deviation is 0.009 in taylor_green_2d. Evening out the latter stirs the liquid: at 1/200 the error of
// that case's velocity is 0.037 %, 0.024 % when twice the deviation is let be, 0.023 % without any relaxation.
constexpr double mean_disorder = 0.002, particle_disorder = 0.02;
// Support radii along a wall that voids behind an edge reach. Waves over a submerged box or an outline (2-D, 11
// spacings wide, free-slip and no-slip) gain 0.67, 0.71, 0.40 and 0.43 of their kinetic energy where no void is closed
// at once, 0.29, 0.27, 0.06 and 0.15 with 1, 0.23, 0.18, 0.09 and 0.12 with 2, 0.23, 0.20, 0.09 and 0.08 with 3. Closed
// at once along flat walls, what lacks in the shear layer of the floor of sloshing drove a jet along it, of six times
// the energy.
constexpr double reach_of_edges = 2;
// Of the full displacement: less is below what positions, of 1e-16 of the domain, can tell.
constexpr double least_displacement = 1e-12;

// What the relaxation reads.
struct Reader {
  const Arrangement& arrangement;
  const Boundary& boundary;
  const VectorField& at;
  const Resolution& resolution;
  const MomentFields& moments;
  const FreeSurface* surface;
  const Array<std::int64_t>* left_out;

  bool counts(std::size_t i) const { return left_out == nullptr || (*left_out)[i] < 0; }

  bool near_box(std::size_t i) const {
    const double support_radius = arrangement.grid.support_radius();
    for (const SolidBox& box : boundary.domain().boxes) {
      double distance2 = 0;
      for (int axis = 0; axis < resolution.dimensions; ++axis) {
        const double x = (*at[axis])[i];
        const double outside = std::max({box.lower[axis] - x, x - box.upper[axis], 0.0});
        distance2 += outside * outside;
      }
      if (distance2 < support_radius * support_radius) return true;
    }
    return false;
  }

  // Whether the neighbourhood of a particle is full, or as thin on all sides. Where liquid ends the normal is large:
  // h |m| is 0.66 (3-D) and 0.84 (2-D) times what div r lacks in the upper layer of a lattice, 0.6 times in the second
  // one. In foam that falls back into the liquid it is a tenth; left at the density of nine tenths that it arrives
  // with, such liquid raised the second wave of dam_break_3d.
  bool tells_density(std::size_t i) const {
    if ((surface != nullptr && near_box(i) && !submerged(i)) || in_pocket(i)) return false;
    if (surface == nullptr || surface->interior_weight[i] == 1) return true;
    if (surface->at_surface[i] != 0) return false;
    const double normal2 = squared_norm(moments.normal, resolution.dimensions, i);
    const double missing = resolution.lattice.divergence_of_position - (*moments.divergence_of_position)[i];
    return std::sqrt(normal2) < largest_isotropic_normal * missing;
  }

  // What it lacks is where walls leave no room.
  bool in_pocket(std::size_t i) const {
    if (boundary.bodies() == nullptr || excess(i) >= -particle_disorder) return false;
    const Vec3 place = vector_at(at, resolution.dimensions, i);
    // Films that a surface ends keep their thickness; where liquid fills the domain a void between walls is one.
    if (surface != nullptr && in_one_layer(boundary, place)) return true;
    return moments.normal[0] != nullptr &&
           ahead_of(boundary, arrangement, i, place, vector_at(moments.normal, resolution.dimensions, i)) ==
               Ahead::pocket;
  }

  // The surface is farther than the support radius.
  bool submerged(std::size_t i) const {
    if (surface->interior_weight[i] != 1) return false;
    for (const std::int32_t j : arrangement.list.of(i))
      if (surface->at_surface[arrangement.particle_of(j)] != 0) return false;
    return true;
  }

  // Beside an edge how much of a void a particle stands at: 0 with what is let be, 1 as thin as a void.
  double void_share(std::size_t i) const {
    const double lack = -excess(i) - particle_disorder;
    if (!(lack > 0) || !boundary.has_obstacles()) return 0;
    const Vec3 place = vector_at(at, resolution.dimensions, i);
    if (!boundary.obstacle_near(place, resolution.support_radius) || (surface != nullptr && !submerged(i)) ||
        !salient_edge_near(boundary, place, reach_of_edges * resolution.support_radius, resolution.dimensions))
      return 0;
    return std::min(1.0, lack / (thin_as_void - particle_disorder));
  }

  double excess(std::size_t i) const {
    const double ratio = moments.kernel_sum[i] / resolution.lattice.kernel_sum;
    return std::clamp(ratio - 1, -largest_lack, largest_excess);
  }
};

double within(double value, double bound) {
  return std::clamp(value, -bound, bound);
}

}  // namespace

double displacement_fraction(const Arrangement& arrangement, const ParticleStore& particles,
                             const Resolution& resolution, double dt) {
  const int d = particles.dimensions;
  const std::size_t n = particles.size();
  const auto u = read(particles.velocity);
  Vec3 mean = parallel_reduce(
      n, Vec3{},
      [&](std::size_t first, std::size_t last) {
        Vec3 sum{};
        for (std::size_t i = first; i < last; ++i)
          for (int axis = 0; axis < d; ++axis) sum[axis] += u[axis][i];
        return sum;
      },
      add);
  for (double& component : mean) component /= static_cast<double>(std::max<std::size_t>(n, 1));
  const std::int32_t* const counts = arrangement.list.counts();
  const int spray = spray_neighbours(d);
  const double fastest2 = parallel_reduce(
      n, 0.0,
      [&](std::size_t first, std::size_t last) {
        double so_far = 0;
        ParticleBlock relative2;
        each_block(first, last, [&](std::size_t from, std::size_t to) {
          largest_square(d, from, to, relative2, [&](int axis) {
            return [u = u[axis], mean = mean[axis]](std::size_t i) { return u[i] - mean; };
          });
          for (std::size_t i = from; i < to; ++i) relative2[i - from] = counts[i] < spray ? 0 : relative2[i - from];
          so_far = larger_or_nan(so_far, largest_size(relative2.data(), 0, to - from));
        });
        return so_far;
      },
      larger_or_nan);
  const double fraction = std::sqrt(fastest2) * dt / (full_displacement * resolution.smoothing_length);
  return fraction < least_displacement ? 0.0 : std::min(most_displacement, fraction);
}

double even_out_density(const DensityRelaxation& relaxation, const Arrangement& arrangement, const Boundary& boundary,
                        const VectorField& at, const Resolution& resolution, const MomentFields& moments,
                        const FreeSurface* surface, std::span<double> divergence) {
  const Reader read{arrangement, boundary, at, resolution, moments, surface, relaxation.left_out};
  struct Sum {
    double disorder = 0, particles = 0, volume = 0;
  };
  const Sum total = parallel_reduce(
      divergence.size(), Sum{},
      [&](std::size_t first, std::size_t last) {
        Sum sum;
        for (std::size_t i = first; i < last; ++i)
          if (!read.counts(i)) {
            continue;
          } else if (read.tells_density(i)) {
            const double excess = read.excess(i);
            sum.disorder += within(excess, particle_disorder);
            sum.particles += 1;
            sum.volume += 1 / (1 + excess);
          } else {
            sum.volume += 1;
          }
        return sum;
      },
      [](const Sum& a, const Sum& b) {
        return Sum{a.disorder + b.disorder, a.particles + b.particles, a.volume + b.volume};
      });
  const double mean = total.disorder / std::max(total.particles, 1.0);
  const double of_all = mean - within(mean, mean_disorder);
  const double closing = relaxation.displacement / (relaxation.steps * relaxation.dt);
  const double at_once = relaxation.displacement / relaxation.dt;
  const double expanding = surface != nullptr ? closing / more_steps_below_surface : closing;
  parallel_for(divergence.size(), [&](std::size_t i) {
    if (!read.counts(i) || !read.tells_density(i)) return;
    const double own = read.excess(i), beyond = own - within(own, particle_disorder);
    const double taken = relaxation.still == nullptr ? 1.0 : 1.0 - double{(*relaxation.still)[i]};
    double change = expanding * of_all;
    if (beyond != 0) {  // of few: the rate takes a division and a look around
      const double rate =
          own < 0 ? std::max(closing * std::max(1.0, -own / thin_as_void), at_once * read.void_share(i)) : expanding;
      change += std::min(rate, 1 / relaxation.dt) * beyond;
    }
    divergence[i] -= taken * change;
  });
  return total.volume;
}

}  // namespace spume
