// SPDX-License-Identifier: MIT
// Cells of the domain that a moving body may reach into: what tells most particles, of which no body is near, by one
// byte in place of a question to each body.
#pragma once

#include <cstdint>
#include <vector>

#include "spume/geometry/shape.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

class MovingBounds {
 public:
  // `margin`: distance from a body within which it counts as near.
  MovingBounds(const Domain& domain, double spacing, double margin);

  void clear();
  // A box that a body is in, anywhere: copies beyond periodic sides included.
  void mark(const Bounds& box);

  double margin() const { return margin_; }
  // False where no body is within the margin; true outside the domain.
  bool near(const Vec3& point) const {
    std::size_t cell = 0;
    for (int axis = dimensions_ - 1; axis >= 0; --axis) {
      const double place = (point[axis] - lower_[axis]) * inverse_width_[axis];
      if (!(place >= 0 && place < static_cast<double>(count_[axis]))) return true;
      cell = cell * count_[axis] + static_cast<std::size_t>(place);
    }
    return marked_[cell] != 0;
  }

 private:
  int dimensions_;
  double margin_;
  Vec3 lower_{}, inverse_width_{};
  std::array<std::size_t, 3> count_{1, 1, 1};
  std::array<bool, 3> periodic_{};
  std::vector<std::uint8_t> marked_;
};

}  // namespace spume
