// SPDX-License-Identifier: MIT
#include "spume/particles/interface_potential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "spume/core/kernel.hpp"
#include "spume/core/parallel.hpp"
#include "spume/operators/interface_curvature.hpp"
#include "spume/operators/interface_jump.hpp"

namespace spume {
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
double averages_of_curvature(const Resolution& resolution) {
  const double kurtosis = resolution.kernel == KernelKind::wendland_c2 ? WendlandC2::kurtosis(resolution.dimensions)
                                                                       : QuinticSpline::kurtosis(resolution.dimensions);
  return 1 + 2 * kurtosis / 3;
}

double band_weight(double colour) {
  return 4 * colour * (1 - colour);
}

}  // namespace

std::vector<Colour> colours_of(const Scene& scene) {
  std::vector<Colour> colours;
  const std::size_t count = scene.phases.size();
  if (count < 2) return colours;
  for (std::size_t n = count == 2 ? 1 : 0; n < count; ++n)
    colours.push_back({.phase = n,
                       .tension = scene.surface_tension / (count == 2 ? 1 : 2),
                       .density_jump = scene.phases[n].density - scene.phases[0].density});
  return colours;
}

double interface_area(const std::vector<Colour>& colours) {
  double sum = 0;
  for (const Colour& colour : colours) sum += colour.area;
  return colours.size() == 1 ? sum : sum / 2;
}

double surface_energy(const std::vector<Colour>& colours) {
  double sum = 0;
  for (const Colour& colour : colours) sum += colour.tension * colour.area;
  return sum;
}

double capillary_time(const Scene& scene) {
  if (scene.phases.size() < 2 || !(scene.surface_tension > 0)) return std::numeric_limits<double>::infinity();
  std::vector<double> sorted;
  for (const Phase& phase : scene.phases) sorted.push_back(phase.density);
  std::sort(sorted.begin(), sorted.end());
  return std::sqrt((sorted[0] + sorted[1]) * std::pow(scene.spacing, 3) /
                   (4 * std::numbers::pi * scene.surface_tension));
}

// Normals are those of C alone: divided by the mean densities as (14) is, they see the lighter side.
InterfaceMeasure::InterfaceMeasure(const InterfaceView& view, Colour& colour, bool curved)
    : view_(view),
      facing_(view.bands.facing(view.arrangement.context)),
      colour_(colour),
      width_(kernel_width(view.resolution)) {
  Arrangement& arrangement = view_.arrangement;
  const std::size_t n = arrangement.list.particles();
  const int dimensions = arrangement.context.dimensions;
  view_.scratch.lease(normal_, dimensions, n);
  find_normals_and_area();
  for (Array<float>* array : {&curvature_, &weight_, &potential_}) view_.scratch.lease(*array, n);
  if (curved)
    curvature_sweep(arrangement.context, arrangement.packed, facing_, read(normal_), view_.reflection,
                    curvature_.data());
  colour_.potential.resize(n);
  colour_.mean_potential = 0;
  parallel_for(n, [&](std::size_t i) {
    weight_[i] = static_cast<float>(band_weight(colour_.value[i]));
    potential_[i] = colour_.potential[i] = 0;
  });
}

InterfaceMeasure::~InterfaceMeasure() {
  view_.scratch.release(normal_);
  for (Array<float>* array : {&curvature_, &weight_, &potential_}) view_.scratch.release(*array);
}

// The gradients, three numbers a particle, are given back before other arrays are leased.
void InterfaceMeasure::find_normals_and_area() {
  Arrangement& arrangement = view_.arrangement;
  const int dimensions = arrangement.context.dimensions;
  ScratchArray<float> ones(view_.scratch, arrangement.list.particles());
  ones.fill(1.0F);
  FloatVectorScratch gradient;
  view_.scratch.lease(gradient, dimensions, arrangement.list.particles());
  interface_normal_sweep(arrangement.context, arrangement.packed, view_.bands, colour_.value.data(), ones.data(),
                         view_.correction, band_threshold, {write(gradient), write(normal_)});
  const auto& band = view_.bands.varying();
  colour_.area = view_.particle_volume * parallel_sum(band.size(), [&](std::size_t s) {
                   const auto i = static_cast<std::size_t>(band[s]);
                   if (view_.left_out != nullptr && (*view_.left_out)[i] >= 0) return 0.0;
                   return std::sqrt(squared_norm(gradient, dimensions, i));
                 });
  view_.scratch.release(gradient);
}

double InterfaceMeasure::distance(std::size_t i) const {
  const double c = std::clamp<double>(colour_.value[i], least_colour, 1 - least_colour);
  return width_ / logistic_width * std::log(c / (1 - c));
}

double InterfaceMeasure::averages_of_height() {
  return 1;
}

void InterfaceMeasure::add_tension() {
  const int curved_axes = view_.arrangement.context.dimensions - 1;
  add(averages_of_curvature(view_.resolution), [&](std::size_t i, double distance) {
    const double stretch = 1 + curvature_[i] * distance / curved_axes;
    return colour_.tension * curvature_[i] / std::clamp(stretch, least_stretch, largest_stretch);
  });
}

// Adds a potential of the interface to that of the colour. Averages over the band continue it and flatten its waves,
// as measuring it did; the difference that one average more makes, times their number, gives back what they took, to
// the square of the wave number. Without it a capillary wave of 32 spacings is 1.3 % too slow with 2 averages.
void InterfaceMeasure::continue_across_band(double averages) {
  Arrangement& arrangement = view_.arrangement;
  const auto band = facing_;
  const auto sum_over_band = [&](auto&& value) {
    return parallel_sum(band.size(), [&](std::size_t s) { return value(static_cast<std::size_t>(band[s])); });
  };
  const double total = sum_over_band([&](std::size_t i) { return double{weight_[i]}; });
  const double mean =
      total > 0 ? sum_over_band([&](std::size_t i) { return double{weight_[i]} * potential_[i]; }) / total : 0;
  colour_.mean_potential += mean;
  parallel_for(band.size(), [&](std::size_t s) { potential_[static_cast<std::size_t>(band[s])] -= float(mean); });
  ScratchArray<float> averaged(view_.scratch, arrangement.list.particles());
  const auto average = [&](const Array<float>& from, Array<float>& to) {
    interface_average_sweep(arrangement.context, arrangement.packed, band, weight_.data(), from.data(), to.data());
  };
  averaged.fill(0.0F);
  const int passes = view_.smoothing;
  for (int pass = 0; pass < passes; ++pass) {
    average(potential_, averaged);
    potential_.swap(averaged);
  }
  average(potential_, averaged);
  const auto lost = static_cast<float>(averages + passes);
  parallel_for(band.size(), [&](std::size_t s) {
    const auto i = static_cast<std::size_t>(band[s]);
    colour_.potential[i] += potential_[i] + lost * (potential_[i] - averaged[i]);
  });
}

}  // namespace spume
