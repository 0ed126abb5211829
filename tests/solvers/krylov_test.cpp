// SPDX-License-Identifier: MIT
// Every solver against SuiteSparse's direct factorisation of the assembled SPH system, and the refinement that runs
// them.
#include "spume/solvers/krylov.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <limits>

#include "problems.hpp"
#include "spume/solvers/refinement.hpp"
#include "support/direct_solution.hpp"

namespace spume {
namespace {

using namespace reference;

// Solves A x = b directly; in the singular case with the first unknown pinned, then shifted to zero mean.
Eigen::VectorXd direct_solution(const Problem& problem) {
  Eigen::SparseMatrix<double> matrix = problem.system.matrix;
  const Eigen::VectorXd b =
      Eigen::Map<const Eigen::VectorXd>(problem.b.data(), static_cast<Eigen::Index>(problem.size()));
  if (problem.singular) {
    matrix.coeffRef(0, 0) *= 2;  // any equation x_0 = c added to a consistent singular system leaves the solution set
  }
  Eigen::VectorXd x = test::direct_solution(matrix, b);
  if (problem.singular) x.array() -= x.mean();
  return x;
}

double relative_difference(const std::vector<double>& x, const Eigen::VectorXd& exact) {
  return (Eigen::Map<const Eigen::VectorXd>(x.data(), exact.size()) - exact).norm() / exact.norm();
}

struct SolverCase {
  const char* name;
  SphSetup (*make)(int, double, double);
  int dimensions;
  double spacing, mach;
};
void PrintTo(const SolverCase& c, std::ostream* out) {
  *out << c.name << ' ' << c.dimensions << "-D Ma " << c.mach;
}

class Direct : public testing::TestWithParam<SolverCase> {};

// ||x - x*|| / ||x*|| <= cond(A) ||r|| / ||b||. The condition number is of order (domain / spacing)^2 < 1e4 here, so a
// residual of 1e-11 leaves the solution within 1e-7.
TEST_P(Direct, EverySolverAgreesWithTheFactorisation) {
  const SolverCase& c = GetParam();
  Problem problem(c.make(c.dimensions, c.spacing, c.mach));
  const Eigen::VectorXd exact = direct_solution(problem);
  JacobiPreconditioner<double> jacobi(problem.diagonal);
  KrylovWorkspace<double> work;
  KrylovOptions<double> options;
  options.tolerance = 1e-11;
  options.max_iterations = 2000;
  options.remove_mean = problem.singular;
  for (Preconditioner<double>* m :
       {static_cast<Preconditioner<double>*>(&jacobi), static_cast<Preconditioner<double>*>(&problem.multigrid)}) {
    std::vector<double> x(problem.size(), 0.5);  // a guess that must be used, not assumed to be zero
    KrylovResult result = bicgstab<double>(problem.exact, *m, problem.b, x, options, work);
    EXPECT_TRUE(result.converged);
    EXPECT_FALSE(result.breakdown);
    EXPECT_LT(relative_difference(x, exact), 1e-7);
    std::fill(x.begin(), x.end(), -0.5);
    result = conjugate_gradients<double>(problem.exact, *m, problem.b, x, options, work);
    EXPECT_TRUE(result.converged);
    EXPECT_LT(relative_difference(x, exact), 1e-7);
  }
  CorrectionWorkspace<float> correction_work;
  for (const KrylovMethod method : {KrylovMethod::bicgstab, KrylovMethod::conjugate_gradients}) {
    std::vector<double> x(problem.size(), 0.5), r(problem.size());
    AssembledSystem system(problem.exact, problem.fast, problem.multigrid, problem.b, x, correction_work);
    system.method = method;
    const double size = norm_of(problem.b);
    const RefinementResult result = solve_refined(system, {1e-11, size, 500, problem.singular}, r);
    EXPECT_TRUE(result.converged);
    // What the recurrence was trusted with holds.
    system.residual(r);
    EXPECT_LE(norm_of(r, problem.singular), 1e-11 * size);
    const double mean =
        problem.singular ? exact.mean() - Eigen::Map<const Eigen::VectorXd>(x.data(), exact.size()).mean() : 0;
    for (double& value : x) value += mean;
    EXPECT_LT(relative_difference(x, exact), 1e-7);
  }
}

INSTANTIATE_TEST_SUITE_P(Systems, Direct,
                         testing::Values(SolverCase{"open wave", open_wave, 2, 0.02, 0.05},
                                         SolverCase{"open wave", open_wave, 2, 0.02, 0},
                                         SolverCase{"open wave", open_wave, 3, 1.0 / 14, 0.05},
                                         SolverCase{"open wave", open_wave, 3, 1.0 / 14, 0},
                                         SolverCase{"closed box", closed_box, 2, 0.02, 0.05},
                                         SolverCase{"closed box", closed_box, 2, 0.02, 0},
                                         SolverCase{"closed box", closed_box, 3, 0.0625, 0},
                                         SolverCase{"periodic", periodic_box, 2, 0.02, 0},
                                         SolverCase{"periodic", periodic_box, 3, 0.0625, 0.05},
                                         SolverCase{"drops", drops, 2, 0.02, 0},
                                         SolverCase{"drops", drops, 3, 0.07, 0}));

TEST(Krylov, ReportedResidualIsTheMeasuredOne) {
  Problem problem(open_wave(3, 0.05, 0));
  KrylovWorkspace<double> work;
  KrylovOptions<double> options;
  for (const bool gradients : {false, true}) {
    std::vector<double> x(problem.size()), ax(problem.size());
    const KrylovResult result =
        gradients ? conjugate_gradients<double>(problem.exact, problem.multigrid, problem.b, x, options, work)
                  : bicgstab<double>(problem.exact, problem.multigrid, problem.b, x, options, work);
    problem.exact.apply(x, ax);
    double rr = 0, bb = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      rr += (problem.b[i] - ax[i]) * (problem.b[i] - ax[i]);
      bb += problem.b[i] * problem.b[i];
    }
    EXPECT_NEAR(result.relative_residual, std::sqrt(rr / bb), 1e-12);
    EXPECT_LE(std::sqrt(rr / bb), 1e-6);
  }
}

TEST(Krylov, ApplicationsAreCounted) {
  Problem problem(open_wave(2, 0.02, 0.05));
  KrylovWorkspace<double> work;
  KrylovOptions<double> options;
  std::vector<double> x(problem.size());
  for (const bool zero_guess : {false, true}) {
    for (const bool confirm : {false, true}) {
      options.zero_guess = zero_guess;
      options.confirm = confirm;
      std::fill(x.begin(), x.end(), 0.0);
      problem.exact.applications = 0;
      const KrylovResult result = bicgstab<double>(problem.exact, problem.multigrid, problem.b, x, options, work);
      EXPECT_EQ(result.applications, problem.exact.applications);
      EXPECT_LE(result.applications, 2 * result.iterations + (zero_guess ? 0 : 1) + (confirm ? 1 : 0));
    }
  }
}

TEST(Krylov, StartingFromTheSolutionTakesNoIteration) {
  Problem problem(open_wave(2, 0.02, 0.05));
  KrylovWorkspace<double> work;
  KrylovOptions<double> options;
  options.tolerance = 1e-9;
  std::vector<double> x(problem.size());
  bicgstab<double>(problem.exact, problem.multigrid, problem.b, x, options, work);
  const KrylovResult again = bicgstab<double>(problem.exact, problem.multigrid, problem.b, x, options, work);
  EXPECT_EQ(again.iterations, 0);
  EXPECT_EQ(again.applications, 1);
  EXPECT_TRUE(again.converged);
}

TEST(Krylov, MeanOfTheSolutionIsRemovedInTheGivenWeights) {
  Problem problem(closed_box(2, 0.05, 0));
  std::vector<double> weights(problem.size());
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = 1 + 0.5 * static_cast<double>(i % 3);
  KrylovWorkspace<double> work;
  KrylovOptions<double> options;
  options.tolerance = 1e-10;
  options.remove_mean = true;
  options.weights = weights;
  for (double& value : problem.b) value += 1;  // not in the range of the operator: the weighted mean goes
  std::vector<double> x(problem.size(), 3.0);
  const KrylovResult result = bicgstab<double>(problem.exact, problem.multigrid, problem.b, x, options, work);
  EXPECT_TRUE(result.converged);
  double mean = 0, total = 0, largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean += weights[i] * x[i];
    total += weights[i];
    largest = std::max(largest, std::abs(x[i]));
  }
  EXPECT_LT(std::abs(mean / total), 1e-13 * largest);
}

