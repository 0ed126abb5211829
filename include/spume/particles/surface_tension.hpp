// SPDX-License-Identifier: MIT
// The continuum surface force between phases for weakly compressible SPH: potentials sigma kappa of the interfaces
// (particles/interface_potential.hpp) and the pair force of operators/wcsph_sums.hpp that they make.
#pragma once

#include "spume/operators/interface_bands.hpp"
#include "spume/particles/interface_potential.hpp"
#include "spume/particles/resolution.hpp"

namespace spume {

class SurfaceTension {
 public:
  // smoothing: InterfaceOptions. Without tension it holds nothing.
  SurfaceTension(const Scene& scene, int smoothing);

  // With new lists: who is near an interface, of which a particle of the lists' skin may be a neighbour.
  void find_bands(const Arrangement& arrangement, const Array<std::int64_t>& phase);

  struct Now {
    Arrangement& arrangement;
    const Resolution& resolution;
    const std::vector<std::array<float, 3>>& reflection;
    ParticleStore& particles;
    const float* volume;  // over that at rest
  };
  // The interfaces where the particles are.
  void find_potentials(const Now& now);
  // Adds (rho du/dt)_i by these.
  void add_force(const Now& now, const std::array<float*, 3>& force) const;

  // Of the interfaces as they were found last: the mean sigma kappa that the pressure of a phase is higher by, and what
  // they hold.
  double mean_jump(std::size_t phase) const;
  double energy() const { return surface_energy(colours_); }
  double bytes() const;

 private:
  std::vector<Colour> colours_;
  const std::size_t phases_;
  const int smoothing_;
  Array<std::uint8_t> phase_;
  InterfaceBands bands_;
};

}  // namespace spume
