// SPDX-License-Identifier: MIT
#include "spume/particles/projection_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/solvers/null_space.hpp"

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
    for (int side = 0; side < 2; ++side) geometry.wall[axis][side] = boundary.holds(axis, side);
  }
  for (const SolidBox& box : domain.boxes) geometry.solids.push_back({box.lower, box.upper});
  if (const BodyWalls* bodies = boundary.bodies(); bodies != nullptr) {
    geometry.distance = [bodies](const std::array<double, 3>& place) { return bodies->distance(place); };
    geometry.farther = [bodies](const std::array<double, 3>& place, double gap) {
      return bodies->surely_farther(place, gap);
    };
  }
  return geometry;
}

// Of the diagonal, what a row makes of a constant that is in its null space: rounding of floats leaves 1e-6, a
// neighbour whose pressure is given at the edge of the support 1e-3.
constexpr double of_no_constant = 1e-4;

// Whether a particle sees the wall of a body that has a motion. Points behind openings come after those of bodies.
bool meets_moving_body(const Boundary& boundary, const SweepContext& context, std::int32_t i) {
  const BodyWalls& bodies = *boundary.bodies();
  const auto n = static_cast<std::int32_t>(context.list->particles());
  const std::int32_t* point = context.images->wall_point();
  for (const std::int32_t j : context.list->of(static_cast<std::size_t>(i))) {
    const std::int32_t wet = j < n || point == nullptr ? -1 : point[j - n];
    if (wet < 0 || static_cast<std::size_t>(wet) >= bodies.stencils().size()) continue;
    const auto body = static_cast<std::size_t>(bodies.body_of_wet(static_cast<std::size_t>(wet)));
    if (bodies.bodies()[body].motion) return true;
  }
  return false;
}

// Of how fast all liquid could accelerate a body, what counts as nothing: edges of the liquid on its surface leave
// some.
constexpr double no_response = 1e-4;

template <class Real>
void subtract_mean(std::span<Real> values) {
  const double mean = parallel_sum(values.size(), [&](std::size_t i) { return static_cast<double>(values[i]); }) /
                      static_cast<double>(std::max<std::size_t>(values.size(), 1));
  parallel_for(values.size(), [&](std::size_t i) { values[i] -= static_cast<Real>(mean); });
}

// The vectors of a correction in float, leased for a solve.
class LeasedWorkspace : public CorrectionWorkspace<float> {
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
  std::array<Array<float>*, 9> all() {
    return {&correction,
            &krylov.residual,
            &krylov.shadow,
            &krylov.direction,
            &krylov.preconditioned,
            &krylov.image,
            &krylov.second_image,
            &krylov.second_preconditioned,
            &right_hand_side};
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
  Operator(ProjectionMatrix& matrix, const PressureRows& rows, const PartConstants& enclosed, bool singular)
      : matrix_(matrix), enclosed_(enclosed), without_mean_(singular && rows.unsymmetric) {}
  std::size_t size() const override { return matrix_.size(); }
  void apply(std::span<const float> x, std::span<float> y) override {
    matrix_.apply(x, y, x);
    if (!enclosed_.empty())
      enclosed_.remove(y);
    else if (without_mean_)
      subtract_mean(y);
  }
  Dots apply_with_dots(std::span<const float> x, std::span<float> y, std::span<const float> w) override {
    return without_mean_ || !enclosed_.empty() ? LinearOperator<float>::apply_with_dots(x, y, w)
                                               : matrix_.apply(x, y, w);
  }
  ProjectionMatrix& matrix_;
  const PartConstants& enclosed_;
  bool without_mean_;
};

// The same in double, for comparison: A x = -(0 - A x). Its weights are floats, so that it is symmetric to 1e-8 at
// most, which matters to the tolerances that double is for: the mean is taken out of products of a symmetric matrix
// too.
struct ProjectionSolver::DoubleOperator final : LinearOperator<double> {
  DoubleOperator(ProjectionMatrix& matrix, const PartConstants& enclosed, bool singular, std::span<const double> zero)
      : matrix_(matrix), enclosed_(enclosed), zero_(zero), without_mean_(singular) {}
  std::size_t size() const override { return matrix_.size(); }
  void apply(std::span<const double> x, std::span<double> y) override {
    matrix_.residual(x, zero_, y, false);
    parallel_for(y.size(), [&](std::size_t i) { y[i] = -y[i]; });
    if (!enclosed_.empty())
      enclosed_.remove(y);
    else if (without_mean_)
      subtract_mean(y);
  }
  ProjectionMatrix& matrix_;
  const PartConstants& enclosed_;
  std::span<const double> zero_;
  bool without_mean_;
};

// Residuals in double, corrections in float.
class ProjectionSolver::MixedSystem final : public RefinedSystem {
 public:
  MixedSystem(ProjectionSolver& solver, const PressureRows& rows, ScratchPool& scratch, std::span<double> q)
      : solver_(solver), rows_(rows), work_(scratch, q.size()), q_(q) {}

