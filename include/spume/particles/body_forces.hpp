// SPDX-License-Identifier: MIT
// Force and torque of the liquid on each body, by integration over its surface:
//
//   F = int (-p n + mu (grad u + grad u^T) n) dA,   n out of the body into the liquid,
//
// torque about the origin of the coordinates, in two dimensions its component out of the plane. Surfaces are cut into
// elements of about a spacing; pressure and velocity gradient of an element are quadratic fits to the particles before
// it, that of the velocity through the velocity of a no-slip surface. Elements without liquid before them feel nothing.
//
// Between a surface and another wall there is liquid in gaps that no particle has room in: it has the pressure of the
// nearest element along the surface before which there is liquid with room, at rest under gravity from there on, and is
// missing where one that is dry is nearer; where there is neither, a fit to what is caught there tells it. Where one
// layer of particles fits its pressure is their mean, each at rest from its place on. Surfaces that touch a wall feel
// nothing there.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "spume/io/record_table.hpp"
#include "spume/operators/surface_force.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/near_particles.hpp"
#include "spume/particles/still_liquid.hpp"
#include "spume/particles/surface_elements.hpp"

namespace spume {

class BodyForces {
 public:
  // Scene and walls, where they stand at the start, outlive the forces.
  BodyForces(const Scene& scene, const Resolution& resolution, const BodyWalls& walls);

  struct Fields {
    // `walls`: where the sides of the domain are.
    Fields(const Arrangement& arrangement, const ParticleStore& store, const WallPositions& walls);
    const WallPositions& sides;
    const CellGrid& grid;
    std::size_t particles;
    std::array<const double*, 3> position, velocity;
    double particle_volume;
    double dynamic_viscosity = 0;
    const float* viscosity = nullptr;                      // of each particle; null: dynamic_viscosity of all
    std::function<double(std::size_t)> density, pressure;  // of a particle
  };
  // Of a particle: place, velocity, pressure and density.
  static constexpr double bytes_read(int dimensions) { return (2 * dimensions + 1) * sizeof(double) + sizeof(float); }
  // Per [[body]] entry; zero for those that are no walls.
  std::vector<SurfaceForce> measure(const Fields& fields, double t) const;
  // For methods that add up what each particle exerts on walls: of bodies with gaps the pressure, which is missing
  // there, is integrated instead.
  void integrate_beside_gaps(const Fields& fields, std::vector<SurfaceForce>& forces) const;

  // That of a still liquid, on what is free of walls.
  void add_pressure(const StillLiquid& still, const WallPositions& sides, std::vector<SurfaceForce>& forces) const;

  // Of bodies that float: the force on an element by the pressure of one of its particles, per pressure.
  struct PressureWeight {
    std::int32_t particle = 0, body = 0;
    Vec3 place{}, force{};
  };
  // All of them, and per [[body]] entry the forces by viscosity and what liquid at rest adds in gaps.
  void find_weights(const Fields& fields, std::vector<PressureWeight>& weights, std::vector<SurfaceForce>& given) const;

  // bodies.csv: t, body, force and torque by pressure and by viscosity; where bodies move, the place of the pivot, by
  // how much and about what the body has turned, and the velocities of both.
  RecordTable table() const;
  void add_rows(double t, const std::vector<SurfaceForce>& forces, std::vector<double>& rows) const;
  std::size_t elements() const { return elements_.size(); }
  // The first body that floats and has gone through a wall of the domain or another body; none: no such body.
  std::optional<std::size_t> floats_through(const WallPositions& sides) const;

 private:
  using Element = SurfaceElements::Element;
  Element now(const Element& element) const;
  Vec3 whole_middle(std::size_t e) const;  // where torques count it
  // What is before an element: liquid that its pressure is fitted to, or nothing; or a gap without room for particles,
  // or a wall that it touches.
  enum class Before : std::uint8_t { nothing, wall, gap, liquid };
  struct Traction {
    Vec3 pressure{}, viscous{};
    // Of the element's pressure: its value, the density of the liquid, and where its weights are in their block.
    double value = 0, density = 0;
    std::size_t first_weight = 0, last_weight = 0;
    Before before = Before::nothing;
    bool in_gap = false;  // too narrow to fit its pressure there
  };
  // Null `weights`: they are not asked for.
  struct Sorted;
  template <int dimensions>
  Traction traction(const Fields& fields, const Sorted& table, NearParticles& near, const Element& element,
                    const Vec3& wall_velocity, std::vector<PressureWeight>* weights) const;
  // Of every element; with `weights` those of floating bodies alone, and what they are made of, block by block.
  std::vector<Traction> tractions(const Fields& fields, double t,
                                  std::vector<std::vector<PressureWeight>>* weights) const;
  bool is_beyond(const Vec3& place, const WallPositions& sides) const;  // a wall of the domain
  bool is_free(const Vec3& place, const WallPositions& sides) const;    // in no wall and beyond none
  // Of the kernel before an element, the share that no walls fill.
  double free_share(const Element& element, const WallPositions& sides) const;
  // Gives elements before gaps the pressure of those before liquid.
  void fill_gaps(std::vector<Traction>& of, std::vector<std::vector<PressureWeight>>* weights) const;
  std::vector<SurfaceForce> add_up(const std::vector<Traction>& of) const;
  bool floats(const Element& element) const;

  const Scene& scene_;
  const Resolution& resolution_;
  const BodyWalls& walls_;
  const Vec3 gravity_;
  const bool is_full_;  // liquid fills a domain that is closed
  const SurfaceElements elements_;
};

}  // namespace spume
