// SPDX-License-Identifier: MIT
// The generalised finite differences of multiphase flow, nanoseconds per pair, beside the pressure operator of SPH in
// the same run. Arguments: those of particle_cube.hpp, and the share of the particles near an interface: 0 one phase, 1
// a ball of another phase in the middle with 0.16 of the volume, 2 all particles.
//
// Operations per pair, of which 10 find the distance and 8 the weight; then what the sums need.
#include "machine.hpp"
#include "particle_cube.hpp"
#include "spume/operators/gfd_gradient.hpp"
#include "spume/operators/gfd_laplacian.hpp"
#include "spume/operators/gfd_pressure.hpp"
#include "spume/operators/interface_curvature.hpp"
#include "spume/operators/interface_filters.hpp"
#include "spume/operators/mass_exchange.hpp"
#include "spume/operators/pressure_operator.hpp"
#include "spume/operators/sph_diffusion.hpp"

namespace spume {
namespace {

enum class Fluids { one_phase, drop, mixed };

struct GfdCube {
  ParticleCube particles;
  SweepContext context;
  PackedNeighbours packed;
  Fluids fluids;
  VelocityImageRule rule;
  std::vector<std::array<float, 3>> reflection;
  InterfaceBands bands;
  std::vector<std::uint8_t> phase;
  Array<std::uint8_t> everywhere;
  std::array<Array<double>, 3> velocity;
  Array<double> potential, divergence;
  std::array<Array<float>, 6> correction;
  std::array<Array<float>, 3> offset, gradient, normal, out;
  Array<float> factor, colour, density, viscosity, result, single, volume;

  explicit GfdCube(const benchmark::State& state)
      : particles(state),
        context(particles.sweep_context()),
        fluids(static_cast<Fluids>(state.range(3))),
        phase(particles.n),
        everywhere(particles.n, 1) {
    const std::size_t n = particles.n;
    for (const ImagePath& path : particles.images.paths()) {
      std::array<float, 3> sign;
      for (int a = 0; a < 3; ++a) sign[a] = static_cast<float>(Images::sign(path, particles.rules, a));
      rule.sign.push_back(sign);
    }
    reflection = rule.sign;
    for (auto* arrays : {&offset, &gradient, &normal, &out})
      for (auto& array : *arrays) array.resize(n);
    for (auto& array : correction) array.resize(n);
    for (auto& array : velocity) array.resize(n);
    for (auto* array : {&factor, &colour, &density, &viscosity, &result, &single, &volume}) array->resize(n);
    for (auto* array : {&potential, &divergence}) array->resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double x = 6.28 * particles.x[i], y = 6.28 * particles.y[i], z = 6.28 * particles.z[i];
      const double r = std::hypot(particles.x[i] - 0.5, particles.y[i] - 0.5, particles.z[i] - 0.5);
      phase[i] = fluids == Fluids::drop && r < 0.34 ? 1 : 0;
      potential[i] = std::cos(x) * std::cos(y + z);
      velocity[0][i] = std::sin(x) * std::cos(y);
      velocity[1][i] = -std::cos(x) * std::sin(y);
      velocity[2][i] = std::sin(z) * std::cos(x);
      single[i] = static_cast<float>(potential[i]);
      density[i] = viscosity[i] = static_cast<float>(phase[i] == 1 || (fluids == Fluids::mixed && x > 3.14) ? 0.5 : 1);
      volume[i] = static_cast<float>(context.volume);
    }
    moments();
    find_bands();
    filter();
    normals();
  }

  static std::array<const float*, 3> read(const std::array<Array<float>, 3>& v) {
    return {v[0].data(), v[1].data(), v[2].data()};
  }
  static std::array<float*, 3> write(std::array<Array<float>, 3>& v) { return {v[0].data(), v[1].data(), v[2].data()}; }
  std::array<const double*, 3> velocities() const {
    return {velocity[0].data(), velocity[1].data(), velocity[2].data()};
  }
  GfdStencils stencils() const {
    GfdStencils all;
    for (std::size_t k = 0; k < 6; ++k) all.correction[k] = correction[k].data();
    all.offset = read(offset);
    all.laplacian_factor = factor.data();
    return all;
  }
  const std::uint8_t* varies() const { return fluids == Fluids::mixed ? everywhere.data() : bands.varies(); }
  PhaseProperty property(const Array<float>& value) const { return {value.data(), varies()}; }

