// SPDX-License-Identifier: MIT
#include "spume/fourier/cross_product.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lane_vector.hpp"
#include "spume/core/parallel.hpp"

namespace spume {

using fourier::Block;
using fourier::Factor;

// Rows of the plane that go through the z stage together: two groups of one row per lane.
template <class T>
constexpr std::size_t group_rows = 2 * lanes<T>;

template <class T>
struct CrossProduct<T>::Scratch {
  std::array<Array<Complex>, 5> line;        // lines of the x stage
  std::array<Array<Complex>, 6> rows;        // of one remainder along y: half_[1] rows (rounded up) of modes along z
  std::array<Array<Complex>, 3> sum;         // of the remainders along y: ny rows
  std::array<Array<Complex>, 6> column;      // lines of the y stage
  std::array<Array<Complex>, 12> turned;     // modes of a group of rows, by mode, one row per lane
  std::array<Array<Complex>, 6> pair;        // two real fields as one complex: values along z of a group
  std::array<Array<Complex>, 3> pair_modes;  // their transforms, summed over the remainders along z
};

template <class T>
CrossProduct<T>::CrossProduct(const ModeLayout& layout, bool padded, Planning planning)
    : layout_(layout), phases_(padded ? 3 : 2) {
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
  lane_wavenumber_.resize(2 * layout.row);
  for (std::size_t iz = 0; iz < layout.row; ++iz)
    lane_wavenumber_[2 * iz] = lane_wavenumber_[2 * iz + 1] = wavenumber_[2][iz];
  for (auto& field : work_) field.resize(half_[0] * layout.plane);
  const std::size_t padded_rows = (half_[1] + group_rows<T> - 1) / group_rows<T> * group_rows<T>;
  for (int thread = 0; thread < thread_count(); ++thread) {
    auto scratch = std::make_unique<Scratch>();
    const auto size = [](auto& arrays, std::size_t values) {
      for (auto& array : arrays) array.resize(values);
    };
    size(scratch->line, half_[0] * lanes<T>);
    size(scratch->rows, padded_rows * layout.row);
    size(scratch->sum, layout.points[1] * layout.row);
    size(scratch->column, half_[1] * lanes<T>);
    size(scratch->turned, half_[2] * lanes<T>);
    size(scratch->pair, half_[2] * lanes<T>);
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
  }
  return values * sizeof(Complex);
}

template <class T>
VelocityPeak CrossProduct<T>::evaluate(const std::array<const Complex*, 3>& potential,
                                       const std::array<Complex*, 3>& sum, const Finish& finish) {
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
  VelocityPeak peak;
  for (std::size_t remainder = 0; remainder < phases_; ++remainder) {
    inverse_x(remainder, potential);
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
    forward_x(remainder, sum, finish);
  }
  return peak;
}

template <class T>
void CrossProduct<T>::inverse_x(std::size_t remainder, const std::array<const Complex*, 3>& potential) {
  const int threads = std::min(static_cast<int>(scratch_.size()), thread_count());
  const std::size_t n = half_[0], ny = layout_.points[1];
  const std::vector<Complex>& twist = twists_[0][remainder];
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t iy = 0; iy < ny; ++iy) {
    Scratch& scratch = *scratch_[static_cast<std::size_t>(omp_get_thread_num())];
    const T ky = wavenumber_[1][iy];
    for (std::size_t first = 0; first < layout_.row; first += lanes<T>) {
      const auto kz = Block<T>::load(reinterpret_cast<const Complex*>(&lane_wavenumber_[2 * first]));
      // Velocity of the modes at ix, twisted: u = i k x b.
      const auto velocity = [&](std::size_t ix, Block<T> out[3]) {
        const std::size_t at = ix * layout_.plane + iy * layout_.row + first;
        const T kx = wavenumber_[0][ix];
        const Factor<T> factor(Complex(-twist[ix].imag(), twist[ix].real()));  // i times the twist
        const auto bx = Block<T>::load(potential[0] + at), by = Block<T>::load(potential[1] + at),
                   bz = Block<T>::load(potential[2] + at);
        out[0] = times(factor, ky * bz - kz * by);
        out[1] = times(factor, kz * bx - kx * bz);
        out[2] = times(factor, kx * by - ky * bx);
      };
      for (std::size_t j = 0; j < n; ++j) {
        Block<T> low[3], high[3];
        velocity(j, low);
        const T k = wavenumber_[0][j];
        if (j == 0) {
          for (auto& h : high) h = Block<T>::zero();
          if (iy == 0 && first == 0)  // the mean velocity
            for (int c = 0; c < 3; ++c) low[c].v[0][0] = potential[c][0].real();
        } else {
          velocity(n + j, high);
        }
        const T l = wavenumber_[0][n + j];
        for (int c = 0; c < 3; ++c) (low[c] + high[c]).store(&scratch.line[c][j * lanes<T>]);
        times_i(k * low[1] + l * high[1]).store(&scratch.line[3][j * lanes<T>]);
        times_i(k * low[2] + l * high[2]).store(&scratch.line[4][j * lanes<T>]);
      }
      for (std::size_t f = 0; f < 5; ++f) {
        transform_[0].inverse(scratch.line[f].data());
        Complex* const out = work_[f].data() + iy * layout_.row + first;
        for (std::size_t j = 0; j < n; ++j)
          Block<T>::load(&scratch.line[f][j * lanes<T>]).store(out + j * layout_.plane);
      }
    }
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
  const std::size_t n = half_[1];
  const std::vector<Complex>& twist = twists_[1][remainder];
  for (std::size_t first = 0; first < layout_.row; first += lanes<T>) {
    const auto kz = Block<T>::load(reinterpret_cast<const Complex*>(&lane_wavenumber_[2 * first]));
    // Velocity and vorticity of the modes at iy, twisted, added to `out`.
    const auto add = [&](std::size_t iy, Block<T> out[6]) {
      const std::size_t at = j * layout_.plane + iy * layout_.row + first;
      const T ky = wavenumber_[1][iy];
      const Factor<T> factor(twist[iy]);
      const auto u = times(factor, Block<T>::load(work_[0].data() + at));
      const auto v = times(factor, Block<T>::load(work_[1].data() + at));
      const auto w = times(factor, Block<T>::load(work_[2].data() + at));
      out[0] = out[0] + u;
      out[1] = out[1] + v;
      out[2] = out[2] + w;
      out[3] = out[3] + times_i(ky * w - kz * v);
      out[4] = out[4] + (times_i(kz * u) - times(factor, Block<T>::load(work_[4].data() + at)));
      out[5] = out[5] + (times(factor, Block<T>::load(work_[3].data() + at)) - times_i(ky * u));
    };
    for (std::size_t jy = 0; jy < n; ++jy) {
      Block<T> out[6];
      for (auto& o : out) o = Block<T>::zero();
      add(jy, out);
      if (jy > 0) add(n + jy, out);
      for (std::size_t f = 0; f < 6; ++f) out[f].store(&scratch.column[f][jy * lanes<T>]);
    }
    for (std::size_t f = 0; f < 6; ++f) {
      transform_[1].inverse(scratch.column[f].data());
      for (std::size_t jy = 0; jy < n; ++jy)
        Block<T>::load(&scratch.column[f][jy * lanes<T>]).store(&scratch.rows[f][jy * layout_.row + first]);
    }
  }
}

// The z stage: groups of rows, one row per lane. Fields of a group travel in pairs (velocity component, vorticity
// component) as the real and imaginary part of one complex field: half the transforms, all of the same kind.
template <class T>
void CrossProduct<T>::rows(Scratch& scratch, VelocityPeak& peak) const {
  using V = typename fourier::VectorOf<T>::Type;
  constexpr std::size_t width = lanes<T>;
  const std::size_t n = half_[2], row = layout_.row;
  std::array<T, 3> per_spacing{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    per_spacing[axis] = static_cast<T>(static_cast<double>(layout_.points[axis]) / layout_.lengths[axis]);
  V fastest{}, largest{};
  T largest_rate = 0, largest_square = 0;
  for (std::size_t top = 0; top < half_[1]; top += group_rows<T>) {
    // Modes by rows to modes by lanes.
    for (std::size_t g = 0; g < 2; ++g)
      for (std::size_t f = 0; f < 6; ++f) {
        const Complex* const from = scratch.rows[f].data() + (top + g * width) * row;
        Complex* const to = scratch.turned[6 * g + f].data();
        for (std::size_t iz = 0; iz < n; ++iz)
          for (std::size_t l = 0; l < width; ++l) to[iz * width + l] = from[l * row + iz];
      }
    for (auto& sum : scratch.pair_modes) std::fill(sum.begin(), sum.end(), Complex{});
    for (std::size_t remainder = 0; remainder < phases_; ++remainder) {
      const std::vector<Complex>& twist = twists_[2][remainder];
      for (std::size_t g = 0; g < 2; ++g)
        for (std::size_t c = 0; c < 3; ++c) {
          const Complex* const a = scratch.turned[6 * g + c].data();
          const Complex* const b = scratch.turned[6 * g + 3 + c].data();
          Complex* const out = scratch.pair[3 * g + c].data();
          // k_z = 0: real parts alone, so that no rounding leaks from one field into the other.
          for (std::size_t l = 0; l < width; ++l) out[l] = {a[l].real(), b[l].real()};
          for (std::size_t j = 1; j < n; ++j) {
            const Factor<T> low(twist[j]), high(twist[n + j]);
            const auto positive = Block<T>::load(a + j * width) + times_i(Block<T>::load(b + j * width));
            const auto negative = conjugate(Block<T>::load(a + (n - j) * width)) +
                                  times_i(conjugate(Block<T>::load(b + (n - j) * width)));
            (times(low, positive) + times(high, negative)).store(out + j * width);
          }
          transform_[2].inverse(out);
        }
      // In place of X, Y, Z = (u, omega_x), (v, omega_y), (w, omega_z): the product's components of both groups, as
      // (x, y) of group 0, (x, y) of group 1, and (z of group 0, z of group 1). Im(conj(Y) Z) = v omega_z - w omega_y.
      for (std::size_t i = 0; i < n * width; i += width) {
        Block<T> xy[2], z[2];
        for (std::size_t g = 0; g < 2; ++g) {
          const auto x = Block<T>::load(&scratch.pair[3 * g][i]), y = Block<T>::load(&scratch.pair[3 * g + 1][i]),
                     w = Block<T>::load(&scratch.pair[3 * g + 2][i]);
          for (int q = 0; q < fourier::vectors_per_block; ++q) {
            const V xs = __builtin_shuffle(x.v[q], fourier::VectorOf<T>::swap);
            const V ys = __builtin_shuffle(y.v[q], fourier::VectorOf<T>::swap);
            const V ws = __builtin_shuffle(w.v[q], fourier::VectorOf<T>::swap);
            // Real entries of these hold the component: v omega_z - omega_y w and so on.
            const V px = y.v[q] * ws - ys * w.v[q];
            const V py = w.v[q] * xs - ws * x.v[q];
            const V pz = x.v[q] * ys - xs * y.v[q];
            // Imaginary entries hold its negative.
            const V choose = fourier::VectorOf<T>::conjugate;
            const V sign = (V{} + T(1) + choose) * T(0.5);   // 1 0 1 0
            const V other = (V{} + T(1) - choose) * T(0.5);  // 0 1 0 1
            xy[g].v[q] = sign * px - other * py;
            z[g].v[q] = pz;
            const V ax = x.v[q] < 0 ? -x.v[q] : x.v[q], ay = y.v[q] < 0 ? -y.v[q] : y.v[q],
                    aw = w.v[q] < 0 ? -w.v[q] : w.v[q];
            const V rate = (ax * per_spacing[0] + ay * per_spacing[1] + aw * per_spacing[2]) * sign;
            const V square = (x.v[q] * x.v[q] + y.v[q] * y.v[q] + w.v[q] * w.v[q]) * sign;
            largest = largest > rate ? largest : rate;
            fastest = fastest > square ? fastest : square;
          }
        }
        Block<T> zz;
        for (int q = 0; q < fourier::vectors_per_block; ++q) {
          const V choose = fourier::VectorOf<T>::conjugate;
          const V sign = (V{} + T(1) + choose) * T(0.5), other = (V{} + T(1) - choose) * T(0.5);
          zz.v[q] = sign * z[0].v[q] - other * z[1].v[q];
        }
        xy[0].store(&scratch.pair[0][i]);
        xy[1].store(&scratch.pair[1][i]);
        zz.store(&scratch.pair[2][i]);
      }
      for (std::size_t p = 0; p < 3; ++p) {
        Complex* const values = scratch.pair[p].data();
        transform_[2].forward(values);
        Complex* const sum = scratch.pair_modes[p].data();
        for (std::size_t j = 0; j < n; ++j) {
          const auto modes = Block<T>::load(values + j * width);
          (Block<T>::load(sum + j * width) + times(Factor<T>(std::conj(twist[j])), modes)).store(sum + j * width);
          if (j == 0) continue;
          Complex* const upper = sum + (n + j) * width;
          (Block<T>::load(upper) + times(Factor<T>(std::conj(twist[n + j])), modes)).store(upper);
        }
      }
    }
    // Two real fields from one complex: A_k = (P_k + conj P_-k) / 2, B_k = (P_k - conj P_-k) / 2i; back to rows.
    for (std::size_t p = 0; p < 3; ++p) {
      const Complex* const sum = scratch.pair_modes[p].data();
      Complex* const first =
          p < 2 ? scratch.rows[0].data() + (top + p * width) * row : scratch.rows[2].data() + top * row;
      Complex* const second =
          p < 2 ? scratch.rows[1].data() + (top + p * width) * row : scratch.rows[2].data() + (top + width) * row;
      for (std::size_t iz = 0; iz < n; ++iz) {
        Complex a[width], b[width];
        const std::size_t partner = iz == 0 ? 0 : 2 * n - iz;
        const auto plus = Block<T>::load(sum + iz * width), minus = conjugate(Block<T>::load(sum + partner * width));
        (T(0.5) * (plus + minus)).store(a);
        (T(-0.5) * times_i(plus - minus)).store(b);
        for (std::size_t l = 0; l < width; ++l) {
          first[l * row + iz] = a[l];
          second[l * row + iz] = b[l];
        }
      }
    }
  }
  for (std::size_t l = 0; l < sizeof(V) / sizeof(T); ++l) {
    largest_rate = largest[l] > largest_rate || largest[l] != largest[l] ? largest[l] : largest_rate;
    largest_square = fastest[l] > largest_square || fastest[l] != fastest[l] ? fastest[l] : largest_square;
  }
  peak.rate = std::max(peak.rate, static_cast<double>(largest_rate));
  peak.speed = std::max(peak.speed, std::sqrt(static_cast<double>(largest_square)));
}

template <class T>
void CrossProduct<T>::forward_y(std::size_t remainder, std::size_t j, Scratch& scratch) {
  const std::size_t n = half_[1], row = layout_.row;
  const std::vector<Complex>& twist = twists_[1][remainder];
  const bool last = remainder + 1 == phases_;
  for (std::size_t first = 0; first < row; first += lanes<T>)
    for (std::size_t f = 0; f < 3; ++f) {
      Complex* const column = scratch.column[f].data();
      for (std::size_t jy = 0; jy < n; ++jy)
        Block<T>::load(&scratch.rows[f][jy * row + first]).store(column + jy * lanes<T>);
      transform_[1].forward(column);
      // The last remainder goes straight to the plane: its modes are no longer needed.
      Complex* const sum = scratch.sum[f].data() + first;
      Complex* const out = last ? work_[f].data() + j * layout_.plane + first : sum;
      const auto add = [&](std::size_t iy, const Block<T>& modes) {
        auto value = times(Factor<T>(std::conj(twist[iy])), modes);
        if (remainder > 0) value = value + Block<T>::load(sum + iy * row);
        value.store(out + iy * row);
      };
      for (std::size_t jy = 0; jy < n; ++jy) {
        const auto modes = Block<T>::load(column + jy * lanes<T>);
        add(jy, modes);
        if (jy > 0) add(n + jy, modes);
      }
    }
}

template <class T>
void CrossProduct<T>::forward_x(std::size_t remainder, const std::array<Complex*, 3>& sum, const Finish& finish) {
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
        const Complex* const from = work_[f].data() + iy * layout_.row + first;
        for (std::size_t j = 0; j < n; ++j) Block<T>::load(from + j * layout_.plane).store(line + j * lanes<T>);
        transform_[0].forward(line);
      }
      const auto mode = [&](std::size_t ix, std::size_t j) {
        const std::size_t at = ix * layout_.plane + iy * layout_.row + first;
        const Factor<T> factor(scale * std::conj(twist[ix]));
        Block<T> value[3];
        for (std::size_t f = 0; f < 3; ++f) {
          value[f] = times(factor, Block<T>::load(&scratch.line[f][j * lanes<T>]));
          if (remainder > 0) value[f] = value[f] + Block<T>::load(sum[f] + at);
          if (!last) value[f].store(sum[f] + at);
        }
        if (!last) return;
        alignas(64) Complex product[3][lanes<T>];
        const Complex* const pointers[3] = {product[0], product[1], product[2]};
        for (std::size_t f = 0; f < 3; ++f) value[f].store(product[f]);
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
