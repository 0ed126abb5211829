// SPDX-License-Identifier: MIT
// Cells of the domain with the moving bodies that may reach into them: a particle asks those that are near, in place of
// all of them. Of 40 bodies in a column a question to each took two thirds of a step.
#pragma once

#include <cstddef>
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
  void mark(const Bounds& box, std::size_t body);

  double margin() const { return margin_; }
  // Calls visit(body) for every body that may be within the margin, that which was marked last first. False outside the
  // domain, where the cells do not tell.
  template <class Visit>
  bool visit(const Vec3& point, Visit&& visit) const {
    std::size_t cell = 0;
    for (int axis = dimensions_ - 1; axis >= 0; --axis) {
      const double place = (point[axis] - lower_[axis]) * inverse_width_[axis];
      if (!(place >= 0 && place < static_cast<double>(count_[axis]))) return false;
      cell = cell * count_[axis] + static_cast<std::size_t>(place);
    }
    for (std::int32_t at = first_[cell]; at >= 0; at = marks_[static_cast<std::size_t>(at)].next)
      visit(static_cast<std::size_t>(marks_[static_cast<std::size_t>(at)].body));
    return true;
  }

 private:
  int dimensions_;
  double margin_;
  Vec3 lower_{}, inverse_width_{};
  std::array<std::size_t, 3> count_{1, 1, 1};
  std::array<bool, 3> periodic_{};
  struct Mark {
    std::int32_t body = 0, next = -1;  // of the same cell
  };
  std::vector<std::int32_t> first_;  // mark of each cell; -1: none
  std::vector<Mark> marks_;
};

}  // namespace spume
