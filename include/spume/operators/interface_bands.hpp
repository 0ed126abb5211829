// SPDX-License-Identifier: MIT
// Which particles are near an interface between phases, so that nothing is computed of it elsewhere.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/operators/pair_sweep.hpp"

namespace spume {

// Lists are looked through only where cells of several phases lie within a support radius of each other; elsewhere a
// particle costs a look at its phase. Images count with the phase of their source.
class InterfaceBands {
 public:
  // phase: number of the phase of each particle. grid, order: those that the neighbour list was built from; its images
  // must be sorted by that grid, as Images::build leaves them.
  void build(const SweepContext& context, const CellGrid& grid, const CellOrder& order,
             std::span<const std::uint8_t> phase);

  // Particles whose support holds more than one phase: their filtered properties differ from those of their phase.
  std::span<const std::int32_t> mixed() const { return mixed_; }
  // Particles whose support holds a mixed one, themselves included: filtered properties vary within it.
  std::span<const std::int32_t> varying() const { return varying_; }
  // Particles that can meet another phase in a pair: the mixed ones, and where wall points have fits of the phases
  // around them all that vary.
  std::span<const std::int32_t> facing(const SweepContext& context) const {
    return context.walls == nullptr ? mixed_ : varying_;
  }
  // Not 0 for the varying ones; null when there is none (PhaseProperty::varies).
  const std::uint8_t* varies() const { return varying_.empty() ? nullptr : near_.data(); }

  double bytes() const;

 private:
  struct Range {  // of the phases in a cell; none: least > most
    std::uint8_t least = 255, most = 0;
    void include(Range other);
  };
  void find_ranges(const SweepContext& context, const CellOrder& order, std::span<const std::uint8_t> phase,
                   std::size_t cells);
  bool several_around(const CellGrid& grid, int column, int iy, int iz) const;

  Array<Range> ranges_, along_rows_;
  Array<std::uint8_t> point_phase_;  // of particles and images
  Array<std::uint8_t> near_;         // 1 varying, 2 mixed
  std::vector<std::int32_t> mixed_, varying_;
};

}  // namespace spume
