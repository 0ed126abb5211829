// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/initial_state.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/random.hpp"
#include "spume/io/checkpoint.hpp"
#include "spume/methods/spectral/flow_fields.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::spectral {
namespace {

using std::cos;
using std::sin;

// From values on the points. line(ix, iy, component, values) fills a line along z.
template <class T>
Modes<T> sampled(Flow<T>& flow,
                 const std::function<void(std::size_t ix, std::size_t iy, int component, T* values)>& line) {
  const ModeLayout& layout = flow.layout();
  const std::size_t nx = layout.points[0], ny = layout.points[1], nz = layout.points[2];
  Modes<T> potential = flow.take_potential();
  Array<T> values(nx * ny * nz);
  for (int c = 0; c < 3; ++c) {
    parallel_blocks(nx, 1, [&, ny = ny, nz = nz](std::size_t, std::size_t ix, std::size_t) {
      for (std::size_t iy = 0; iy < ny; ++iy) line(ix, iy, c, &values[(ix * ny + iy) * nz]);
    });
    add_velocity(flow.box(), layout, values.data(), c, potential);
  }
  return potential;
}

double coordinate(const ModeLayout& layout, std::size_t axis, std::size_t i) {
  return layout.lengths[axis] * static_cast<double>(i) / static_cast<double>(layout.points[axis]);
}

template <class T>
Modes<T> waves(const Case& options, Flow<T>& flow) {
  const InitialOptions& initial = options.get<InitialOptions>();
  const ModeLayout& layout = flow.layout();
  std::array<double, 3> k{};
  for (std::size_t axis = 0; axis < 3; ++axis) k[axis] = initial.wavenumber * layout.unit(axis);
  const bool abc = initial.kind == InitialKind::abc;
  if (abc && (std::abs(k[0] / k[1] - 1) > 1e-12 || std::abs(k[0] / k[2] - 1) > 1e-12))
    throw refusal(options, "initial.kind",
                  "initial.kind = \"abc\" is a Beltrami flow only in a box of equal sides; change the domain");
  std::vector<double> amplitude = initial.amplitude;
  amplitude.resize(3, 1.0);
  const double a = amplitude[0], b = amplitude[1], c = amplitude[2];
  return sampled<T>(flow, [&](std::size_t ix, std::size_t iy, int component, T* values) {
    const double x = k[0] * coordinate(layout, 0, ix), y = k[1] * coordinate(layout, 1, iy);
    for (std::size_t iz = 0; iz < layout.points[2]; ++iz) {
      const double z = k[2] * coordinate(layout, 2, iz);
      double u = 0;
      if (abc)
        u = component == 0   ? a * sin(z) + c * cos(y)
            : component == 1 ? b * sin(x) + a * cos(z)
                             : c * sin(y) + b * cos(x);
      else
        u = component == 0   ? a * sin(x) * cos(y) * cos(z)
            : component == 1 ? -a * k[0] / k[1] * cos(x) * sin(y) * cos(z)
                             : 0;
      values[iz] = static_cast<T>(u);
    }
  });
}

template <class T>
Modes<T> evaluated(const LoadedCase& loaded, Flow<T>& flow) {
  const Scene& scene = loaded.scene;
  const ModeLayout& layout = flow.layout();
  const VectorExpression& given = *scene.initial_velocity;
  std::vector<VectorExpression> own;  // one per thread: an expression is not thread-safe
  own.reserve(static_cast<std::size_t>(thread_count()));
  for (int thread = 0; thread < thread_count(); ++thread) own.push_back(given.clone());
  Modes<T> potential = sampled<T>(flow, [&](std::size_t ix, std::size_t iy, int component, T* values) {
    const auto& expression = own[static_cast<std::size_t>(omp_get_thread_num())].component[component];
    const double x = scene.domain.lower[0] + coordinate(layout, 0, ix);
    const double y = scene.domain.lower[1] + coordinate(layout, 1, iy);
    for (std::size_t iz = 0; iz < layout.points[2]; ++iz)
      values[iz] = !expression
                       ? T(0)
                       : static_cast<T>((*expression)(x, y, scene.domain.lower[2] + coordinate(layout, 2, iz), 0));
  });
  for (const auto& field : potential)
    if (const double sum = parallel_sum(field.size(), [&](std::size_t i) { return double{std::norm(field[i])}; });
        !std::isfinite(sum))
      throw refusal(loaded.options, "initial.velocity", "initial.velocity is not finite somewhere in the box");
  return potential;
}

// Rogallo's field: u = A (exp(i a) cos f e1 + exp(i b) sin f e2) with e1, e2 normal to k; b = k^-2 i k x u.
std::array<std::complex<double>, 3> random_mode(std::uint64_t seed, const std::array<std::int64_t, 3>& index,
                                                const std::array<double, 3>& k) {
  constexpr std::int64_t offset = 1 << 20;
  std::uint64_t identifier = 0;
  for (const std::int64_t i : index) identifier = identifier << 21 | static_cast<std::uint64_t>(i + offset);
  const auto r = random_uniform(seed, RandomPurpose::initial_field, identifier, 0, 0);
  const double tau = 2 * std::numbers::pi;
  const std::complex<double> first = std::polar(cos(tau * r[2]), tau * r[0]);
  const std::complex<double> second = std::polar(sin(tau * r[2]), tau * r[1]);
  const double across = std::hypot(k[0], k[1]), all = std::hypot(across, k[2]);
  const std::array<double, 3> e1 =
      across > 0 ? std::array<double, 3>{k[1] / across, -k[0] / across, 0} : std::array<double, 3>{1, 0, 0};
  const std::array<double, 3> e2{(k[1] * e1[2] - k[2] * e1[1]) / all, (k[2] * e1[0] - k[0] * e1[2]) / all,
                                 (k[0] * e1[1] - k[1] * e1[0]) / all};
  std::array<std::complex<double>, 3> u, b;
  for (std::size_t c = 0; c < 3; ++c) u[c] = first * e1[c] + second * e2[c];
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t p = (c + 1) % 3, q = (c + 2) % 3;
    b[c] = std::complex<double>(0, 1) * (k[p] * u[q] - k[q] * u[p]) / (all * all);
  }
  return b;
}

