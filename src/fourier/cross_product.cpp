// SPDX-License-Identifier: MIT
#include "spume/fourier/cross_product.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/fourier/lane_vector.hpp"

namespace spume {

using fourier::conjugate;
using fourier::copy_block;
using fourier::Factor;
using fourier::load;
using fourier::prefetch_block;
using fourier::release_streams;
using fourier::store;
using fourier::stream_block;
using fourier::times_i;
using fourier::vector_width;

// Bytes of the planes from which on they are written past the caches, which saves reading them first: some tens of
// megabytes, the last cache of a server. On a machine with AVX-512 flow steps of 64^3 to 128^3 (7 to 50 MB), either
// precision, one thread, take the same within 3 % both ways, which is what repeats differ by.
constexpr double streamed_bytes = 3e7;

// Rows of the plane that go through the z stage together: two groups of one row per lane.
template <class T>
constexpr std::size_t group_rows = 2 * lanes<T>;

template <class T>
struct CrossProduct<T>::Scratch {
  std::array<Array<Complex>, 5> line;     // lines along x
  std::array<Array<Complex>, 6> rows;     // of one remainder along y: half_[1] rows (rounded up) of modes along z
  std::array<Array<Complex>, 3> sum;      // of the remainders along y: ny rows
  std::array<Array<Complex>, 6> column;   // lines of the y stage
  std::array<Array<Complex>, 12> turned;  // modes of a group of rows, by mode, one row per lane
  std::array<Array<Complex>, 6> pair;     // two real fields as one complex: values along z of a group
  Array<Complex> pair_z;
  std::array<Array<Complex>, 3> pair_modes;  // their transforms, summed over the remainders along z
};

template <class T>
CrossProduct<T>::CrossProduct(const ModeLayout& layout, bool padded, Planning planning)
    : layout_(layout),
      phases_(padded ? 3 : 2),
      work_row_(layout.row + lanes<T>),
      work_plane_(layout.points[1] * work_row_ + lanes<T>) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t n = half_[axis] = layout.points[axis] / 2;
    twists_[axis].resize(phases_);
    for (std::size_t r = 0; r < phases_; ++r)
      for (std::size_t i = 0; i < 2 * n; ++i) {
        const double k = i < n ? static_cast<double>(i) : static_cast<double>(i) - 2.0 * static_cast<double>(n);
        const double angle = 2 * std::numbers::pi * k * static_cast<double>(r) / static_cast<double>(phases_ * n);
        twists_[axis][r].emplace_back(static_cast<T>(std::cos(angle)), static_cast<T>(std::sin(angle)));
      }
    for (const double k : layout.wavenumber[axis]) wavenumber_[axis].push_back(static_cast<T>(k));
    transform_.emplace_back(n, planning);
  }
  lane_wavenumber_.resize(layout.row);
  for (std::size_t iz = 0; iz < layout.row; ++iz) lane_wavenumber_[iz] = {wavenumber_[2][iz], wavenumber_[2][iz]};
  for (auto& field : work_) field.resize(half_[0] * work_plane_);
  const std::size_t padded_rows = (half_[1] + group_rows<T> - 1) / group_rows<T> * group_rows<T>;
  for (int thread = 0; thread < thread_count(); ++thread) {
    auto scratch = std::make_unique<Scratch>();
    const auto size = [](auto& arrays, std::size_t values) {
      for (auto& array : arrays) array.resize(values);
    };
    size(scratch->line, half_[0] * lanes<T>);
    size(scratch->rows, padded_rows * work_row_);
    size(scratch->sum, layout.points[1] * work_row_);
    size(scratch->column, half_[1] * lanes<T>);
    size(scratch->turned, half_[2] * lanes<T>);
    size(scratch->pair, half_[2] * lanes<T>);
    scratch->pair_z.resize(half_[2] * lanes<T>);
    size(scratch->pair_modes, 2 * half_[2] * lanes<T>);
    scratch_.push_back(std::move(scratch));
  }
  peaks_.resize(half_[0]);
}

template <class T>
CrossProduct<T>::~CrossProduct() = default;

