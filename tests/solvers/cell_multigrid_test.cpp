// SPDX-License-Identifier: MIT
#include "spume/solvers/cell_multigrid.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <limits>
#include <numeric>
#include <random>

#include "problems.hpp"
#include "spume/solvers/krylov.hpp"
#include "spume/solvers/refinement.hpp"

namespace spume {
namespace {

using namespace reference;

std::vector<double> noise(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(n);
  for (double& v : values) v = normal(random);
  return values;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

std::vector<double> applied(CellMultigrid& m, const std::vector<double>& r) {
  std::vector<double> z(r.size());
  m.apply(std::span<const double>(r), std::span<double>(z));
  return z;
}

struct GridCase {
  const char* name;
  SphSetup (*make)(int, double, double);
  int dimensions;
  double coarse, fine;
};
void PrintTo(const GridCase& c, std::ostream* out) {
  *out << c.name << ' ' << c.dimensions << "-D";
}

class Everywhere : public testing::TestWithParam<GridCase> {};

// x.My and y.Mx are sums of n terms computed in float: they differ by rounding, about 1e-7 of |x||My|.
TEST_P(Everywhere, IsSymmetricAndPositive) {
  const GridCase& c = GetParam();
  for (const double mach : {0.0, 0.05}) {
    Problem problem(c.make(c.dimensions, c.coarse, mach));
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const std::vector<double> x = noise(problem.size(), seed), y = noise(problem.size(), seed + 10);
      const std::vector<double> mx = applied(problem.multigrid, x), my = applied(problem.multigrid, y);
      EXPECT_NEAR(dot(x, my), dot(y, mx), 3e-7 * std::sqrt(dot(x, x) * dot(my, my)));
      EXPECT_GT(dot(x, mx), 0.0);
    }
  }
}

// The bar of the project is 8 BiCGStab iterations to 1e-6 from a warm start; here from zero, for twice the resolution
// too.
TEST_P(Everywhere, FewIterationsAtTwoResolutions) {
  const GridCase& c = GetParam();
  for (const double mach : {0.0, 0.05}) {
    int iterations[2];
    for (const int level : {0, 1}) {
      Problem problem(c.make(c.dimensions, level == 0 ? c.coarse : c.fine, mach));
      CorrectionWorkspace<float> work;
      const RefinementOptions options{1e-6, norm_of(problem.b), 500, problem.singular};
      std::vector<double> x(problem.size()), r(problem.size());
      const auto solve_from_zero = [&](Preconditioner<float>& m, KrylovMethod method) {
        std::fill(x.begin(), x.end(), 0.0);
        AssembledSystem system(problem.exact, problem.fast, m, problem.b, x, work);
        system.method = method;
        return solve_refined(system, options, r);
      };
      RefinementResult result = solve_from_zero(problem.multigrid, KrylovMethod::bicgstab);
      EXPECT_TRUE(result.converged);
      iterations[level] = result.iterations;
      const int bicgstab_applications = result.applications;
      result = solve_from_zero(problem.multigrid, KrylovMethod::conjugate_gradients);
      EXPECT_TRUE(result.converged);
      EXPECT_LE(result.iterations, 15);
      JacobiPreconditioner<float> jacobi(problem.system.diagonal);
      const RefinementResult slow = solve_from_zero(jacobi, KrylovMethod::bicgstab);
      RecordProperty(std::string("iterations_") + (mach > 0 ? "compressible_" : "incompressible_") +
                         (level == 0 ? "coarse" : "fine"),
                     iterations[level]);
      std::printf("%-11s %d-D n = %6zu Ma = %.2f: BiCGStab %d (%d applications), CG %d (%d), Jacobi BiCGStab %d (%d)\n",
                  c.name, c.dimensions, problem.size(), mach, iterations[level], bicgstab_applications,
                  result.iterations, result.applications, slow.iterations, slow.applications);
      EXPECT_GT(slow.iterations, 2 * iterations[level]);
    }
    EXPECT_LE(iterations[0], 8);
    EXPECT_LE(iterations[1], 8);
    EXPECT_LE(iterations[1], iterations[0] + 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Everywhere,
                         testing::Values(GridCase{"open wave", open_wave, 2, 0.02, 0.01},
                                         GridCase{"open wave", open_wave, 3, 0.05, 0.025},
                                         GridCase{"closed box", closed_box, 2, 0.02, 0.01},
                                         GridCase{"closed box", closed_box, 3, 0.04, 0.025},
                                         GridCase{"periodic", periodic_box, 2, 0.02, 0.01},
                                         GridCase{"periodic", periodic_box, 3, 0.04, 0.025},
                                         GridCase{"drops", drops, 2, 0.02, 0.01},
                                         GridCase{"drops", drops, 3, 0.05, 0.03}));

TEST(CellMultigrid, SolidBoxInTheLiquidCostsFewIterations) {
  // The particles see no mirror images in the box, which is its zero normal gradient: no neighbour, no flux.
  SphSetup setup = closed_box(3, 0.03125, 0);
  const CellGeometry::Box box{{0.40625, 0.125, 0.0}, {0.59375, 0.34375, 0.125}};
  setup.liquid = [&](double x, double y, double z) {
    return !(x > box.lower[0] && x < box.upper[0] && y > box.lower[1] && y < box.upper[1] && z < box.upper[2]);
  };
  const SphSystem system = assemble(setup);
  CellGeometry geometry = geometry_of(setup);
  SparseOperator<double> exact(system.matrix);
  SparseOperator<float> fast(system.matrix);
  const Eigen::VectorXd rhs = system.right_hand_side();
  const std::vector<double> b(rhs.data(), rhs.data() + rhs.size());
  CorrectionWorkspace<float> work;
  int iterations[2];
  for (const int with_box : {0, 1}) {
    if (with_box == 1) geometry.solids = {box};
    CellMultigrid multigrid(geometry);
    multigrid.setup(system.x, system.y, system.z, system.interior, 0.0, system.diagonal);
    std::vector<double> x(system.size()), r(system.size());
    AssembledSystem assembled(exact, fast, multigrid, b, x, work);
    const RefinementResult result = solve_refined(assembled, {1e-6, norm_of(b, true), 500, true}, r);
    EXPECT_TRUE(result.converged);
    iterations[with_box] = result.iterations;
    const std::vector<double> u = noise(system.size(), 3), v = noise(system.size(), 4);
    const std::vector<double> mu = applied(multigrid, u), mv = applied(multigrid, v);
    EXPECT_NEAR(dot(u, mv), dot(v, mu), 3e-7 * std::sqrt(dot(u, u) * dot(mv, mv)));
  }
  EXPECT_LE(iterations[1], 10);
  EXPECT_LT(iterations[1], iterations[0]);  // taken for air, the box would pin the pressure to zero
}

// A coefficient c of all particles divides the cells' part of z by c: with 1 / c of the diagonal it is M / c.
TEST(CellMultigrid, AUniformCoefficientScalesIt) {
  Problem plain(closed_box(2, 0.02, 0)), scaled(closed_box(2, 0.02, 0));
  constexpr float c = 1.0F / 1024;
  std::vector<float> diagonal(scaled.system.diagonal), coefficient(scaled.size(), c);
  for (float& entry : diagonal) entry *= c;
  scaled.multigrid.setup(scaled.system.x, scaled.system.y, scaled.system.z, scaled.system.interior, 0.0, diagonal,
                         coefficient);
  const std::vector<double> r = noise(plain.size(), 3);
  const std::vector<double> one = applied(plain.multigrid, r), other = applied(scaled.multigrid, r);
  const double size = std::sqrt(dot(one, one));
  // c is a power of two; means of it over a cell are off by a rounding or two.
  for (std::size_t i = 0; i < r.size(); ++i) ASSERT_NEAR(other[i] * c, one[i], 1e-5 * size);
}

TEST(CellMultigrid, IsSymmetricAndPositiveWithACoefficientThatJumpsAThousandfold) {
  Problem problem(closed_box(3, 0.05, 0));
  std::vector<float> coefficient(problem.size());
  for (std::size_t i = 0; i < coefficient.size(); ++i) coefficient[i] = problem.system.x[i] < 0.5 ? 1.0F : 1e-3F;
  problem.multigrid.setup(problem.system.x, problem.system.y, problem.system.z, problem.system.interior, 0.0,
                          problem.system.diagonal, coefficient);
  const std::vector<double> x = noise(problem.size(), 1), y = noise(problem.size(), 2);
  const std::vector<double> mx = applied(problem.multigrid, x), my = applied(problem.multigrid, y);
  EXPECT_NEAR(dot(x, my), dot(y, mx), 3e-6 * std::sqrt(dot(x, x) * dot(my, my)));
  EXPECT_GT(dot(x, mx), 0.0);
  EXPECT_THROW(problem.multigrid.setup(problem.system.x, problem.system.y, problem.system.z, problem.system.interior,
                                       0.0, problem.system.diagonal, std::vector<float>(3, 1.0F)),
               std::invalid_argument);
}

TEST(CellMultigrid, ApplicationIsTheSameToTheBitForAnyThreadCount) {
  const SphSetup setup = open_wave(3, 0.02, 0.05);
  Problem problem(setup);
  const std::vector<double> r = noise(problem.size(), 5);
  const int before = omp_get_max_threads();
  std::vector<double> first;
  for (const int threads : {1, 2, 3, 7}) {
    omp_set_num_threads(threads);
    problem.multigrid.setup(problem.system.x, problem.system.y, problem.system.z, problem.system.interior,
                            setup.helmholtz, problem.system.diagonal);
    const std::vector<double> z = applied(problem.multigrid, r);
    if (threads == 1) first = z;
    EXPECT_EQ(z, first) << threads << " threads";
  }
  omp_set_num_threads(before);
}

TEST(CellMultigrid, SteadyStateAllocatesNothing) {
  const SphSetup setup = open_wave(3, 0.03, 0.05);
  Problem problem(setup);
  SphSystem& s = problem.system;
  CorrectionWorkspace<float> work;
  std::vector<double> x(problem.size()), r(problem.size());
  AssembledSystem system(problem.exact, problem.fast, problem.multigrid, problem.b, x, work);
  const auto step = [&] {
    for (std::size_t i = 0; i < s.size(); ++i) s.x[i] = std::fmod(s.x[i] + 0.01 + 1.0, 1.0);
    problem.multigrid.setup(s.x, s.y, s.z, s.interior, setup.helmholtz, s.diagonal);
    for (const KrylovMethod method : {KrylovMethod::bicgstab, KrylovMethod::conjugate_gradients}) {
      system.method = method;
      std::fill(x.begin(), x.end(), 0.0);
      solve_refined(system, {1e-6, norm_of(problem.b), 3, false}, r);
    }
  };
  step();
  const auto before = array_statistics();
  for (int i = 0; i < 3; ++i) step();
  EXPECT_EQ(array_statistics().allocations, before.allocations);
  EXPECT_EQ(array_statistics().bytes, before.bytes);
}

// A V-cycle of a scattered cloud must not cost the box that holds it.
TEST(CellMultigrid, FarParticlesDoNotBlowUpTheBox) {
  const SphSetup setup = drops(3, 0.05, 0);
  Problem problem(setup);
  SphSystem s = problem.system;
  std::size_t farthest = 0;
  while (s.interior[farthest] < 1) ++farthest;
  s.x[farthest] = 1e6;
  s.y[farthest] = -1e6;
  problem.multigrid.setup(s.x, s.y, s.z, s.interior, 0.0, s.diagonal);
  const auto cells = problem.multigrid.cells();
  EXPECT_LE(static_cast<double>(cells[0]) * cells[1] * cells[2], 65536.0);
  for (const double z : applied(problem.multigrid, noise(s.size(), 1))) EXPECT_TRUE(std::isfinite(z));
  // Back among the others the cells are fine again, and the preconditioner good.
  problem.multigrid.setup(problem.system.x, problem.system.y, problem.system.z, problem.system.interior, 0.0,
                          problem.system.diagonal);
  std::vector<double> x(problem.size());
  KrylovWorkspace<double> work;
  EXPECT_LE(bicgstab<double>(problem.exact, problem.multigrid, problem.b, x, {}, work).iterations, 8);
}

TEST(CellMultigrid, NonsenseIsHarmless) {
  CellGeometry geometry;
  geometry.upper = {1, 1, 1};
  geometry.cell_size = 0.1;
  CellMultigrid m(geometry);
  // No particle.
  m.setup({}, {}, {}, {}, 0.0, {});
  std::vector<double> none;
  m.apply(std::span<const double>(none), std::span<double>(none));
  // One particle, inside and pinned; far outside the domain; at a non-finite place.
  for (const double at :
       {0.5, -3.0, 1e300, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (const float interior : {1.0F, 0.0F}) {
      const std::vector<double> p{at}, r{1.0};
      const std::vector<float> w{interior}, d{2.0F};
      m.setup(p, p, p, w, 0.0, d);
      const double z = applied(m, r)[0];
      EXPECT_TRUE(std::isfinite(z)) << at;
      if (interior == 0 || !std::isfinite(at))
        EXPECT_DOUBLE_EQ(z, 0.5);
      else
        EXPECT_GE(z, 0.5);
    }
  }
  EXPECT_THROW(m.setup(std::vector<double>{1.0}, {}, {}, {}, 0.0, {}), std::invalid_argument);
  geometry.cell_size = 0;
  EXPECT_THROW(CellMultigrid{geometry}, std::invalid_argument);
}

// Particles outside a wall, as an overshooting step leaves them, count for the wall's cell.
TEST(CellMultigrid, ParticlesBeyondAWallAreHeldByItsCell) {
  const SphSetup setup = closed_box(3, 0.05, 0.05);
  Problem problem(setup);
  SphSystem s = problem.system;
  for (std::size_t i = 0; i < s.size(); i += 50) s.y[i] = -0.01;
  problem.multigrid.setup(s.x, s.y, s.z, s.interior, setup.helmholtz, s.diagonal);
  EXPECT_LE(problem.multigrid.cells()[1], 8);
  const std::vector<double> u = noise(s.size(), 3), v = noise(s.size(), 4);
  const std::vector<double> mu = applied(problem.multigrid, u), mv = applied(problem.multigrid, v);
  EXPECT_NEAR(dot(u, mv), dot(v, mu), 3e-7 * std::sqrt(dot(u, u) * dot(mv, mv)));
}

}  // namespace
}  // namespace spume