template <class T>
Modes<T> random_field(const LoadedCase& loaded, Flow<T>& flow) {
  const ModeLayout& layout = flow.layout();
  const std::size_t nx = layout.points[0], ny = layout.points[1];
  const double unit = 2 * std::numbers::pi / *std::max_element(layout.lengths.begin(), layout.lengths.end());
  double largest = layout.largest_wavenumber(0);
  for (std::size_t axis = 1; axis < 3; ++axis) largest = std::min(largest, layout.largest_wavenumber(axis));
  const auto shells = static_cast<std::size_t>(std::lround(largest / unit)) + 1;
  const auto signed_index = [](std::size_t i, std::size_t n) {
    return i < n / 2 ? static_cast<std::int64_t>(i) : static_cast<std::int64_t>(i) - static_cast<std::int64_t>(n);
  };
  const auto place = [&](std::size_t ix, std::size_t iy) { return ix * layout.plane + iy * layout.row; };
  Modes<T> potential = flow.take_potential();
  std::vector<double> energy(shells, 0.0);
  const auto shell_of = [&](std::size_t ix, std::size_t iy, std::size_t iz) {
    const double k = std::hypot(layout.wavenumber[0][ix], layout.wavenumber[1][iy], layout.wavenumber[2][iz]);
    return ix == nx / 2 || iy == ny / 2 || k == 0 || k > largest * (1 + 1e-12)
               ? shells
               : static_cast<std::size_t>(std::lround(k / unit));
  };
  for (std::size_t ix = 0; ix < nx; ++ix)
    for (std::size_t iy = 0; iy < ny; ++iy)
      for (std::size_t iz = 0; iz < layout.modes_z; ++iz) {
        const std::size_t shell = shell_of(ix, iy, iz);
        if (shell >= shells) continue;
        // In the plane k_z = 0 half the modes are conjugates of the other half.
        const std::int64_t sx = signed_index(ix, nx), sy = signed_index(iy, ny);
        const bool mirrored = iz == 0 && (sy < 0 || (sy == 0 && sx < 0));
        const std::int64_t sign = mirrored ? -1 : 1;
        const double flip = mirrored ? -1 : 1;
        const auto b =
            random_mode(loaded.scene.seed, {sign * sx, sign * sy, static_cast<std::int64_t>(iz)},
                        {flip * layout.wavenumber[0][ix], flip * layout.wavenumber[1][iy], layout.wavenumber[2][iz]});
        double square = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          potential[c][place(ix, iy) + iz] = static_cast<std::complex<T>>(mirrored ? std::conj(b[c]) : b[c]);
          square += std::norm(b[c]);
        }
        const double k2 = std::pow(layout.wavenumber[0][ix], 2) + std::pow(layout.wavenumber[1][iy], 2) +
                          std::pow(layout.wavenumber[2][iz], 2);
        energy[shell] += ModeLayout::weight(iz) * k2 * square / 2;
      }
  std::vector<double> factor(shells + 1, 0.0);
  double total = 0;
  for (std::size_t shell = 1; shell < shells; ++shell) {
    const double wanted = (*loaded.scene.initial_spectrum)(static_cast<double>(shell) * unit, 0, 0, 0);
    if (!(wanted >= 0) || !std::isfinite(wanted))
      throw refusal(
          loaded.options, "initial.spectrum",
          "initial.spectrum is negative or not finite at k = " + std::to_string(static_cast<double>(shell) * unit));
    if (!(energy[shell] > 0)) continue;
    factor[shell] = std::sqrt(wanted / energy[shell]);
    total += wanted;
  }
  if (!(total > 0))
    throw refusal(loaded.options, "initial.spectrum", "initial.spectrum is zero at every wavenumber of the grid");
  const double scale = std::sqrt(loaded.options.get<InitialOptions>().energy / total);
  for (std::size_t ix = 0; ix < nx; ++ix)
    for (std::size_t iy = 0; iy < ny; ++iy)
      for (std::size_t iz = 0; iz < layout.modes_z; ++iz)
        for (auto& field : potential)
          field[place(ix, iy) + iz] *= static_cast<T>(scale * factor[std::min(shell_of(ix, iy, iz), shells)]);
  return potential;
}