  void residual(std::span<double> r) override { solver_.matrix_->residual(q_, rows_.right_hand_side, r, true); }
  KrylovResult correct(std::span<const double> r, const CorrectionTask& task) override {
    size_ = task.size;
    Operator a(*solver_.matrix_, rows_, solver_.enclosed_, solver_.singular_);
    JacobiPreconditioner<float> jacobi(rows_.diagonal);
    return correct_by_krylov<float>(solver_.options_.method, a, solver_.preconditioner(jacobi), r, task, q_, work_);
  }
  void subtract_product(std::span<double> r) override { solver_.matrix_->subtract_product(size_, work_.correction, r); }

 private:
  ProjectionSolver& solver_;
  const PressureRows& rows_;
  LeasedWorkspace work_;
  std::span<double> q_;
  double size_ = 0;  // of the residual that the last correction started from
};

// All in double.
class ProjectionSolver::DoubleSystem final : public RefinedSystem {
 public:
  DoubleSystem(ProjectionSolver& solver, const PressureRows& rows, std::span<double> q)
      : solver_(solver), rows_(rows), q_(q) {}

  void residual(std::span<double> r) override { solver_.matrix_->residual(q_, rows_.right_hand_side, r, true); }
  KrylovResult correct(std::span<const double> r, const CorrectionTask& task) override {
    solver_.zero_.resize(r.size());
    solver_.double_diagonal_.resize(r.size());
    parallel_for(r.size(), [&](std::size_t i) { solver_.double_diagonal_[i] = rows_.diagonal[i]; });
    DoubleOperator a(*solver_.matrix_, solver_.enclosed_, solver_.singular_, solver_.zero_);
    JacobiPreconditioner<double> jacobi(solver_.double_diagonal_);
    return correct_by_krylov<double>(solver_.options_.method, a, solver_.preconditioner(jacobi), r, task, q_,
                                     solver_.double_work_);
  }
  void subtract_product(std::span<double> r) override { residual(r); }

