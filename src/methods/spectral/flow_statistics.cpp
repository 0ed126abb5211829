// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/flow_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/methods/spectral/flow_fields.hpp"

namespace spume::spectral {
namespace {

// Adds the squares of the velocity's modes times weight(kx, ky, kz), one sum per plane of x, in a fixed order.
template <class T, class Weight>
double mode_sum(const Flow<T>& flow, Weight&& weight) {
  const ModeLayout& layout = flow.layout();
  const Modes<T>& b = flow.potential();
  std::vector<double> sums(layout.points[0], 0.0);
  parallel_blocks(layout.points[0], 1, [&](std::size_t, std::size_t ix, std::size_t) {
    for (std::size_t iy = 0; iy < layout.points[1]; ++iy)
      for (std::size_t iz = 0; iz < layout.modes_z; ++iz) {
        const std::size_t at = ix * layout.plane + iy * layout.row + iz;
        const std::array<double, 3> k{layout.wavenumber[0][ix], layout.wavenumber[1][iy], layout.wavenumber[2][iz]};
        sums[ix] += ModeLayout::weight(iz) * weight(k, b, at);
      }
  });
  double sum = 0;
  for (const double s : sums) sum += s;
  return sum;
}

// Mean square of d u_c / d x_a.
template <class T>
double gradient_variance(const Flow<T>& flow, std::size_t c, std::size_t a) {
  const std::size_t p = (c + 1) % 3, q = (c + 2) % 3;
  return mode_sum(flow, [=](const std::array<double, 3>& k, const Modes<T>& b, std::size_t at) {
    return k[a] * k[a] * std::norm(k[p] * std::complex<double>(b[q][at]) - k[q] * std::complex<double>(b[p][at]));
  });
}

// Calls visit(line) for every line of d u_c / d x_a, with `sums` one entry per plane of x.
template <class T, class Visit>
void visit_gradient(Flow<T>& flow, int c, int a, Visit&& visit) {
  flow.box().inverse(gradient_source(flow, c, a),
                     [&](std::size_t ix, std::size_t, const T* values) { visit(ix, values); });
}

// In standard deviations; bins of a tenth of one. What lies beyond is left out.
constexpr double pdf_half_width = 15;
constexpr std::size_t pdf_bins = 301;

}  // namespace

template <class T>
ShellSpectrum shell_spectrum(const Flow<T>& flow) {
  const ModeLayout& layout = flow.layout();
  const Modes<T>& b = flow.potential();
  ShellSpectrum spectrum;
  spectrum.width = 2 * std::numbers::pi / *std::max_element(layout.lengths.begin(), layout.lengths.end());
  double corner = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) corner += std::pow(layout.largest_wavenumber(axis), 2);
  const auto shells = static_cast<std::size_t>(std::lround(std::sqrt(corner) / spectrum.width)) + 1;
  std::vector<double> partial(layout.points[0] * shells, 0.0);
  parallel_blocks(layout.points[0], 1, [&](std::size_t, std::size_t ix, std::size_t) {
    double* const sums = &partial[ix * shells];
    for (std::size_t iy = 0; iy < layout.points[1]; ++iy)
      for (std::size_t iz = 0; iz < layout.modes_z; ++iz) {
        const std::size_t at = ix * layout.plane + iy * layout.row + iz;
        const double k2 = std::pow(layout.wavenumber[0][ix], 2) + std::pow(layout.wavenumber[1][iy], 2) +
                          std::pow(layout.wavenumber[2][iz], 2);
        const double square = std::norm(std::complex<double>(b[0][at])) + std::norm(std::complex<double>(b[1][at])) +
                              std::norm(std::complex<double>(b[2][at]));
        sums[static_cast<std::size_t>(std::lround(std::sqrt(k2) / spectrum.width))] +=
            ModeLayout::weight(iz) * k2 * square / 2;
      }
  });
  spectrum.wavenumber.resize(shells);
  spectrum.energy.assign(shells, 0.0);
  for (std::size_t n = 0; n < shells; ++n) {
    spectrum.wavenumber[n] = static_cast<double>(n) * spectrum.width;
    for (std::size_t i = n; i < partial.size(); i += shells) spectrum.energy[n] += partial[i];
    spectrum.energy[n] /= spectrum.width;
  }
  return spectrum;
}

