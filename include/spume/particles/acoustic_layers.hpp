// SPDX-License-Identifier: MIT
// Buffer layers behind openings (particles/buffer_layers.hpp) of weakly compressible phases: their pressures, and the
// velocities behind outflows.
//
// The pressure behind an inflow is that of the liquid before it and its weight. Behind an outflow the particles of a
// phase in a column go with the liquid of their phase before them; where there is none they go with what there is,
// unless they are heavier than all of it: air does not carry water back. Along the side their velocity follows. With
// u_n the mean velocity outwards of the liquid before a particle, U the mean of that before its column of the opening
// over a time 1 / K and Z the harmonic mean of the impedances rho c there, its pressure is
//
//   p = p_out + Z (u_n - U),  dU/dt = K (u_n - U).
//
// That lets sound out: it is the characteristic condition dp/dt + K (p - p_out) = Z du_n/dt of T. J. Poinsot and S. K.
// Lele, J. Comput. Phys. 101 (1992), with K = 0.25 c / L, L the length of the domain. By the mean over the whole
// opening in place of columns air that sloshes below an open top gains speed until it breaks up. Beside a free surface,
// which lets sound out itself, p = p_out: drops that fall out would be held back.
//
// What comes back has been at rest outside: rho u^2 / 2 less, u that of its phase. Means are over the liquid within the
// kernel, pressures and velocities behind a side over that of the phase of the particle where there is any. An inflow
// holds its velocity and therefore reflects sound, as a wall does.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "spume/operators/image_values.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/buffer_layers.hpp"
#include "spume/particles/phase_law.hpp"

namespace spume {

class AcousticLayers {
 public:
  // All outlive them.
  AcousticLayers(const Scene& scene, const Resolution& resolution, const std::vector<PhaseLaw>& laws,
                 ParticleStore& particles, const Array<std::int64_t>& phase, BufferLayers& layers);

  // Of the liquid as it is, at time t.
  struct Liquid {
    const Arrangement& arrangement;
    ImageMap images;
    Vec3 gravity{};         // zero along periodic axes
    double background = 0;  // part of the pressures
    double time = 0;
    std::function<double(int axis, std::size_t i)> velocity;
  };
  // Excess, pressure and volume over that at rest of the particles of the layers.
  void find_pressures(const Liquid& liquid, Array<double>& excess, Array<float>& pressure, Array<float>& volume);
  // Velocities behind outflows and the means of columns follow the liquid over a step, before its particles change
  // over.
  void follow(double dt);

  // The largest speed over sound speed with which an inflow lets anything enter until `end`, and its name.
  struct Fastest {
    double mach = 0;
    std::string name;
  };
  Fastest fastest_inflow(double end) const;

  void save(StateWriter& writer) const;
  void load(StateReader& reader);
  double bytes() const;

 private:
  // Of a column at an outflow.
  struct Mean {
    double outwards = 0;  // velocity
    bool known = false;
  };
  // What a particle of the layers sees of the liquid: means over its own phase where there is any, and sums over all.
  struct Seen {
    double weight = 0, pressure = 0;
    Vec3 velocity{};
    bool own = false;                              // phase, else all others
    double heaviest = 0;                           // density
    double all = 0, outwards = 0, compliance = 0;  // of u_n and of 1 / (rho c)
  };

  const OpenGate& gate_of(std::size_t i) const { return layers_.gate_of(layers_.column()[i]); }
  Mean& mean_of(std::size_t i) { return means_[static_cast<std::size_t>(layers_.column()[i])]; }
  Seen look(const Liquid& liquid, const Array<float>& pressure, std::size_t i) const;
  double share_of_step(int axis, double sound_speed, double dt) const;

  const Scene& scene_;
  const Resolution& resolution_;
  const std::vector<PhaseLaw>& laws_;
  ParticleStore& particles_;
  const Array<std::int64_t>& phase_;
  BufferLayers& layers_;
  std::vector<Mean> means_;                       // of the columns
  const Array<std::int32_t>* members_ = nullptr;  // particles of the layers
  std::vector<Seen> seen_;                        // of them
};

}  // namespace spume
