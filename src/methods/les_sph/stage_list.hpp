// SPDX-License-Identifier: MIT
// Arrays that the plan of a flow names, those of other classes among them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "spume/methods/les_sph/flow.hpp"
#include "spume/methods/stage.hpp"

namespace spume::les_sph {

// Arrays that the plan of a flow names and other classes keep.
struct KeptArrays {
  explicit KeptArrays(const Flow& f)
      : images([&f] { return f.arrangement.image_traffic(); }),
        lists([&f] { return f.arrangement.list_traffic(f.sizes); }),
        sorted([&f] { return f.arrangement.sort_traffic(f.particles); }),
        surface([&f] { return f.surface->traffic(); }),
        bends([&f] { return f.wall_bends == nullptr ? 0.0 : f.wall_bends->bytes(); }),
        sizes([&f] { return 4.0 * 4.0 * static_cast<double>(f.sizes.length_ratio.size()); }),
        bubbles([&f] { return f.bubbles->population().traffic(); }),
        bubble_images([&f] { return f.bubbles->image_traffic(); }) {}

  ArrayUse images, lists, sorted, surface;  // lists: with the coordinates that they refer to
  ArrayUse bends, sizes, bubbles, bubble_images;
};

// What a stage of the bubbles reads or writes of the particles, while bubbles live: else it returns at once.
inline Arrays while_bubbles_live(const Flow& f, Arrays arrays) {
  return {ArrayUse([&f, arrays = std::move(arrays)] {
    double sum = 0;
    if (!f.bubbles->population().empty())
      for (const ArrayUse& use : arrays) sum += use.bytes();
    return sum;
  })};
}

inline Arrays seen_by_bubbles(const Flow& f, const KeptArrays& kept) {
  return {kept.bubbles,        kept.bubble_images, f.advecting_velocity, f.material_acceleration, f.velocity_gradient,
          f.filtered_velocity, f.strain,           f.eddy_viscosity(),   f.moments.normal,        kept.sizes};
}

inline Arrays arrays_of(const MomentFields& m) {
  return {m.correction, m.uncorrected, m.divergence_of_position, m.laplacian_diagonal,
          m.kernel_sum, m.normal,      m.concentration_gradient};
}

// With what a scalar that rides on the sweep reads and writes.
inline Arrays read_by_viscosity(const Flow& f) {
  const auto riding = [&f] { return f.solutes.scalars == nullptr ? 0.0 : f.solutes.scalars->ridden_bytes(); };
  return {f.advecting_velocity, f.moments.divergence_of_position, f.eddy_viscosity(), ArrayUse(riding)};
}

inline Arrays read_by_matrix(const Flow& f) {
  const MomentFields& m = f.moments;
  return {m.divergence_of_position, m.laplacian_diagonal, f.divergence, f.first_source, f.pressure, f.potential};
}

inline Arrays arrays_of(const PressureRows& rows) {
  return {rows.diagonal_shift, rows.diagonal, rows.weight, rows.row, rows.right_hand_side};
}

// One sweep, or that of the change by the shift too.
inline auto differentiating(Flow& f) {
  return [&f](StageRun& run) {
    f.differentiate_velocity();
    run.pairs = f.arrangement.pair_count() * (f.shifts_without_bends() ? 2 : 1);
  };
}

inline auto factorising(Flow& f) {
  return [&f](StageRun& run) {
    f.factorise();
    run.pairs = f.arrangement.pair_count() * f.solver.direct()->products();
  };
}

// A solve counts what the applications of its matrix stream itself.
inline auto solving(Flow& f, void (Flow::*solve)()) {
  return [&f, solve](StageRun& run) {
    (f.*solve)();
    run.pairs = f.arrangement.pair_count() * f.solver.report().applications;
  };
}

}  // namespace spume::les_sph