 private:
  ProjectionSolver& solver_;
  const PressureRows& rows_;
  std::span<double> q_;
};

template <class Real>
Preconditioner<Real>& ProjectionSolver::preconditioner(JacobiPreconditioner<Real>& jacobi) {
  if (multigrid_ != nullptr) return *multigrid_;
  return jacobi;
}

ProjectionSolver::Options projection_options(const PressureOptions& pressure, double spacing) {
  return {.method = pressure.solver == PressureSolver::cg ? KrylovMethod::conjugate_gradients : KrylovMethod::bicgstab,
          .multigrid = pressure.preconditioner == PreconditionerKind::multigrid,
          .mixed = pressure.precision == Precision::mixed,
          .tolerance = pressure.tolerance,
          .max_iterations = pressure.max_iterations,
          .cell_size = pressure.cell_ratio * spacing,
          .direct = pressure.solver == PressureSolver::direct};
}

double divergence_tolerance(double tolerance) {
  return std::max(tolerance, std::min(1000 * tolerance, 0.01));
}

ProjectionSolver::ProjectionSolver(const Boundary& boundary, const Options& options)
    : options_(options),
      boundary_(boundary),
      may_enclose_(boundary.bodies() != nullptr || !boundary.domain().boxes.empty()) {
  if (options.direct) direct_ = std::make_unique<DirectPressure>();
  if (options.multigrid && !options.direct)
    multigrid_ = std::make_unique<CellMultigrid>(cell_geometry(boundary, options.cell_size));
}

void ProjectionSolver::prepare(const PressureRows& rows, ParticleStore& particles, const VectorField& at,
                               const Boundary& boundary) {
  if (multigrid_ == nullptr) return;
  const std::size_t n = particles.size();
  if (boundary.features.displaced_walls || boundary.features.displaced_bodies)
    multigrid_->set_geometry(cell_geometry(boundary, options_.cell_size));
  ScratchArray<float> inside(particles.scratch(), n);
  parallel_for(n, [&](std::size_t i) {
    inside[i] = rows.pressure_fixed != nullptr && (*rows.pressure_fixed)[i] != 0 ? 0.0F : 1.0F;
  });
  const auto r = read(at);
  const auto span = [&](int axis) {
    return axis < particles.dimensions ? std::span(r[axis], n) : std::span<const double>();
  };
  multigrid_->setup(span(0), span(1), span(2), inside, rows.helmholtz, rows.diagonal,
                    rows.coefficient == nullptr ? std::span<const float>() : std::span(rows.coefficient, n));
}

PressureOperator& ProjectionSolver::bind(const PressureRows& rows, const SweepContext& context,
                                         PackedNeighbours& packed) {
  PressureMatrix matrix{rows.diagonal_shift.data(),
                        rows.pressure_fixed == nullptr ? nullptr : rows.pressure_fixed->data()};
  if (!rows.weight.empty()) {
    matrix.weight = rows.weight.data();
    matrix.row = rows.row.data();
  }
  operator_.bind(context, packed, matrix);
  return operator_;
}

double given_norm(ProjectionMatrix& matrix, ParticleStore& particles) {
  const std::size_t n = particles.size();
  ScratchArray<double> zero(particles.scratch(), n), given(particles.scratch(), n);
  parallel_for(n, [&](std::size_t i) { zero[i] = 0; });
  const std::span<const double> none(zero.data(), n);
  matrix.residual(none, none, std::span(given.data(), n), true);
  return std::sqrt(parallel_sum(n, [&](std::size_t i) { return given[i] * given[i]; }));
}

void ProjectionSolver::solve(const PressureRows& rows, ProjectionMatrix& matrix, ParticleStore& particles,
                             Array<double>& q) {
  const std::size_t n = particles.size();
  matrix_ = &matrix;
  // At most the share itself: where sources cancel, the right-hand side is smaller than each of them.
  const double of_divergence = rows.reference_norm > 0 ? std::min(1.0, rows.source_norm / rows.reference_norm) : 0;
  const double tolerance = std::max(options_.tolerance, of_divergence * divergence_tolerance(options_.tolerance));
  const double reference_norm = std::max(rows.reference_norm, rows.rounding_norm / tolerance);
  singular_ = rows.singular;
  const bool looks = looks_for_enclosed != 0 || (rows.helmholtz != 0 && (rows.measured || rows.closed_off)) ||
                     (rows.singular && matrix.coupling() != nullptr);
  if (may_enclose_ && direct_ == nullptr && looks) find_enclosed(rows, particles);
  const auto refinement = [&] {
    return RefinementOptions{tolerance, reference_norm, options_.max_iterations,
                             singular_, rows.measured,  enclosed_.empty() ? nullptr : &enclosed_};
  };
  if (direct_ != nullptr) {
    ScratchArray<double> residual(particles.scratch(), n);
    solve_directly(rows, refinement(), residual, q);
    return;
  }
  solve_iteratively(rows, refinement(), particles, q);
  if (report_.converged || !may_enclose_ || !enclosed_.empty()) return;
  find_enclosed(rows, particles);
  if (enclosed_.empty()) return;
  parallel_for(n, [&](std::size_t i) {
    if (rows.diagonal[i] != 0) q[i] = 0;
  });
  solve_iteratively(rows, refinement(), particles, q);
}

void ProjectionSolver::factorise(const PressureRows& rows, ProjectionMatrix& matrix, ParticleStore& particles) {
  matrix_ = &matrix;
  singular_ = rows.singular;
  if (may_enclose_) find_enclosed(rows, particles);
  direct_->factorise(matrix, rows.diagonal, rows.singular, enclosed_);
}

// A pressure is known where a constant is not in the null space of the rows, but for what sound adds to them: beside
// surfaces and openings; and where it is fixed.
void ProjectionSolver::find_enclosed(const PressureRows& rows, ParticleStore& particles) {
  enclosed_ = {};
  looks_for_enclosed = 0;
  const SweepContext* context = matrix_->context();
  if (context == nullptr || (rows.helmholtz != 0 && boundary_.features.displaced_walls)) return;
  const std::size_t n = matrix_->size();
  ScratchPool& scratch = particles.scratch();
  ScratchArray<double> constant(scratch, n), zero(scratch, n), product(scratch, n);
  parallel_for(n, [&](std::size_t i) {
    constant[i] = 1;
    zero[i] = 0;
  });
  ProjectionMatrix& liquid = matrix_->coupling() == nullptr ? *matrix_ : matrix_->coupling()->liquid();
  liquid.residual(std::span<const double>(constant.data(), n), std::span<const double>(zero.data(), n),
                  std::span(product.data(), n), false);
  const auto of_sound = [&](std::size_t i) {
    return rows.helmholtz == 0
               ? 0.0
               : particles.volume * rows.helmholtz * (rows.helmholtz_scale ? rows.helmholtz_scale(i) : 1);
  };
  const auto is_fixed = [&](std::int32_t i) { return rows.diagonal[static_cast<std::size_t>(i)] == 0; };
  EnclosedParts found = enclosed_parts(*context, [&](std::size_t i) {
    return rows.diagonal[i] != 0 && std::abs(product[i] + of_sound(i)) >= of_no_constant * rows.diagonal[i];
  });
  std::erase_if(found.parts, [&](const auto& part) { return std::all_of(part.begin(), part.end(), is_fixed); });
  const bool may_close = !found.parts.empty();
  const auto leave_out = [&](const auto& chosen) {
    if (std::erase_if(found.parts, [&](const auto& part) { return std::any_of(part.begin(), part.end(), chosen); }) > 0)
      found.all = false;
  };
  leave_out(is_fixed);
  if (rows.helmholtz != 0 && boundary_.features.displaced_bodies)
    leave_out([&](std::int32_t i) { return meets_moving_body(boundary_, *context, i); });
  enclosed_ = constants_of(std::move(found), rows.mean_is_removed);
  // With sound no solve says that a pool is closed again which spray in it kept open.
  if (!enclosed_.empty() || (may_close && rows.helmholtz != 0)) looks_for_enclosed = 1;
  if (enclosed_.empty() || remarked_) return;
  remarked_ = true;
  remark_ =
      "solids enclose liquid apart from the rest: its pressure is known up to a constant, whose choice the forces on "
      "the bodies around it share; a gap between the solids makes it known";
}

// Where no pressure is known the largest part is the rest. Bodies that float know the constants that accelerate them:
// those of liquid below a piston, but not those below and above it together.
PartConstants ProjectionSolver::constants_of(EnclosedParts found, bool mean_is_removed) {
  auto& parts = found.parts;
  const bool of_method = found.all && mean_is_removed;
  const BodyCoupling* coupling = matrix_->coupling();
  if (coupling != nullptr && !parts.empty()) {
    std::vector<std::vector<double>> responses;  // of a body, to all parts
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const std::vector<double> response = coupling->relative_response(parts[p]);
      responses.resize(response.size(), std::vector<double>(parts.size(), 0));
      for (std::size_t k = 0; k < response.size(); ++k) responses[k][p] = response[k];
    }
    std::vector<std::vector<double>> free = null_space(std::move(responses), parts.size(), no_response);
    // One constant of all liquid is what rows.singular stands for, and bodies may know that.
    const bool of_all = (singular_ || of_method) && free.size() == 1 &&
                        std::all_of(free[0].begin(), free[0].end(),
                                    [&](double value) { return std::abs(value - free[0][0]) < no_response; });
    if (!of_all) singular_ = false;
    if (of_all) free.clear();
    return {std::move(parts), std::move(free)};
  }
  // One part of which the method takes the mean out needs no more.
  if (singular_ ? !parts.empty() : of_method && parts.size() == 1)
    parts.erase(
        std::max_element(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); }));
  return {std::move(parts), singular_};
}

