// SPDX-License-Identifier: MIT
// Walls that give something of a scalar: a flux, or a value. The sections [[scalar_wall]] name flat sides of the
// domain.
//
// Without them a side is a mirror: pair sums see a profile that is even about it. A gradient G along the distance d
// from the wall adds to their rates D G R(d), with
//   R(d) = sum_k P_k 2 (k dr - d),   over the planes k of a lattice behind the wall, P_k the pair weights of one,
// so that a linear profile on a lattice stays as it is. With sum_k P_k (k dr)^2 = 1, the second moment of the pair sum,
// R gives the whole flux: its sum over the layers of a lattice times dr, and its integral, are 1. A flux gives D G =
// -q, a value c_w gives D G = D (c - c_w) / d, and counts among the exchanges that divide a step.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spume/particles/resolution.hpp"

namespace spume {

struct Draft;
class Expression;
class Problems;
struct Section;

struct ScalarWall {
  std::size_t scalar = 0;
  int axis = 0, end = 0;                    // of the side
  std::shared_ptr<const Expression> flux;   // into the liquid, amount per area and time; or
  std::shared_ptr<const Expression> value;  // at the wall
};
struct ScalarWalls {
  std::vector<ScalarWall> walls;
};

Section scalar_wall_section();
// Names of scalars and sides; completes ScalarWalls but for the expressions. Behind the checks that add scalars.
void check_scalar_walls(Draft& draft, Problems& problems);

// R(d) of the kernel of a resolution.
class WallProfile {
 public:
  explicit WallProfile(const Resolution& resolution);
  double operator()(double distance) const;

 private:
  double spacing_;
  std::vector<double> planes_;  // P_k, from k = 1 on
};

}  // namespace spume