template <class T>
double CrossProduct<T>::bytes() const {
  double values = 0;
  for (const auto& field : work_) values += static_cast<double>(field.capacity());
  const auto add = [&](const auto& arrays) {
    for (const auto& array : arrays) values += static_cast<double>(array.capacity());
  };
  for (const auto& scratch : scratch_) {
    add(scratch->line);
    add(scratch->rows);
    add(scratch->sum);
    add(scratch->column);
    add(scratch->turned);
    add(scratch->pair);
    add(scratch->pair_modes);
    values += static_cast<double>(scratch->pair_z.capacity());
  }
  return values * sizeof(Complex);
}

template <class T>
VelocityPeak CrossProduct<T>::evaluate(const std::array<const Complex*, 3>& potential,
                                       const std::array<Complex*, 3>& sum, const Finish& finish) {
  VelocityPeak peak;
  for (std::size_t remainder = 0; remainder < phases_; ++remainder) {
    inverse_x(remainder, potential);
    form_planes(peak);
    forward_x(remainder, sum, finish);
  }
  return peak;
}

template <class T>
void CrossProduct<T>::form_planes(VelocityPeak& peak) {
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t j = 0; j < half_[0]; ++j) {
    peaks_[j] = {};
    plane(j, *scratch_[static_cast<std::size_t>(omp_get_thread_num())], peaks_[j]);
  }
  for (const VelocityPeak& p : peaks_) {
    // A value that is not a number has to reach the caller.
    peak.speed = p.speed > peak.speed || p.speed != p.speed ? p.speed : peak.speed;
    peak.rate = p.rate > peak.rate || p.rate != p.rate ? p.rate : peak.rate;
  }
}

template <class T>
void CrossProduct<T>::inverse_x(std::size_t remainder, const std::array<const Complex*, 3>& potential) {
  using V = fourier::Vector<T>;
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
  const std::size_t n = half_[0], ny = layout_.points[1];
  const std::vector<Complex>& twist = twists_[0][remainder];
  const bool stream = static_cast<double>(work_[0].size() * work_.size() * sizeof(Complex)) > streamed_bytes;
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t iy = 0; iy < ny; ++iy) {
    Scratch& scratch = *scratch_[static_cast<std::size_t>(omp_get_thread_num())];
    const T ky = wavenumber_[1][iy];
    for (std::size_t first = 0; first < layout_.row; first += lanes<T>) {
      for (std::size_t j = 0; j < n; ++j) {
        // i times the twist: u = i k x b.
        const Factor<T> low(Complex(-twist[j].imag(), twist[j].real()));
        const Factor<T> high(Complex(-twist[n + j].imag(), twist[n + j].real()));
        const T k = wavenumber_[0][j], l = wavenumber_[0][n + j];
        const std::size_t at = j * layout_.plane + iy * layout_.row + first, above = at + n * layout_.plane;
        // The next block's lines lie a plane apart each: no prefetcher of the processor sees them coming.
        for (std::size_t c = 0; c < 3; ++c) {
          prefetch_block(potential[c] + at + lanes<T>);
          prefetch_block(potential[c] + above + lanes<T>);
        }
        for (std::size_t q = 0; q < lanes<T>; q += vector_width<T>) {
          const V kz = load(lane_wavenumber_.data() + first + q);
          V bx = load(potential[0] + at + q), by = load(potential[1] + at + q), bz = load(potential[2] + at + q);
          V u = low * (ky * bz - kz * by), v = low * (kz * bx - k * bz), w = low * (k * by - ky * bx);
          V dv = k * v, dw = k * w;
          if (j > 0) {
            bx = load(potential[0] + above + q), by = load(potential[1] + above + q),
            bz = load(potential[2] + above + q);
            const V v_above = high * (kz * bx - l * bz), w_above = high * (l * by - ky * bx);
            u += high * (ky * bz - kz * by);
            v += v_above;
            w += w_above;
            dv += l * v_above;
            dw += l * w_above;
          }
          const std::size_t to = j * lanes<T> + q;
          store<T>(&scratch.line[0][to], u);
          store<T>(&scratch.line[1][to], v);
          store<T>(&scratch.line[2][to], w);
          store<T>(&scratch.line[3][to], times_i<T>(dv));
          store<T>(&scratch.line[4][to], times_i<T>(dw));
        }
      }
      if (iy == 0 && first == 0)  // the mean velocity
        for (std::size_t c = 0; c < 3; ++c) scratch.line[c][0] += potential[c][0].real();
      for (std::size_t f = 0; f < 5; ++f) {
        transform_[0].inverse(scratch.line[f].data());
        Complex* const out = work_[f].data() + iy * work_row_ + first;
        if (stream)
          for (std::size_t j = 0; j < n; ++j) stream_block(&scratch.line[f][j * lanes<T>], out + j * work_plane_);
        else
          for (std::size_t j = 0; j < n; ++j) copy_block(&scratch.line[f][j * lanes<T>], out + j * work_plane_);
      }
    }
    release_streams();
  }
}

