// SPDX-License-Identifier: MIT
// The spectral flow: a step beside its floor, the nine pruned transforms of the nonlinear term done by FFTW alone,
// plane by plane, without curl, product and update. Argument: points per axis.
#include "spume/methods/spectral/spectral.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "machine.hpp"
#include "spume/core/parallel.hpp"
#include "spume/fourier/box_transform.hpp"
#include "spume/fourier/lane_vector.hpp"
#include "spume/methods/registry.hpp"
#include "spume/methods/spectral/flow_fields.hpp"
#include "spume/methods/spectral/initial_state.hpp"

namespace spume {
namespace {

using fourier::copy_block;

LoadedCase turbulence(std::size_t n, Integrator integrator) {
  LoadedCase loaded;
  loaded.scene.domain.upper = {2 * std::numbers::pi, 2 * std::numbers::pi, 2 * std::numbers::pi};
  loaded.scene.grid = {n, n, n};
  loaded.scene.fluid.kinematic_viscosity = 0.01;
  case_schema().declare_groups(loaded.options, "spectral");
  loaded.options.get<InitialOptions>().kind = InitialKind::taylor_green;
  loaded.options.time.courant = 1;
  loaded.options.get<SpectralOptions>().integrator = integrator;
  return loaded;
}

// A complex transform of m points takes about 5 m log2(m) operations, a real one half; 12 for a cross product, 60 for
// curl and update of a mode. Of each field of modes (n^3 numbers) and of work (3/2 of that): read the potential and
// write six curls and vorticities; read six and write three products; read these, and read and write potential and
// tendency.
template <class T>
Work flow_work(std::size_t points) {
  const auto n = static_cast<double>(points), m = 1.5 * n, line = 5 * m * std::log2(m);
  const double transforms = line * (n * n / 2 + m * n / 2 + m * m / 2), cubed = n * n * n;
  const double numbers = (3 + 6 * 1.5) + (6 + 3) * 1.5 + (3 * 1.5 + 3 * 4);
  constexpr double size = sizeof(T);
  return {numbers * cubed * size, (9 * transforms + 12 * m * m * m + 60 * cubed) * size / 4, 0, 0};
}

template <class T>
void flow_step(benchmark::State& state) {
  const int threads = use_threads(state, 1);
  const auto n = static_cast<std::size_t>(state.range(0));
  LoadedCase loaded = turbulence(n, Integrator::ab2);
  if (sizeof(T) == 4) loaded.options.get<SpectralOptions>().precision = FieldPrecision::f32;
  spectral::Spectral<T> method(loaded);
  method.start();
  const double dt = 0.2 * method.step_limit().dt;
  Ledger ledger;
  method.step(dt, ledger);
  for (auto _ : state) method.step(dt, ledger);
  const double cubed = std::pow(static_cast<double>(n), 3);
  double bytes = 0;
  for (const auto& array : method.flow().arrays()) bytes += array.bytes;
  state.counters["fields"] = bytes / (cubed * sizeof(T));
  state.counters["ns_per_point"] =
      benchmark::Counter(cubed, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  count_against_machine(state, flow_work<T>(n), threads);
}

// Lines of N modes padded to M = 3N/2 in a buffer; a transform of M points each.
template <class T>
struct Floor {
  using Complex = std::complex<T>;
  std::size_t n, m, row, plane;
  LaneTransform<T> line;
  RealLineTransform<T> real_line;
  std::array<Array<Complex>, 6> work;
  struct Scratch {
    Array<Complex> buffer, modes, passes;
    Array<T> values;
    std::array<Array<Complex>, 6> page;
  };
  std::vector<Scratch> scratch;

  explicit Floor(std::size_t points)
      : n(points),
        m(3 * points / 2),
        row((points / 2 + lanes<T> - 1) / lanes<T> * lanes<T> + lanes<T>),
        plane(points * row + lanes<T>),
        line(m, Planning::measure, LineKernels::fftw),
        real_line(m, Planning::measure),
        scratch(static_cast<std::size_t>(thread_count())) {
    for (auto& field : work) field.resize(m * plane);
    for (Scratch& s : scratch) {
      s.buffer.resize(m * lanes<T>);
      s.passes.resize(line.work_size());
      s.modes.resize(m / 2 + 1);
      s.values.resize(m);
      for (auto& page : s.page) page.resize(m * row);
    }
  }
  void pad(const Complex* from, std::size_t stride, Complex* buffer) const {
    for (std::size_t j = 0; j < n / 2; ++j) copy_block(from + j * stride, buffer + j * lanes<T>);
    std::fill(buffer + n / 2 * lanes<T>, buffer + (m - n / 2) * lanes<T>, Complex{});
    for (std::size_t j = n / 2; j < n; ++j) copy_block(from + j * stride, buffer + (m - n + j) * lanes<T>);
  }
  void cut(const Complex* buffer, Complex* to, std::size_t stride) const {
    for (std::size_t j = 0; j < n / 2; ++j) copy_block(buffer + j * lanes<T>, to + j * stride);
    for (std::size_t j = n / 2; j < n; ++j) copy_block(buffer + (m - n + j) * lanes<T>, to + j * stride);
  }
  void inverse_page(Scratch& s, std::size_t f, const Complex* from) const {
    for (std::size_t first = 0; first + lanes<T> < row; first += lanes<T>) {
      pad(from + first, row, s.buffer.data());
      line.inverse(s.buffer.data(), s.passes.data());
      for (std::size_t j = 0; j < m; ++j) copy_block(&s.buffer[j * lanes<T>], &s.page[f][j * row + first]);
    }
    for (std::size_t j = 0; j < m; ++j) {
      std::copy_n(&s.page[f][j * row], n / 2, s.modes.data());
      std::fill(s.modes.data() + n / 2, s.modes.data() + m / 2 + 1, Complex{});
      real_line.inverse(s.modes.data(), s.values.data());
      benchmark::DoNotOptimize(s.values.data());
    }
  }
  void forward_page(Scratch& s, std::size_t f, Complex* to) const {
    for (std::size_t j = 0; j < m; ++j) {
      real_line.forward(s.values.data(), s.modes.data());
      std::copy_n(s.modes.data(), n / 2, &s.page[f][j * row]);
    }
    for (std::size_t first = 0; first + lanes<T> < row; first += lanes<T>) {
      for (std::size_t j = 0; j < m; ++j) copy_block(&s.page[f][j * row + first], &s.buffer[j * lanes<T>]);
      line.forward(s.buffer.data(), s.passes.data());
      cut(s.buffer.data(), to + first, row);
    }
  }
  void run() {
#pragma omp parallel
    {
      Scratch& s = scratch[static_cast<std::size_t>(omp_get_thread_num())];
#pragma omp for schedule(static)
      for (std::size_t iy = 0; iy < n; ++iy)
        for (auto& field : work)
          for (std::size_t first = 0; first + lanes<T> < row; first += lanes<T>) {
            pad(field.data() + iy * row + first, plane, s.buffer.data());
            line.inverse(s.buffer.data(), s.passes.data());
            for (std::size_t j = 0; j < m; ++j)
              copy_block(&s.buffer[j * lanes<T>], field.data() + j * plane + iy * row + first);
          }
#pragma omp for schedule(static)
      for (std::size_t ix = 0; ix < m; ++ix) {
        for (std::size_t f = 0; f < 6; ++f) inverse_page(s, f, work[f].data() + ix * plane);
        for (std::size_t f = 0; f < 3; ++f) forward_page(s, f, work[f].data() + ix * plane);
      }
#pragma omp for schedule(static)
      for (std::size_t iy = 0; iy < n; ++iy)
        for (std::size_t f = 0; f < 3; ++f)
          for (std::size_t first = 0; first + lanes<T> < row; first += lanes<T>) {
            for (std::size_t j = 0; j < m; ++j)
              copy_block(work[f].data() + j * plane + iy * row + first, &s.buffer[j * lanes<T>]);
            line.forward(s.buffer.data(), s.passes.data());
            cut(s.buffer.data(), work[f].data() + iy * row + first, plane);
          }
    }
  }
};

template <class T>
void fused_floor(benchmark::State& state) {
  use_threads(state, 1);
  Floor<T> floor(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) floor.run();
}

// Modes and values read or written once, and along every axis 5 N log2 N operations of a complex transform, half of
// them for a real field.
template <class T>
Work three_transforms(std::size_t points) {
  const auto n = static_cast<double>(points), cubed = n * n * n;
  return {3 * 2 * cubed * sizeof(T), 3 * 2.5 * cubed * 3 * std::log2(n) * sizeof(T) / 4, 0, 0};
}

// Three unpadded transforms, as particles ask for them.
template <class T>
void velocity_on_points(benchmark::State& state) {
  const int threads = use_threads(state, 1);
  const auto n = static_cast<std::size_t>(state.range(0));
  const LoadedCase loaded = turbulence(n, Integrator::ab2);
  spectral::Flow<T> flow(loaded);
  flow.set_potential(spectral::initial_potential(loaded, flow));
  const std::size_t size = n * n * n;
  Array<T> values(3 * size);
  for (auto _ : state)
    spectral::real_velocity(flow, flow.potential(), {}, {&values[0], &values[size], &values[2 * size]}, n);
  count_against_machine(state, three_transforms<T>(n), threads);
}

// The force of particles to modes: three transforms the other way, and its projection.
template <class T>
void force_to_modes(benchmark::State& state) {
  const int threads = use_threads(state, 1);
  const auto n = static_cast<std::size_t>(state.range(0));
  const LoadedCase loaded = turbulence(n, Integrator::ab2);
  spectral::Flow<T> flow(loaded);
  const std::size_t size = n * n * n;
  Array<T> values(3 * size);
  for (std::size_t i = 0; i < 3 * size; ++i) values[i] = static_cast<T>(std::sin(0.1 * static_cast<double>(i)));
  spectral::Modes<T> modes;
  for (auto _ : state) spectral::force_modes<T>(flow, {&values[0], &values[size], &values[2 * size]}, n, modes);
  count_against_machine(state, three_transforms<T>(n), threads);
}

void grid_sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"points", "threads"})
      ->ArgsProduct({{64, 128}, thread_counts()})
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
}
BENCHMARK(flow_step<double>)->Apply(grid_sizes);
BENCHMARK(fused_floor<double>)->Apply(grid_sizes);
BENCHMARK(flow_step<float>)->Apply(grid_sizes);
BENCHMARK(fused_floor<float>)->Apply(grid_sizes);
BENCHMARK(velocity_on_points<double>)->Apply(grid_sizes);
BENCHMARK(velocity_on_points<float>)->Apply(grid_sizes);
BENCHMARK(force_to_modes<double>)->Apply(grid_sizes);
BENCHMARK(force_to_modes<float>)->Apply(grid_sizes);

}  // namespace
}  // namespace spume
