// SPDX-License-Identifier: MIT
// What keeps the volume of a weakly compressible liquid with a free surface: its densities follow the kernel sums of
// the arrangement over N spacings that the fastest particle moves,
//
//   ds_i/dt = max|u| / (N dr) l_i,   l_i = <c> + b_i (e_i - e_i within 0.01),
//   c_i = (S_i / S_lattice - 1 within 0.06) - (s'_i - <s'> at the start) - c_0,  S_i = sum_j V W_ij,  e_i = c_i - <c>,
//
// with <c> the mean with weights b, the interior weight of particles/surface.hpp, and s' the density excess less its
// hydrostatic part, g . (x - x_0) / c^2, which in a liquid at rest is the same everywhere. c_0: <c> where settled
// liquid rests (particles/settling.hpp), whose kernel sums are not a lattice's; else 0.
//
// The rate of density of the continuity equation is that of the kernel sums; where liquid meets and leaves walls,
// bodies and itself it is not that of the volume, and nothing takes back what it errs by. Without the relaxation bodies
// that grow lift a surface by 3 to 78 % of what they displace (methods/wcsph/README.md), with it by 100.5 %.
#pragma once

#include "spume/particles/arrangement.hpp"
#include "spume/particles/phase_law.hpp"

namespace spume {

class ExcessRelaxation {
 public:
  // What is relaxed; all of it outlives the relaxation. Gravity: across sides.
  struct Liquid {
    ParticleStore& particles;
    Arrangement& arrangement;
    const Resolution& resolution;
    ParticleLaws law;
    const Array<double>& excess;
    Vec3 gravity{};
    const Array<std::int64_t>* left_out = nullptr;  // particles with 0 or more are not relaxed; null: all are
  };
  // Of the liquid as it starts. `way`: N. Adds a field of state.
  ExcessRelaxation(const Liquid& liquid, double way);

  // Measures l by the present lists: a pass over the pairs.
  void measure();
  double lack(std::size_t i) const { return (*lack_)[i]; }  // l
  const double* lack() const { return lack_->data(); }
  // Of l, what is made up for while the fastest particle goes so far.
  double share_of(double way) const;

  // The present arrangement is that of liquid at rest: nothing lacks.
  void take_as_rest();

  double volume = 0;  // by the kernel sums, as measured last; state between steps
  double rest = 0;    // c_0; state between steps
  double bytes() const { return lack_->bytes(); }

 private:
  double reduced(std::size_t i) const;  // s'

  const Liquid liquid_;
  const double way_;
  const double start_;  // <s'>
  double mean_ = 0;     // <c>, as measured last
  Array<double>* lack_;
};

}  // namespace spume