template <class T>
void CrossProduct<T>::plane(std::size_t j, Scratch& scratch, VelocityPeak& peak) {
  for (std::size_t remainder = 0; remainder < phases_; ++remainder) {
    inverse_y(remainder, j, scratch);
    rows(scratch, peak);
    forward_y(remainder, j, scratch);
  }
}

template <class T>
void CrossProduct<T>::inverse_y(std::size_t remainder, std::size_t j, Scratch& scratch) const {
  using V = fourier::Vector<T>;
  const std::size_t n = half_[1];
  const std::vector<Complex>& twist = twists_[1][remainder];
  for (std::size_t first = 0; first < layout_.row; first += lanes<T>) {
    const Complex* from[5];
    for (std::size_t f = 0; f < 5; ++f) from[f] = work_[f].data() + j * work_plane_ + first;
    for (std::size_t jy = 0; jy < n; ++jy) {
      const Factor<T> low(twist[jy]), high(twist[n + jy]);
      const T k = wavenumber_[1][jy], l = wavenumber_[1][n + jy];
      const std::size_t at = jy * work_row_, above = at + n * work_row_;
      for (const Complex* const f : from) {
        prefetch_block(f + at + lanes<T>);
        prefetch_block(f + above + lanes<T>);
      }
      for (std::size_t q = 0; q < lanes<T>; q += vector_width<T>) {
        const V kz = load(lane_wavenumber_.data() + first + q);
        V u = low * load(from[0] + at + q), v = low * load(from[1] + at + q), w = low * load(from[2] + at + q);
        V vx = low * load(from[3] + at + q), wx = low * load(from[4] + at + q);
        V uy = k * u, wy = k * w;
        if (jy > 0) {
          const V u_above = high * load(from[0] + above + q), w_above = high * load(from[2] + above + q);
          u += u_above;
          v += high * load(from[1] + above + q);
          w += w_above;
          vx += high * load(from[3] + above + q);
          wx += high * load(from[4] + above + q);
          uy += l * u_above;
          wy += l * w_above;
        }
        const std::size_t to = jy * lanes<T> + q;
        store<T>(&scratch.column[0][to], u);
        store<T>(&scratch.column[1][to], v);
        store<T>(&scratch.column[2][to], w);
        store<T>(&scratch.column[3][to], times_i<T>(wy - kz * v));
        store<T>(&scratch.column[4][to], times_i<T>(kz * u) - wx);
        store<T>(&scratch.column[5][to], vx - times_i<T>(uy));
      }
    }
    for (std::size_t f = 0; f < 6; ++f) {
      transform_[1].inverse(scratch.column[f].data());
      for (std::size_t jy = 0; jy < n; ++jy)
        copy_block(&scratch.column[f][jy * lanes<T>], &scratch.rows[f][jy * work_row_ + first]);
    }
  }
}

// Largest values of every lane.
template <class T>
struct CrossProduct<T>::PeakLanes {
  using V = fourier::Vector<T>;
  std::array<T, 3> per_spacing{};
  V rate{}, square{};

