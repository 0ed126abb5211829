// SPDX-License-Identifier: MIT
// The pressure of a step against a direct solution of the system that the slow twin assembles.
#include <gtest/gtest.h>

#include "methods/les_sph_simulation.hpp"
#include "reference/sph_sums.hpp"
#include "reference/surface_layers.hpp"
#include "spume/core/random.hpp"
#include "support/direct_solution.hpp"

namespace spume::test {
namespace {

using reference::SphSums;

reference::Boundaries boundaries_of(const Domain& domain) {
  reference::Boundaries boundaries;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) boundaries.sides[axis][side] = domain.sides[axis][side].kind;
  boundaries.boxes = domain.boxes;
  return boundaries;
}

// A liquid with jittered particles and a velocity that is not divergence-free, up to the solve of its pressure.
struct PreparedStep : StagedFlow {
  static constexpr double dt = 0.005;

  PreparedStep(const std::string& text, const Overrides& overrides) : StagedFlow(text, overrides) {
    const double amplitude = 0.2 * loaded.scene.spacing;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      const auto r = random_uniform(5, RandomPurpose::test, i, 0, 0);
      Vec3 x{};
      for (int axis = 0; axis < flow.dimensions; ++axis) {
        x[axis] = (*flow.particles.position[axis])[i] += amplitude * (2 * r[axis] - 1);
      }
      for (int axis = 0; axis < flow.dimensions; ++axis)
        (*flow.particles.velocity[axis])[i] = std::sin(3 * x[axis] + 2 * x[0]) + 0.1 * r[axis];
      (*flow.pressure)[i] = std::cos(2 * x[0]) + x[1];
    }
    run_before("divergence", dt);
    flow.displacement = 0;  // the twin has no density relaxation
  }

  bool pressure_fixed(std::size_t i) const { return outside(i) == 1 && flow.moments.uncorrected[i] != 0; }

  // 1 - b: by how much a particle lies at the surface.
  double outside(std::size_t i) const {
    return flow.features.free_surface ? 1 - double{flow.surface->interior_weight[i]} : 0.0;
  }

  // What multiplies a row: the trace of the second moment, filled up at a surface.
  double row_scale(std::size_t i) const {
    const double bulk = flow.resolution.lattice.divergence_of_position;
    const double trace = std::max<double>((*flow.moments.divergence_of_position)[i], 0.5 * bulk);
    return (trace + outside(i) * std::max(0.0, bulk - trace)) / flow.dimensions;
  }
  // Normals of the edge particles, from the twin's sums.
  std::vector<reference::Vector> edge_normals(const SphSums& twin) const {
    std::vector<reference::Vector> normals(flow.size());
    for (std::size_t i = 0; i < flow.size(); ++i) {
      if (outside(i) == 0 || flow.moments.uncorrected[i] != 0) continue;
      const auto normal = twin.normal(i);
      const double size = std::hypot(normal[0].value, normal[1].value, normal[2].value);
      for (int a = 0; a < flow.dimensions && size > 0; ++a) normals[i][a] = normal[a].value / size;
    }
    return normals;
  }
  ImageRules image_rules() const { return flow.boundary.image_rules(flow.arrangement.grid.support_radius()); }
  double helmholtz() const {
    const double c = loaded.scene.fluid.sound_speed;
    return c > 0 ? 1 / (c * c * dt * dt) : 0;
  }
  // E and p0 of the mirrored liquid, from the twin's sums.
  std::array<double, 2> surface_row(const SphSums& twin, const reference::SurfaceLayers& layers, std::size_t i) const {
    if (outside(i) == 0 || flow.moments.uncorrected[i] != 0) return {};
    const auto normal = twin.normal(i);  // -h m
    double size2 = 0, along = 0;
    for (int a = 0; a < flow.dimensions; ++a) {
      size2 += normal[a].value * normal[a].value;
      along += normal[a].value * flow.uniform_acceleration[a];
    }
    const double spacing = loaded.scene.spacing;
    const double depth = layers.depth(i);
    const double missing =
        flow.resolution.lattice.laplacian_diagonal / (spacing * spacing) - twin.laplacian_diagonal(i).value;
    const double mirrored = 2 * std::sqrt(size2) / flow.resolution.smoothing_length / depth;
    return {outside(i) * std::max({mirrored, missing, 0.0}), size2 > 0 ? -depth * along / std::sqrt(size2) : 0.0};
  }

  // The stages from the divergence to the solve.
  void solve() {
    bool reached = false;
    for (const Stage& stage : plan.stages()) {
      if (stage.name == "projection") return;
      reached = reached || stage.name == "divergence";
      StageRun run{.dt = dt};
      if (reached && stage.on && stage.part != StagePart::start) stage.work(run);
    }
  }

