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

double band_weight(double colour) {
  return 4 * colour * (1 - colour);
}

}  // namespace

// At the positions of the start of the step: walls with a normal velocity stand there too, and have the velocity of its
// end, which the new velocities must meet.
void Flow::make_images(double dt) {
  boundary.next_walls = boundary.walls;
  const double end = time + dt;
  boundary.make_images(arrangement, particles, particles.position, sizes.largest_length_ratio, {end, end, end});
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
  for (std::size_t n = 0; n < phase_volume.size(); ++n)
    phase_volume[n] = particles.volume * parallel_sum(size(), [&](std::size_t i) {
                        return phase[i] == n && moments.kernel_sum[i] > 0 ? bulk / moments.kernel_sum[i] : 0.0;
                      });
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
  parallel_for(n, [&](std::size_t i) {
    weight[i] = static_cast<float>(band_weight(colour.value[i]));
    potential[i] = colour.potential[i] = 0;
  });
  const auto& band = bands.varying();
  parallel_for(band.size(), [&](std::size_t s) {
    const auto i = static_cast<std::size_t>(band[s]);
    const double c = std::clamp<double>(colour.value[i], least_colour, 1 - least_colour);
    const double distance = width / logistic_width * std::log(c / (1 - c));  // along the normal
    double value = 0;
    if (features.tension) {
      const double stretch = 1 + curvature[i] * distance / (dimensions - 1);
      value += colour.tension * curvature[i] / std::clamp(stretch, least_stretch, largest_stretch);
    }
    if (features.gravity && colour.density_jump != 0) {
      double height = gravity_potential(i);
      for (int axis = 0; axis < dimensions; ++axis)
        if (!scene.domain.periodic(axis)) height += distance * scene.fluid.gravity[axis] * normal[axis][i];
      value += colour.density_jump * height;
    }
    potential[i] = static_cast<float>(value);
  });
  const auto sum_over_band = [&](auto&& value) {
    return parallel_sum(band.size(), [&](std::size_t s) { return value(static_cast<std::size_t>(band[s])); });
  };
  const double total = sum_over_band([&](std::size_t i) { return double{weight[i]}; });
  colour.mean_potential =
      total > 0 ? sum_over_band([&](std::size_t i) { return double{weight[i]} * potential[i]; }) / total : 0;
  const auto mean = static_cast<float>(colour.mean_potential);
  parallel_for(band.size(), [&](std::size_t s) { potential[static_cast<std::size_t>(band[s])] -= mean; });
  for (int pass = 0; pass < options.get<InterfaceOptions>().smoothing; ++pass) {
    interface_average_sweep(arrangement.context, arrangement.packed, bands, weight.data(), potential.data(),
                            colour.potential.data());
    if (pass + 1 < options.get<InterfaceOptions>().smoothing) potential.swap(colour.potential);
  }
  colour.area =
      particles.volume * sum_over_band([&](std::size_t i) { return std::sqrt(squared_norm(gradient, dimensions, i)); });
  scratch.release(normal);
  scratch.release(gradient);
}

// (18), of the filtered viscosity itself: the same for two phases, and right for more.
void Flow::find_viscosity_gradient() {
  particles.scratch().lease(viscosity_gradient, dimensions, size());
  gfd_gradient_over_density_subset(arrangement.context, arrangement.packed, viscosity->data(), density->data(),
                                   stencils().correction, bands.varying(), write(viscosity_gradient));
}

}  // namespace spume::gfd