TEST(Krylov, ZeroRightHandSideGivesZero) {
  Problem problem(open_wave(2, 0.05, 0.05));
  const std::vector<double> zero(problem.size(), 0.0);
  std::vector<double> x(problem.size(), 2.0);
  KrylovWorkspace<double> work;
  const KrylovResult result = bicgstab<double>(problem.exact, problem.multigrid, zero, x, {}, work);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 0);
  for (const double value : x) EXPECT_EQ(value, 0.0);
}

TEST(Krylov, NonFiniteInputIsReportedAtOnce) {
  Problem problem(open_wave(2, 0.05, 0.05));
  KrylovWorkspace<double> work;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<double> b = problem.b, x(problem.size(), 0.0);
    b[b.size() / 2] = bad;
    problem.exact.applications = 0;
    for (const KrylovResult& result : {bicgstab<double>(problem.exact, problem.multigrid, b, x, {}, work),
                                       conjugate_gradients<double>(problem.exact, problem.multigrid, b, x, {}, work)}) {
      EXPECT_TRUE(result.breakdown);
      EXPECT_FALSE(result.converged);
    }
    EXPECT_EQ(problem.exact.applications, 0);
    for (const double value : x) EXPECT_EQ(value, 0.0);
    // A non-finite guess is found by the first residual.
    std::vector<double> guess(problem.size(), bad);
    const KrylovResult result = bicgstab<double>(problem.exact, problem.multigrid, problem.b, guess, {}, work);
    EXPECT_TRUE(result.breakdown);
    EXPECT_LE(result.applications, 1);
  }
}

