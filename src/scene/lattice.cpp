// SPDX-License-Identifier: MIT
#include "spume/scene/lattice.hpp"

#include <algorithm>
#include <cmath>

namespace spume {

Lattice make_lattice(const Domain& domain, double spacing) {
  Lattice lattice;
  lattice.dimensions = domain.dimensions;
  lattice.spacing = {1, 1, 1};
  for (std::size_t a = 0; a < static_cast<std::size_t>(domain.dimensions); ++a) {
    const double length = domain.upper[a] - domain.lower[a];
    const bool lower_closed = domain.sides[a][0].bounds_liquid();
    const bool upper_closed = domain.sides[a][1].bounds_liquid();
    lattice.origin[a] = domain.lower[a];
    if (lower_closed && upper_closed) {
      lattice.count[a] = std::max(1.0, std::round(length / spacing));
      lattice.spacing[a] = length / lattice.count[a];
    } else {
      lattice.count[a] = std::max(1.0, std::ceil(length / spacing - 0.5 - 1e-9));
      lattice.spacing[a] = spacing;
      if (upper_closed) lattice.origin[a] = domain.upper[a] - lattice.count[a] * spacing;
    }
  }
  return lattice;
}

}  // namespace spume
