// SPDX-License-Identifier: MIT
// The sweeps of the liquid, nanoseconds per pair, against what the machine can do.
// Arguments: those of particle_cube.hpp.
//
// Operations per pair, of which 10 find the distance, 7 the kernel, 5 its slope with its factor; then what the sums
// need. Per pair an index of 4 bytes and records of 16 bytes; per particle the records, written and read, and `values`
// bytes of input and output.
#include "machine.hpp"
#include "particle_cube.hpp"
#include "spume/operators/scalar_transport.hpp"
#include "spume/operators/sph_operators.hpp"
#include "spume/operators/surface_layers.hpp"

namespace spume {
namespace {

struct PairWork {
  double flops, records, values;
};

struct Sweeps {
  ParticleCube particles;
  SweepContext context;
  PackedNeighbours packed;
  VelocityImageRule rule;
  std::vector<std::array<float, 3>> reflection;
  std::array<Array<double>, 3> velocity;
  std::array<Array<float>, 6> correction;
  std::array<Array<float>, 9> gradient;
  std::array<Array<float>, 3> vector, shift, out;
  std::array<Array<float>, 5> scalar;
  Array<std::uint8_t> flag;
  Array<double> potential, divergence;

  explicit Sweeps(const benchmark::State& state) : particles(state), context(particles.sweep_context()) {
    for (const ImagePath& path : particles.images.paths()) {
      std::array<float, 3> sign;
      for (int a = 0; a < 3; ++a) sign[a] = static_cast<float>(Images::sign(path, particles.rules, a));
      rule.sign.push_back(sign);
    }
    reflection = rule.sign;
    const auto size = [&](auto& arrays) {
      for (auto& array : arrays) array.resize(particles.n);
    };
    size(velocity);
    size(correction);
    size(gradient);
    size(vector);
    size(shift);
    size(out);
    size(scalar);
    flag.resize(particles.n);
    potential.resize(particles.n);
    divergence.resize(particles.n);
    for (std::size_t i = 0; i < particles.n; ++i) {
      const double x = 6.28 * particles.x[i], y = 6.28 * particles.y[i], z = 6.28 * particles.z[i];
      potential[i] = std::cos(x) * std::cos(y + z);
      velocity[0][i] = std::sin(x) * std::cos(y);
      velocity[1][i] = -std::cos(x) * std::sin(y);
      velocity[2][i] = std::sin(z) * std::cos(x);
      for (int a = 0; a < 3; ++a) {
        vector[a][i] = static_cast<float>(velocity[a][i]);
        shift[a][i] = static_cast<float>(0.01 * particles.spacing() * velocity[a][i]);
      }
      scalar[0][i] = scalar[1][i] = static_cast<float>(1 + 0.5 * std::sin(x));
    }
    moments();
    velocity_gradient(false);
  }

  std::array<const double*, 3> velocities() const {
    return {velocity[0].data(), velocity[1].data(), velocity[2].data()};
  }
  static std::array<const float*, 3> read(const std::array<Array<float>, 3>& v) {
    return {v[0].data(), v[1].data(), v[2].data()};
  }
  static std::array<float*, 3> write(std::array<Array<float>, 3>& v) { return {v[0].data(), v[1].data(), v[2].data()}; }
  std::array<const float*, 6> corrections() const {
    std::array<const float*, 6> all;
    for (int k = 0; k < 6; ++k) all[k] = correction[k].data();
    return all;
  }

  void moments() {
    KernelMoments result;
    result.kernel_sum = scalar[2].data();
    result.divergence_of_position = scalar[3].data();
    result.laplacian_diagonal = scalar[4].data();
    result.uncorrected = flag.data();
    for (int k = 0; k < 6; ++k) result.correction[k] = correction[k].data();
    result.concentration_gradient = write(out);
    result.normal = write(vector);
    kernel_moment_sweep(context, packed, {true, true, particles.spacing(), {}}, result);
  }
  void velocity_gradient(bool with_change) {
    VelocityGradientOut result;
    for (int k = 0; k < 9; ++k) result.gradient[k] = gradient[k].data();
    result.filtered = write(vector);
    result.strain = scalar[2].data();
    if (with_change) {
      result.displacement = read(shift);
      result.change = write(out);
    }
    velocity_gradient_sweep(context, packed, velocities(), rule, corrections(), result);
  }

