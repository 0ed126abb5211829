// SPDX-License-Identifier: MIT
#include "spume/physics/oxygen/oxygen.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume::oxygen {
namespace {

double highest(const Scene& scene) {
  const auto up = static_cast<std::size_t>(scene.domain.dimensions - 1);
  const auto& heights = scene.particles.position[up];
  const auto top = std::max_element(heights.begin(), heights.end());
  return top == heights.end() ? scene.domain.upper[up] : *top + scene.spacing / 2;
}

}  // namespace

Oxygen::Oxygen(Scalars& scalars, const ParticleStore& particles, const Resolution& resolution, const Case& options,
               const Scene& scene)
    : scalars_(scalars),
      particles_(particles),
      options_(options.get<OxygenOptions>()),
      gas_(gas_of(options, scene.fluid.density, scene.fluid.kinematic_viscosity,
                  std::max(0.0, -scene.fluid.gravity[static_cast<std::size_t>(scene.domain.dimensions - 1)]),
                  highest(scene))) {
  saved_.add(from_surface_).add(surface_area_);
  const int d = resolution.dimensions;
  if (has_surface())
    layer_area_ = (d == 3 ? resolution.spacing : 1) * resolution.spacing /
                  lattice_surface(d, resolution.kernel, resolution.smoothing_ratio)[0].normal;
}

void Oxygen::exchange_with_air(double dt, const Surface& surface) {
  if (!has_surface()) return;
  struct Sums {
    double gained = 0, area = 0;
  };
  double* values = scalars_.values(options_.index).data();
  if (keeps_conductance_) {
    surface_conductance_.resize(particles_.size());
    surface_conductance_.fill(0.0F);
  }
  const double layer_area = layer_area_ / surface.gradient_scale;
  const double saturation = gas_.saturation_below_air(), k = gas_.factor * options_.surface_k_l, v = particles_.volume;
  const Sums sums = parallel_reduce(
      particles_.size(), Sums{},
      [&](std::size_t first, std::size_t last) {
        Sums part;
        for (std::size_t i = first; i < last; ++i) {
          const double share = 1 - surface.interior_weight[i];
          if (!(share > 0) || !scalars_.counts(i)) continue;
          double normal2 = 0;
          for (const float* component : surface.normal)
            if (component != nullptr) normal2 += double{component[i]} * component[i];
          const double area = share * layer_area * std::sqrt(normal2), before = values[i];
          values[i] -= (saturation - before) * std::expm1(-k * area / v * dt);
          if (keeps_conductance_) surface_conductance_[i] = static_cast<float>(k * area);
          part.area += area;
          part.gained += values[i] - before;
        }
        return part;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a.gained + b.gained, a.area + b.area};
      });
  from_surface_ += v * sums.gained;
  surface_area_ = sums.area;
}

// What bubbles would give per time to clean water without oxygen at 20 C under one atmosphere, ASCE 2-06.
double Oxygen::standard_capacity(double capacity) const {
  return capacity * std::pow(transfer_temperature, standard_temperature - gas_.temperature) / gas_.factor *
         saturation_concentration(standard_temperature, 0) / gas_.saturation * atmosphere / gas_.air_pressure;
}

void Oxygen::add_columns(SeriesTable& series, const Supply* bubbles) const {
  series.add("mean_oxygen", "g/m3", [this] {
    const double volume = scalars_.liquid_volume();
    return volume > 0 ? scalars_.amount(options_.index) / volume : 0;
  });
  if (has_surface()) {
    series.add("surface_area", particles_.dimensions == 3 ? "length^2, last step" : "length, per depth, last step",
               [this] { return surface_area_; });
    series.add("oxygen_from_surface", "g, since the start", [this] { return from_surface_; });
  }
  series.add("kla", "1/time: k_L A of bubbles and surface over the volume of liquid", [this, bubbles] {
    const double sum =
        (bubbles == nullptr ? 0 : bubbles->conductance()) + gas_.factor * options_.surface_k_l * surface_area_;
    const double volume = scalars_.liquid_volume();
    return volume > 0 ? sum / volume : 0;
  });
  if (bubbles == nullptr) return;
  series.add("sotr", "g/time: standard transfer rate of the bubbles",
             [this, bubbles] { return standard_capacity(bubbles->transfer_capacity()); });
  series.add("sote", "1: sotr over the oxygen that spargers feed", [this, bubbles] {
    const double feed = bubbles->oxygen_feed();
    return feed > 0 ? standard_capacity(bubbles->transfer_capacity()) / feed : 0;
  });
}

}  // namespace spume::oxygen
