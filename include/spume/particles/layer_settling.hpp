// SPDX-License-Identifier: MIT
// Layers of weakly compressible phases at rest, at the start.
//
// A lattice is no place to rest on. Under Wendland's kernel of 1.3 spacings rows of a square one that slide by half a
// spacing lower its kernel sums, from 1.0105 to 1.0088 where they are hexagonal: it breaks up within 6 sqrt(H/g), and
// the pressure times that is kinetic energy, 0.05 sqrt(gH), which nothing dissipates without viscosity. Where phases
// meet the slope of the pressure has a kink, which the sums of a lattice miss. So the particles move until the pressure
// of the layers holds each of them, beginning off the lattice: on it they would stay.
#pragma once

#include <functional>

#include "spume/particles/boundary.hpp"
#include "spume/particles/phase_law.hpp"

namespace spume {

struct LayerSettling {
  // Of gravity: what is left of accelerations.
  static constexpr double at_rest = 0.005;

  const Scene& scene;
  const Boundary& boundary;
  const Resolution& resolution;
  ParticleStore& particles;
  Arrangement& arrangement;  // the kernel gradient becomes exact in it: SweepContext::gradient_scale
  ParticleLaws law;
  Array<double>& excess;  // of each particle that of the pressure of its layer; it follows the particle
  Vec3 gravity{};         // across sides

  struct Forces {
    const float* pressure = nullptr;
    const FloatVectorScratch& force;  // (rho du/dt)_i by pressure
  };
  using UseForces = std::function<void(const Forces&)>;
  // Lists and images where the particles are now, and the forces by the pressures of `excess` there: as the method
  // finds those of a step. They are there until `use` has returned.
  std::function<void(const UseForces& use)> with_forces;

  // Moves the particles; returns the largest acceleration left over that of gravity, more than `at_rest` where it
  // ended without.
  double settle() const;

 private:
  void raise_datum() const;
  void move(std::size_t i, const Vec3& way) const;
  double step(VectorScratch& way) const;
  void fit_gradient_scale() const;
};

}  // namespace spume
