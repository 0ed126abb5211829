// SPDX-License-Identifier: MIT
#include "spume/particles/averaged_walls.hpp"

namespace spume {

void AveragedWalls::take_points(double t) {
  if (boundary_.bodies() != nullptr) boundary_.bodies()->take_all_points(t);
}

void AveragedWalls::find_entries(const Arrangement& arrangement) {
  if (boundary_.bodies() == nullptr) return;
  averages_.find_entries(arrangement.context, boundary_.reflection(), boundary_.bodies()->stencils(), rates_);
}

void AveragedWalls::follow(double t) {
  if (boundary_.bodies() != nullptr) boundary_.bodies()->follow_points(t);
}

void AveragedWalls::weigh(const Arrangement& arrangement) {
  if (boundary_.bodies() != nullptr) averages_.weigh(arrangement.context, boundary_.bodies()->stencils());
}

void AveragedWalls::add_rates(const Arrangement& arrangement, const std::array<const double*, 3>& velocity,
                              const float* volume, float* rate) const {
  const WallStencils& stencils = boundary_.bodies()->stencils();
  ScratchArray<double> flow(scratch_, stencils.size());
  averages_.add_rates(arrangement.context, stencils, velocity, volume, flow.data(), rate);
}

void AveragedWalls::find_pressure(const Arrangement& arrangement, const float* pressure, const float* density,
                                  const StillLiquid& still) {
  if (boundary_.bodies() == nullptr) return;
  const BodyWalls& walls = *boundary_.bodies();
  scratch_.lease(pressure_, walls.stencils().size());
  scratch_.lease(density_, walls.stencils().size());
  averages_.extrapolate(
      arrangement.context, walls.stencils(),
      {.pressure = pressure, .density = density, .gravity = gravity_, .wall_acceleration = read(walls.acceleration())},
      pressure_.data(), density_.data());
  still.subtract(place(), walls.stencils().size(), pressure_.data());
}

void AveragedWalls::release() {
  scratch_.release(pressure_);
  scratch_.release(density_);
}

std::array<const double*, 3> AveragedWalls::place() const {
  if (boundary_.bodies() == nullptr) return {};
  return static_cast<const Boundary&>(boundary_).bodies()->wet().position;
}

std::vector<SurfaceForce> AveragedWalls::forces(const Arrangement& arrangement, const Liquid& liquid) const {
  const BodyWalls& walls = *boundary_.bodies();
  const std::size_t points = walls.stencils().size();
  const std::array<const double*, 3> place = walls.wet().position;
  std::vector<std::int32_t> body(points);
  std::array<std::vector<double>, 3> arm;
  const int dimensions = boundary_.domain().dimensions;
  for (int axis = 0; axis < dimensions; ++axis) arm[axis].resize(points);
  for (std::size_t g = 0; g < points; ++g) {
    body[g] = walls.body_of_wet(g);
    Vec3 at{};
    for (int axis = 0; axis < dimensions; ++axis) at[axis] = place[axis][g];
    const Vec3 whole = walls.whole_place(static_cast<std::size_t>(body[g]), at);
    for (int axis = 0; axis < dimensions; ++axis) arm[axis][g] = whole[axis];
  }
  return wall_forces(arrangement.context,
                     {.velocity = liquid.velocity,
                      .pressure = liquid.pressure,
                      .volume = liquid.volume,
                      .viscosity = liquid.viscosity,
                      .friction = liquid.friction,
                      .gravity = gravity_,
                      .left_out = liquid.left_out,
                      .reflection = &boundary_.reflection(),
                      .held = &boundary_.velocity_rule().sign,
                      .wall_pressure = pressure_.data(),
                      .wall_density = density_.data(),
                      .wall_position = place,
                      .arm = {arm[0].data(), arm[1].data(), arm[2].data()},
                      .body = body.data(),
                      .near = &near()},
                     walls.bodies().size());
}

}  // namespace spume
