// SPDX-License-Identifier: MIT
// The nonlinear term of a periodic flow, F[u x omega], from its vector potential, without a padded field in memory.
//
// The product is formed on a grid of M = P n points per axis with n = N/2: P = 3 is zero padding to 3N/2, which holds
// all products of modes below N/2 free of aliasing in the modes kept (de Wit et al. 2024, figure 3b); P = 2 is the
// unpadded grid. The points P j + r of one remainder r are a transform of length n of the N modes, twisted by
// exp(2 pi i k r / M) and folded modulo n, so that no zero is ever transformed. For each remainder along x:
//   1. inverse_x: blocks of lines gathered into a small buffer; five fields u, v, w, dv/dx, dw/dx on n planes of x;
//   2. form_planes, one plane of x at a time, in cache: curl, and for each remainder along y the inverse transforms
//      along y and z of six fields, the cross product, and the forward transforms along z and y of three;
//   3. forward_x, summed over the remainders.
// The largest array is 5 fields of n planes: 2.5 real fields of N^3 numbers.
//
// The result does not depend on the number of threads, bit for bit.
#pragma once

#include <array>
#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/fourier/line_transform.hpp"
#include "spume/fourier/mode_layout.hpp"

namespace spume {

// Largest values over the points of the product's grid.
struct VelocityPeak {
  double speed = 0;
  double rate = 0;  // of |u|/dx + |v|/dy + |w|/dz with the spacings of the N points
};

template <class T>
class CrossProduct {
 public:
  using Complex = std::complex<T>;
  // Told of every block of the result once: modes (ix, iy, first .. first + lanes<T>), product[c][lane], scaled. Called
  // from several threads, for one iy always from one thread and in the same order.
  using Finish =
      std::function<void(std::size_t ix, std::size_t iy, std::size_t first, const Complex* const product[3])>;

  // layout: with rows for T. padded: P = 3, otherwise 2.
  CrossProduct(const ModeLayout& layout, bool padded, Planning planning = Planning::estimate);

  // potential: three fields b of layout.size() modes with div b = 0; u = curl b, and the mode k = 0 of b holds the mean
  // of u itself. sum: three fields of the same size that hold partial sums on the way and are left undefined; `finish`
  // may write into them at its own block. Not called for the modes that a layout holds at zero along x and y.
  VelocityPeak evaluate(const std::array<const Complex*, 3>& potential, const std::array<Complex*, 3>& sum,
                        const Finish& finish);

  // The parts of evaluate(), for a caller that times them: for each remainder from 0 to remainders() - 1 all three, in
  // this order, with the same arrays. `peak` collects the largest values; `finish` is called with the last remainder.
  std::size_t remainders() const { return phases_; }
  void inverse_x(std::size_t remainder, const std::array<const Complex*, 3>& potential);
  void form_planes(VelocityPeak& peak);
  void forward_x(std::size_t remainder, const std::array<Complex*, 3>& sum, const Finish& finish);
  // The fields on the planes of a remainder: five after inverse_x, the product in the first three after form_planes.
  const std::array<Array<Complex>, 5>& planes() const { return work_; }

  ~CrossProduct();

  // Its memory, free between evaluations: two pieces of half the planes each.
  std::array<Complex*, 2> spare() { return {work_[0].data(), work_[1].data()}; }

  double bytes() const;

 private:
  struct Scratch;  // of a thread
  struct PeakLanes;
  // Twists of one axis by remainder: at[r][j] for wavenumber j, at[r][n + j] for wavenumber j - n.
  using Twists = std::vector<std::vector<Complex>>;

  void plane(std::size_t j, Scratch& scratch, VelocityPeak& peak);
  void inverse_y(std::size_t remainder, std::size_t j, Scratch& scratch) const;
  void rows(Scratch& scratch, VelocityPeak& peak) const;
  void rows_to_lanes(std::size_t top, Scratch& scratch) const;
  void inverse_z(std::size_t remainder, Scratch& scratch) const;
  void forward_z(std::size_t remainder, Scratch& scratch, PeakLanes& peak) const;
  void lanes_to_rows(std::size_t top, Scratch& scratch) const;
  void forward_y(std::size_t remainder, std::size_t j, Scratch& scratch);

  ModeLayout layout_;
  std::size_t phases_;
  std::array<std::size_t, 3> half_;  // n per axis
  std::array<Twists, 3> twists_;
  std::array<std::vector<T>, 3> wavenumber_;
  Array<Complex> lane_wavenumber_;  // k_z per stored mode in both parts, as registers take it
  std::vector<LaneTransform<T>> transform_;
  // A block longer than the rows of the layout: columns of a plane would meet in a few sets of the cache otherwise.
  std::size_t work_row_, work_plane_;
  std::array<Array<Complex>, 5> work_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
  std::vector<VelocityPeak> peaks_;
};

}  // namespace spume