template <class T>
Modes<T> from_checkpoint(const Case& options, Flow<T>& flow) {
  const std::string& path = options.get<InitialOptions>().file;
  const ModeLayout& layout = flow.layout();
  const auto refuse = [&](const std::string& why) {
    throw refusal(options, "initial.file", "initial.file '" + path + "': " + why);
  };
  Modes<T> potential = flow.take_potential();
  try {
    const CheckpointReader file(path);
    Array<std::int64_t> counters;
    Array<double> lengths, values;
    if (!file.has("method/potential_x")) refuse("it holds no flow of method \"spectral\"");
    file.i64("method/counters", counters);
    file.f64("method/lengths", lengths);
    if (counters.size() != 5 || lengths.size() != 3) refuse("it was written by another version of the method");
    std::array<std::size_t, 3> points{}, half{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      points[axis] = static_cast<std::size_t>(counters[2 + axis]);
      half[axis] = std::min(points[axis], layout.points[axis]) / 2;
      if (std::abs(lengths[axis] / layout.lengths[axis] - 1) > 1e-12)
        refuse("its box has another size along " + std::string(1, "xyz"[axis]));
    }
    const char* const axes[3] = {"x", "y", "z"};
    for (std::size_t c = 0; c < 3; ++c) {
      file.f64(std::string("method/potential_") + axes[c], values);
      if (values.size() != points[0] * points[1] * (points[2] / 2) * 2) refuse("an array has another size");
      // Wavenumber s lies at s or, below 0, at n + s.
      const auto index = [](std::int64_t s, std::size_t n) {
        return static_cast<std::size_t>(s < 0 ? static_cast<std::int64_t>(n) + s : s);
      };
      const auto hx = static_cast<std::int64_t>(half[0]), hy = static_cast<std::int64_t>(half[1]);
      for (std::int64_t sx = 1 - hx; sx < hx; ++sx)
        for (std::int64_t sy = 1 - hy; sy < hy; ++sy) {
          const double* from = &values[2 * (index(sx, points[0]) * points[1] + index(sy, points[1])) * (points[2] / 2)];
          std::complex<T>* to =
              &potential[c][index(sx, layout.points[0]) * layout.plane + index(sy, layout.points[1]) * layout.row];
          for (std::size_t iz = 0; iz < half[2]; ++iz)
            to[iz] = {static_cast<T>(from[2 * iz]), static_cast<T>(from[2 * iz + 1])};
        }
    }
  } catch (const FileError& error) {
    throw refusal(options, "initial.file", std::string("initial.file: ") + error.what());
  }
  return potential;
}

}  // namespace

template <class T>
Modes<T> initial_potential(const LoadedCase& loaded, Flow<T>& flow) {
  switch (loaded.options.get<InitialOptions>().kind) {
    case InitialKind::taylor_green:
    case InitialKind::abc:
      return waves(loaded.options, flow);
    case InitialKind::random:
      return random_field(loaded, flow);
    case InitialKind::expressions:
      return evaluated(loaded, flow);
    case InitialKind::checkpoint:
      return from_checkpoint(loaded.options, flow);
    case InitialKind::rest:
      break;
  }
  return flow.take_potential();
}

template Modes<double> initial_potential(const LoadedCase&, Flow<double>&);
template Modes<float> initial_potential(const LoadedCase&, Flow<float>&);

}  // namespace spume::spectral
