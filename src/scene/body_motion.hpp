// SPDX-License-Identifier: MIT
// How [[body]] entries move: by expressions, by a table, with another body, or floating.
#pragma once

#include "spume/scene/draft.hpp"
#include "spume/scene/method_declaration.hpp"

namespace spume {

// Keys of motion that belong together and fit the body; `walls`: names of the bodies that are walls, in order.
void check_body_motions(const Draft& draft, const MethodDeclaration* method, Problems& problems);

// The motions of the bodies, whose places are moved to those of t = 0. `duration` is that of the run.
std::vector<BodyMotion> make_body_motions(const Draft& draft, const CompileExpression& compile, double duration,
                                          std::vector<Body>& bodies, Problems& problems);

// Finds the motions that probes are carried by.
void carry_probes(const Draft& draft, const std::vector<Body>& bodies, std::vector<ProbeOptions>& probes,
                  Problems& problems);

}  // namespace spume