// An inconsistent singular system cannot reach the tolerance: the solver must end and say so.
TEST(Krylov, UnreachableToleranceEnds) {
  Problem problem(closed_box(2, 0.05, 0));
  for (double& value : problem.b) value += 1e-3;
  KrylovWorkspace<double> work;
  KrylovOptions<double> options;
  options.max_iterations = 200;
  for (const bool gradients : {false, true}) {
    std::vector<double> x(problem.size(), 0.0);
    const KrylovResult result =
        gradients ? conjugate_gradients<double>(problem.exact, problem.multigrid, problem.b, x, options, work)
                  : bicgstab<double>(problem.exact, problem.multigrid, problem.b, x, options, work);
    EXPECT_FALSE(result.converged);
    EXPECT_LE(result.iterations, 200);
  }
}

TEST(Krylov, EmptyAndSingleUnknown) {
  KrylovWorkspace<double> work;
  Eigen::SparseMatrix<double, Eigen::RowMajor> nothing(0, 0), one(1, 1);
  one.insert(0, 0) = 4;
  SparseOperator<double> empty(nothing), scalar(one);
  const std::vector<double> diagonal{4.0}, b{8.0};
  std::vector<double> x{0.0}, none;
  JacobiPreconditioner<double> jacobi(diagonal), no_jacobi{std::span<const double>{}};
  EXPECT_TRUE(bicgstab<double>(empty, no_jacobi, none, none, {}, work).converged);
  EXPECT_TRUE(conjugate_gradients<double>(empty, no_jacobi, none, none, {}, work).converged);
  EXPECT_TRUE(bicgstab<double>(scalar, jacobi, b, x, {}, work).converged);
  EXPECT_DOUBLE_EQ(x[0], 2.0);
  x[0] = 0;
  EXPECT_TRUE(conjugate_gradients<double>(scalar, jacobi, b, x, {}, work).converged);
  EXPECT_DOUBLE_EQ(x[0], 2.0);
}

TEST(Krylov, SolutionIsTheSameToTheBitForAnyThreadCount) {
  Problem problem(open_wave(3, 0.03, 0));
  const int before = omp_get_max_threads();
  std::vector<double> first, first_gradients;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    problem.multigrid.setup(problem.system.x, problem.system.y, problem.system.z, problem.system.interior, 0.0,
                            problem.system.diagonal);
    CorrectionWorkspace<float> work;
    std::vector<double> x(problem.size(), 0.0), y(problem.size(), 0.0), r(problem.size());
    AssembledSystem stabilised(problem.exact, problem.fast, problem.multigrid, problem.b, x, work);
    AssembledSystem gradients(problem.exact, problem.fast, problem.multigrid, problem.b, y, work);
    gradients.method = KrylovMethod::conjugate_gradients;
    const RefinementOptions options{1e-6, norm_of(problem.b), 500, false};
    EXPECT_TRUE(solve_refined(stabilised, options, r).converged);
    EXPECT_TRUE(solve_refined(gradients, options, r).converged);
    if (threads == 1) {
      first = x;
      first_gradients = y;
    }
    EXPECT_EQ(x, first) << threads << " threads";
    EXPECT_EQ(y, first_gradients) << threads << " threads";
  }
  omp_set_num_threads(before);
}

TEST(Refinement, AResidualThatIsSmallEnoughTakesNoCorrection) {
  Problem problem(open_wave(2, 0.05, 0.05));
  const std::vector<double> zero(problem.size(), 0.0);
  std::vector<double> x(problem.size(), 0.0), r(problem.size());
  CorrectionWorkspace<float> work;
  AssembledSystem rest(problem.exact, problem.fast, problem.multigrid, zero, x, work);
  RefinementResult result = solve_refined(rest, {}, r);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.applications, 1);
  EXPECT_EQ(result.relative_residual, 0);
  // From the solution of a stricter tolerance.
  AssembledSystem system(problem.exact, problem.fast, problem.multigrid, problem.b, x, work);
  const double size = norm_of(problem.b);
  EXPECT_TRUE(solve_refined(system, {1e-9, size, 500, false}, r).converged);
  result = solve_refined(system, {1e-6, size, 500, false}, r);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_LE(result.relative_residual, 1e-9);
}

