// SPDX-License-Identifier: MIT
// Dissolved oxygen of a liquid of particles: a scalar that gains what bubbles give, and what passes the free surface.
//
// The amount of the scalar changes by what bubbles lose and by what the surface gives, to the rounding of doubles.
//
// The surface of a particle near it is (1 - b) |m| / |m_0| dr^2, with the interior weight b, the moment m that points
// out of the liquid, and m_0 that of the outermost layer below a plane surface: a plane of a lattice has its area. In
// two dimensions dr in place of dr^2, and amounts are those of a unit of depth.
#pragma once

#include "spume/physics/oxygen/options.hpp"
#include "spume/physics/oxygen/supply.hpp"
#include "spume/physics/scalars/scalars.hpp"

namespace spume::oxygen {

class Oxygen {
 public:
  Oxygen(Scalars& scalars, const ParticleStore& particles, const Resolution& resolution, const Case& options,
         const Scene& scene);

  const Gas& gas() const { return gas_; }
  const Array<double>& dissolved() const { return static_cast<const Scalars&>(scalars_).values(options_.index); }

  // `change` of the concentrations, of the exact sum `amount`.
  void take_from_bubbles(const Array<float>& change, double amount) { scalars_.add(options_.index, change, amount); }

  struct Surface {
    const float* interior_weight;
    std::array<const float*, 3> normal;  // times h; null beyond the dimensions
    double gradient_scale = 1;           // SweepContext::gradient_scale of the moments
  };
  // Each particle towards saturation with k_L A / V: exact while its area stays, for any dt.
  void exchange_with_air(double dt, const Surface& surface);

  bool has_surface() const { return options_.surface_k_l > 0; }
  std::size_t scalar() const { return options_.index; }
  // Of the particles in the last step, alpha k_L A of the surface, from this call on; empty without a surface.
  void keep_surface_conductance() { keeps_conductance_ = true; }
  const Array<float>& surface_conductance() const { return surface_conductance_; }

  // Columns; `bubbles`: null without.
  void add_columns(SeriesTable& series, const Supply* bubbles) const;
  void save(StateWriter& writer) const { saved_.save(writer); }
  void load(StateReader& reader) { saved_.load(reader); }

 private:
  double standard_capacity(double capacity) const;

  Scalars& scalars_;
  const ParticleStore& particles_;
  const OxygenOptions& options_;
  const Gas gas_;
  double layer_area_ = 0;                       // dr^2 / |m_0|
  double from_surface_ = 0, surface_area_ = 0;  // g since the start; of the last step
  bool keeps_conductance_ = false;
  Array<float> surface_conductance_;
  SavedNumbers saved_{"oxygen"};
};

}  // namespace spume::oxygen
