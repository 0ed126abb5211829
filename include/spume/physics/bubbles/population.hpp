// SPDX-License-Identifier: MIT
// The bubbles that are alive: one array per quantity, no holes. An identifier is given at birth and never again.
//
// Births and deaths of a step are gathered by blocks in parallel and take effect in the order of the blocks, so that
// identifiers and order depend on neither the thread count nor on who came first.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "spume/core/field_set.hpp"
#include "spume/core/parallel.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/scene/scene.hpp"

namespace spume::bubbles {

inline double volume_of(double radius) {
  return 4 * std::numbers::pi / 3 * radius * radius * radius;
}
inline double radius_of(double volume) {
  return std::cbrt(volume * (3 / (4 * std::numbers::pi)));
}

// Of the oxygen of a bubble: its contents follow from its volume and its place.
inline constexpr double no_gas_yet = -1;

struct NewBubble {
  Vec3 position{}, velocity{}, fluctuation{};
  double volume = 0;
  double oxygen = no_gas_yet, inert = 0;  // mol
  bool at_rest_in_liquid = false;         // takes the velocity of the liquid at its first step
};

inline constexpr double not_merging = std::numeric_limits<double>::infinity();

class Population {
 public:
  // Arrays of a model exist only when it is on.
  struct Models {
    bool fluctuations = false, breakup = false, surface = false, gas = false;
  };
  explicit Population(const Models& models);

  std::size_t size() const { return fields.size(); }
  bool empty() const { return fields.size() == 0; }
  double radius(std::size_t b) const { return radius_of((*volume)[b]); }
  double total_volume() const;
  double traffic() const;  // compulsory (core/ledger.hpp), of everything that bubbles carry

  // Adds what make(item, list) appends to its list for each item of [0, items), in the order of the items, born at
  // time t. Returns the number of births.
  template <class Make>
  std::size_t give_birth(std::size_t items, double t, Make&& make) {
    constexpr std::size_t blocks = 64;
    if (items == 0) return 0;
    const std::size_t block = (items + blocks - 1) / blocks;
    pending_births_.resize(blocks);
    for (auto& list : pending_births_) list.clear();
    parallel_blocks(items, block, [&](std::size_t b, std::size_t first, std::size_t last) {
      for (std::size_t item = first; item < last; ++item) make(item, pending_births_[b]);
    });
    return settle(t);
  }

  // Removes the bubbles whose flag is set (one per bubble); the others keep their order.
  void remove(const Array<std::uint8_t>& dead);

  // Sorts by the cell of `next_position`.
  void sort(const CellGrid& grid);
  const CellOrder& table() const { return table_; }

  FieldSet fields;
  // State between steps.
  std::array<Array<double>*, 3> position{}, velocity{};
  std::array<Array<double>*, 3> fluctuation{};  // u' of the liquid, King (2.8)
  Array<double>* volume = nullptr;
  Array<double>* birth_time = nullptr;
  Array<double>* deformation = nullptr;           // L_def, King (3.26)
  Array<double>* dissipation_integral = nullptr;  // of epsilon over the age, King (3.29)
  Array<double>* oxygen = nullptr;                // moles of oxygen and of other dry gas
  Array<double>* inert = nullptr;
  Array<double>* merge_time = nullptr;  // t_m, King section 3.4.3; not_merging: moves freely
  Array<std::int64_t>* identifier = nullptr;
  Array<std::int64_t>* at_rest_in_liquid = nullptr;  // 1 until the first step
  Array<double>* slip = nullptr;                     // |u_l - u_b| at the last step, u_l resolved
  std::int64_t next_identifier = 0;

  // Found within a step, taken over when it is accepted.
  std::array<Array<double>*, 3> next_position{};  // sorted with the state
  std::array<Array<double>*, 3> next_velocity{}, next_fluctuation{};

 private:
  std::size_t settle(double t);

  std::vector<std::vector<NewBubble>> pending_births_;
  CellOrder table_;
  Array<std::int32_t> order_;
};

}  // namespace spume::bubbles
