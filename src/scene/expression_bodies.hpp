// SPDX-License-Identifier: MIT
#pragma once

#include "spume/geometry/shapes.hpp"
#include "spume/scene/draft.hpp"
#include "spume/scene/expression.hpp"

namespace spume {

// The body where an expression of its own coordinates is positive, where it stands. Its surface is found within four
// spacings of the domain. What ends within three beyond a periodic side is one body, whose copies are for repeat();
// what goes on there is what the expression says in the domain, continued with its period. Refused where the two sides
// disagree.
ShapePointer make_expression_body(const Draft& draft, const std::string& name, const Expression& where,
                                  const Pose& pose, Problems& problems);

}  // namespace spume