  template <class Body>
  void run(benchmark::State& state, const PairWork& work, Body&& body) {
    for (auto _ : state) {
      body();
      benchmark::ClobberMemory();
    }
    const auto pairs = static_cast<double>(particles.list.pair_count()), n = static_cast<double>(particles.n);
    particles.count(state, pairs / n);
    state.counters["time_per_pair"] =
        benchmark::Counter(pairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    count_against_machine(
        state, {4 * pairs + n * (32 * work.records + work.values), work.flops * pairs, work.records * pairs, 0},
        static_cast<int>(state.range(2)));
  }
};

// Sums of W and g, g d, its products with d (6 by 2), the tensile factor, its product with d.
void geometry_sums(benchmark::State& state) {
  Sweeps sweeps(state);
  sweeps.run(state, {10 + 7 + 5 + 2 + 6 + 12 + 6 + 6, 1, 24 + 61}, [&] { sweeps.moments(); });
}

// Differences, their products with g d (9 by 2), the filter, the bounds of the change.
void velocity_gradient(benchmark::State& state) {
  Sweeps sweeps(state);
  sweeps.run(state, {10 + 7 + 5 + 3 + 3 + 18 + 7 + 9, 2, 24 + 24 + 36 + 12 + 4 + 24},
             [&] { sweeps.velocity_gradient(true); });
}

void shift_curvature(benchmark::State& state) {
  Sweeps sweeps(state);
  sweeps.run(state, {10 + 5 + 6 + 1 + 27 + 6, 3, 36 + 24 + 12 + 24}, [&] {
    shift_curvature_sweep(sweeps.context, sweeps.packed,
                          {sweeps.gradient[0].data(), sweeps.gradient[1].data(), sweeps.gradient[2].data(),
                           sweeps.gradient[3].data(), sweeps.gradient[4].data(), sweeps.gradient[5].data(),
                           sweeps.gradient[6].data(), sweeps.gradient[7].data(), sweeps.gradient[8].data()},
                          sweeps.rule, sweeps.reflection, Sweeps::read(sweeps.shift), sweeps.corrections(),
                          Sweeps::write(sweeps.out));
  });
}

// Harmonic mean 5, direction 5 + 5 + 3, sum 6.
void viscous_stress(benchmark::State& state) {
  Sweeps sweeps(state);
  sweeps.run(state, {10 + 5 + 6 + 13 + 6, 2, 24 + 4 + 12}, [&] {
    viscous_sweep(sweeps.context, sweeps.packed, sweeps.velocities(), sweeps.rule, sweeps.scalar[0].data(),
                  Sweeps::write(sweeps.out), true);
  });
}

void viscous_laplacian(benchmark::State& state) {
  Sweeps sweeps(state);
  sweeps.run(state, {10 + 5 + 6 + 6, 2, 24 + 4 + 12}, [&] {
    viscous_sweep(sweeps.context, sweeps.packed, sweeps.velocities(), sweeps.rule, sweeps.scalar[0].data(),
                  Sweeps::write(sweeps.out));
  });
}

// `count` scalars with what sweeps give of them.
template <int count>
struct SweptScalars {
  std::vector<Array<float>> rate, change;
  std::vector<const double*> values;
  std::vector<double> reference = std::vector<double>(count, -1.0);
  std::vector<float> diffusivity = std::vector<float>(count, 1.0F);
  std::vector<Array<double>> of_each;
  std::vector<float*> rates, changes;