  void add_to(VelocityPeak& peak) const {
    T largest_rate = 0, largest_square = 0;
    for (std::size_t l = 0; l < sizeof(V) / sizeof(T); ++l) {
      largest_rate = rate[l] > largest_rate || rate[l] != rate[l] ? rate[l] : largest_rate;
      largest_square = square[l] > largest_square || square[l] != square[l] ? square[l] : largest_square;
    }
    peak.rate = std::max(peak.rate, static_cast<double>(largest_rate));
    peak.speed = std::max(peak.speed, std::sqrt(static_cast<double>(largest_square)));
  }
};

// The z stage: groups of rows, one row per lane. Fields of a group travel in pairs (velocity component, vorticity
// component) as the real and imaginary part of one complex field: half the transforms, all of the same kind.
template <class T>
void CrossProduct<T>::rows(Scratch& scratch, VelocityPeak& peak) const {
  PeakLanes largest;
  for (std::size_t axis = 0; axis < 3; ++axis)
    largest.per_spacing[axis] = static_cast<T>(static_cast<double>(layout_.points[axis]) / layout_.lengths[axis]);
  for (std::size_t top = 0; top < half_[1]; top += group_rows<T>) {
    rows_to_lanes(top, scratch);
    for (auto& sum : scratch.pair_modes) std::fill(sum.begin(), sum.end(), Complex{});
    for (std::size_t remainder = 0; remainder < phases_; ++remainder) {
      inverse_z(remainder, scratch);
      multiply(scratch, largest);
      forward_z(remainder, scratch);
    }
    lanes_to_rows(top, scratch);
  }
  largest.add_to(peak);
}

// Modes by rows to modes by lanes, already paired: a + i b at k_z, and conj(a) + i conj(b), which stands at -k_z.
template <class T>
void CrossProduct<T>::rows_to_lanes(std::size_t top, Scratch& scratch) const {
  using V = fourier::Vector<T>;
  constexpr std::size_t width = lanes<T>;
  const std::size_t n = half_[2], row = work_row_;
  for (std::size_t g = 0; g < 2; ++g)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t l = 0; l < width; ++l) {
        const Complex* const a = scratch.rows[c].data() + (top + g * width + l) * row;
        const Complex* const b = scratch.rows[3 + c].data() + (top + g * width + l) * row;
        Complex* const positive = scratch.turned[6 * g + c].data() + l;
        Complex* const negative = scratch.turned[6 * g + 3 + c].data() + l;
        const Complex mean(a[0].real(), b[0].real());  // real parts alone: no rounding leaks from one to the other
        for (std::size_t iz = 0; iz < n; iz += vector_width<T>) {
          const V at_a = load(a + iz), at_b = load(b + iz);
          const V plus = at_a + times_i<T>(at_b), minus = conjugate<T>(at_a) + times_i<T>(conjugate<T>(at_b));
          for (std::size_t e = 0; e < vector_width<T> && iz + e < n; ++e) {
            fourier::store_element<T>(positive + (iz + e) * width, plus, e);
            fourier::store_element<T>(negative + (iz + e) * width, minus, e);
          }
        }
        positive[0] = mean;
      }
}

template <class T>
void CrossProduct<T>::inverse_z(std::size_t remainder, Scratch& scratch) const {
  constexpr std::size_t width = lanes<T>;
  const std::size_t n = half_[2];
  const std::vector<Complex>& twist = twists_[2][remainder];
  for (std::size_t g = 0; g < 2; ++g)
    for (std::size_t c = 0; c < 3; ++c) {
      const Complex* const positive = scratch.turned[6 * g + c].data();
      const Complex* const negative = scratch.turned[6 * g + 3 + c].data();
      Complex* const out = scratch.pair[3 * g + c].data();
      copy_block(positive, out);
      for (std::size_t j = 1; j < n; ++j) {
        const Factor<T> low(twist[j]), high(twist[n + j]);
        for (std::size_t q = 0; q < width; q += vector_width<T>)
          store<T>(out + j * width + q,
                   low * load(positive + j * width + q) + high * load(negative + (n - j) * width + q));
      }
      transform_[2].inverse(out);
    }
}