void ProjectionSolver::solve_iteratively(const PressureRows& rows, const RefinementOptions& refinement,
                                         ParticleStore& particles, Array<double>& q) {
  ScratchArray<double> residual(particles.scratch(), q.size());
  if (options_.mixed) {
    MixedSystem system(*this, rows, particles.scratch(), q);
    report_ = solve_refined(system, refinement, residual);
  } else {
    DoubleSystem system(*this, rows, q);
    report_ = solve_refined(system, refinement, residual);
  }
  if (!enclosed_.empty()) enclosed_.remove(std::span<double>(q.data(), q.size()));
}

// A correction at least, whatever the guess: the result is exact to rounding then, and one more says so.
void ProjectionSolver::solve_directly(const PressureRows& rows, const RefinementOptions& refinement,
                                      std::span<double> r, std::span<double> q) {
  constexpr int most_corrections = 3;
  const double reference_norm = refinement.reference_norm;
  report_ = {.tolerance = refinement.tolerance};
  const auto find_residual = [&] {
    matrix_->residual(q, rows.right_hand_side, r, true);
    ++report_.applications;
    if (!enclosed_.empty())
      enclosed_.remove(r);
    else if (singular_)
      subtract_mean(r);
  };
  find_residual();
  do {
    direct_->solve(r, r);
    parallel_for(q.size(), [&](std::size_t i) { q[i] += r[i]; });
    ++report_.iterations;
    find_residual();
    const double size = std::sqrt(parallel_sum(r.size(), [&](std::size_t i) { return r[i] * r[i]; }));
    report_.relative_residual = relative_size(size, reference_norm);
    report_.converged = size <= refinement.tolerance * reference_norm;
  } while (!report_.converged && report_.iterations < most_corrections);
  if (!enclosed_.empty()) enclosed_.remove(q);
}

double ProjectionSolver::bytes() const {
  double total = operator_.bytes() + double_work_.bytes() + (direct_ == nullptr ? 0 : direct_->bytes());
  for (const auto* array : {&zero_, &double_diagonal_}) total += array->bytes();
  return multigrid_ == nullptr ? total : total + multigrid_->bytes();
}

void demand_convergence(const RefinementResult& report, const std::string& solve) {
  if (report.converged) return;
  StepFailure::Details details;
  details.cause = solve + " did not converge in " + std::to_string(report.iterations) + " iterations";
  // More iterations help a solve that is on its way only; this one has left the first guess of zero behind.
  if (report.relative_residual < 1) details.option = "pressure.max_iterations";
  details.value = report.relative_residual;
  throw StepFailure(details);
}

}  // namespace spume
