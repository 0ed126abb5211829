// SPDX-License-Identifier: MIT
// What an opening is made of, for the sources of open_sides.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/open_sides.hpp"

namespace spume {

// An opening, cut into cells of about a spacing across: the cross-sections of its columns.
struct OpenSides::Gate {
  struct Column {
    Vec3 foot{};  // middle of the part of its cell that is outside bodies
    double area = 0;
    double layer = 0;                // distance of its points
    double travelled = 0, next = 0;  // since the last of its points passed the side, less half a layer
    bool wet = true;                 // below the level, where it is looked at
  };
  const Opening* opening = nullptr;
  double plane = 0, inwards = 1;
  std::array<int, 2> across{0, -1};  // axes on the side
  std::array<std::size_t, 2> cells{1, 1};
  std::array<double, 2> lower{}, size{1, 1};
  std::vector<std::int32_t> column_of;  // of a cell, -1: closed
  std::vector<Column> columns;
  double layer = 0;  // distance of the points of a column of a whole cell

  // Marks the columns below the level at time t, and adds up their areas.
  double find_wet(int up, double t) {
    const double level = opening->level ? (*opening->level)(0, 0, 0, t) : std::numeric_limits<double>::infinity();
    for (Column& column : columns) column.wet = column.foot[up] < level;
    return wet_area();
  }
  double wet_area() const {
    double area = 0;
    for (const Column& column : columns) area += column.wet ? column.area : 0;
    return area;
  }

  // -1: none.
  std::int32_t column_at(const Vec3& place) const {
    std::array<std::size_t, 2> at{};
    for (std::size_t k = 0; k < 2; ++k) {
      if (across[k] < 0) continue;
      const double cell = (place[across[k]] - lower[k]) / size[k];
      if (!(cell >= 0 && cell < static_cast<double>(cells[k]))) return -1;
      at[k] = static_cast<std::size_t>(cell);
    }
    return column_of[at[1] * cells[0] + at[0]];
  }
};

inline double value_at(const Expression& expression, const Vec3& r, double t) {
  return expression(r[0], r[1], r[2], t);
}

[[noreturn]] inline void refuse_value(const Opening& opening, const char* what, double value) {
  StepFailure::Details details;
  details.cause = std::string(what) + " is not a finite number";
  details.option = opening.name;
  details.value = value;
  throw StepFailure(details);
}

// What an inflow gives at a time.
struct Entering {
  Entering(const Opening& opening, double wet_area, double t) : opening_(opening), t_(t) {
    if (!opening.flow_rate) return;
    const double rate = value_at(*opening.flow_rate, {}, t);
    if (!std::isfinite(rate)) refuse_value(opening, "the flow rate of an inflow", rate);
    speed_ = wet_area > 0 ? rate / wet_area : 0;
  }
  Vec3 velocity(const Vec3& foot) const {
    Vec3 u{};
    if (opening_.velocity)
      u = (*opening_.velocity)(foot, t_);
    else
      u[opening_.axis] = opening_.side == 0 ? speed_ : -speed_;
    if (!std::isfinite(u[0] + u[1] + u[2])) refuse_value(opening_, "the velocity of an inflow", length(u));
    return u;
  }

 private:
  const Opening& opening_;
  double t_, speed_ = 0;
};

}  // namespace spume
