// SPDX-License-Identifier: MIT
// The pressure equation: nanoseconds per pair of the operator, in float and with the residual in double, and a whole
// solve below a free surface. Arguments: those of particle_cube.hpp.
#include "machine.hpp"
#include "particle_cube.hpp"
#include "spume/operators/pressure_operator.hpp"
#include "spume/operators/sph_operators.hpp"
#include "spume/solvers/cell_multigrid.hpp"
#include "spume/solvers/refinement.hpp"

namespace spume {
namespace {

struct Pressure {
  ParticleCube particles;
  SweepContext context;
  PackedNeighbours packed;
  Array<float> diagonal_shift, x, y;
  PressureOperator matrix;

  explicit Pressure(const benchmark::State& state) : particles(state), context(particles.sweep_context()) {
    for (auto* array : {&diagonal_shift, &x, &y}) array->resize(particles.n);
    for (std::size_t i = 0; i < particles.n; ++i) x[i] = static_cast<float>(std::sin(6.28 * particles.x[i]));
    matrix.bind(context, packed, {diagonal_shift.data(), nullptr});
  }
  // Per pair: an index of 4 bytes, a record, and differences 3, r^2 5, root 1, q 1, kernel slope 6, select 1, sum 3;
  // per particle: 16 bytes of record written and read, 12 of positions, 12 of values in and out. Twice the operations
  // and another record of values for the residual in double.
  void report(benchmark::State& state, double records) const {
    const auto pairs = static_cast<double>(particles.list.pair_count());
    state.counters["time_per_pair"] =
        benchmark::Counter(pairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    const auto n = static_cast<double>(particles.n);
    count_against_machine(state, {4 * pairs + 56 * n * records, 20 * pairs * records, pairs * records, 0},
                          static_cast<int>(state.range(2)));
  }
};

void pressure_apply(benchmark::State& state) {
  Pressure pressure(state);
  for (auto _ : state) benchmark::DoNotOptimize(pressure.matrix.apply(pressure.x, pressure.y, pressure.x));
  pressure.report(state, 1);
}

void pressure_residual(benchmark::State& state) {
  Pressure pressure(state);
  Array<double> q(pressure.particles.n), b(pressure.particles.n), r(pressure.particles.n);
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = pressure.x[i];
  for (auto _ : state) pressure.matrix.residual(q, b, r);
  pressure.report(state, 2);
}

void pressure_subtract_product(benchmark::State& state) {
  Pressure pressure(state);
  Array<double> r(pressure.particles.n);
  for (auto _ : state) pressure.matrix.subtract_product(0.5, pressure.x, r);
  pressure.report(state, 1);
}

struct InFloat final : LinearOperator<float> {
  explicit InFloat(PressureOperator& m) : matrix(m) {}
  std::size_t size() const override { return matrix.size(); }
  void apply(std::span<const float> x, std::span<float> y) override { matrix.apply(x, y, x); }
  Dots apply_with_dots(std::span<const float> x, std::span<float> y, std::span<const float> w) override {
    const Dots dots = matrix.apply(x, y, w);
    return {dots.wy, dots.yy};
  }
  PressureOperator& matrix;
};
// A q = b, corrected in float.
struct Refined final : RefinedSystem {
  Refined(PressureOperator& m, Preconditioner<float>& p, std::span<const double> right, std::span<double> unknowns)
      : matrix(m), fast(m), preconditioner(p), b(right), q(unknowns) {}
  void residual(std::span<double> r) override { matrix.residual(q, b, r); }
  KrylovResult correct(std::span<const double> r, const CorrectionTask& task) override {
    size = task.size;
    return correct_by_krylov<float>(KrylovMethod::bicgstab, fast, preconditioner, r, task, q, work);
  }
  void subtract_product(std::span<double> r) override { matrix.subtract_product(size, work.correction, r); }
  PressureOperator& matrix;
  InFloat fast;
  Preconditioner<float>& preconditioner;
  std::span<const double> b;
  std::span<double> q;
  CorrectionWorkspace<float> work;
  double size = 0;
};

// From nothing to 1e-6 in double, the preconditioner's setup included; the uppermost layer is bound to a given value
// as particles at a surface are.
void pressure_solve(benchmark::State& state) {
  Pressure pressure(state);
  const ParticleCube& particles = pressure.particles;
  const std::size_t n = particles.n;
  const double spacing = particles.spacing();
  Array<float> kernel_sum(n), trace(n), diagonal(n), interior(n);
  std::array<Array<float>, 12> rest;
  for (auto& array : rest) array.resize(n);
  Array<std::uint8_t> flag(n);
  KernelMoments sums;
  sums.kernel_sum = kernel_sum.data();
  sums.divergence_of_position = trace.data();
  sums.laplacian_diagonal = diagonal.data();
  sums.uncorrected = flag.data();
  for (std::size_t k = 0; k < 6; ++k) sums.correction[k] = rest[k].data();
  for (std::size_t k = 0; k < 3; ++k) {
    sums.normal[k] = rest[6 + k].data();
    sums.concentration_gradient[k] = rest[9 + k].data();
  }
  kernel_moment_sweep(pressure.context, pressure.packed, {true, true, spacing, {}}, sums);
  Array<double> b(n), q(n);
  for (std::size_t i = 0; i < n; ++i) {
    const bool top = particles.z[i] > 1 - spacing;
    pressure.diagonal_shift[i] = top ? static_cast<float>(10 / (spacing * spacing)) : 0;
    interior[i] = top ? 0 : 1;
    diagonal[i] = static_cast<float>(pressure.context.volume) * (diagonal[i] + pressure.diagonal_shift[i]);
    b[i] = pressure.context.volume * std::sin(6.28 * particles.x[i]) * particles.z[i];
  }
  pressure.matrix.bind(pressure.context, pressure.packed, {pressure.diagonal_shift.data(), nullptr});
  CellGeometry geometry;
  geometry.upper = {1, 1, 1};
  geometry.periodic = {true, true, false};
  geometry.wall[2] = {true, false};
  geometry.cell_size = 1.5 * spacing;
  CellMultigrid multigrid(geometry);
  Refined refined(pressure.matrix, multigrid, b, q);
  Array<double> r(n);
  double squares = 0;
  for (const double value : b) squares += value * value;
  RefinementResult result;
  for (auto _ : state) {
    multigrid.setup(particles.x, particles.y, particles.z, interior, 0.0, diagonal);
    parallel_for(n, [&](std::size_t i) { q[i] = 0; });
    result = solve_refined(refined, {1e-6, std::sqrt(squares), 500, false}, r);
  }
  if (!result.converged) state.SkipWithError("the solve has not converged");
  particles.count(state, 0);
  state.counters["iterations"] = result.iterations;
  // The applications alone: vectors and preconditioner stream some hundred bytes a particle each.
  const auto pairs = static_cast<double>(particles.list.pair_count()), products = double(result.applications);
  count_against_machine(
      state, {products * (4 * pairs + 56 * static_cast<double>(n)), 20 * pairs * products, pairs * products, 0},
      static_cast<int>(state.range(2)));
}

BENCHMARK(pressure_apply)->Apply(ParticleCube::sizes);
BENCHMARK(pressure_residual)->Apply(ParticleCube::sizes);
BENCHMARK(pressure_subtract_product)->Apply(ParticleCube::sizes);
BENCHMARK(pressure_solve)->Apply(ParticleCube::sizes);

}  // namespace
}  // namespace spume
