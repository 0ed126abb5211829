// SPDX-License-Identifier: MIT
#include "spume/methods/les_sph/pressure_system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/free_surface.hpp"
#include "spume/methods/les_sph/number_density.hpp"
#include "spume/methods/les_sph/traffic.hpp"

namespace spume::les_sph {
namespace {

CellGeometry cell_geometry(const Liquid& liquid) {
  const Domain& domain = liquid.scene.domain;
  CellGeometry geometry;
  geometry.dimensions = liquid.dimensions;
  geometry.cell_size = liquid.options.get<PressureOptions>().cell_ratio * liquid.scene.spacing;
  for (int axis = 0; axis < liquid.dimensions; ++axis) {
    geometry.lower[axis] = liquid.next_walls[axis][0];
    geometry.upper[axis] = liquid.next_walls[axis][1];
    geometry.periodic[axis] = domain.periodic(axis);
    for (int side = 0; side < 2; ++side) {
      const BoundaryKind kind = domain.sides[axis][side].kind;
      geometry.wall[axis][side] = kind == BoundaryKind::free_slip || kind == BoundaryKind::no_slip;
    }
  }
  for (const SolidBox& box : domain.boxes) geometry.solids.push_back({box.lower, box.upper});
  return geometry;
}

// Images in solids are those of the nearest face, which is not mutual at a box edge: the matrix of a closed
// incompressible box around a solid is then not symmetric, its right-hand side is not compatible, and removing the mean
// does not help. A compressibility of 1e-3 over the square of the domain, far below that of the smallest wave number
// (2 pi)^2, makes the constant solvable; it is removed afterwards.
double regularisation(const Liquid& liquid, double helmholtz) {
  if (!liquid.plan.closed || helmholtz > 0 || liquid.scene.domain.boxes.empty()) return 0;
  double length = 0;
  for (int axis = 0; axis < liquid.dimensions; ++axis)
    length = std::max(length, liquid.scene.domain.upper[axis] - liquid.scene.domain.lower[axis]);
  return 1e-3 / (length * length);
}

double norm(std::span<const double> values) {
  return std::sqrt(parallel_sum(values.size(), [&](std::size_t i) { return values[i] * values[i]; }));
}

}  // namespace

// The particle matrix as the Krylov solvers see it.
struct PressureSystem::Operator final : LinearOperator<float> {
  Operator(PressureOperator& matrix, int& applications) : matrix_(matrix), applications_(applications) {}
  std::size_t size() const override { return matrix_.size(); }
  void apply(std::span<const float> x, std::span<float> y) override {
    matrix_.apply(x, y, x);
    ++applications_;
  }
  Dots apply_with_dots(std::span<const float> x, std::span<float> y, std::span<const float> w) override {
    const Dots dots = matrix_.apply(x, y, w);
    ++applications_;
    return {dots.wy, dots.yy};
  }
  PressureOperator& matrix_;
  int& applications_;
};

// The same in double, for comparison: A x = -(0 - A x).
struct PressureSystem::DoubleOperator final : LinearOperator<double> {
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

PressureSystem::PressureSystem(const Liquid& liquid) {
  if (liquid.options.get<PressureOptions>().preconditioner == PreconditionerKind::multigrid)
    multigrid_ = std::make_unique<CellMultigrid>(cell_geometry(liquid));
}

// V_j of (3.9), and with mixture-pressure alpha div((1/alpha) grad q), the left-hand side of King (3.17), by the
// geometric mean of 1/alpha: alpha_i / sqrt(alpha_i alpha_j).
void PressureSystem::set_weights(const Liquid& liquid) {
  for (auto* array : {&weight_, &row_}) array->resize(liquid.size());
  parallel_for(liquid.size(), [&](std::size_t i) {
    const float root = liquid.plan.mixture_pressure ? std::sqrt(liquid.next_volume_fraction[i]) : 1.0F;
    weight_[i] = liquid.volume_ratio[i] / root;
    row_[i] = root;
  });
}

void PressureSystem::set_matrix(const Liquid& liquid, double helmholtz) {
  const std::size_t n = liquid.size();
  if (liquid.varying) set_weights(liquid);
  for (auto* array : {&diagonal_shift_, &diagonal_, &row_scale_}) array->resize(n);
  const double bulk = liquid.lattice.divergence_of_position;
  const auto volume = static_cast<float>(liquid.volume);
  parallel_for(n, [&](std::size_t i) {
    // Far below the bulk value div r tells of missing neighbours, not of the arrangement; the mirrored liquid makes up
    // for those missing at a surface.
    double div_r = std::max<double>((*liquid.divergence_of_position)[i], 0.5 * bulk);
    if (liquid.plan.free_surface) div_r += (1 - double{liquid.interior_weight[i]}) * std::max(0.0, bulk - div_r);
    const double scale = div_r / liquid.dimensions;  // what the row is multiplied by
    row_scale_[i] = static_cast<float>(scale);
    diagonal_shift_[i] = static_cast<float>(helmholtz * scale);
    const bool pressure_fixed = liquid.plan.free_surface && liquid.pressure_fixed[i] != 0;
    diagonal_[i] = pressure_fixed ? 0.0F : volume * ((*liquid.laplacian_diagonal)[i] + diagonal_shift_[i]);
  });
  if (!liquid.plan.free_surface) return;
  surface_source_.resize(liquid.near_surface.size());
  parallel_for(liquid.near_surface.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(liquid.near_surface[k]);
    const SurfaceRow row = surface_row(liquid, k);
    diagonal_shift_[i] += static_cast<float>(row.laplacian_diagonal);
    diagonal_[i] += static_cast<float>(volume * row.laplacian_diagonal);
    surface_source_[k] = row.laplacian_diagonal * row.hydrostatic_pressure;
    if (liquid.potential != nullptr) potential_laplacian_[i] -= static_cast<float>(surface_source_[k]);
  });
}

// Adds tr(grad u . grad u), minus the rate of change of div u along frozen velocities, to the right-hand side.
void PressureSystem::add_gradient_trace(Liquid& liquid, double factor) {
  if (liquid.plan.no_slip) {
    correction_.resize(liquid.size());  // borrowed until the solve
    gradient_trace_sweep(liquid.context, liquid.records, liquid.read(liquid.velocity), liquid.volume_rule(),
                         liquid.read_correction(), correction_.data());
    parallel_for(liquid.size(), [&](std::size_t i) { right_hand_side_[i] += factor * correction_[i]; });
    return;
  }
  parallel_for(liquid.size(), [&](std::size_t i) { right_hand_side_[i] += factor * (*liquid.gradient_trace)[i]; });
}

// Right-hand side for q, times the volume, in place of the source that stands there, and its norm in terms of p.
void PressureSystem::set_right_hand_side(const Liquid& liquid, double helmholtz, double source_scale) {
  const std::size_t n = liquid.size();
  const double density = liquid.scene.fluid.density;
  const bool surface = liquid.plan.free_surface;
  const double squares = parallel_reduce(
      n, 0.0,
      [&](std::size_t first, std::size_t last) {
        double sum = 0;
        for (std::size_t i = first; i < last; ++i) {
          if (surface && liquid.pressure_fixed[i] != 0) {
            right_hand_side_[i] = 0;
            continue;
          }
          double source_factor = source_scale, pressure_factor = helmholtz;
          if (liquid.plan.mixture_pressure)
            source_factor *= liquid.alpha_at(i);
          else if (liquid.varying)
            pressure_factor *= (*liquid.volume_fraction)[i] / liquid.alpha_at(i);
          const double known =
              (source_factor * right_hand_side_[i] + pressure_factor * (*liquid.pressure)[i] / density) * row_scale_[i];
          const double potential = liquid.potential == nullptr ? 0.0 : (*liquid.potential)[i];
          right_hand_side_[i] = liquid.volume * (known + diagonal_shift_[i] * potential);
          const double in_pressure =
              liquid.volume * (known - (liquid.potential == nullptr ? 0.0F : potential_laplacian_[i]));
          sum += in_pressure * in_pressure;
        }
        return sum;
      },
      [](double a, double b) { return a + b; });
  reference_norm_ = std::sqrt(squares);
  if (!surface) return;
  parallel_for(liquid.near_surface.size(), [&](std::size_t k) {
    right_hand_side_[static_cast<std::size_t>(liquid.near_surface[k])] += liquid.volume * surface_source_[k];
  });
}

namespace {

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
KrylovResult run_krylov(PressureSolver solver, LinearOperator<Real>& a, spume::Preconditioner<Real>& m,
                        std::span<const Real> b, std::span<Real> x, const KrylovOptions<Real>& options,
                        KrylovWorkspace<Real>& work) {
  return solver == PressureSolver::cg ? conjugate_gradients<Real>(a, m, b, x, options, work)
                                      : bicgstab<Real>(a, m, b, x, options, work);
}

// Lends the solve, for its lifetime, the arrays of the liquid that nobody reads between the right-hand side and the
// projection: 32 bytes per particle with a surface.
class LentArrays {
 public:
  LentArrays(Liquid& liquid, KrylovWorkspace<float>& work, Array<float>& right_hand_side) {
    const std::array borrowers{&work.residual,
                               &work.shadow,
                               &work.direction,
                               &work.preconditioned,
                               &work.image,
                               &work.second_image,
                               &work.second_preconditioned,
                               &right_hand_side};
    std::size_t next = 0;
    // Bubbles may read smoothed normals that no step has written: they must stay zero, not hold what a solve left.
    const auto normals = liquid.plan.bubbles ? FloatVectorField{} : liquid.smoothed_normal;
    for (Array<float>* lent :
         {liquid.acceleration[0], liquid.acceleration[1], liquid.acceleration[2], liquid.diffusivity,
          liquid.gradient_trace, liquid.laplacian_diagonal, normals[0], normals[1], normals[2]}) {
      if (lent == nullptr || next == borrowers.size()) continue;
      lent->swap(*borrowers[next]);
      pairs_[next] = {lent, borrowers[next]};
      ++next;
    }
  }
  ~LentArrays() {
    for (const auto& [lent, borrower] : pairs_)
      if (lent != nullptr) lent->swap(*borrower);
  }
  LentArrays(const LentArrays&) = delete;
  LentArrays& operator=(const LentArrays&) = delete;