template <class T>
Scales flow_scales(const Flow<T>& flow, const ShellSpectrum& spectrum) {
  Scales scales;
  double energy = 0;
  for (const double shell : spectrum.energy) energy += shell * spectrum.width;
  // Mode by mode: the middle of a shell is 17 % off the mean 1/|k| in the first of a cube, and shells depend on the
  // box.
  const double weighted = mode_sum(flow, [](const std::array<double, 3>& k, const Modes<T>& b, std::size_t at) {
    return std::sqrt(k[0] * k[0] + k[1] * k[1] + k[2] * k[2]) / 2 *
           (std::norm(std::complex<double>(b[0][at])) + std::norm(std::complex<double>(b[1][at])) +
            std::norm(std::complex<double>(b[2][at])));
  });
  const double nu = flow.viscosity(), dissipation = flow.budget().dissipation;
  scales.rms_velocity = std::sqrt(2 * energy / 3);
  scales.enstrophy =
      nu > 0 ? dissipation / (2 * nu)
             : mode_sum(flow, [](const std::array<double, 3>& k, const Modes<T>& b, std::size_t at) {
                 const double k2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
                 return k2 * k2 / 2 *
                        (std::norm(std::complex<double>(b[0][at])) + std::norm(std::complex<double>(b[1][at])) +
                         std::norm(std::complex<double>(b[2][at])));
               });
  if (!(scales.rms_velocity > 0)) {
    // A flow at rest has no lengths, nor a Reynolds number of them.
    for (double* length : {&scales.integral_scale, &scales.taylor_scale, &scales.reynolds_lambda,
                           &scales.kolmogorov_scale, &scales.kmax_eta})
      *length = std::numeric_limits<double>::quiet_NaN();
    return scales;
  }
  scales.integral_scale = std::numbers::pi / (2 * scales.rms_velocity * scales.rms_velocity) * weighted;
  scales.taylor_scale = scales.rms_velocity * std::sqrt(15 * nu / dissipation);
  scales.reynolds_lambda = scales.rms_velocity * scales.taylor_scale / nu;
  scales.kolmogorov_scale = std::pow(nu * nu * nu / dissipation, 0.25);
  scales.kmax_eta = flow.largest_wavenumber() * scales.kolmogorov_scale;
  return scales;
}

template <class T>
double largest_speed(Flow<T>& flow) {
  const ModeLayout& layout = flow.layout();
  const std::size_t ny = layout.points[1], nz = layout.points[2];
  Array<T> square(layout.points[0] * ny * nz);
  std::vector<double> largest(layout.points[0], 0.0);
  for (int c = 0; c < 3; ++c)
    flow.box().inverse(velocity_source(flow, c), [&](std::size_t ix, std::size_t iy, const T* values) {
      T* const line = &square[(ix * ny + iy) * nz];
      for (std::size_t iz = 0; iz < nz; ++iz) {
        line[iz] = values[iz] * values[iz] + (c > 0 ? line[iz] : T(0));
        if (c == 2) largest[ix] = larger_or_nan(largest[ix], static_cast<double>(line[iz]));
      }
    });
  double all = 0;
  for (const double of_plane : largest) all = larger_or_nan(all, of_plane);
  return std::sqrt(all);
}

template <class T>
GradientMoments gradient_moments(Flow<T>& flow) {
  struct Sums {
    double second = 0, third = 0, fourth = 0;
  };
  std::vector<Sums> sums(flow.layout().points[0]);
  const std::size_t nz = flow.layout().points[2];
  for (int c = 0; c < 3; ++c)
    visit_gradient(flow, c, c, [&](std::size_t ix, const T* values) {
      Sums line;
      for (std::size_t iz = 0; iz < nz; ++iz) {
        const double g = double{values[iz]}, square = g * g;
        line.second += square;
        line.third += g * square;
        line.fourth += square * square;
      }
      sums[ix].second += line.second;
      sums[ix].third += line.third;
      sums[ix].fourth += line.fourth;
    });
  Sums all;
  for (const Sums& s : sums) all.second += s.second, all.third += s.third, all.fourth += s.fourth;
  const double count = 3 * flow.layout().point_count(), variance = all.second / count;
  if (!(variance > 0)) return {std::nan(""), std::nan("")};
  return {all.third / count / std::pow(variance, 1.5), all.fourth / count / (variance * variance)};
}

