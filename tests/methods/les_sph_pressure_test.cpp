// SPDX-License-Identifier: MIT
// The pressure of a step against a direct solution of the system that the slow twin assembles.
#include <gtest/gtest.h>

#include <Eigen/SparseCore>
#include <Eigen/UmfPackSupport>

#include "methods/les_sph_simulation.hpp"
#include "reference/sph_sums.hpp"
#include "reference/surface_layers.hpp"
#include "spume/core/random.hpp"
#include "spume/methods/les_sph/free_surface.hpp"
#include "spume/methods/les_sph/pressure_system.hpp"

namespace spume::test {
namespace {

using les_sph::Liquid;
using reference::SphSums;

reference::Boundaries boundaries_of(const Domain& domain) {
  reference::Boundaries boundaries;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) boundaries.sides[axis][side] = domain.sides[axis][side].kind;
  for (const SolidBox& box : domain.boxes) boundaries.boxes.push_back(box.kind);
  return boundaries;
}

// A liquid with jittered particles and a velocity that is not divergence-free, up to the solve of its pressure.
struct PreparedStep {
  LoadedCase loaded;
  Liquid liquid;
  les_sph::PressureSystem system;
  Ledger ledger;
  static constexpr double dt = 0.005;

  PreparedStep(const std::string& text, const Overrides& overrides)
      : loaded(load_text(text, overrides)), liquid(loaded), system(liquid) {
    const double amplitude = 0.2 * loaded.scene.spacing;
    for (std::size_t i = 0; i < liquid.size(); ++i) {
      const auto r = random_uniform(5, RandomPurpose::test, i, 0, 0);
      Vec3 x{};
      for (int axis = 0; axis < liquid.dimensions; ++axis) {
        x[axis] = (*liquid.position[axis])[i] += amplitude * (2 * r[axis] - 1);
      }
      for (int axis = 0; axis < liquid.dimensions; ++axis)
        (*liquid.velocity[axis])[i] = std::sin(3 * x[axis] + 2 * x[0]) + 0.1 * r[axis];
      (*liquid.pressure)[i] = std::cos(2 * x[0]) + x[1];
    }
    les_sph::move_to_intermediate(liquid, dt);
    les_sph::sort_particles(liquid);
    if (liquid.plan.images) les_sph::make_images(liquid, dt);
    les_sph::find_neighbours(liquid);
    les_sph::measure_kernel_moments(liquid);
    if (liquid.plan.free_surface) les_sph::find_surface(liquid);
    if (liquid.plan.velocity_gradient) les_sph::differentiate_velocity(liquid);
    les_sph::predict_velocity(liquid, dt);
  }

  bool pressure_fixed(std::size_t i) const { return outside(i) == 1 && liquid.uncorrected[i] != 0; }

  // 1 - b: by how much a particle lies at the surface.
  double outside(std::size_t i) const { return liquid.plan.free_surface ? 1 - double{liquid.interior_weight[i]} : 0.0; }

  // What multiplies a row: the trace of the second moment, filled up at a surface.
  double row_scale(std::size_t i) const {
    const double bulk = liquid.lattice.divergence_of_position;
    const double trace = std::max<double>((*liquid.divergence_of_position)[i], 0.5 * bulk);
    return (trace + outside(i) * std::max(0.0, bulk - trace)) / liquid.dimensions;
  }
  // Normals of the edge particles, from the twin's sums.
  std::vector<reference::Vector> edge_normals(const SphSums& twin) const {
    std::vector<reference::Vector> normals(liquid.size());
    for (std::size_t i = 0; i < liquid.size(); ++i) {
      if (outside(i) == 0 || liquid.uncorrected[i] != 0) continue;
      const auto normal = twin.normal(i);
      const double size = std::hypot(normal[0].value, normal[1].value, normal[2].value);
      for (int a = 0; a < liquid.dimensions && size > 0; ++a) normals[i][a] = normal[a].value / size;
    }
    return normals;
  }
  double helmholtz() const {
    const double c = loaded.scene.fluid.sound_speed;
    return c > 0 ? 1 / (c * c * dt * dt) : 0;
  }
  // E and p0 of the mirrored liquid, from the twin's sums.
  std::array<double, 2> surface_row(const SphSums& twin, const reference::SurfaceLayers& layers, std::size_t i) const {
    if (outside(i) == 0 || liquid.uncorrected[i] != 0) return {};
    const auto normal = twin.normal(i);  // -h m
    double size2 = 0, along = 0;
    for (int a = 0; a < liquid.dimensions; ++a) {
      size2 += normal[a].value * normal[a].value;
      along += normal[a].value * liquid.uniform_acceleration[a];
    }
    const double spacing = loaded.scene.spacing;
    const double depth = layers.depth(i);
    const double missing = liquid.lattice.laplacian_diagonal / (spacing * spacing) - twin.laplacian_diagonal(i).value;
    const double mirrored = 2 * std::sqrt(size2) / liquid.smoothing_length / depth;
    return {outside(i) * std::max({mirrored, missing, 0.0}), size2 > 0 ? -depth * along / std::sqrt(size2) : 0.0};
  }