 private:
  std::array<std::pair<Array<float>*, Array<float>*>, 8> pairs_{};
};

}  // namespace

// Residuals are scaled to order one: float keeps its range for any units. A correction gains at most three digits,
// rounding in float spoils more.
KrylovResult PressureSystem::correct(Liquid& liquid, double size, double target, int left, bool singular) {
  const std::size_t n = liquid.size();
  const LentArrays lent(liquid, work_, correction_right_);
  for (auto* array : {&correction_, &correction_right_}) array->resize(n);
  Operator a(operator_, report_.applications);
  JacobiPreconditioner<float> jacobi(diagonal_);
  spume::Preconditioner<float>* preconditioner = &jacobi;
  if (multigrid_ != nullptr) preconditioner = multigrid_.get();
  parallel_for(n, [&](std::size_t i) { correction_right_[i] = static_cast<float>(residual_[i] / size); });
  const auto options = correction_options<float>(size, target, 1e-3, left, singular);
  const KrylovResult result = run_krylov<float>(liquid.options.get<PressureOptions>().solver, a, *preconditioner,
                                                correction_right_, correction_, options, work_);
  parallel_for(n, [&](std::size_t i) { (*liquid.reduced_pressure)[i] += size * correction_[i]; });
  return result;
}

KrylovResult PressureSystem::correct_in_double(Liquid& liquid, double size, double target, int left, bool singular) {
  const std::size_t n = liquid.size();
  for (auto* array : {&double_correction_, &zero_, &double_diagonal_}) array->resize(n);
  parallel_for(n, [&](std::size_t i) { double_diagonal_[i] = diagonal_[i]; });
  DoubleOperator a(operator_, report_.applications, zero_);
  JacobiPreconditioner<double> jacobi(double_diagonal_);
  spume::Preconditioner<double>* preconditioner = &jacobi;
  if (multigrid_ != nullptr) preconditioner = multigrid_.get();
  const auto options = correction_options<double>(size, target, 1e-12, left, singular);
  const KrylovResult result = run_krylov<double>(liquid.options.get<PressureOptions>().solver, a, *preconditioner,
                                                 residual_, double_correction_, options, double_work_);
  parallel_for(n, [&](std::size_t i) { (*liquid.reduced_pressure)[i] += double_correction_[i]; });
  return result;
}

void PressureSystem::solve(Liquid& liquid, double helmholtz, const char* stage, Ledger& ledger) {
  const std::size_t n = liquid.size();
  const PressureOptions& options = liquid.options.get<PressureOptions>();
  const bool surface = liquid.plan.free_surface;
  residual_.resize(n);

  PressureMatrix matrix{diagonal_shift_.data(), surface ? liquid.pressure_fixed.data() : nullptr};
  if (liquid.varying) {
    matrix.weight = weight_.data();
    matrix.row = row_.data();
  }
  operator_.bind(liquid.context, liquid.records, matrix);
  report_ = {};
  if (multigrid_ != nullptr) {
    const auto scope = ledger.time("preconditioner setup", static_cast<double>(n));
    if (liquid.plan.displaced_walls) multigrid_->set_geometry(cell_geometry(liquid));
    // Borrowed from the corrections, which start after the setup.
    correction_.resize(n);
    parallel_for(n, [&](std::size_t i) { correction_[i] = surface && liquid.pressure_fixed[i] != 0 ? 0.0F : 1.0F; });
    const auto r = liquid.read(liquid.intermediate);
    const auto span = [&](int axis) {
      return axis < liquid.dimensions ? std::span(r[axis], n) : std::span<const double>();
    };
    multigrid_->setup(span(0), span(1), span(2), correction_, helmholtz, diagonal_);
  }

  const auto scope = ledger.time(stage, static_cast<double>(n));
  // Iterative refinement: residuals in double, corrections in float.
  const double target = options.tolerance * reference_norm_;
  const bool singular = liquid.plan.closed && helmholtz == 0 && regularisation(liquid, helmholtz) == 0;
  const bool mixed = options.precision == Precision::mixed;
  for (int round = 0;; ++round) {
    if (round == 0 || !mixed) {
      operator_.residual(*liquid.reduced_pressure, right_hand_side_, residual_);
      ++report_.applications;
    }
    if (singular) {
      const double mean = parallel_sum(n, [&](std::size_t i) { return residual_[i]; }) / static_cast<double>(n);
      parallel_for(n, [&](std::size_t i) { residual_[i] -= mean; });
    }
    const double size = norm(residual_);
    report_.relative_residual = reference_norm_ > 0 ? size / reference_norm_ : 0;
    if (size <= target) return;
    const int left = options.max_iterations - report_.iterations;
    if (!std::isfinite(size) || left <= 0 || round > 20) {
      report_.converged = false;
      return;
    }
    const KrylovResult result =
        mixed ? correct(liquid, size, target, left, singular) : correct_in_double(liquid, size, target, left, singular);
    report_.iterations += std::max(result.iterations, 1);
    // Rounding in float leaves about 1e-3 of the residual that a correction started from: where a hundredth was to be
    // reached, the recurrence may be trusted and a sweep in double is saved.
    if (result.converged && size <= 100 * target) {
      report_.relative_residual = result.relative_residual * size / reference_norm_;
      return;
    }
    if (mixed) {
      operator_.subtract_product(size, correction_, residual_);
      ++report_.applications;
    }
  }
}

void PressureSystem::demand_convergence(const std::string& solve) const {
  if (report_.converged) return;
  StepFailure::Details details;
  details.cause = solve + " did not converge in " + std::to_string(report_.iterations) + " iterations";
  details.option = "pressure.max_iterations";
  details.value = report_.relative_residual;
  throw StepFailure(details);
}

void PressureSystem::remove_constant(Liquid& liquid) const {
  const std::size_t n = liquid.size();
  const double mean = parallel_sum(n,
                                   [&](std::size_t i) {
                                     return (*liquid.reduced_pressure)[i] -
                                            (liquid.potential == nullptr ? 0.0 : (*liquid.potential)[i]);
                                   }) /
                      static_cast<double>(std::max<std::size_t>(n, 1));
  parallel_for(n, [&](std::size_t i) { (*liquid.reduced_pressure)[i] -= mean; });
}

void PressureSystem::solve_step(Liquid& liquid, double dt, Ledger& ledger) {
  const std::size_t n = liquid.size();
  const double pairs = static_cast<double>(liquid.list.pair_count());
  const double density = liquid.scene.fluid.density;
  const double c = liquid.scene.fluid.sound_speed;
  const double helmholtz = c > 0 ? 1 / (c * c * dt * dt) : 0;
  right_hand_side_.resize(n);
  if (liquid.potential != nullptr) potential_laplacian_.resize(n);
  {
    auto scope = ledger.time("divergence", static_cast<double>(n), pairs);
    divergence_sweep(liquid.context, liquid.records, liquid.read(liquid.predicted), liquid.volume_rule(),
                     liquid.read_correction(), liquid.potential == nullptr ? nullptr : liquid.potential->data(),
                     right_hand_side_.data(), potential_laplacian_.data());
    liquid.max_divergence = parallel_max(n, 0.0, [&](std::size_t i) { return std::abs(right_hand_side_[i]); });
    // The new velocity moves the particles from here to the next positions: it is made free of divergence half way,
    // where div u = (div u here) - dt/2 tr(grad u . grad u). The step is then of second order, and a projection
    // does not cost the energy dt |grad p|^2 / 2 per time.
    if (liquid.options.get<SchemeOptions>().centred) add_gradient_trace(liquid, -0.5 * dt);
    if (liquid.plan.density_relaxation) even_out_density(liquid, dt, right_hand_side_);
    set_matrix(liquid, helmholtz + regularisation(liquid, helmholtz));
    set_right_hand_side(liquid, helmholtz, -1 / dt);
    scope.add_bytes(traffic::divergence(liquid));
  }
  const bool warm_start = liquid.options.get<PressureOptions>().warm_start;
  // Start from the pressure that the particle carries; held ones p = 0.
  parallel_for(n, [&](std::size_t i) {
    const bool pressure_fixed = liquid.plan.free_surface && liquid.pressure_fixed[i] != 0;
    const double carried = pressure_fixed || !warm_start ? 0.0 : (*liquid.pressure)[i] / density;
    (*liquid.reduced_pressure)[i] = carried + (liquid.potential == nullptr ? 0.0 : (*liquid.potential)[i]);
  });
  solve(liquid, helmholtz, "pressure", ledger);
  ledger.count("pressure", 0, 0, 0, pairs * report_.applications, traffic::pressure(liquid));
  demand_convergence("the pressure solve");
  if (liquid.plan.closed) remove_constant(liquid);
}

void PressureSystem::solve_initial(Liquid& liquid, Ledger& ledger) {
  const std::size_t n = liquid.size();
  right_hand_side_.resize(n);
  if (liquid.potential != nullptr) {
    potential_laplacian_.resize(n);
    divergence_sweep(liquid.context, liquid.records, liquid.read(liquid.velocity), liquid.volume_rule(),
                     liquid.read_correction(), liquid.potential->data(), right_hand_side_.data(),
                     potential_laplacian_.data());
  }
  // -lap p = tr(grad u . grad u), from the divergence of the momentum equation.
  parallel_for(n, [&](std::size_t i) { right_hand_side_[i] = 0; });
  add_gradient_trace(liquid, 1);
  set_matrix(liquid, regularisation(liquid, 0));
  set_right_hand_side(liquid, 0, 1);
  parallel_for(n, [&](std::size_t i) {
    (*liquid.reduced_pressure)[i] = liquid.potential == nullptr ? 0.0 : (*liquid.potential)[i];
  });
  solve(liquid, 0, "first pressure", ledger);
  demand_convergence("the first pressure solve");
  if (liquid.plan.closed) remove_constant(liquid);
  const double density = liquid.scene.fluid.density;
  parallel_for(n, [&](std::size_t i) {
    (*liquid.pressure)[i] =
        density * ((*liquid.reduced_pressure)[i] - (liquid.potential == nullptr ? 0.0 : (*liquid.potential)[i]));
  });
}

double PressureSystem::bytes() const {
  double total = operator_.bytes() + work_.bytes() + double_work_.bytes();
  for (const auto* array :
       {&right_hand_side_, &residual_, &surface_source_, &double_correction_, &zero_, &double_diagonal_})
    total += array->bytes();
  for (const auto* array : {&potential_laplacian_, &diagonal_shift_, &diagonal_, &row_scale_, &correction_right_,
                            &correction_, &weight_, &row_})
    total += array->bytes();
  return multigrid_ == nullptr ? total : total + multigrid_->bytes();
}

}  // namespace spume::les_sph