  std::vector<double> direct_pressure() const {
    const std::size_t n = flow.size();
    const int d = flow.dimensions;
    std::vector<reference::Point> points(n);
    for (std::size_t i = 0; i < n; ++i)
      for (int axis = 0; axis < d; ++axis) points[i][axis] = (*flow.intermediate_position[axis])[i];
    const SphSums twin({loaded.options.resolution.kernel, d}, flow.resolution.smoothing_length, flow.particles.volume,
                       points, image_rules(), boundaries_of(loaded.scene.domain));
    // Rates of volume: walls without friction, which mirror velocities as they mirror the pressure.
    Domain slippery = loaded.scene.domain;
    for (auto& sides : slippery.sides)
      for (Side& side : sides)
        if (side.kind == BoundaryKind::no_slip) side.kind = BoundaryKind::free_slip;
    const SphSums mirror({loaded.options.resolution.kernel, d}, flow.resolution.smoothing_length, flow.particles.volume,
                         points, image_rules(), boundaries_of(slippery));
    const reference::SurfaceLayers layers(twin, {loaded.options.resolution.kernel, d}, loaded.scene.spacing,
                                          edge_normals(twin));
    const auto potential = [&](std::size_t i) { return flow.potential == nullptr ? 0.0 : (*flow.potential)[i]; };
    std::array<std::vector<double>, 3> start, u;
    for (int axis = 0; axis < d; ++axis) {
      start[axis].assign(flow.particles.velocity[axis]->begin(), flow.particles.velocity[axis]->end());
      u[axis].assign(flow.intermediate_velocity[axis].begin(), flow.intermediate_velocity[axis].end());
    }

    const bool singular = flow.features.closed && helmholtz() == 0;
    Eigen::VectorXd b(static_cast<Eigen::Index>(n));
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < n; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      if (pressure_fixed(i)) {
        entries.emplace_back(row, row, 1.0);
        b[row] = potential(i);
        continue;
      }
      const auto [surface_coupling, hydrostatic] = surface_row(twin, layers, i);
      const double diagonal_shift = helmholtz() * row_scale(i) + surface_coupling;
      double diagonal = flow.particles.volume * diagonal_shift;
      twin.pressure_couplings(i, [&](std::size_t j, double a) {
        entries.emplace_back(row, static_cast<Eigen::Index>(j), a);
        diagonal -= a;
      });
      entries.emplace_back(row, row, diagonal);
      reference::Matrix correction{};
      int slot = 0;
      for (int r = 0; r < d; ++r)
        for (int c = r; c < d; ++c, ++slot) correction[r][c] = correction[c][r] = (*flow.moments.correction[slot])[i];
      double divergence = mirror.divergence(i, u, correction).value;
      if (loaded.options.get<SchemeOptions>().centred) {  // half a step ahead, along the velocities of the step's start
        const auto gradient = mirror.velocity_gradient(i, start, correction);
        for (int r = 0; r < d; ++r)
          for (int c = 0; c < d; ++c) divergence -= 0.5 * dt * gradient[r][c].value * gradient[c][r].value;
      }
      b[row] = flow.particles.volume * ((-divergence / dt + helmholtz() * (*flow.pressure)[i]) * row_scale(i) +
                                        diagonal_shift * potential(i) + surface_coupling * hydrostatic);
    }
    if (singular) b.array() -= b.mean();
    Eigen::SparseMatrix<double> matrix(b.size(), b.size());
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (singular) {  // any one row follows from the others: one value is chosen instead
      matrix.row(0) *= 0;
      matrix.coeffRef(0, 0) = 1;
      b[0] = 0;
    }
    const Eigen::VectorXd q = test::direct_solution(matrix, b);
    std::vector<double> p(n);
    for (std::size_t i = 0; i < n; ++i) p[i] = q[static_cast<Eigen::Index>(i)] - potential(i);
    return p;
  }
};

struct PressureCase {
  const char* name;
  std::string text;
  Overrides overrides;
};

void PrintTo(const PressureCase& value, std::ostream* out) {
  *out << value.name;
}

TEST(PressureTolerance, IsAThousandthOfTheDivergenceByDefaultAndNeverAboveAHundredth) {
  EXPECT_DOUBLE_EQ(divergence_tolerance(1e-6), 1e-3);
  EXPECT_DOUBLE_EQ(divergence_tolerance(1e-4), 0.01);
  EXPECT_DOUBLE_EQ(divergence_tolerance(0.05), 0.05);
}

