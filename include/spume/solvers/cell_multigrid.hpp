// SPDX-License-Identifier: MIT
// Additive two-scale preconditioner for the particle pressure operator:
//
//   z = D^-1 r + S P B P^T S r,
//
// with D the diagonal of the particle matrix, S = diag(interior weight), P the (bi-, tri-)linear interpolation from
// cell centres to particles and B one multigrid V-cycle for the cell-integrated Helmholtz operator
// -laplacian + helmholtz. The particle matrix is volume-weighted, A_ij = -V_i V_j w_ij with
// sum_j V_j w_ij (q_i - q_j) ~ -laplacian q, so P^T r is the residual integrated over cells and no further scaling
// is needed. z = M r is symmetric and positive definite: conjugate gradients may use it.
//
// Cells without an interior particle hold zero pressure; walls and solid boxes have zero normal gradient; periodic
// axes wrap. Everything inside is float, applies to float and double vectors, is bit-identical for any thread count
// and allocates nothing once sizes have settled.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/solvers/cell_hierarchy.hpp"
#include "spume/solvers/linear_operator.hpp"

namespace spume {

struct CellGeometry {
  struct Box {
    std::array<double, 3> lower{}, upper{};
  };
  int dimensions = 3;                      // 2: z is ignored
  std::array<double, 3> lower{}, upper{};  // domain
  std::array<bool, 3> periodic{};
  std::array<std::array<bool, 2>, 3> wall{};  // wall[axis][0] at lower, [1] at upper; otherwise open
  std::vector<Box> solids;                    // impermeable boxes inside the domain
  // Of impermeable bodies of any shape: the distance from their surface, negative inside; null without.
  std::function<double(const std::array<double, 3>&)> distance = {};
  // True where a place is known to lie farther outside than that, which costs less; null: never known.
  std::function<bool(const std::array<double, 3>&, double)> farther = {};
  double cell_size = 0;  // about 1.5 particle spacings; adjusted to fit between walls
};

class CellMultigrid final : public Preconditioner<float>, public Preconditioner<double> {
 public:
  // Throws std::invalid_argument when the sizes make no sense.
  explicit CellMultigrid(const CellGeometry& geometry);

  // For walls or solids that move: takes effect at the next setup().
  void set_geometry(const CellGeometry& geometry);

  // Bins the particles and builds the levels. All spans have one entry per particle; z is ignored in two dimensions.
  //   interior     in [0, 1]: 0 for rows that are masked or pinned to zero (they are then preconditioned by the
  //                diagonal alone), 1 inside the liquid
  //   helmholtz    Ma^2 / dt^2 in 1/length^2, zero for an incompressible liquid
  //   diagonal     A_ii; stays the caller's, who keeps it until the next setup()
  //   coefficient  c of -div(c grad), positive; empty: 1. Cells have the mean of their particles, 1 / c the mean of two
  //                cells across their face: what differs a thousandfold from cell to cell then conducts as little as
  //                the pairs do
  // Particles with non-finite positions take part through the diagonal only. Particles outside a wall count for the
  // cell at that wall.
  void setup(std::span<const double> x, std::span<const double> y, std::span<const double> z,
             std::span<const float> interior, double helmholtz, std::span<const float> diagonal,
             std::span<const float> coefficient = {});

  void apply(std::span<const float> r, std::span<float> z) override;
  void apply(std::span<const double> r, std::span<double> z) override;

  std::array<int, 3> cells() const { return hierarchy_.finest().cells; }
  int level_count() const { return hierarchy_.level_count(); }
  double bytes() const;

 private:
  // Position of a particle between the centres of its 2^d nearest cells, and its interior weight.
  struct Stencil {
    float fx, fy, fz, weight;
  };
  struct Axis {
    double origin = 0;  // coordinate of the lower face of cell 0 of the whole axis
    double width = 1;
    int count = 0;  // cells of the whole axis between walls or periodic sides, 0 when a side is open
    bool lower_wall = false, upper_wall = false, periodic = false;
  };

  struct Range {
    double lower[3] = {0, 0, 0}, upper[3] = {0, 0, 0};
    bool any = false;
  };
  // Where a particle is among the cells: the lowest of the 2^d that it lies between, how far to the next, and its own.
  struct CellPlace {
    int lowest[3] = {0, 0, 0}, own[3] = {0, 0, 0};
    float fraction[3] = {0, 0, 0};
  };

  Range liquid_range(std::span<const double> const (&position)[3], std::span<const float> interior) const;
  void set_axis(std::size_t a, double size);
  std::array<int, 2> box_along(const Axis& axis, double lower, double upper) const;
  void choose_box(std::span<const double> const (&position)[3], std::span<const float> interior);
  void clear_cells();
  bool place_along(std::size_t axis, double position, CellPlace& place) const;  // false: not at a finite place
  void place(std::size_t p, std::span<const double> const (&position)[3], float interior);
  std::atomic_ref<std::int32_t> start_of(std::size_t particle);  // of the list of its stencil cell
  void counts_to_ends();
  void sort_cells();
  void bin(std::span<const double> const (&position)[3], std::span<const float> interior);
  void mark_solids();
  void mark_bodies();
  void find_shore();
  void spread_from_shore();
  void extend_to_shore();
  void fill_holes();
  void set_coefficients(double helmholtz);
  void find_cell_coefficients(std::span<const float> coefficient);
  void multiply_faces();
  void spread(const float* r);
  void collect();
  template <class Real>
  void apply_any(std::span<const Real> r, std::span<Real> z);

  CellGeometry geometry_;
  std::array<Axis, 3> axis_{};
  std::array<double, 3> width_{}, inverse_width_{};  // cell width in use
  std::array<int, 3> first_cell_{};                  // index along the whole axis of the first cell of the box
  std::size_t particles_ = 0;
  bool empty_ = true;  // no interior particle: M = D^-1

  Array<Stencil> stencil_;           // per particle
  Array<std::int32_t> corner_;       // per particle: lowest cell of the stencil in the corner array, -1 for none
  std::span<const float> diagonal_;  // the caller's
  Array<std::int32_t> start_;        // per entry of the corner array but for its last plane: first entry in order_
  Array<std::int32_t> order_;        // particles sorted by stencil cell, then by index
  Array<std::int32_t> row_total_;    // particles before each row of that
  Array<std::uint8_t> status_;       // per cell: empty, interior or solid
  Array<float> open_volume_, open_face_[3];  // open fractions, only with solids
  // Solid cells beside liquid, which particles before the solid interpolate between: each has the mean of the liquid
  // across its faces, else its edges, else its corners, cells shore_next_[k] for k from shore_first_[s] to
  // shore_first_[s + 1]. With zero there, a liquid around a box takes 42 iterations in place of 7.
  std::vector<std::size_t> shore_, shore_first_, shore_next_;
  Array<std::int32_t> shore_cells_;
  Array<float> cell_coefficient_;       // of the cells, with a coefficient alone; laid out as their right-hand side
  Array<float> partial_;                // spread sums per row of stencil cells and side
  Array<float> corner_value_;           // cell values with wrapped upper neighbours
  Array<float> residual_, correction_;  // float copies for double vectors
  CellHierarchy hierarchy_;
};

}  // namespace spume
