// SPDX-License-Identifier: MIT
// How long lists of neighbours live that were made with a skin: until a step may bring two nearer to each other than
// the support who are in no list.
//
// After each look at all particles the lists have something in hand, what those outside them are farther apart than the
// support: the skin less twice the longest way since they were made, or the bound of neighbours/list_skin.hpp where
// that is more. A step takes no more of it than twice the fastest could go, so that nobody is looked at while it lasts.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "spume/neighbours/list_skin.hpp"
#include "spume/particles/arrangement.hpp"

namespace spume {

class ListLife {
 public:
  // `together`: whether everybody in the lists goes with the particles, sides hold these without moving them farther
  // than their step, and no side moves. Else the longest way alone decides, and everybody is looked at in every step.
  ListLife(const Arrangement& arrangement, const ParticleStore& particles, double support_radius, double skin,
           bool together)
      : arrangement_(arrangement),
        particles_(particles),
        support_radius_(support_radius),
        skin_(skin),
        together_(together) {}

  // Of the state: r + dt (u + delta u + dt/2 a) is where the particles will be.
  struct Motion {
    std::array<const float*, 3> listed{};        // places of the lists, from the origin of the arrangement
    std::array<const float*, 3> acceleration{};  // a
    std::array<const float*, 3> shift{};         // delta u; null: none
  };
  // Whether the lists last through a step. dt = 0: particles have come where they are by no step of velocities.
  bool last(double dt, const Motion& motion, const ImageRules& rules, ScratchPool& scratch);

  // Lists have been made anew where the particles are; or the same again, of a state that has been restored.
  void renew() {
    slack_ = skin_;
    helped_ = false;
    if (waiting_ > 0) --waiting_;
    remake();
  }
  void remake() { list_skin_.renew(); }
  void accept() { slack_ = next_slack_; }
  double bytes() const { return list_skin_.bytes(); }
  bool together() const { return together_; }
  std::int64_t asked() const { return asked_; }  // how often for the bound

  // State between steps: of the fastest particles |u + delta u| and |a|, read where they go together; and what refused
  // steps too may change, as the places of the lists.
  double fastest = 0, most_accelerated = 0;
  static constexpr std::size_t state_size = 4;
  std::vector<double> state(double beside) const;  // with another number behind it
  void restore(const double* state);

 private:
  const Arrangement& arrangement_;
  const ParticleStore& particles_;
  const double support_radius_, skin_;
  const bool together_;
  double slack_ = 0, next_slack_ = 0;  // in hand, and at the end of the step
  // Whether the bound has helped these lists, how many it is not asked for, and how many it was not the last time.
  bool helped_ = false;
  int waiting_ = 0, waited_ = 0;
  std::int64_t asked_ = 0;
  ListSkin list_skin_;
};

}  // namespace spume
