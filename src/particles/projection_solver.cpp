// SPDX-License-Identifier: MIT
#include "spume/particles/projection_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"

namespace spume {
namespace {

CellGeometry cell_geometry(const Boundary& boundary, double cell_size) {
  const Domain& domain = boundary.domain();
  CellGeometry geometry;
  geometry.dimensions = domain.dimensions;
  geometry.cell_size = cell_size;
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    geometry.lower[axis] = boundary.next_walls[axis][0];
    geometry.upper[axis] = boundary.next_walls[axis][1];
    geometry.periodic[axis] = domain.periodic(axis);
    for (int side = 0; side < 2; ++side) geometry.wall[axis][side] = is_wall(domain.sides[axis][side].kind);
  }
  for (const SolidBox& box : domain.boxes) geometry.solids.push_back({box.lower, box.upper});
  return geometry;
}

double norm(std::span<const double> values) {
  return std::sqrt(parallel_sum(values.size(), [&](std::size_t i) { return values[i] * values[i]; }));
}

// Krylov options of one correction: the residual has the norm `size` and shall fall below `target`.
template <class Real>
KrylovOptions<Real> correction_options(double size, double target, double most_digits, int left, bool singular) {
  KrylovOptions<Real> krylov;
  krylov.tolerance = std::clamp(0.5 * target / size, most_digits, 0.5);
  krylov.max_iterations = left;
  krylov.zero_guess = true;
  krylov.confirm = false;
  krylov.remove_mean = singular;
  return krylov;
}

template <class Real>
KrylovResult run_krylov(bool conjugate, LinearOperator<Real>& a, Preconditioner<Real>& m, std::span<const Real> b,
                        std::span<Real> x, const KrylovOptions<Real>& options, KrylovWorkspace<Real>& work) {
  return conjugate ? conjugate_gradients<Real>(a, m, b, x, options, work) : bicgstab<Real>(a, m, b, x, options, work);
}

// The vectors of a Krylov method, leased.
class LeasedWorkspace : public KrylovWorkspace<float> {
 public:
  LeasedWorkspace(ScratchPool& scratch, std::size_t size) : scratch_(scratch) {
    for (Array<float>* array : all()) scratch.lease(*array, size);
  }
  LeasedWorkspace(const LeasedWorkspace&) = delete;
  LeasedWorkspace& operator=(const LeasedWorkspace&) = delete;
  ~LeasedWorkspace() {
    for (Array<float>* array : all()) scratch_.release(*array);
  }

 private:
  std::array<Array<float>*, 7> all() {
    return {&residual, &shadow, &direction, &preconditioned, &image, &second_image, &second_preconditioned};
  }
  ScratchPool& scratch_;
};

}  // namespace

void PressureRows::release(ScratchPool& scratch) {
  for (Array<float>* array : {&diagonal_shift, &diagonal, &weight, &row}) scratch.release(*array);
  scratch.release(right_hand_side);
}

// The particle matrix as the Krylov solvers see it.
struct ProjectionSolver::Operator final : LinearOperator<float> {
  Operator(PressureOperator& matrix, int& applications) : matrix_(matrix), applications_(applications) {}
  std::size_t size() const override { return matrix_.size(); }
  void apply(std::span<const float> x, std::span<float> y) override {
    matrix_.apply(x, y, x);
    ++applications_;
  }
  Dots apply_with_dots(std::span<const float> x, std::span<float> y, std::span<const float> w) override {
    ++applications_;
    return matrix_.apply(x, y, w);
  }
  PressureOperator& matrix_;
  int& applications_;
};

// The same in double, for comparison: A x = -(0 - A x).
struct ProjectionSolver::DoubleOperator final : LinearOperator<double> {
  DoubleOperator(PressureOperator& matrix, int& applications, std::span<const double> zero)
      : matrix_(matrix), applications_(applications), zero_(zero) {}
  std::size_t size() const override { return matrix_.size(); }
  void apply(std::span<const double> x, std::span<double> y) override {
    matrix_.residual(x, zero_, y);
    parallel_for(y.size(), [&](std::size_t i) { y[i] = -y[i]; });
    ++applications_;
  }
  PressureOperator& matrix_;
  int& applications_;
  std::span<const double> zero_;
};

ProjectionSolver::ProjectionSolver(const Boundary& boundary, const Options& options) : options_(options) {
  if (options.multigrid) multigrid_ = std::make_unique<CellMultigrid>(cell_geometry(boundary, options.cell_size));
}

void ProjectionSolver::prepare(const PressureRows& rows, ParticleStore& particles, const VectorField& at,
                               const Boundary& boundary) {
  if (multigrid_ == nullptr) return;
  const std::size_t n = particles.size();
  if (boundary.features.displaced_walls) multigrid_->set_geometry(cell_geometry(boundary, options_.cell_size));
  ScratchArray<float> inside(particles.scratch(), n);
  parallel_for(n, [&](std::size_t i) {
    inside[i] = rows.pressure_fixed != nullptr && (*rows.pressure_fixed)[i] != 0 ? 0.0F : 1.0F;
  });
  const auto r = read(at);
  const auto span = [&](int axis) {
    return axis < particles.dimensions ? std::span(r[axis], n) : std::span<const double>();
  };
  multigrid_->setup(span(0), span(1), span(2), inside, rows.helmholtz, rows.diagonal);
}

