// SPDX-License-Identifier: MIT
// How values at points behind walls and openings follow from particles: by the fit of the highest order, up to 2, that
// the particles around a place bear, with coefficients that add up to 1. Blocks of points are fitted side by side and
// joined in their order.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "spume/operators/moving_least_squares.hpp"
#include "spume/operators/wall_stencils.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/near_particles.hpp"

namespace spume {

// What a block of points found, in their order.
struct PointFits {
  static constexpr std::size_t block = 128;    // points of a block
  std::vector<std::int32_t> nearest, entries;  // per point
  std::vector<std::int32_t> source;            // per entry
  std::vector<double> coefficient;
  std::vector<double> bend;  // per entry of the points that have one, zero of those between
};

// The particles around one place after another. One per thread.
template <int dimensions>
class PointFit {
 public:
  explicit PointFit(const Resolution& resolution)
      : spacing_(resolution.spacing),
        smoothing_length_(resolution.smoothing_length),
        reach_(fit_reach_of(dimensions) * resolution.support_radius) {}

  double reach() const { return reach_; }
  // The particles within the reach of a place, of which those that add() names are taken.
  const NearParticles& begin(const Domain& domain, const Arrangement& arrangement, const VectorField& at,
                             const Vec3& place) {
    near_.find(domain, arrangement.grid, arrangement.table, read(at), place, reach_);
    taken_.clear();
    nearest_ = 0;
    nearest2_ = std::numeric_limits<double>::infinity();
    return near_;
  }
  void add(std::size_t k) {
    taken_.push_back(static_cast<std::int32_t>(k));
    if (near_.r2(k) >= nearest2_) return;
    nearest2_ = near_.r2(k);
    nearest_ = near_.particle(k);
  }
  // The order that the particles bear, -1: none; above order 0 the sum of |c_j| is `most_moduli` at most.
  int fit(double most_moduli = std::numeric_limits<double>::infinity());
  // Adds the point of the last fit.
  void append(PointFits& fits);
  // The bend e_j of WallStencils of the point added last, which lies at `behind` from the place of its fit; zero where
  // that is not quadratic. Ends the fit.
  void append_bend(const Vec3& behind, PointFits& fits);
  // Adds a point without entries.
  void append_none(PointFits& fits) const {
    fits.nearest.push_back(nearest_);
    fits.entries.push_back(0);
  }

 private:
  // Offsets less `behind` and weights of the particles taken, and `more` places for others. Returns the sum of weights.
  double fill(const Vec3& behind, std::size_t more);

  const double spacing_, smoothing_length_, reach_;
  MovingLeastSquares<dimensions> fit_;
  NearParticles near_;
  std::vector<std::int32_t> taken_;
  std::int32_t nearest_ = 0;
  double nearest2_ = 0;
  int order_ = -1;
};

// Makes room for the points of the blocks behind those that the stencils have, and sets their entries and the nearest
// particles. Returns the first of the new points.
std::size_t append_points(const std::vector<PointFits>& blocks, int dimensions, WallStencils& stencils);

}  // namespace spume