// In place of X, Y, Z = (u, omega_x), (v, omega_y), (w, omega_z): the product's components of both groups, as (x, y) of
// group 0, (x, y) of group 1, and (z of group 0, z of group 1). Im(conj(Y) Z) = v omega_z - w omega_y.
template <class T>
void CrossProduct<T>::multiply(Scratch& scratch, PeakLanes& peak) const {
  using V = fourier::Vector<T>;
  using Traits = fourier::VectorTraits<T>;
  PeakLanes largest = peak;
  for (std::size_t i = 0; i < half_[2] * lanes<T>; i += vector_width<T>) {
    V z[2];
    for (std::size_t g = 0; g < 2; ++g) {
      const V x = load(&scratch.pair[3 * g][i]), y = load(&scratch.pair[3 * g + 1][i]),
              w = load(&scratch.pair[3 * g + 2][i]);
      const V xs = fourier::swap<T>(x), ys = fourier::swap<T>(y), ws = fourier::swap<T>(w);
      // The real entries hold the component, the imaginary ones its negative.
      store<T>(&scratch.pair[g][i], Traits::real_part * (y * ws - ys * w) - Traits::imaginary_part * (w * xs - ws * x));
      z[g] = x * ys - xs * y;
      const V ax = x < 0 ? -x : x, ay = y < 0 ? -y : y, aw = w < 0 ? -w : w;
      const V rate =
          (ax * largest.per_spacing[0] + ay * largest.per_spacing[1] + aw * largest.per_spacing[2]) * Traits::real_part;
      const V square = (x * x + y * y + w * w) * Traits::real_part;
      largest.rate = largest.rate > rate ? largest.rate : rate;
      largest.square = largest.square > square ? largest.square : square;
    }
    store<T>(&scratch.pair_z[i], Traits::real_part * z[0] - Traits::imaginary_part * z[1]);
  }
  peak = largest;
}

template <class T>
void CrossProduct<T>::forward_z(std::size_t remainder, Scratch& scratch) const {
  using V = fourier::Vector<T>;
  constexpr std::size_t width = lanes<T>;
  const std::size_t n = half_[2];
  const std::vector<Complex>& twist = twists_[2][remainder];
  for (std::size_t p = 0; p < 3; ++p) {
    Complex* const values = p < 2 ? scratch.pair[p].data() : scratch.pair_z.data();
    transform_[2].forward(values);
    Complex* const sum = scratch.pair_modes[p].data();
    for (std::size_t j = 0; j < n; ++j) {
      const Factor<T> low(std::conj(twist[j])), high(std::conj(twist[n + j]));
      Complex *const lower = sum + j * width, *const upper = lower + n * width;
      for (std::size_t q = 0; q < width; q += vector_width<T>) {
        const V modes = load(values + j * width + q);
        store<T>(lower + q, load(lower + q) + low * modes);
        if (j > 0) store<T>(upper + q, load(upper + q) + high * modes);
      }
    }
  }
}

// Two real fields from one complex: A_k = (P_k + conj P_-k) / 2, B_k = (P_k - conj P_-k) / 2i; back to rows.
template <class T>
void CrossProduct<T>::lanes_to_rows(std::size_t top, Scratch& scratch) const {
  using V = fourier::Vector<T>;
  constexpr std::size_t width = lanes<T>;
  const std::size_t n = half_[2], row = work_row_;
  for (std::size_t p = 0; p < 3; ++p) {
    const Complex* const sum = scratch.pair_modes[p].data();
    Complex* const first =
        p < 2 ? scratch.rows[0].data() + (top + p * width) * row : scratch.rows[2].data() + top * row;
    Complex* const second =
        p < 2 ? scratch.rows[1].data() + (top + p * width) * row : scratch.rows[2].data() + (top + width) * row;
    for (std::size_t iz = 0; iz < n; ++iz) {
      const std::size_t partner = iz == 0 ? 0 : 2 * n - iz;
      for (std::size_t q = 0; q < width; q += vector_width<T>) {
        const V plus = load(sum + iz * width + q), minus = conjugate<T>(load(sum + partner * width + q));
        const V a = T(0.5) * (plus + minus), b = T(-0.5) * times_i<T>(plus - minus);
        for (std::size_t e = 0; e < vector_width<T>; ++e) {
          fourier::store_element<T>(first + (q + e) * row + iz, a, e);
          fourier::store_element<T>(second + (q + e) * row + iz, b, e);
        }
      }
    }
  }
}

