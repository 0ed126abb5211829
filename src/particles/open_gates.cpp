// SPDX-License-Identifier: MIT
#include "spume/particles/open_gates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/boundary.hpp"

namespace spume {
namespace {

// Of a cell: through less nothing enters, as its particles would be farther apart than kernels reach.
constexpr double least_share = 0.25;

// Moves the middle of a cell of an opening to that of its part outside bodies and boxes, and returns the share of it.
double keep_outside_bodies(const Scene& scene, const OpenGate& gate, Vec3& middle) {
  constexpr int places = 8;  // along each side of the cell
  const bool flat = gate.across[1] < 0;
  Vec3 sum{};
  int outside = 0;
  for (int i = 0; i < places; ++i)
    for (int j = 0; j < (flat ? 1 : places); ++j) {
      Vec3 place = middle;
      place[gate.across[0]] += ((i + 0.5) / places - 0.5) * gate.size[0];
      if (!flat) place[gate.across[1]] += ((j + 0.5) / places - 0.5) * gate.size[1];
      if (inside_solid(scene.domain, place)) continue;
      if (!scene.walls.empty() && !(scene.walls.distance(place) > 0)) continue;
      sum = add(sum, place);
      ++outside;
    }
  const int all = flat ? places : places * places;
  if (outside > 0 && outside < all) middle = multiply(1.0 / outside, sum);
  return static_cast<double>(outside) / all;
}

[[noreturn]] void refuse_value(const Opening& opening, const char* what, double value) {
  StepFailure::Details details;
  details.cause = std::string(what) + " is not a finite number";
  details.option = opening.name;
  details.value = value;
  throw StepFailure(details);
}

}  // namespace

double value_at(const Expression& expression, const Vec3& r, double t) {
  return expression(r[0], r[1], r[2], t);
}

double OpenGate::find_wet(int up, double t) {
  const double level = opening->level ? (*opening->level)(0, 0, 0, t) : std::numeric_limits<double>::infinity();
  for (Column& column : columns) column.wet = column.foot[up] < level;
  return wet_area();
}

double OpenGate::wet_area() const {
  double area = 0;
  for (const Column& column : columns) area += column.wet ? column.area : 0;
  return area;
}

Vec3 OpenGate::wrapped(Vec3 place) const {
  for (std::size_t k = 0; k < 2; ++k)
    if (period[k] > 0) place[across[k]] = wrap_periodic(place[across[k]], start[k], period[k]);
  return place;
}

double OpenGate::whole_layers(double reach) const {
  constexpr double rounding = 1e-9;  // a whole number of layers is not one more
  return std::ceil(reach / layer - rounding) * layer;
}

std::int32_t OpenGate::column_at(const Vec3& place) const {
  const Vec3 inside = wrapped(place);
  std::array<std::size_t, 2> at{};
  for (std::size_t k = 0; k < 2; ++k) {
    if (across[k] < 0) continue;
    const double cell = (inside[across[k]] - lower[k]) / size[k];
    if (!(cell >= 0 && cell < static_cast<double>(cells[k]))) return -1;
    at[k] = static_cast<std::size_t>(cell);
  }
  return column_of[at[1] * cells[0] + at[0]];
}

OpenGates::OpenGates(const Scene& scene, double particle_volume) {
  const Domain& domain = scene.domain;
  const int d = domain.dimensions;
  for (const Opening& opening : scene.openings) {
    OpenGate gate;
    gate.opening = &opening;
    gate.plane = opening.side == 0 ? domain.lower[opening.axis] : domain.upper[opening.axis];
    gate.inwards = opening.side == 0 ? 1 : -1;
    double area = 1;
    std::size_t k = 0;
    for (int axis = 0; axis < d; ++axis) {
      if (axis == opening.axis) continue;
      const double length = opening.upper[axis] - opening.lower[axis];
      gate.across[k] = axis;
      gate.lower[k] = opening.lower[axis];
      gate.start[k] = domain.lower[axis];
      gate.period[k] = domain.periodic(axis) ? domain.upper[axis] - domain.lower[axis] : 0;
      gate.cells[k] = static_cast<std::size_t>(std::max(1.0, std::round(length / scene.spacing)));
      gate.size[k] = length / static_cast<double>(gate.cells[k]);
      area *= gate.size[k++];
    }
    gate.layer = particle_volume / area;
    gate.column_of.assign(gate.cells[0] * gate.cells[1], -1);
    for (std::size_t cell = 0; cell < gate.column_of.size(); ++cell) {
      OpenGate::Column column;
      column.foot[opening.axis] = gate.plane;
      const std::array<std::size_t, 2> at{cell % gate.cells[0], cell / gate.cells[0]};
      for (std::size_t a = 0; a < 2; ++a)
        if (gate.across[a] >= 0)
          column.foot[gate.across[a]] = gate.lower[a] + (static_cast<double>(at[a]) + 0.5) * gate.size[a];
      if (opening.where && !((*opening.where)(column.foot[0], column.foot[1], column.foot[2], 0) > 0)) continue;
      column.area = area * keep_outside_bodies(scene, gate, column.foot);
      if (opening.inflow && column.area < least_share * area) continue;
      column.layer = particle_volume / column.area;
      gate.column_of[cell] = static_cast<std::int32_t>(gate.columns.size());
      gate.columns.push_back(column);
    }
    list.push_back(std::move(gate));
  }
}

int OpenGates::opening_at(int axis, int side, const Vec3& place) const {
  for (std::size_t g = 0; g < list.size(); ++g) {
    const Opening& opening = *list[g].opening;
    if (opening.axis == axis && opening.side == side && list[g].column_at(place) >= 0) return static_cast<int>(g);
  }
  return -1;
}

bool OpenGates::outflow_at(int axis, int side, const Vec3& place) const {
  const int g = opening_at(axis, side, place);
  return g >= 0 && !list[static_cast<std::size_t>(g)].opening->inflow;
}

int OpenGates::outflow_behind(const Vec3& place) const {
  for (std::size_t g = 0; g < list.size(); ++g)
    if (!list[g].opening->inflow && list[g].depth_behind(place) > 0 && list[g].column_at(place) >= 0)
      return static_cast<int>(g);
  return -1;
}

Entering::Entering(const Opening& opening, double wet_area, double t) : opening_(opening), t_(t) {
  if (!opening.flow_rate) return;
  const double rate = value_at(*opening.flow_rate, {}, t);
  if (!std::isfinite(rate)) refuse_value(opening, "the flow rate of an inflow", rate);
  speed_ = wet_area > 0 ? rate / wet_area : 0;
}

Vec3 Entering::velocity(const Vec3& foot) const {
  Vec3 u{};
  if (opening_.velocity)
    u = (*opening_.velocity)(foot, t_);
  else
    u[opening_.axis] = opening_.side == 0 ? speed_ : -speed_;
  if (!std::isfinite(u[0] + u[1] + u[2])) refuse_value(opening_, "the velocity of an inflow", length(u));
  return u;
}

double pressure_outside(const Scene& scene, const Opening& opening, const Vec3& foot, const OutsideDensity& density,
                        double t) {
  const int up = scene.domain.dimensions - 1;
  double pressure = 0;
  if (opening.pressure) pressure = value_at(*opening.pressure, foot, t);
  if (opening.level && !opening.inflow) {
    const double depth = value_at(*opening.level, {}, t) - foot[up];
    pressure += (depth > 0 ? density.below : density.above) * -scene.fluid.gravity[up] * depth;
  }
  if (!std::isfinite(pressure)) refuse_value(opening, "the pressure of an outflow", pressure);
  return pressure;
}

}  // namespace spume