// A correction that says it has converged and corrects nothing: only a measured residual tells.
class EmptyCorrection final : public RefinedSystem {
 public:
  void residual(std::span<double> r) override { std::fill(r.begin(), r.end(), 1.0); }
  KrylovResult correct(std::span<const double>, const CorrectionTask&) override {
    KrylovResult result;
    result.iterations = 1;
    result.converged = true;
    result.relative_residual = 1e-3;
    return result;
  }
  void subtract_product(std::span<double>) override {}
};

TEST(Refinement, AMeasuredResidualDoesNotTrustTheRecurrence) {
  std::vector<double> r(100);
  EmptyCorrection system;
  const double size = 10;  // of 100 ones
  EXPECT_LT(solve_refined(system, {0.1, size, 500, false, false}, r).relative_residual, 0.1);
  EXPECT_NEAR(solve_refined(system, {0.1, size, 500, false, true}, r).relative_residual, 1, 1e-12);
}

// One measured residual for a start, then a product for each correction: two of three digits for 1e-6. No product where
// a hundredth is asked for and the recurrence may be trusted.
TEST(Refinement, ResidualsAreMeasuredOnceAndKept) {
  Problem problem(open_wave(3, 0.05, 0));
  for (const auto& [tolerance, products] : {std::pair{1e-6, 2}, std::pair{1.1e-2, 0}}) {
    std::vector<double> x(problem.size(), 0.0), r(problem.size());
    CorrectionWorkspace<float> work;
    AssembledSystem system(problem.exact, problem.fast, problem.multigrid, problem.b, x, work);
    problem.exact.applications = problem.fast.applications = 0;
    const double size = norm_of(problem.b);
    const RefinementResult result = solve_refined(system, {tolerance, size, 500, false}, r);
    EXPECT_TRUE(result.converged);
    EXPECT_EQ(system.measured, 1);
    EXPECT_EQ(problem.exact.applications, 1 + products);
    EXPECT_EQ(result.applications, problem.exact.applications + problem.fast.applications);
    system.residual(r);
    EXPECT_LE(norm_of(r), tolerance * size);
  }
}

TEST(Refinement, EndsWhereItCannotConverge) {
  Problem problem(open_wave(2, 0.05, 0.05));
  CorrectionWorkspace<float> work;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<double> b = problem.b, x(problem.size(), 0.0), r(problem.size());
    b[b.size() / 2] = bad;
    AssembledSystem system(problem.exact, problem.fast, problem.multigrid, b, x, work);
    const RefinementResult result = solve_refined(system, {1e-6, norm_of(problem.b), 500, false}, r);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.applications, 1);
    for (const double value : x) EXPECT_EQ(value, 0.0);
  }
  // Too few iterations, and a right-hand side out of the range of a singular matrix.
  Problem closed(closed_box(2, 0.05, 0));
  for (double& value : closed.b) value += 1e-3;
  for (Problem* p : {&problem, &closed}) {
    const int iterations = p == &closed ? 200 : 2;
    std::vector<double> x(p->size(), 0.0), r(p->size());
    AssembledSystem system(p->exact, p->fast, p->multigrid, p->b, x, work);
    const RefinementResult result = solve_refined(system, {1e-6, norm_of(p->b), iterations, false}, r);
    EXPECT_FALSE(result.converged);
    EXPECT_LE(result.iterations, iterations);
    EXPECT_GT(result.relative_residual, 1e-6);
  }
}

// In double one correction gains what is asked for at once, and the result is that of the float ones.
TEST(Refinement, CorrectionsInDoubleGiveTheSameSolution) {
  Problem problem(open_wave(2, 0.02, 0));
  struct InDouble final : RefinedSystem {
    Problem& problem;
    std::vector<double> x;
    CorrectionWorkspace<double> work;
    int corrections = 0;
    explicit InDouble(Problem& p) : problem(p), x(p.size(), 0.0) {}
    void residual(std::span<double> r) override {
      problem.exact.apply(x, r);
      for (std::size_t i = 0; i < r.size(); ++i) r[i] = problem.b[i] - r[i];
    }
    KrylovResult correct(std::span<const double> r, const CorrectionTask& task) override {
      ++corrections;
      return correct_by_krylov<double>(KrylovMethod::bicgstab, problem.exact, problem.multigrid, r, task, x, work);
    }
    void subtract_product(std::span<double> r) override { residual(r); }
  } system(problem);
  std::vector<double> r(problem.size());
  const double size = norm_of(problem.b);
  EXPECT_TRUE(solve_refined(system, {1e-11, size, 2000, false}, r).converged);
  EXPECT_EQ(system.corrections, 1);
  EXPECT_LT(relative_difference(system.x, direct_solution(problem)), 1e-7);
}

}  // namespace
}  // namespace spume