  std::vector<double> direct_pressure() const {
    const std::size_t n = liquid.size();
    const int d = liquid.dimensions;
    std::vector<reference::Point> points(n);
    for (std::size_t i = 0; i < n; ++i)
      for (int axis = 0; axis < d; ++axis) points[i][axis] = (*liquid.intermediate[axis])[i];
    const SphSums twin({loaded.options.resolution.kernel, d}, liquid.smoothing_length, liquid.volume, points,
                       les_sph::image_rules(liquid, liquid.next_walls), boundaries_of(loaded.scene.domain));
    // Rates of volume: walls without friction, which mirror velocities as they mirror the pressure.
    Domain slippery = loaded.scene.domain;
    for (auto& sides : slippery.sides)
      for (Side& side : sides)
        if (side.kind == BoundaryKind::no_slip) side.kind = BoundaryKind::free_slip;
    const SphSums mirror({loaded.options.resolution.kernel, d}, liquid.smoothing_length, liquid.volume, points,
                         les_sph::image_rules(liquid, liquid.next_walls), boundaries_of(slippery));
    const reference::SurfaceLayers layers(twin, {loaded.options.resolution.kernel, d}, liquid.smoothing_length,
                                          loaded.scene.spacing, edge_normals(twin));
    const auto potential = [&](std::size_t i) { return liquid.potential == nullptr ? 0.0 : (*liquid.potential)[i]; };
    std::array<std::vector<double>, 3> start, u;
    for (int axis = 0; axis < d; ++axis) {
      start[axis].assign(liquid.velocity[axis]->begin(), liquid.velocity[axis]->end());
      u[axis].assign(liquid.predicted[axis]->begin(), liquid.predicted[axis]->end());
    }

    const bool singular = liquid.plan.closed && helmholtz() == 0;
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
      double diagonal = liquid.volume * diagonal_shift;
      twin.pressure_couplings(i, [&](std::size_t j, double a) {
        entries.emplace_back(row, static_cast<Eigen::Index>(j), a);
        diagonal -= a;
      });
      entries.emplace_back(row, row, diagonal);
      reference::Matrix correction{};
      int slot = 0;
      for (int r = 0; r < d; ++r)
        for (int c = r; c < d; ++c, ++slot) correction[r][c] = correction[c][r] = (*liquid.correction[slot])[i];
      double divergence = mirror.divergence(i, u, correction).value;
      if (loaded.options.get<SchemeOptions>().centred) {  // half a step ahead, along the velocities of the step's start
        const auto gradient = mirror.velocity_gradient(i, start, correction);
        for (int r = 0; r < d; ++r)
          for (int c = 0; c < d; ++c) divergence -= 0.5 * dt * gradient[r][c].value * gradient[c][r].value;
      }
      b[row] = liquid.volume * ((-divergence / dt + helmholtz() * (*liquid.pressure)[i]) * row_scale(i) +
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
    Eigen::UmfPackLU<Eigen::SparseMatrix<double>> factor(matrix);
    EXPECT_EQ(factor.info(), Eigen::Success);
    const Eigen::VectorXd q = factor.solve(b);
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

class DirectPressure : public ::testing::TestWithParam<PressureCase> {};

// The residual is reduced to 1e-7 and coefficients are floats: differences of 1e-7 times the spread of the couplings
// over the smallest eigenvalue kept by smooth fields.
TEST_P(DirectPressure, AgreesWithTheIterativeOne) {
  Overrides overrides = GetParam().overrides;
  overrides.push_back("pressure.tolerance=1e-7");
  PreparedStep step(GetParam().text, overrides);
  auto direct = step.direct_pressure();
  step.system.solve_step(step.liquid, PreparedStep::dt, step.ledger);
  EXPECT_TRUE(step.system.report().converged);
  const std::size_t n = step.liquid.size();
  std::vector<double> solved(n);
  for (std::size_t i = 0; i < n; ++i)
    solved[i] =
        (*step.liquid.reduced_pressure)[i] - (step.liquid.potential == nullptr ? 0.0 : (*step.liquid.potential)[i]);
  if (step.liquid.plan.closed)
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
                      PressureCase{"DamBreakJacobi", dam_break, {"pressure.preconditioner=\"jacobi\""}},
                      PressureCase{"ClosedBoxConjugateGradients", closed_box, {"pressure.solver=\"cg\""}}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace spume::test
