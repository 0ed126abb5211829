// SPDX-License-Identifier: MIT
#pragma once

namespace spume {

// Inner products that a sweep can accumulate while y = A x is still in registers.
struct Dots {
  double wy = 0;  // sum of w_i y_i
  double yy = 0;  // sum of y_i^2
  Dots& operator+=(const Dots& other) {
    wy += other.wy;
    yy += other.yy;
    return *this;
  }
};

}  // namespace spume