template <class T>
void CrossProduct<T>::forward_y(std::size_t remainder, std::size_t j, Scratch& scratch) {
  using V = fourier::Vector<T>;
  const std::size_t n = half_[1], row = work_row_;
  const std::vector<Complex>& twist = twists_[1][remainder];
  const bool last = remainder + 1 == phases_;
  for (std::size_t first = 0; first < layout_.row; first += lanes<T>)
    for (std::size_t f = 0; f < 3; ++f) {
      Complex* const column = scratch.column[f].data();
      for (std::size_t jy = 0; jy < n; ++jy) copy_block(&scratch.rows[f][jy * row + first], column + jy * lanes<T>);
      transform_[1].forward(column);
      // The last remainder goes straight to the plane: its modes are no longer needed.
      const Complex* const sum = scratch.sum[f].data() + first;
      Complex* const out = last ? work_[f].data() + j * work_plane_ + first : scratch.sum[f].data() + first;
      for (std::size_t jy = 0; jy < n; ++jy) {
        const Factor<T> low(std::conj(twist[jy])), high(std::conj(twist[n + jy]));
        const std::size_t at = jy * row, above = at + n * row;
        for (std::size_t q = 0; q < lanes<T>; q += vector_width<T>) {
          const V modes = load(column + jy * lanes<T> + q);
          V lower = low * modes, upper = high * modes;
          if (remainder > 0) lower += load(sum + at + q), upper += load(sum + above + q);
          store<T>(out + at + q, lower);
          if (jy > 0) store<T>(out + above + q, upper);
        }
      }
    }
}

template <class T>
void CrossProduct<T>::forward_x(std::size_t remainder, const std::array<Complex*, 3>& sum, const Finish& finish) {
  using V = fourier::Vector<T>;
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
  const std::size_t n = half_[0], ny = layout_.points[1];
  const std::vector<Complex>& twist = twists_[0][remainder];
  const bool last = remainder + 1 == phases_;
  const T scale = static_cast<T>(1 / (layout_.point_count() / 8 * static_cast<double>(phases_ * phases_ * phases_)));
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t iy = 0; iy < ny; ++iy) {
    if (iy == ny / 2) continue;
    Scratch& scratch = *scratch_[static_cast<std::size_t>(omp_get_thread_num())];
    for (std::size_t first = 0; first < layout_.row; first += lanes<T>) {
      for (std::size_t f = 0; f < 3; ++f) {
        Complex* const line = scratch.line[f].data();
        const Complex* const from = work_[f].data() + iy * work_row_ + first;
        for (std::size_t j = 0; j < n; ++j) {
          prefetch_block(from + j * work_plane_ + lanes<T>);
          copy_block(from + j * work_plane_, line + j * lanes<T>);
        }
        transform_[0].forward(line);
      }
      const auto mode = [&](std::size_t ix, std::size_t j) {
        const std::size_t at = ix * layout_.plane + iy * layout_.row + first;
        const Factor<T> factor(scale * std::conj(twist[ix]));
        for (std::size_t f = 0; f < 3; ++f) prefetch_block<T>(sum[f] + at + lanes<T>);
        alignas(64) Complex product[3][lanes<T>];
        for (std::size_t f = 0; f < 3; ++f)
          for (std::size_t q = 0; q < lanes<T>; q += vector_width<T>) {
            V value = factor * load(&scratch.line[f][j * lanes<T> + q]);
            if (remainder > 0) value += load(sum[f] + at + q);
            store<T>(last ? product[f] + q : sum[f] + at + q, value);
          }
        if (!last) return;
        const Complex* const pointers[3] = {product[0], product[1], product[2]};
        finish(ix, iy, first, pointers);
      };
      for (std::size_t j = 0; j < n; ++j) mode(j, j);
      for (std::size_t j = 1; j < n; ++j) mode(n + j, j);
    }
  }
}

template class CrossProduct<double>;
template class CrossProduct<float>;

}  // namespace spume