  explicit SweptScalars(const Sweeps& sweeps) {
    for (int s = 0; s < count; ++s) {
      of_each.push_back(sweeps.potential);
      rate.emplace_back(sweeps.particles.n);
      change.emplace_back(sweeps.particles.n);
    }
    for (int s = 0; s < count; ++s) {
      values.push_back(of_each[s].data());
      rates.push_back(rate[s].data());
      changes.push_back(change[s].data());
    }
  }
};

// Of all a comparison, their weight 2, along the shift 6; of each a difference, rate and change 4, extremes 2.
template <int count>
void viscous_laplacian_with_scalars(benchmark::State& state) {
  Sweeps sweeps(state);
  const SweptScalars<count> swept(sweeps);
  const RidingScalars scalars{.values = swept.values,
                              .reference = swept.reference,
                              .diffusivity = swept.diffusivity,
                              .viscosity = 1,
                              .shift = Sweeps::read(sweeps.shift),
                              .correction = sweeps.corrections(),
                              .rate = swept.rates,
                              .change = swept.changes};
  sweeps.run(state, {10 + 5 + 6 + 6 + 9 + 7 * count, count == 1 ? 2 : 3, 24 + 4 + 12 + 12 + 24 + 16.0 * count}, [&] {
    viscous_sweep(sweeps.context, sweeps.packed, sweeps.velocities(), sweeps.rule, sweeps.scalar[0].data(),
                  Sweeps::write(sweeps.out), false, {}, &scalars);
  });
}

// Scalars in sweeps of their own; of eddies 4 and of each scalar 2.
template <int count, bool eddies = false>
void scalars_alone(benchmark::State& state) {
  Sweeps sweeps(state);
  const SweptScalars<count> swept(sweeps);
  const std::vector<float> inverse_schmidt(count, 1.0F);
  const ScalarSweepInput in{.values = swept.values,
                            .reference = swept.reference,
                            .diffusivity = swept.diffusivity,
                            .normalisation = sweeps.scalar[0].data(),
                            .eddy_viscosity = eddies ? sweeps.scalar[1].data() : nullptr,
                            .inverse_schmidt = inverse_schmidt,
                            .shift = Sweeps::read(sweeps.shift),
                            .correction = sweeps.corrections()};
  const ScalarSweepOutput out{.rate = swept.rates, .change = swept.changes, .exchange = sweeps.scalar[4].data()};
  // Up to eight share a sweep: records of eight floats hold four scalars, without eddies, of twelve eight.
  const double turns = (count + 7) / 8, records = turns * (count == 1 || (count <= 4 && !eddies) ? 2 : 3);
  sweeps.run(state,
             {turns * (10 + 5 + 2 + 2 + 1 + 6 + (eddies ? 4 : 0)) + (eddies ? 9 : 7) * count, records,
              turns * (4 + 12 + 24 + 4) + 16.0 * count},
             [&] { scalar_transport_sweep(sweeps.context, sweeps.packed, in, out); });
}

void velocity_divergence(benchmark::State& state) {
  Sweeps sweeps(state);
  sweeps.run(state, {10 + 5 + 3 + 3 + 18 + 3, 2, 24 + 8 + 24 + 12}, [&] {
    divergence_sweep(sweeps.context, sweeps.packed, sweeps.velocities(), sweeps.rule, sweeps.corrections(),
                     sweeps.potential.data(), sweeps.divergence.data(), sweeps.scalar[2].data());
  });
}

void pressure_gradient(benchmark::State& state) {
  Sweeps sweeps(state);
  sweeps.run(state, {10 + 5 + 2 + 6, 1, 8 + 24 + 12}, [&] {
    gradient_sweep(sweeps.context, sweeps.packed, sweeps.potential.data(), 0, sweeps.corrections(),
                   Sweeps::write(sweeps.out));
  });
}

void filter_of_vector(benchmark::State& state) {
  Sweeps sweeps(state);
  sweeps.run(state, {10 + 7 + 1 + 6, 2, 24}, [&] {
    filter_vector(sweeps.context, sweeps.packed, Sweeps::read(sweeps.vector), sweeps.reflection,
                  Sweeps::write(sweeps.out));
  });
}

void filter_of_two_scalars(benchmark::State& state) {
  Sweeps sweeps(state);
  const std::array<const float*, 2> values{sweeps.scalar[0].data(), sweeps.scalar[1].data()};
  const std::array<float*, 2> out{sweeps.scalar[2].data(), sweeps.scalar[3].data()};
  sweeps.run(state, {10 + 7 + 1 + 4, 2, 16}, [&] { filter_scalars(sweeps.context, sweeps.packed, values, out); });
}

// Depths and shared shifts as at a surface through half of the particles, the others below it and outside of the lists.
struct HalfAtSurface {
  Sweeps sweeps;
  std::vector<std::int32_t> upper;
  std::array<Array<float>, 3> normal;
  Array<float> scratch, depth;
  Array<std::array<float, 3>> shared;
  double pairs = 0;

