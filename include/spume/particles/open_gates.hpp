// SPDX-License-Identifier: MIT
// Openings of the sides, cut into cells of about a spacing across: where they are, and what inflows give.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "spume/core/vec3.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

// An opening and its cells, the cross-sections of columns of particles.
struct OpenGate {
  struct Column {
    Vec3 foot{};  // middle of the part of its cell that is outside bodies
    double area = 0;
    double layer = 0;                // distance of its particles
    double travelled = 0, next = 0;  // since the last of its points passed the side, less half a layer
    bool wet = true;                 // below the level, where it is looked at
  };
  const Opening* opening = nullptr;
  double plane = 0, inwards = 1;
  std::array<int, 2> across{0, -1};  // axes on the side
  std::array<std::size_t, 2> cells{1, 1};
  std::array<double, 2> lower{}, size{1, 1};
  std::array<double, 2> start{}, period{};  // of the domain along periodic axes; a period of 0: not periodic
  std::vector<std::int32_t> column_of;      // of a cell, -1: closed
  std::vector<Column> columns;
  double layer = 0;  // distance of the particles of a column of a whole cell

  // Marks the columns below the level at time t, and adds up their areas.
  double find_wet(int up, double t);
  double wet_area() const;
  // Back into the domain along periodic axes.
  Vec3 wrapped(Vec3 place) const;
  std::int32_t column_at(const Vec3& place) const;  // also of places that are to go round periodic sides; -1: none
  double depth_behind(const Vec3& place) const { return inwards * (plane - place[opening->axis]); }
  // Of as many layers as fill a depth, half a layer behind the side and farther: what takes the place of a particle
  // that comes back stands a layer behind the last.
  double whole_layers(double reach) const;
};

// A particle behind an inflow: where it will pass the side, how far it is from there, and how fast it goes.
struct Coming {
  std::size_t particle = 0;
  Vec3 foot{};
  double depth = 0, speed = 0;
};

class OpenGates {
 public:
  // `scene` outlives them.
  OpenGates(const Scene& scene, double particle_volume);

  std::vector<OpenGate> list;  // in the order of scene.openings

  // Whether a place on a side of the domain is open, and to what.
  bool open_at(int axis, int side, const Vec3& place) const { return opening_at(axis, side, place) >= 0; }
  bool outflow_at(int axis, int side, const Vec3& place) const;
  int outflow_behind(const Vec3& place) const;  // the gate of the outflow that the place lies behind, or -1

 private:
  int opening_at(int axis, int side, const Vec3& place) const;
};

// What an inflow gives at a time. Throws StepFailure for what is not finite.
class Entering {
 public:
  Entering(const Opening& opening, double wet_area, double t);
  Vec3 velocity(const Vec3& foot) const;

 private:
  const Opening& opening_;
  double t_, speed_ = 0;
};

double value_at(const Expression& expression, const Vec3& r, double t);

// What stands outside below and above the level of an outflow.
struct OutsideDensity {
  double below = 0, above = 0;
};

// The pressure that an outflow gives at a place of its side, hydrostatic from its level on. Throws StepFailure for one
// that is not finite.
double pressure_outside(const Scene& scene, const Opening& opening, const Vec3& foot, const OutsideDensity& density,
                        double t);

}  // namespace spume