// Residuals are scaled to order one: float keeps its range for any units. A correction gains at most three digits,
// rounding in float spoils more.
KrylovResult ProjectionSolver::correct(const PressureRows& rows, ParticleStore& particles,
                                       const Array<double>& residual, double size, double target, int left,
                                       Array<float>& correction, Array<double>& q) {
  const std::size_t n = residual.size();
  LeasedWorkspace work(particles.scratch(), n);
  ScratchArray<float> right_hand_side(particles.scratch(), n);
  Operator a(operator_, report_.applications);
  JacobiPreconditioner<float> jacobi(rows.diagonal);
  Preconditioner<float>* preconditioner = &jacobi;
  if (multigrid_ != nullptr) preconditioner = multigrid_.get();
  parallel_for(n, [&](std::size_t i) { right_hand_side[i] = static_cast<float>(residual[i] / size); });
  const auto options = correction_options<float>(size, target, 1e-3, left, rows.singular);
  const KrylovResult result =
      run_krylov<float>(options_.conjugate_gradients, a, *preconditioner, right_hand_side, correction, options, work);
  parallel_for(n, [&](std::size_t i) { q[i] += size * correction[i]; });
  return result;
}

KrylovResult ProjectionSolver::correct_in_double(const PressureRows& rows, ParticleStore& particles,
                                                 const Array<double>& residual, double size, double target, int left,
                                                 Array<double>& q) {
  const std::size_t n = particles.size();
  for (auto* array : {&double_correction_, &zero_, &double_diagonal_}) array->resize(n);
  parallel_for(n, [&](std::size_t i) { double_diagonal_[i] = rows.diagonal[i]; });
  DoubleOperator a(operator_, report_.applications, zero_);
  JacobiPreconditioner<double> jacobi(double_diagonal_);
  Preconditioner<double>* preconditioner = &jacobi;
  if (multigrid_ != nullptr) preconditioner = multigrid_.get();
  const auto options = correction_options<double>(size, target, 1e-12, left, rows.singular);
  const KrylovResult result = run_krylov<double>(options_.conjugate_gradients, a, *preconditioner, residual,
                                                 double_correction_, options, double_work_);
  parallel_for(n, [&](std::size_t i) { q[i] += double_correction_[i]; });
  return result;
}

void ProjectionSolver::solve(const PressureRows& rows, Arrangement& arrangement, ParticleStore& particles,
                             Array<double>& q) {
  const std::size_t n = particles.size();
  PressureMatrix matrix{rows.diagonal_shift.data(),
                        rows.pressure_fixed == nullptr ? nullptr : rows.pressure_fixed->data()};
  if (!rows.weight.empty()) {
    matrix.weight = rows.weight.data();
    matrix.row = rows.row.data();
  }
  operator_.bind(arrangement.context, arrangement.packed, matrix);
  report_ = {};

  // Iterative refinement: residuals in double, corrections in float.
  ScratchArray<double> residual(particles.scratch(), n);
  ScratchArray<float> correction(particles.scratch(), options_.mixed ? n : 0);
  const double target = options_.tolerance * rows.reference_norm;
  for (int round = 0;; ++round) {
    if (round == 0 || !options_.mixed) {
      operator_.residual(q, rows.right_hand_side, residual);
      ++report_.applications;
    }
    if (rows.singular) {
      const double mean = parallel_sum(n, [&](std::size_t i) { return residual[i]; }) / static_cast<double>(n);
      parallel_for(n, [&](std::size_t i) { residual[i] -= mean; });
    }
    const double size = norm(residual);
    report_.relative_residual = rows.reference_norm > 0 ? size / rows.reference_norm : 0;
    if (size <= target) return;
    const int left = options_.max_iterations - report_.iterations;
    if (!std::isfinite(size) || left <= 0 || round > 20) {
      report_.converged = false;
      return;
    }
    const KrylovResult result = options_.mixed ? correct(rows, particles, residual, size, target, left, correction, q)
                                               : correct_in_double(rows, particles, residual, size, target, left, q);
    report_.iterations += std::max(result.iterations, 1);
    // Rounding in float leaves about 1e-3 of the residual that a correction started from: where a hundredth was to be
    // reached, the recurrence may be trusted and a sweep in double is saved.
    if (result.converged && size <= 100 * target) {
      report_.relative_residual = result.relative_residual * size / rows.reference_norm;
      return;
    }
    if (options_.mixed) {
      operator_.subtract_product(size, correction, residual);
      ++report_.applications;
    }
  }
}

double ProjectionSolver::bytes() const {
  double total = operator_.bytes() + double_work_.bytes();
  for (const auto* array : {&double_correction_, &zero_, &double_diagonal_}) total += array->bytes();
  return multigrid_ == nullptr ? total : total + multigrid_->bytes();
}

void demand_convergence(const SolveReport& report, const std::string& solve) {
  if (report.converged) return;
  StepFailure::Details details;
  details.cause = solve + " did not converge in " + std::to_string(report.iterations) + " iterations";
  details.option = "pressure.max_iterations";
  details.value = report.relative_residual;
  throw StepFailure(details);
}

}  // namespace spume