  void moments() {
    GfdMoments all;
    for (std::size_t k = 0; k < 6; ++k) all.correction[k] = correction[k].data();
    all.offset = write(offset);
    all.laplacian_factor = factor.data();
    gfd_moment_sweep(context, packed, all);
  }
  void find_bands() { bands.build(context, particles.grid, particles.table, phase); }
  void filter() {
    const std::array<float*, 2> colours{nullptr, colour.data()};
    filter_colours(context, packed, bands, phase, colours);
  }
  void normals() {
    interface_normal_sweep(context, packed, bands, colour.data(), density.data(), stencils().correction, band_threshold,
                           {write(gradient), write(normal)});
  }

  // Pairs of the particles that are summed over.
  double pairs_of(std::span<const std::int32_t> listed) const {
    double pairs = 0;
    for (const std::int32_t i : listed) pairs += particles.list.count(static_cast<std::size_t>(i));
    return pairs;
  }

  // Operations and records of 16 bytes per pair, bytes of values per particle.
  template <class Body>
  void run(benchmark::State& state, double pairs, double flops, double records, double values, Body&& body) {
    for (auto _ : state) {
      body();
      benchmark::ClobberMemory();
    }
    const auto n = static_cast<double>(particles.n);
    particles.count(state, pairs / n);
    if (pairs > 0)
      state.counters["time_per_pair"] =
          benchmark::Counter(pairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    count_against_machine(state, {4 * pairs + n * (32 * records + values), flops * pairs, records * pairs, 0},
                          static_cast<int>(state.range(2)));
  }
  template <class Body>
  void run_all(benchmark::State& state, double flops, double records, double values, Body&& body) {
    run(state, static_cast<double>(particles.list.pair_count()), flops, records, values, body);
  }
};

void gfd_moments(benchmark::State& state) {
  GfdCube cube(state);
  cube.run_all(state, 10 + 8 + 3 + 6 + 12, 1, 40, [&] { cube.moments(); });
}

void gfd_gradient_and_laplacian(benchmark::State& state) {
  GfdCube cube(state);
  cube.run_all(state, 10 + 8 + 2 + 6 + 2 + 6, 1, 8 + 40 + 16, [&] {
    gfd_laplacian_sweep(cube.context, cube.packed, cube.potential.data(), 0, cube.stencils(),
                        {cube.result.data(), GfdCube::write(cube.out)});
  });
}

void gfd_velocity_divergence(benchmark::State& state) {
  GfdCube cube(state);
  cube.run_all(state, 10 + 8 + 3 + 18 + 6 + 2, 2, 24 + 24 + 8, [&] {
    gfd_divergence_sweep(cube.context, cube.packed, cube.velocities(), cube.rule, cube.stencils().correction,
                         cube.divergence.data());
  });
}

void gfd_diffusion(benchmark::State& state, MomentumDiffusion form) {
  GfdCube cube(state);
  const bool gradients = form != MomentumDiffusion::mu_laplacian;
  cube.run_all(state, 10 + 8 + 6 + 1 + 5 + 9 + (gradients ? 3 + 18 : 0), 2, 24 + 40 + 12 + 20, [&] {
    gfd_stress_sweep(cube.context, cube.packed, cube.velocities(), cube.rule, cube.stencils(), form,
                     {cube.property(cube.viscosity), cube.density.data(), GfdCube::read(cube.gradient)},
                     GfdCube::write(cube.out));
  });
}
void gfd_stress_split(benchmark::State& state) {
  gfd_diffusion(state, MomentumDiffusion::split);
}
void gfd_stress_rotation_free(benchmark::State& state) {
  gfd_diffusion(state, MomentumDiffusion::rotation_free);
}
void gfd_stress_printed(benchmark::State& state) {
  gfd_diffusion(state, MomentumDiffusion::printed);
}
void gfd_mu_laplacian(benchmark::State& state) {
  gfd_diffusion(state, MomentumDiffusion::mu_laplacian);
}

void hu_adams_diffusion(benchmark::State& state) {
  GfdCube cube(state);
  cube.run_all(state, 10 + 5 + 4 + 6 + 9, 2, 24 + 12 + 12, [&] {
    hu_adams_sweep(cube.context, cube.packed, cube.velocities(), cube.rule, cube.volume.data(),
                   {cube.property(cube.viscosity), cube.density.data(), {}}, GfdCube::write(cube.out));
  });
}

void gfd_pressure_gradient(benchmark::State& state) {
  GfdCube cube(state);
  cube.run_all(state, 10 + 8 + 2 + 3 + 6, 2, 8 + 4 + 24 + 12, [&] {
    gfd_gradient_over_density_sweep(cube.context, cube.packed, cube.potential.data(), 0, cube.property(cube.density),
                                    cube.stencils().correction, GfdCube::write(cube.out));
  });
}

void gfd_pressure_apply(benchmark::State& state) {
  GfdCube cube(state);
  GfdPressureOperator pressure;
  pressure.bind(cube.context, cube.packed, {cube.stencils(), cube.property(cube.density), nullptr, nullptr});
  cube.run_all(state, 10 + 8 + 6 + 1 + 3 + 2, 1, 36,
               [&] { benchmark::DoNotOptimize(pressure.apply(cube.single, cube.result, cube.single)); });
}

// Once per solve: the weights of the rows where the density varies.
void gfd_pressure_bind(benchmark::State& state) {
  GfdCube cube(state);
  GfdPressureOperator pressure;
  const auto bind = [&] {
    pressure.bind(cube.context, cube.packed, {cube.stencils(), cube.property(cube.density), nullptr, nullptr});
  };
  if (cube.fluids == Fluids::mixed)
    cube.run_all(state, 10 + 8 + 6 + 2 + 2, 1, 24, bind);
  else
    cube.run(state, cube.pairs_of(cube.bands.varying()), 10 + 8 + 6 + 2 + 2, 1, 24, bind);
}

void gfd_pressure_subtract_product(benchmark::State& state) {
  GfdCube cube(state);
  GfdPressureOperator pressure;
  pressure.bind(cube.context, cube.packed, {cube.stencils(), cube.property(cube.density), nullptr, nullptr});
  cube.run_all(state, 10 + 8 + 6 + 1 + 3, 1, 44, [&] { pressure.subtract_product(0.5, cube.single, cube.divergence); });
}

void gfd_pressure_residual(benchmark::State& state) {
  GfdCube cube(state);
  GfdPressureOperator pressure;
  pressure.bind(cube.context, cube.packed, {cube.stencils(), cube.property(cube.density), nullptr, nullptr});
  Array<double> b(cube.particles.n);
  cube.run_all(state, 10 + 8 + 6 + 1 + 3 + 8, 2, 52, [&] { pressure.residual(cube.potential, b, cube.divergence); });
}

// The operator of les-sph on the same particles.
void sph_pressure_apply(benchmark::State& state) {
  GfdCube cube(state);
  const Array<float> diagonal_shift(cube.particles.n);
  PressureOperator pressure;
  pressure.bind(cube.context, cube.packed, {diagonal_shift.data(), nullptr});
  cube.run_all(state, 20, 1, 24,
               [&] { benchmark::DoNotOptimize(pressure.apply(cube.single, cube.result, cube.single)); });
}

void interface_bands(benchmark::State& state) {
  GfdCube cube(state);
  cube.run(state, 0, 0, 0, 2, [&] { cube.find_bands(); });
}

void interface_colours(benchmark::State& state) {
  GfdCube cube(state);
  cube.run(state, cube.pairs_of(cube.bands.mixed()), 10 + 8 + 1 + 2, 1, 5, [&] { cube.filter(); });
}

void interface_property(benchmark::State& state) {
  GfdCube cube(state);
  cube.run(state, cube.pairs_of(cube.bands.mixed()), 10 + 8 + 1 + 2, 1, 12,
           [&] { filter_property(cube.context, cube.packed, cube.bands, cube.density.data(), cube.result); });
}

// Gains as of a drop that moves: half of the varying particles gain what the others lose.
void mass_exchange(benchmark::State& state) {
  GfdCube cube(state);
  parallel_for(cube.particles.n, [&](std::size_t i) { cube.single[i] *= 0.1F * cube.density[i]; });
  cube.run(state, cube.pairs_of(cube.bands.varying()) / 2, 10 + 8 + 2 + 9, 1, 24 + 4 + 12, [&] {
    mass_exchange_sweep(cube.context, cube.packed, cube.bands,
                        {cube.single.data(), cube.density.data(), cube.velocities()}, cube.rule,
                        GfdCube::write(cube.out));
  });
}

void interface_normals(benchmark::State& state) {
  GfdCube cube(state);
  cube.run(state, cube.pairs_of(cube.bands.varying()), 10 + 8 + 2 + 3 + 6, 2, 8 + 24, [&] { cube.normals(); });
}

void interface_curvature(benchmark::State& state) {
  GfdCube cube(state);
  cube.run(state, cube.pairs_of(cube.bands.varying()), 10 + 8 + 6 + 3 + 18 + 12 + 3, 2, 12 + 4, [&] {
    curvature_sweep(cube.context, cube.packed, cube.bands.varying(), GfdCube::read(cube.normal), cube.reflection,
                    cube.result.data());
  });
}

void with_fluids(benchmark::internal::Benchmark* bench, std::vector<std::int64_t> fluids) {
  bench->ArgNames({"particles", "arrangement", "threads", "fluids"})
      ->ArgsProduct({{10000, 100000, 1000000}, {1}, thread_counts(), std::move(fluids)})
      ->UseRealTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond);
}
void one_phase(benchmark::internal::Benchmark* bench) {
  with_fluids(bench, {0});
}
void all_fluids(benchmark::internal::Benchmark* bench) {
  with_fluids(bench, {0, 1, 2});
}
void two_phases(benchmark::internal::Benchmark* bench) {
  with_fluids(bench, {0, 1});
}

BENCHMARK(gfd_moments)->Apply(one_phase);
BENCHMARK(gfd_gradient_and_laplacian)->Apply(one_phase);
BENCHMARK(gfd_velocity_divergence)->Apply(one_phase);
BENCHMARK(gfd_stress_split)->Apply(all_fluids);
BENCHMARK(gfd_stress_rotation_free)->Apply(all_fluids);
BENCHMARK(gfd_stress_printed)->Apply(all_fluids);
BENCHMARK(gfd_mu_laplacian)->Apply(all_fluids);
BENCHMARK(hu_adams_diffusion)->Apply(all_fluids);
BENCHMARK(gfd_pressure_gradient)->Apply(all_fluids);
BENCHMARK(gfd_pressure_apply)->Apply(all_fluids);
BENCHMARK(gfd_pressure_bind)->Apply(all_fluids);
BENCHMARK(gfd_pressure_subtract_product)->Apply(all_fluids);
BENCHMARK(gfd_pressure_residual)->Apply(all_fluids);
BENCHMARK(sph_pressure_apply)->Apply(one_phase);
BENCHMARK(interface_bands)->Apply(two_phases);
BENCHMARK(interface_colours)->Apply(two_phases);
BENCHMARK(interface_property)->Apply(two_phases);
BENCHMARK(interface_normals)->Apply(two_phases);
BENCHMARK(mass_exchange)->Apply(two_phases);
BENCHMARK(interface_curvature)->Apply(two_phases);

}  // namespace
}  // namespace spume