template <class T>
GradientDistribution gradient_distribution(Flow<T>& flow) {
  GradientDistribution result;
  const double width = 2 * pdf_half_width / static_cast<double>(pdf_bins);
  for (std::size_t bin = 0; bin < pdf_bins; ++bin)
    result.value.push_back(-pdf_half_width + (static_cast<double>(bin) + 0.5) * width);
  const std::size_t nx = flow.layout().points[0], nz = flow.layout().points[2];
  for (int turn = 0; turn < 2; ++turn) {
    std::vector<std::int64_t> counts(nx * pdf_bins, 0);
    for (int c = 0; c < 3; ++c) {
      const int axis = (c + turn) % 3;
      const double variance = gradient_variance(flow, static_cast<std::size_t>(c), static_cast<std::size_t>(axis));
      if (!(variance > 0)) continue;
      const double per_bin = 1 / (std::sqrt(variance) * width);
      visit_gradient(flow, c, axis, [&](std::size_t ix, const T* values) {
        for (std::size_t iz = 0; iz < nz; ++iz) {
          const double place = double{values[iz]} * per_bin + static_cast<double>(pdf_bins) / 2;
          if (place >= 0 && place < static_cast<double>(pdf_bins))
            ++counts[ix * pdf_bins + static_cast<std::size_t>(place)];
        }
      });
    }
    std::vector<double>& density = turn == 0 ? result.longitudinal : result.transverse;
    for (std::size_t bin = 0; bin < pdf_bins; ++bin) {
      std::int64_t count = 0;
      for (std::size_t ix = 0; ix < nx; ++ix) count += counts[ix * pdf_bins + bin];
      density.push_back(static_cast<double>(count) / (3 * flow.layout().point_count() * width));
    }
  }
  return result;
}

template <class T>
PointSample sample_flow(const Flow<T>& flow, const Array<std::complex<T>>& total_pressure, const Vec3& from_lower) {
  using Complex = std::complex<double>;
  const ModeLayout& layout = flow.layout();
  const Modes<T>& b = flow.potential();
  std::array<std::vector<Complex>, 3> wave;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double k : layout.wavenumber[axis]) wave[axis].push_back(std::polar(1.0, k * from_lower[axis]));
  std::vector<std::array<double, 4>> sums(layout.points[0]);
  parallel_blocks(layout.points[0], 1, [&](std::size_t, std::size_t ix, std::size_t) {
    std::array<Complex, 4> plane{};
    for (std::size_t iy = 0; iy < layout.points[1]; ++iy) {
      std::array<Complex, 4> row{};
      for (std::size_t iz = 0; iz < layout.modes_z; ++iz) {
        const std::size_t at = ix * layout.plane + iy * layout.row + iz;
        const double k[3] = {layout.wavenumber[0][ix], layout.wavenumber[1][iy], layout.wavenumber[2][iz]};
        const Complex factor = ModeLayout::weight(iz) * wave[2][iz];
        const Complex field[3] = {Complex(b[0][at]), Complex(b[1][at]), Complex(b[2][at])};
        for (std::size_t c = 0; c < 3; ++c) {
          const std::size_t p = (c + 1) % 3, q = (c + 2) % 3;
          row[c] += factor * (at == 0 ? field[c] : Complex(0, 1) * (k[p] * field[q] - k[q] * field[p]));
        }
        row[3] += factor * Complex(total_pressure[at]);
      }
      for (std::size_t c = 0; c < 4; ++c) plane[c] += row[c] * wave[1][iy];
    }
    for (std::size_t c = 0; c < 4; ++c) sums[ix][c] = (plane[c] * wave[0][ix]).real();
  });
  PointSample sample{.scalars = {0.0}, .coverage = 1};
  double& pressure = sample.scalars[0];
  for (const auto& sum : sums) {
    for (std::size_t c = 0; c < 3; ++c) sample.velocity[c] += sum[c];
    pressure += sum[3];
  }
  for (const double u : sample.velocity) pressure -= u * u / 2;
  return sample;
}

