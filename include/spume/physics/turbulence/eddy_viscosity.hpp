// SPDX-License-Identifier: MIT
// The closures (physics/turbulence/closures.hpp) on particles: from the strain and the test-filtered velocity of a
// carrier to its eddy viscosity.
#pragma once

#include "spume/particles/boundary.hpp"
#include "spume/physics/turbulence/options.hpp"

namespace spume::turbulence {

// What a closure sees of its carrier, in one step.
struct ResolvedMotion {
  Arrangement& arrangement;
  ParticleStore& particles;
  const Boundary& boundary;
  const Resolution& resolution;
  const ParticleSizes& sizes;
  const Array<float>& strain;                            // |S| = sqrt(2 S:S)
  const std::array<Array<float>, 9>& velocity_gradient;  // of the dynamic closures
  const VectorScratch& velocity;
  const FloatVectorScratch& filtered_velocity;  // of all but Smagorinsky's
  double kinematic_viscosity = 0;
};

class EddyViscosity {
 public:
  // Adds the eddy viscosity to the fields of the particles, and to their state what the closure remembers.
  // Precondition: a model other than none.
  EddyViscosity(ParticleStore& particles, const TurbulenceOptions& options);

  // Of a step dt. The averages of the Lagrangian dynamic closure are those at its end, taken over by accept(): a
  // refused step leaves the state as it was.
  void find(const ResolvedMotion& motion, double dt);
  void accept(ParticleStore& particles);

  const Array<float>& viscosity() const { return *viscosity_; }  // nu_t
  double largest(std::size_t particles) const;
  bool dynamic() const;

 private:
  template <int d>
  void find_static(const ResolvedMotion& motion);
  template <int d>
  void find_dynamic(const ResolvedMotion& motion, double dt);

  TurbulenceOptions options_;
  Array<float>* viscosity_ = nullptr;
  std::array<Array<double>*, 2> lagrangian_average_{};  // I_LM and I_MM
  std::array<Array<double>, 2> next_average_;           // leased
};

}  // namespace spume::turbulence
