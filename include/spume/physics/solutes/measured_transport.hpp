// SPDX-License-Identifier: MIT
// Solutes of a method that keeps no kernel moments between its stages: they are measured where an accepted step has
// left the liquid, by the lists and images of its end, as far as what it carries asks for them.
#pragma once

#include "spume/particles/boundary.hpp"
#include "spume/physics/solutes/solutes.hpp"

namespace spume {

class MeasuredTransport {
 public:
  // What is carried and by what; all of it outlives the transport.
  struct Liquid {
    Solutes& solutes;
    ParticleStore& particles;
    Arrangement& arrangement;
    const Boundary& boundary;
    double spacing = 0;
    bool shifting = false;
    bool free_surface = false;
  };
  explicit MeasuredTransport(const Liquid& liquid) : liquid_(liquid) {}

  // By which a step of dt has shifted the particles, before the next velocity takes the place of this one.
  void keep_shift(const FloatVectorField& velocity, double dt);
  // Diffusion, the change by the shift, and sources of a step of dt up to the time t. Returns the number of sweeps.
  std::int64_t transport(double t, double dt);
  // Behind it: oxygen of released bodies and of the air.
  void transfer_oxygen(double t, double dt);

 private:
  bool meets_air() const;
  std::int64_t move(double t, double dt);

  const Liquid liquid_;
  // Leased from the acceptance of a step until the last stage that reads them.
  FloatVectorScratch shift_, normal_;  // by which the shift moved; outward, times h
  Array<float> interior_;              // weight
};

}  // namespace spume