  explicit HalfAtSurface(const benchmark::State& state) : sweeps(state) {
    const std::size_t n = sweeps.particles.n;
    for (auto& component : normal) component.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const bool at_surface = sweeps.particles.z[i] > 0.5;
      normal[0][i] = normal[1][i] = 0;
      normal[2][i] = at_surface ? 1 : 0;
      if (!at_surface) continue;
      upper.push_back(static_cast<std::int32_t>(i));
      pairs += static_cast<double>(sweeps.particles.list.count(i));
    }
    scratch.resize(n);
    depth.resize(upper.size());
    shared.resize(upper.size());
  }

  // Twice over the pairs, each with records of 16 bytes times `records`.
  template <class Body>
  void run(benchmark::State& state, double flops, double records, Body&& body) {
    for (auto _ : state) {
      body();
      benchmark::ClobberMemory();
    }
    state.counters["time_per_pair"] =
        benchmark::Counter(2 * pairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    count_against_machine(
        state,
        {8 * pairs + 64 * records * static_cast<double>(sweeps.particles.n), 2 * flops * pairs, 2 * records * pairs, 0},
        static_cast<int>(state.range(2)));
  }
};

// Distances 10, then along the normal 6 and 9, columns 8 + 9 and sums 2; layers' weights 7 + 4 and sums 4.
void depths_below_surface(benchmark::State& state) {
  HalfAtSurface half(state);
  half.run(state, 10 + (15 + 19 + 6 + 15) / 2.0, 1, [&] {
    surface_depths(half.sweeps.context, half.sweeps.packed,
                   {half.sweeps.particles.spacing(), half.upper, Sweeps::read(half.normal)}, half.scratch, half.depth);
  });
}

// Distances 10, then weights 5, lengths and sums 5 + 8; along the normal 6, weights 7 + 4, sums 8.
void shift_shared_by_layers(benchmark::State& state) {
  HalfAtSurface half(state);
  half.run(state, 10 + (18 + 25) / 2.0, 2, [&] {
    shared_along_normal(half.sweeps.context, half.sweeps.packed, half.sweeps.particles.spacing(),
                        Sweeps::read(half.normal), Sweeps::read(half.sweeps.shift), half.sweeps.reflection, half.upper,
                        half.shared);
  });
}

BENCHMARK(geometry_sums)->Apply(ParticleCube::sizes);
BENCHMARK(velocity_gradient)->Apply(ParticleCube::sizes);
BENCHMARK(shift_curvature)->Apply(ParticleCube::sizes);
BENCHMARK(viscous_stress)->Apply(ParticleCube::sizes);
BENCHMARK(viscous_laplacian)->Apply(ParticleCube::sizes);
BENCHMARK(viscous_laplacian_with_scalars<1>)->Apply(ParticleCube::sizes);
BENCHMARK(viscous_laplacian_with_scalars<2>)->Apply(ParticleCube::sizes);
BENCHMARK(viscous_laplacian_with_scalars<3>)->Apply(ParticleCube::sizes);
BENCHMARK(viscous_laplacian_with_scalars<4>)->Apply(ParticleCube::sizes);
BENCHMARK(viscous_laplacian_with_scalars<5>)->Apply(ParticleCube::sizes);
BENCHMARK(scalars_alone<1>)->Apply(ParticleCube::sizes);
BENCHMARK(scalars_alone<2>)->Apply(ParticleCube::sizes);
BENCHMARK(scalars_alone<4>)->Apply(ParticleCube::sizes);
BENCHMARK(scalars_alone<8>)->Apply(ParticleCube::sizes);
BENCHMARK(scalars_alone<14>)->Apply(ParticleCube::sizes);
BENCHMARK(scalars_alone<1, true>)->Apply(ParticleCube::sizes);
BENCHMARK(scalars_alone<4, true>)->Apply(ParticleCube::sizes);
BENCHMARK(scalars_alone<8, true>)->Apply(ParticleCube::sizes);
BENCHMARK(scalars_alone<14, true>)->Apply(ParticleCube::sizes);
BENCHMARK(velocity_divergence)->Apply(ParticleCube::sizes);
BENCHMARK(pressure_gradient)->Apply(ParticleCube::sizes);
BENCHMARK(filter_of_vector)->Apply(ParticleCube::sizes);
BENCHMARK(filter_of_two_scalars)->Apply(ParticleCube::sizes);
BENCHMARK(depths_below_surface)->Apply(ParticleCube::sizes);
BENCHMARK(shift_shared_by_layers)->Apply(ParticleCube::sizes);

}  // namespace
}  // namespace spume
