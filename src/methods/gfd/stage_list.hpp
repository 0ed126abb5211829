// SPDX-License-Identifier: MIT
// Stages that count their pairs themselves.
#pragma once

#include "spume/methods/gfd/flow.hpp"
#include "spume/methods/particle_stages.hpp"

namespace spume::gfd {

// Of one phase nothing is filtered.
inline auto blending(Flow& f) {
  return [&f](StageRun& run) {
    f.blend_properties();
    if (f.features.interfaces) run.pairs = f.arrangement.pair_count();
  };
}

// A solve counts what the applications of its matrix stream itself.
inline auto solving(Flow& f) {
  return [&f](StageRun& run) {
    f.solve_pressure();
    run.pairs = f.arrangement.pair_count() * f.solver.report().applications;
  };
}

inline auto factorising(Flow& f) {
  return [&f](StageRun& run) {
    f.solver.factorise(f.rows, f.matrix, f.particles);
    run.pairs = f.arrangement.pair_count() * f.solver.direct()->products();
  };
}

inline auto implicitly(Flow& f) {
  return [&f](StageRun& run) {
    f.diffuse_implicitly(run.dt);
    run.pairs = f.arrangement.pair_count() * (f.implicit_diffusion.report().applications + 2);
  };
}

}  // namespace spume::gfd