TEST(PressureTolerance, LiquidInMotionIsHeldToItsDivergenceAndLiquidAtRestToItsWeight) {
  for (const std::string& text : {taylor_green, taylor_green_3d, tank}) {
    StagedFlow step(text);
    step.run_before("pressure", 0.002);
    const double of_divergence = 1e-3 * step.flow.rows.source_norm / step.flow.rows.reference_norm;
    step.flow.solve_pressure();
    const RefinementResult& report = step.flow.solver.report();
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.relative_residual, std::max(1e-6, of_divergence)) << text;
    if (text == tank) {
      EXPECT_LT(of_divergence, 1e-6);
    } else {
      EXPECT_GT(of_divergence, 1e-5) << text;
    }
  }
}

// What a step leaves is at most a thousandth of its divergence, and moves the velocity by as much over the wave number
// of the longest wave, 2 pi here; were every step to leave it with the same sign, that many times as much.
TEST(PressureTolerance, WhatIsLeftDoesNotAddUp) {
  const int steps = 20;
  const double dt = 0.005;
  Simulation loose(taylor_green), tight(taylor_green, {"pressure.tolerance=1e-10"});
  double largest = 0, iterations[2] = {0, 0};
  for (int k = 0; k < steps; ++k) {
    loose.steps(1, dt);
    tight.steps(1, dt);
    largest = std::max(largest, tight.method.flow().next_max_divergence);
    iterations[0] += loose.method.flow().solver.report().iterations;
    iterations[1] += tight.method.flow().solver.report().iterations;
  }
  const State a = loose.state(), b = tight.state();
  double squares = 0;
  for (std::size_t i = 0; i < a.velocity.size(); ++i)
    for (int axis = 0; axis < 2; ++axis) squares += std::pow(a.velocity[i][axis] - b.velocity[i][axis], 2);
  const double difference = std::sqrt(squares / static_cast<double>(a.velocity.size()));
  RecordProperty("difference", std::to_string(difference * 1e6) + "e-6");
  EXPECT_LT(difference, 1e-3 * largest / (2 * M_PI));
  EXPECT_GT(difference, 0);
  EXPECT_LT(iterations[0], 0.5 * iterations[1]);
}

class DirectPressure : public ::testing::TestWithParam<PressureCase> {};

// The residual is reduced to 1e-7 of the divergence and coefficients are floats: differences of 1e-7 times the spread
// of the couplings over the smallest eigenvalue kept by smooth fields.
TEST_P(DirectPressure, AgreesWithTheIterativeOne) {
  Overrides overrides = GetParam().overrides;
  overrides.push_back("pressure.tolerance=1e-10");
  PreparedStep step(GetParam().text, overrides);
  auto direct = step.direct_pressure();
  step.solve();
  EXPECT_TRUE(step.flow.solver.report().converged);
  const std::size_t n = step.flow.size();
  std::vector<double> solved(n);
  for (std::size_t i = 0; i < n; ++i)
    solved[i] = (*step.flow.reduced_pressure)[i] - (step.flow.potential == nullptr ? 0.0 : (*step.flow.potential)[i]);
  if (step.flow.features.closed)
    for (auto* p : {&direct, &solved}) {
      double mean = 0;
      for (const double value : *p) mean += value / static_cast<double>(n);
      for (double& value : *p) value -= mean;
    }
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < n; ++i) {
    difference += std::pow(solved[i] - direct[i], 2);
    size += std::pow(direct[i], 2);
  }
  RecordProperty("relative_difference", std::to_string(std::sqrt(difference / size) * 1e6) + "e-6");
  EXPECT_LT(std::sqrt(difference / size), 1e-5);
  EXPECT_GT(size, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, DirectPressure,
    ::testing::Values(PressureCase{"Periodic2D", taylor_green, {}}, PressureCase{"Periodic3D", taylor_green_3d, {}},
                      PressureCase{"NotCentred", taylor_green, {"time.centred=false"}},
                      PressureCase{"PeriodicCompressible", taylor_green, {"fluid.mach=0.1"}},
                      PressureCase{"PeriodicQuintic", taylor_green, {"resolution.kernel=\"quintic-spline\""}},
                      PressureCase{"ClosedBox", closed_box, {}},
                      PressureCase{"ClosedBoxCompressible", closed_box, {"fluid.mach=0.1"}},
                      PressureCase{"Tank", tank, {}}, PressureCase{"DamBreak", dam_break, {}},
                      PressureCase{"DamBreak3D", dam_break_3d, {}}, PressureCase{"SquarePatch", square_patch, {}},
                      PressureCase{"DamBreakByFactors", dam_break, {"pressure.solver=\"direct\""}},
                      PressureCase{"ClosedBoxByFactors", closed_box, {"pressure.solver=\"direct\""}},
                      PressureCase{"Periodic3DByFactors", taylor_green_3d, {"pressure.solver=\"direct\""}},
                      PressureCase{"DamBreakJacobi", dam_break, {"pressure.preconditioner=\"jacobi\""}},
                      PressureCase{"ClosedBoxConjugateGradients", closed_box, {"pressure.solver=\"cg\""}}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace spume::test
