// SPDX-License-Identifier: MIT
// The arrangement of a step and its interfaces: colours, filtered properties, potentials.
#include <algorithm>
#include <cmath>

#include "spume/core/kernel.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/gfd/flow.hpp"
#include "spume/operators/interface_curvature.hpp"
#include "spume/operators/interface_filters.hpp"
#include "spume/operators/interface_jump.hpp"
#include "spume/particles/number_density.hpp"
#include "spume/particles/packing.hpp"

namespace spume::gfd {
namespace {

// The colour across a flat interface is nearly a normal distribution of the width of the kernel, and that within 0.0095
// a logistic one of 1 / 1.702 of its width (Camilli 1994): the distance follows from the colour in closed form.
constexpr double logistic_width = 1.702;
// Colours beyond tell hardly anything of the distance.
constexpr double least_colour = 0.01;
// Bounds of R / r of two level sets: within the band of a drop of less than a support a curvature says nothing.
constexpr double least_stretch = 0.5, largest_stretch = 2;

double kernel_width(const Resolution& resolution) {
  const double variance = resolution.kernel == KernelKind::wendland_c2 ? WendlandC2::variance(resolution.dimensions)
                                                                       : QuinticSpline::variance(resolution.dimensions);
  return resolution.smoothing_length * std::sqrt(variance);
}

// Averages over the kernel that flatten a wave of the interface as much as its measurement does, to the square of its
// number k: an average of the variance s^2 leaves 1 - k^2 s^2 / 2, and so does the colour that tells the height; a
// derivative of weights W d leaves 1 - k^2 <d^4> / (6 <d^2>), and the curvature takes two.
double averages_of_colour() {
  return 1;
}
double averages_of_curvature(const Resolution& resolution) {
  const double kurtosis = resolution.kernel == KernelKind::wendland_c2 ? WendlandC2::kurtosis(resolution.dimensions)
                                                                       : QuinticSpline::kurtosis(resolution.dimensions);
  return averages_of_colour() + 2 * kurtosis / 3;
}

double band_weight(double colour) {
  return 4 * colour * (1 - colour);
}

}  // namespace

void Flow::pack() {
  if (packed != 0) return;
  pack_beside_bodies(arrangement, particles, boundary, resolution, particles.position, false, time);
  packed = 1;
}

// At the positions of the start of the step: walls with a normal velocity stand there too, and have the velocity of its
// end, which the new velocities must meet. Bodies have that of the start: what they gain is a pressure behind them.
void Flow::make_images(double dt) {
  boundary.next_walls = boundary.walls;
  const double end = time + dt, before = features.displaced_bodies ? time : end;
  boundary.make_images(arrangement, particles, particles.position, sizes.largest_length_ratio, {time, before, end});
}

void Flow::find_neighbours(double dt) {
  arrangement.find_neighbours(particles, particles.position, sizes);
  displacement = dt > 0 ? displacement_fraction(arrangement, particles, resolution, dt) : 0;
  phase.resize(size());
  parallel_for(size(), [&](std::size_t i) { phase[i] = static_cast<std::uint8_t>((*phase_number)[i]); });
}

void Flow::measure_stencils() {
  GfdMoments out;
  for (std::size_t k = 0; k < 6; ++k) out.correction[k] = correction[k] == nullptr ? nullptr : correction[k]->data();
  out.offset = write(offset);
  out.laplacian_factor = laplacian_factor->data();
  gfd_moment_sweep(arrangement.context, arrangement.packed, out);
  moments.measure(arrangement, particles, spacing());
  particles.scratch().release(moments.laplacian_diagonal);
  const double bulk = resolution.lattice.kernel_sum;
  double total = 0;
  for (std::size_t n = 0; n < phase_volume.size(); ++n) {
    phase_volume[n] = parallel_sum(size(), [&](std::size_t i) {
      return phase[i] == n && moments.kernel_sum[i] > 0 ? bulk / moments.kernel_sum[i] : 0.0;
    });
    total += phase_volume[n];
  }
  // The phases fill the domain: what disorder does to the sums of all of them, 0.1 %, says nothing of their volumes.
  for (double& volume : phase_volume) volume *= particles.volume * static_cast<double>(size()) / total;
  if (steps == 0) first_volume = phase_volume;
}

void Flow::find_bands() {
  bands.build(arrangement.context, arrangement.grid, arrangement.table, phase);
}

void Flow::blend_properties() {
  const std::size_t n = size();
  if (!features.interfaces) {
    parallel_for(n, [&](std::size_t i) {
      (*density)[i] = static_cast<float>(densities[0]);
      if (viscosity != nullptr) (*viscosity)[i] = static_cast<float>(viscosities[0]);
    });
    return;
  }
  std::vector<Array<float>> first(colours.size() < densities.size() ? 1 : 0);
  std::vector<float*> out;
  for (Array<float>& colour : first) {
    particles.scratch().lease(colour, n);
    out.push_back(colour.data());
  }
  for (Colour& colour : colours) {
    colour.value.resize(n);
    out.push_back(colour.value.data());
  }
  filter_colours(arrangement.context, arrangement.packed, bands, phase, out);
  const std::vector<const float*> in(out.begin(), out.end());
  blend_property(bands, phase, in, densities, *density);
  if (viscosity != nullptr) blend_viscosity(in);
  for (Array<float>& colour : first) particles.scratch().release(colour);
}

// Across layers in shear the stress is continuous and resistances add up: the harmonic mean keeps the integral of 1 /
// mu of the sharp interface, where the arithmetic one of (7) makes the thinner fluid narrower by a part of the support.
void Flow::blend_viscosity(std::span<const float* const> colour) {
  const bool harmonic = options.get<MomentumOptions>().viscosity_mean == ViscosityMean::harmonic &&
                        std::none_of(viscosities.begin(), viscosities.end(), [](double mu) { return mu == 0; });
  if (!harmonic) return blend_property(bands, phase, colour, viscosities, *viscosity);
  std::vector<double> fluidity;
  for (const double mu : viscosities) fluidity.push_back(1 / mu);
  blend_property(bands, phase, colour, fluidity, *viscosity);
  parallel_for(size(), [&](std::size_t i) { (*viscosity)[i] = 1 / (*viscosity)[i]; });
}

void Flow::find_potentials() {
  for (Colour& colour : colours) find_potential(colour);
}

// Normals are those of C alone: divided by the mean densities as (14) is, they see the lighter side.
void Flow::find_potential(Colour& colour) {
  const std::size_t n = size();
  ScratchPool& scratch = particles.scratch();
  const double width = kernel_width(resolution);
  FloatVectorScratch normal, gradient;
  scratch.lease(normal, dimensions, n);
  scratch.lease(gradient, dimensions, n);
  ScratchArray<float> curvature(scratch, n), weight(scratch, n), potential(scratch, n), ones(scratch, n);
  ones.fill(1.0F);
  interface_normal_sweep(arrangement.context, arrangement.packed, bands, colour.value.data(), ones.data(),
                         stencils().correction, band_threshold, {write(gradient), write(normal)});
  if (features.tension)
    curvature_sweep(arrangement.context, arrangement.packed, bands, read(normal), boundary.reflection(),
                    curvature.data());
  colour.potential.resize(n);
  colour.mean_potential = 0;
  parallel_for(n, [&](std::size_t i) {
    weight[i] = static_cast<float>(band_weight(colour.value[i]));
    potential[i] = colour.potential[i] = 0;
  });
  const auto& band = bands.varying();
  // A potential from value(i, distance of the particle along the normal), measured through `averages` of the kernel.
  const auto add = [&](double averages, auto&& value) {
    parallel_for(band.size(), [&](std::size_t s) {
      const auto i = static_cast<std::size_t>(band[s]);
      const double c = std::clamp<double>(colour.value[i], least_colour, 1 - least_colour);
      potential[i] = static_cast<float>(value(i, width / logistic_width * std::log(c / (1 - c))));
    });
    continue_across_band(colour, weight, potential, averages);
  };
  if (features.tension)
    add(averages_of_curvature(resolution), [&](std::size_t i, double distance) {
      const double stretch = 1 + curvature[i] * distance / (dimensions - 1);
      return colour.tension * curvature[i] / std::clamp(stretch, least_stretch, largest_stretch);
    });
  if (features.gravity && colour.density_jump != 0)
    add(averages_of_colour(), [&](std::size_t i, double distance) {
      double height = gravity_potential(i);
      for (int axis = 0; axis < dimensions; ++axis)
        if (!scene.domain.periodic(axis)) height += distance * scene.fluid.gravity[axis] * normal[axis][i];
      return colour.density_jump * height;
    });
  colour.area = particles.volume * parallel_sum(band.size(), [&](std::size_t s) {
                  return std::sqrt(squared_norm(gradient, dimensions, static_cast<std::size_t>(band[s])));
                });
  scratch.release(normal);
  scratch.release(gradient);
}

// Adds a potential of the interface to that of the colour. Averages over the band continue it and flatten its waves,
// as measuring it did; the difference that one average more makes, times their number, gives back what they took, to
// the square of the wave number. Without it a capillary wave of 32 spacings is 1.3 % too slow with 2 averages.
void Flow::continue_across_band(Colour& colour, const Array<float>& weight, Array<float>& potential, double averages) {
  const std::size_t n = size();
  const auto& band = bands.varying();
  const auto sum_over_band = [&](auto&& value) {
    return parallel_sum(band.size(), [&](std::size_t s) { return value(static_cast<std::size_t>(band[s])); });
  };
  const double total = sum_over_band([&](std::size_t i) { return double{weight[i]}; });
  const double mean =
      total > 0 ? sum_over_band([&](std::size_t i) { return double{weight[i]} * potential[i]; }) / total : 0;
  colour.mean_potential += mean;
  parallel_for(band.size(), [&](std::size_t s) { potential[static_cast<std::size_t>(band[s])] -= float(mean); });
  ScratchArray<float> averaged(particles.scratch(), n);
  const auto average = [&](const Array<float>& from, Array<float>& to) {
    interface_average_sweep(arrangement.context, arrangement.packed, bands, weight.data(), from.data(), to.data());
  };
  averaged.fill(0.0F);
  const int passes = options.get<InterfaceOptions>().smoothing;
  for (int pass = 0; pass < passes; ++pass) {
    average(potential, averaged);
    potential.swap(averaged);
  }
  average(potential, averaged);
  const auto lost = static_cast<float>(averages + passes);
  parallel_for(band.size(), [&](std::size_t s) {
    const auto i = static_cast<std::size_t>(band[s]);
    colour.potential[i] += potential[i] + lost * (potential[i] - averaged[i]);
  });
}

// (18), of the filtered viscosity itself: the same for two phases, and right for more.
void Flow::find_viscosity_gradient() {
  particles.scratch().lease(viscosity_gradient, dimensions, size());
  gfd_gradient_over_density_subset(arrangement.context, arrangement.packed, viscosity->data(), density->data(),
                                   stencils().correction, bands.varying(), write(viscosity_gradient));
}

}  // namespace spume::gfd
