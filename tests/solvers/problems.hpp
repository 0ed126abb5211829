// SPDX-License-Identifier: MIT
// The systems that the solver tests share.
#pragma once

#include <cmath>

#include "reference/sph_operator.hpp"
#include "spume/solvers/cell_multigrid.hpp"
#include "spume/solvers/refinement.hpp"

namespace spume::reference {

// dt at courant 0.2 of a unit speed: Ma^2 / dt^2.
inline double helmholtz_of(double mach, double spacing) {
  return mach * mach / (0.04 * spacing * spacing);
}

inline SphSetup open_wave(int dimensions, double spacing, double mach) {
  SphSetup s;
  s.dimensions = dimensions;
  s.spacing = spacing;
  s.helmholtz = helmholtz_of(mach, spacing);
  s.periodic = {true, dimensions == 3, false};
  if (dimensions == 2) {
    s.upper = {1, 0.7, 1};
    s.wall[1] = {true, false};
    s.liquid = [](double x, double y, double) { return y < 0.45 + 0.1 * std::cos(6.283185307 * x); };
  } else {
    s.upper = {1, 0.5, 0.5};
    s.wall[2] = {true, false};
    s.liquid = [](double x, double, double z) { return z < 0.3 + 0.08 * std::cos(6.283185307 * x); };
  }
  return s;
}

inline SphSetup closed_box(int dimensions, double spacing, double mach) {
  SphSetup s;
  s.dimensions = dimensions;
  s.spacing = spacing;
  s.helmholtz = helmholtz_of(mach, spacing);
  s.upper = {1, 0.5, 0.25};
  s.surface = false;
  for (auto& axis : s.wall) axis = {true, true};
  return s;
}

inline SphSetup periodic_box(int dimensions, double spacing, double mach) {
  SphSetup s = closed_box(dimensions, spacing, mach);
  s.wall = {};
  s.periodic = {true, true, dimensions == 3};
  return s;
}

// A ball and a cube in the corner, nothing between them.
inline SphSetup drops(int dimensions, double spacing, double mach) {
  SphSetup s;
  s.dimensions = dimensions;
  s.spacing = spacing;
  s.helmholtz = helmholtz_of(mach, spacing);
  s.upper = {1, 1, 1};
  s.liquid = [dimensions](double x, double y, double z) {
    const double dz = dimensions == 3 ? z - 0.5 : 0, cz = dimensions == 3 ? z : 0;
    return (x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5) + dz * dz < 0.09 || (x < 0.2 && y < 0.2 && cz < 0.2);
  };
  return s;
}

inline CellGeometry geometry_of(const SphSetup& s) {
  CellGeometry g;
  g.dimensions = s.dimensions;
  g.lower = s.lower;
  g.upper = s.upper;
  g.periodic = s.periodic;
  g.wall = s.wall;
  g.cell_size = 1.5 * s.spacing;
  return g;
}

// The assembled system, its operators, a right-hand side, and the preconditioner after setup.
struct Problem {
  explicit Problem(const SphSetup& setup)
      : system(assemble(setup)),
        exact(system.matrix),
        fast(system.matrix),
        multigrid(geometry_of(setup)),
        singular(!setup.surface && setup.helmholtz == 0) {
    Eigen::VectorXd rhs = system.right_hand_side();
    if (singular) rhs.array() -= rhs.mean();
    b.assign(rhs.data(), rhs.data() + rhs.size());
    multigrid.setup(system.x, system.y, system.z, system.interior, setup.helmholtz, system.diagonal);
    diagonal.assign(system.diagonal.begin(), system.diagonal.end());
  }
  std::size_t size() const { return system.size(); }

  SphSystem system;
  SparseOperator<double> exact;
  SparseOperator<float> fast;
  CellMultigrid multigrid;
  bool singular;
  std::vector<double> b, diagonal;
};

// An assembled system A x = b as the refinement sees it, corrected in float.
class AssembledSystem final : public RefinedSystem {
 public:
  KrylovMethod method = KrylovMethod::bicgstab;
  int measured = 0;  // residuals b - A x

  AssembledSystem(SparseOperator<double>& exact, SparseOperator<float>& fast, Preconditioner<float>& preconditioner,
                  std::span<const double> b, std::span<double> x, CorrectionWorkspace<float>& work)
      : exact_(exact), fast_(fast), preconditioner_(preconditioner), b_(b), x_(x), work_(work) {
    change_.resize(b.size());
    product_.resize(b.size());
  }
  void residual(std::span<double> r) override {
    ++measured;
    exact_.apply(x_, r);
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = b_[i] - r[i];
  }
  KrylovResult correct(std::span<const double> r, const CorrectionTask& task) override {
    size_ = task.size;
    return correct_by_krylov<float>(method, fast_, preconditioner_, r, task, x_, work_);
  }
  void subtract_product(std::span<double> r) override {
    for (std::size_t i = 0; i < r.size(); ++i) change_[i] = size_ * work_.correction[i];
    exact_.apply(change_, product_);
    for (std::size_t i = 0; i < r.size(); ++i) r[i] -= product_[i];
  }

 private:
  SparseOperator<double>& exact_;
  SparseOperator<float>& fast_;
  Preconditioner<float>& preconditioner_;
  std::span<const double> b_;
  std::span<double> x_;
  CorrectionWorkspace<float>& work_;
  Array<double> change_, product_;
  double size_ = 0;
};

// Euclidean norm, of what is left without the mean where that is removed.
inline double norm_of(std::span<const double> values, bool without_mean = false) {
  double mean = 0, squares = 0;
  for (const double value : values) mean += without_mean ? value / static_cast<double>(values.size()) : 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares);
}

}  // namespace spume::reference
