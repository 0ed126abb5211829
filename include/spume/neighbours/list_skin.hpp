// SPDX-License-Identifier: MIT
// How near those may have come to each other who are in no list of neighbours, since lists were made with a skin.
//
// A list holds the pairs that were nearer than s, the support radius and the skin. Two points approach each other by no
// more than both have gone; but points that go together stay apart. In blocks of cells, none narrower than s, the way d
// of the points is d = m + G x + e with |e| <= r. A pair that was farther apart than s is then no nearer than
//
//   s sigma(I + G) - 2 r,   sigma the least singular value,
//
// whatever the translation m; a rotation has sigma = 1. Bounds of r come from fits in each block and from how far these
// differ from those of the blocks around. Pairs of blocks that do not touch and have none between them are judged by
// the two alone; those three blocks apart or more, at a distance of 2 s at least, by the longest way. That last part
// also bounds who may have gone how far at all, (2 s - R) / 2 for a support R: nobody who was too far from a mirror for
// an image, s, has come within R / 2 of it unseen.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/core/simd.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/images.hpp"

namespace spume {

class ListSkin {
 public:
  // Where the lists were made, in the order of the cells, and how far everybody has gone since. Images go as their
  // sources by the rules. No wall points, no solid boxes, no sides that have moved.
  struct Points {
    const CellGrid& grid;
    const CellOrder& particles;
    const Images& images;
    const ImageRules rules;
    std::array<double, 3> origin{};       // of `place`
    std::array<const float*, 3> place{};  // null beyond the dimensions
    std::array<const float*, 3> way{};    // the same
  };

  // Lists have been made anew.
  void renew() { indexed_ = false; }

  // The least distance that two may have who were farther apart than s: a bound from below. `longest`: of the ways. The
  // same for any number of threads.
  double nearest(const Points& points, double longest);

  double bytes() const;

 private:
  // Of the points in a block: their mean place and way, the gradient of the way by columns, and how far they are from
  // the mean place along each axis at most; in the fourth lanes their number and the longest remainder.
  struct Fit {
    simd::f32x4 place{}, way{};
    std::array<simd::f32x4, 3> gradient{};
    simd::f32x4 extent{};
    float count() const { return place[3]; }
    float remainder() const { return extent[3]; }
  };
  class Gathered;
  // Of images, from the origin: x -> sign x + shift.
  struct Path {
    std::array<float, 3> sign{1, 1, 1}, shift{};
  };

  void find_blocks(const Points& points);
  std::array<int, 3> place_of(std::size_t block) const;
  std::array<std::int64_t, 2> cells_of(const Points& points, std::size_t block) const;
  // Of the block so many steps from the one at `place`; null without points.
  const Fit* fit_at(std::array<int, 3> place, const std::array<int, 3>& step) const;
  template <int dimensions>
  void fit_block(const Points& points, std::size_t slot, Gathered& gathered);
  float nearest_around(std::size_t slot, float reach) const;
  static float nearest_of(const Fit* const* fits, std::size_t count, float reach);

  bool indexed_ = false;               // the blocks are those of the lists
  std::array<int, 3> count_{1, 1, 1};  // of blocks
  int columns_ = 1;                    // cells along x of a block
  Array<std::int32_t> slot_;           // of each block among those with points, -1 of others
  std::vector<std::int32_t> block_;
  std::vector<Fit> fit_;
  std::vector<Path> path_;
};

}  // namespace spume
