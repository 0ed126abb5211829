// SPDX-License-Identifier: MIT
#include "places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "colouring.hpp"
#include "spume/core/parallel.hpp"

namespace spume {
namespace {

using Json = nlohmann::json;
constexpr double reach_in_spacings = 2;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

double squared_distance(const ParticleSnapshot& family, std::size_t i, const std::array<double, 3>& place) {
  double sum = 0;
  for (std::size_t axis = 0; axis < family.position.size(); ++axis) {
    const double d = family.position[axis][i] - place[axis];
    sum += d * d;
  }
  return sum;
}

struct Nearest {
  double square = std::numeric_limits<double>::infinity();
  std::size_t index = 0;
};

Nearest nearest(const ParticleSnapshot& family, const std::array<double, 3>& place) {
  return parallel_reduce(
      family.size, Nearest{},
      [&](std::size_t first, std::size_t last) {
        Nearest best;
        for (std::size_t i = first; i < last; ++i)
          if (const double square = squared_distance(family, i, place); square < best.square) best = {square, i};
        return best;
      },
      [](const Nearest& a, const Nearest& b) { return b.square < a.square ? b : a; });
}

double component(const ParticleField& field, int which, std::size_t i) {
  const auto one = [&](std::size_t k) {
    return field.f64.empty() ? static_cast<double>(field.i64[k][i]) : field.f64[k][i];
  };
  if (which >= 0) return one(static_cast<std::size_t>(which));
  double squares = 0;
  for (std::size_t k = 0; k < std::max(field.f64.size(), field.i64.size()); ++k) squares += one(k) * one(k);
  return std::sqrt(squares);
}

// Particles and their weights, which add up to 1; none without any near.
std::vector<std::pair<std::size_t, double>> around(const ParticleSnapshot& family, const std::array<double, 3>& place,
                                                   double spacing) {
  std::vector<std::pair<std::size_t, double>> list;
  if (family.size == 0) return list;
  if (!(spacing > 0)) return {{nearest(family, place).index, 1.0}};
  const double reach = reach_in_spacings * spacing, square = reach * reach;
  double sum = 0;
  for (std::size_t i = 0; i < family.size; ++i) {
    const double share = 1 - squared_distance(family, i, place) / square;
    if (!(share > 0)) continue;
    list.emplace_back(i, share * share);
    sum += share * share;
  }
  for (auto& [i, weight] : list) weight /= sum;
  return list;
}

double interpolated(const GridSnapshot& grid, const Colouring& colour, const std::array<double, 3>& place) {
  std::array<std::size_t, 3> low{}, high{};
  std::array<double, 3> share{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto count = static_cast<double>(grid.points[axis]);
    double at = grid.spacing[axis] > 0 ? (place[axis] - grid.origin[axis]) / grid.spacing[axis] : 0;
    if (grid.periodic) at -= count * std::floor(at / count);
    if (!(at >= 0 && at <= count - (grid.periodic ? 0 : 1))) return std::nan("");
    const auto whole = static_cast<std::size_t>(at);
    low[axis] = whole % grid.points[axis];
    high[axis] = grid.periodic ? (whole + 1) % grid.points[axis] : std::min(whole + 1, grid.points[axis] - 1);
    share[axis] = at - std::floor(at);
  }
  const auto& components = grid.fields[colour.field].components;
  double squares = 0, value = 0;
  for (std::size_t c = 0; c < components.size(); ++c) {
    double sum = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
      double weight = 1;
      std::array<std::size_t, 3> point{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool upper = (corner >> axis & 1U) != 0;
        point[axis] = upper ? high[axis] : low[axis];
        weight *= upper ? share[axis] : 1 - share[axis];
      }
      const std::size_t i = (point[0] * grid.points[1] + point[1]) * grid.points[2] + point[2];
      if (weight > 0) sum += weight * static_cast<double>(components[c][i]);
    }
    squares += sum * sum;
    if (static_cast<int>(c) == colour.component) value = sum;
  }
  return colour.component < 0 ? std::sqrt(squares) : value;
}

}  // namespace

const std::int64_t* identifiers(const ParticleSnapshot& family) {
  for (const ParticleField& field : family.fields)
    if (field.name == "id" && !field.i64.empty()) return field.i64[0];
  return nullptr;
}

Json picked_particle(const std::vector<ParticleSnapshot>& families, const PickWish& wish) {
  const auto family =
      std::find_if(families.begin(), families.end(), [&](const auto& one) { return one.name == wish.family; });
  if (family == families.end() || family->size == 0) return {};
  const std::int64_t* const id = identifiers(*family);
  std::size_t index = 0;
  if (wish.id && id != nullptr)
    index = static_cast<std::size_t>(std::find(id, id + family->size, *wish.id) - id);
  else
    index = nearest(*family, wish.place).index;
  if (index >= family->size) return {};  // it has left, dissolved or broken up
  Json told{{"family", family->name}, {"index", index}, {"place", Json::array()}, {"values", Json::array()}};
  for (const double* axis : family->position) told["place"].push_back(number(axis[index]));
  if (id != nullptr) told["id"] = id[index];
  for (const ParticleField& field : family->fields) {
    if (field.compute) field.compute();
    Json values = Json::array();
    for (const double* one : field.f64) values.push_back(number(one[index]));
    for (const std::int64_t* one : field.i64) values.push_back(one[index]);
    told["values"].push_back({{"name", field.name}, {"values", std::move(values)}});
  }
  return told;
}

Json values_at(const FrameSide& shown, const std::array<double, 3>& place) {
  Json told{{"place", place}, {"values", Json::array()}};
  const auto add = [&](const Colouring& colour, double value) {
    told["values"].push_back({{"name", colour.name}, {"unit", colour.unit}, {"value", number(value)}});
  };
  if (!shown.grids.empty()) {
    const GridSnapshot& grid = shown.grids.front();
    for (const Colouring& colour : all_colourings(grid)) add(colour, interpolated(grid, colour, place));
    return told;
  }
  if (shown.families.empty()) return told;
  const ParticleSnapshot& family = shown.families.front();
  const auto weights = around(family, place, shown.spacing);
  for (const Colouring& colour : all_colourings(family)) {
    const ParticleField& field = family.fields[colour.field];
    if (field.name == "id") continue;
    if (field.compute) field.compute();
    double value = weights.empty() ? std::nan("") : 0;
    for (const auto& [i, weight] : weights) {
      // The mean speed is that of the mean velocity only for one particle: sizes of vectors are averaged as such.
      value += weight * component(field, colour.component, i);
    }
    add(colour, value);
  }
  return told;
}

}  // namespace spume
