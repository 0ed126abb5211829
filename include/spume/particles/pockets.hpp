// SPDX-License-Identifier: MIT
// Places between the wall of a body and another wall where no particle has room: the wedge below a ball that lies on
// the floor, a slot narrower than the spacing. They are filled with nothing, and stay so: liquid drawn in leaves a void
// behind it, with less pressure, which draws more in; still water beside a cylinder on the floor reached 5 sqrt(gH).
//
// All but ahead_of() ask for walls of bodies: boundary.bodies() is not null. Walls are those of the last state
// (Boundary::walls). Which body moves is asked of the nearest one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "spume/core/vec3.hpp"
#include "spume/particles/store.hpp"

namespace spume {

class Arrangement;
class Boundary;

// Whether a ball of half a spacing, of which walls may take a fifth, fits between them around a place that it may be
// beside.
bool has_room(const Boundary& boundary, const Vec3& place);

// What there is along a normal from particle i, at half a spacing, one and one and a half: somewhere a ball of half a
// spacing fits between the walls that no particle stands in; else, at some of the places, none fits, a pocket; or one
// fits where i itself stands alone, before a wall; or other particles are everywhere. Who lacks liquid and has a pocket
// ahead lacks what walls leave no room for: it faces no surface and no void. So does who has a wall ahead in liquid at
// rest; of a film that runs down a face the other side is free. `room` farther than a support radius from bodies, and
// for what is caught between parallel faces less than a spacing apart of which one moves: without a surface its
// pressure rises with every step, which threw a box up that had landed on it.
enum class Ahead { room, liquid, wall, pocket };
Ahead ahead_of(const Boundary& boundary, const Arrangement& arrangement, std::size_t i, const Vec3& place,
               const Vec3& normal);

// Whether a place is between the face of a body and another wall that are less than two spacings apart, where one layer
// of particles fits at most: their kernel sums tell how it fits. False beside bodies that move: without a surface in
// the layer that it lands on, what a wave pressed into it threw a plank of four times the density of water up.
bool in_one_layer(const Boundary& boundary, const Vec3& place);

// Spacings between the faces of a wedge. A layer of particles, which stand half a spacing from walls, needs one; at 0.6
// those that press against each other at its mouth stay.
inline constexpr double narrowest_wedge = 0.6;
// A wall of a side or a body that a place is behind, and by how much.
struct WallBehind {
  Vec3 normal{};
  double behind = 0;
  bool of_body = false;
  Vec3 place{};
};
// The wall across a wedge from the nearest wall of a body: the one that is less than `width` away from that along its
// normal at `place`, which is in between.
std::optional<WallBehind> wall_across(const Boundary& boundary, const Vec3& place, double width);
// A place in a wedge whose faces are nearer to each other than 0.6 spacings there: out along the bisector to where
// they are not, with the velocity that leads in, beside the mean of both faces (sides of the domain stand), taken away.
// Between faces that are parallel to 6 degrees, which lead nowhere out: along them to where the slot ends, if that is
// nearer than two spacings, 0.5 where the faces are more than 0.4 spacings apart; else the place is left.
// What was at `from`, which may be null, and has come through the narrow end of the wedge goes back there.
void lead_out_of_wedges(const Boundary& boundary, Vec3& place, Vec3* velocity, const Vec3* from = nullptr);

}  // namespace spume