template <class T>
PlaneSample sample_plane(const Flow<T>& flow, const Array<std::complex<T>>& total_pressure, std::size_t axis,
                         double from_lower) {
  using Complex = std::complex<double>;
  const ModeLayout& layout = flow.layout();
  const Modes<T>& b = flow.potential();
  const std::array<std::size_t, 3> stored{layout.points[0], layout.points[1], layout.modes_z};
  const auto& along = layout.wavenumber[axis];
  std::vector<Complex> wave;
  for (const double k : along) wave.push_back(std::polar(1.0, k * from_lower));
  // The modes of velocity and total pressure at index (ix, iy, iz).
  const auto modes_at = [&](const std::array<std::size_t, 3>& index) {
    const std::size_t at = index[0] * layout.plane + index[1] * layout.row + index[2];
    std::array<double, 3> k;
    std::array<Complex, 3> field;
    for (std::size_t c = 0; c < 3; ++c) {
      k[c] = layout.wavenumber[c][index[c]];
      field[c] = Complex(b[c][at]);
    }
    std::array<Complex, 4> modes{field[0], field[1], field[2], Complex(total_pressure[at])};
    for (std::size_t c = 0; c < 3 && at != 0; ++c) {
      const std::size_t p = (c + 1) % 3, q = (c + 2) % 3;
      modes[c] = Complex(0, 1) * (k[p] * field[q] - k[q] * field[p]);
    }
    return modes;
  };

  PlaneSample sample;
  sample.area = layout.lengths[(axis + 1) % 3] * layout.lengths[(axis + 2) % 3];
  sample.scalars = {0.0};
  sample.velocity = {};
  double& pressure = sample.scalars[0];
  std::array<std::size_t, 3> line{};
  for (std::size_t i = 0; i < stored[axis]; ++i) {
    line[axis] = i;
    const auto modes = modes_at(line);
    const double weight = axis == 2 ? ModeLayout::weight(i) : 1.0;
    for (std::size_t c = 0; c < 3; ++c) sample.velocity[c] += weight * (wave[i] * modes[c]).real();
    pressure += weight * (wave[i] * modes[3]).real();
  }

  // Rows of wavenumbers within the plane; along z half of the modes are stored, the others conjugates of (-kx, -ky).
  const std::size_t outer = axis == 0 ? 1 : 0, inner = axis == 2 ? 1 : 2;
  const auto mirrored = [&](std::size_t i, std::size_t a) { return i == 0 ? 0 : layout.points[a] - i; };
  std::vector<double> squares(stored[outer]);
  parallel_blocks(stored[outer], 1, [&](std::size_t, std::size_t row, std::size_t) {
    double sum = 0;
    for (std::size_t column = 0; column < stored[inner]; ++column) {
      std::array<Complex, 3> amplitude{};
      std::array<std::size_t, 3> index{};
      index[outer] = row;
      index[inner] = column;
      for (std::size_t i = 0; i < stored[axis]; ++i) {
        index[axis] = i;
        const auto modes = modes_at(index);
        for (std::size_t c = 0; c < 3; ++c) amplitude[c] += wave[i] * modes[c];
        if (axis != 2 || i == 0) continue;
        const auto opposite = modes_at({mirrored(row, 0), mirrored(column, 1), i});
        for (std::size_t c = 0; c < 3; ++c) amplitude[c] += std::conj(wave[i] * opposite[c]);
      }
      const double weight = inner == 2 ? ModeLayout::weight(column) : 1.0;
      for (const Complex& one : amplitude) sum += weight * std::norm(one);
    }
    squares[row] = sum;
  });
  for (const double square : squares) pressure -= square / 2;
  return sample;
}

// NOLINTBEGIN(bugprone-macro-parentheses): a type in parentheses is none
#define SPUME_INSTANTIATE(T)                                                                    \
  template ShellSpectrum shell_spectrum(const Flow<T>&);                                        \
  template Scales flow_scales(const Flow<T>&, const ShellSpectrum&);                            \
  template double largest_speed(Flow<T>&);                                                      \
  template GradientMoments gradient_moments(Flow<T>&);                                          \
  template GradientDistribution gradient_distribution(Flow<T>&);                                \
  template PointSample sample_flow(const Flow<T>&, const Array<std::complex<T>>&, const Vec3&); \
  template PlaneSample sample_plane(const Flow<T>&, const Array<std::complex<T>>&, std::size_t, double)
// NOLINTEND(bugprone-macro-parentheses)
SPUME_INSTANTIATE(double);
SPUME_INSTANTIATE(float);
#undef SPUME_INSTANTIATE

}  // namespace spume::spectral
