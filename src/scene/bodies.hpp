// SPDX-License-Identifier: MIT
// From the [[body]] entries of a case to shapes.
#pragma once

#include "spume/scene/case.hpp"
#include "spume/scene/draft.hpp"
#include "spume/scene/method_declaration.hpp"

namespace spume {

// Each body has one shape with what that needs and nothing else; names are their own, those that [[liquid]] and
// [[region]] refer to exist; walls are refused where the method has none of bodies. Names and kinds are completed.
void check_bodies(Draft& draft, const MethodDeclaration* method, Problems& problems);

// Reads meshes and finds surfaces of expressions. Bodies that cannot be made are reported and left without a shape, as
// are those that are known to be wrong.
std::vector<Body> make_bodies(const Draft& draft, const CompileExpression& compile, Problems& problems);

// The walls of bodies at the start, in their order; those that are released then or later are not there yet.
Combination make_walls(const std::vector<Body>& bodies, const std::vector<BodyMotion>& motions);

// Point probes in solids that stand still, which record nothing.
void warn_of_probes(const Draft& draft, const Scene& scene, Problems& problems);

// The [[body]], or the [[solid]] that became one, which body k of the scene is; null of flaps and of copies.
const Node* node_of_body(const Draft& draft, const Scene& scene, std::size_t k);

// Bodies that lie outside the domain, that are much larger, or thinner than a spacing.
std::vector<Problem> body_warnings(const Draft& draft, const Scene& scene, const std::string& file);

// Faces of thin bodies that meet others at less than 45 degrees.
std::vector<Problem> corner_warnings(const Draft& draft, const Scene& scene, const std::string& file);

}  // namespace spume
