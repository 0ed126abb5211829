// SPDX-License-Identifier: MIT
// Weakly compressible liquid that starts at rest: the arrangement that its pressure holds.
//
// A lattice is no place to rest on. Under Wendland's kernel of 1.3 spacings rows of a square one that slide by half a
// spacing lower its kernel sums, from 1.0105 to 1.0088 where they are hexagonal: it breaks up within 6 sqrt(H/g), and
// the pressure times that is kinetic energy, 0.05 sqrt(gH), which nothing dissipates without viscosity. Where phases
// meet the slope of the pressure has a kink, which the sums of a lattice miss. Beside bodies, which cut the lattice,
// sums are off by a tenth, and still water begins with 0.13 to 0.5 sqrt(gH). So the particles move until the pressure
// at rest holds each of them, beginning off the lattice: on it they would stay.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "spume/core/go_on.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/phase_law.hpp"
#include "spume/particles/still_liquid.hpp"

namespace spume {

struct Settling {
  const Scene& scene;
  const Boundary& boundary;
  const Resolution& resolution;
  ParticleStore& particles;
  Arrangement& arrangement;  // in a full tank the kernel gradient becomes exact in it: SweepContext::gradient_scale
  ParticleLaws law;
  Array<double>& excess;  // of each particle that of the pressure at its height; it follows the particle
  Vec3 gravity{};         // across sides
  StillLiquid still;      // forces are without its pressure
  // The stress by which sides part particles over its (W / W(spacing))^4 - 1, over rho_0; 0: none.
  double of_sides = 0;
  const std::vector<std::uint8_t>& chosen;  // by identifier, 1 for those that move; empty: all
  int most_rounds = 0;

  struct Forces {
    const float* pressure = nullptr;
    const FloatVectorScratch& force;  // (rho du/dt)_i by pressure
  };
  using UseForces = std::function<void(const Forces&)>;
  // Lists and images where the particles are now, and the forces by the pressures of `excess` there: as the method
  // finds those of a step. They are there until `use` has returned.
  std::function<void(const UseForces& use)> with_forces;

  // Moves the particles; says what is left where it ended with an acceleration of more than 0.0003 of gravity. `go_on`,
  // which may be empty, is asked after each round.
  std::string settle(const GoOn& go_on) const;

 private:
  struct Round;
  bool meets_side(std::size_t i) const;
  bool moves(std::size_t id) const { return chosen.empty() || chosen[id] != 0; }
  void raise_datum() const;
  Vec3 move(std::size_t i, const Vec3& way) const;  // the direction of its contact, if any
  void step(Round& round) const;
  void fit_gradient_scale() const;
  HowFar how_far(int rounds, const Round& round) const;
  std::string in_words(const Round& round) const;
};

}  // namespace spume
