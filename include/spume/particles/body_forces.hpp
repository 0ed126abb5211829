// SPDX-License-Identifier: MIT
// Force and torque of the liquid on each body, by integration over its surface:
//
//   F = int (-p n + mu (grad u + grad u^T) n) dA,   n out of the body into the liquid,
//
// torque about the origin of the coordinates, in two dimensions its component out of the plane. Surfaces are cut into
// elements of about a spacing; pressure and velocity gradient of an element are quadratic fits to the particles before
// it, that of the velocity through the velocity of a no-slip surface. Elements without liquid before them feel nothing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "spume/io/record_table.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/near_particles.hpp"

namespace spume {

struct SurfaceForce {
  Vec3 pressure{}, viscous{};                // forces
  Vec3 pressure_torque{}, viscous_torque{};  // torques
};

class BodyForces {
 public:
  // Scene and walls, where they stand at the start, outlive the forces.
  BodyForces(const Scene& scene, const Resolution& resolution, const BodyWalls& walls);

  struct Fields {
    const CellGrid& grid;
    std::size_t particles = 0;
    std::array<const double*, 3> position, velocity;
    const double* pressure;
    double particle_volume = 0;
    double dynamic_viscosity = 0;
    const float* viscosity = nullptr;  // of each particle; null: dynamic_viscosity of all
  };
  // Per [[body]] entry; zero for those that are no walls.
  std::vector<SurfaceForce> measure(const Fields& fields, double t) const;

  // Of bodies that float: the force on an element by the pressure of one of its particles, per pressure.
  struct PressureWeight {
    std::int32_t particle = 0, body = 0;
    Vec3 place{}, force{};
  };
  // All of them, and per [[body]] entry the forces by viscosity.
  void find_weights(const Fields& fields, std::vector<PressureWeight>& weights,
                    std::vector<SurfaceForce>& viscous) const;

  // bodies.csv: t, body, force and torque by pressure and by viscosity; where bodies move, the place of the pivot, by
  // how much and about what the body has turned, and the velocities of both.
  RecordTable table() const;
  void add_rows(double t, const std::vector<SurfaceForce>& forces, std::vector<double>& rows) const;
  std::size_t elements() const { return elements_.size(); }
  // The first body that floats and has gone through a wall of the domain or another body; none: no such body.
  std::optional<std::size_t> floats_through() const;

 private:
  struct Element {
    Vec3 middle{}, area{};  // at the start; area times the normal out of the body
    std::int32_t body = 0;
  };
  Element now(const Element& element) const;
  struct Traction {
    Vec3 pressure{}, viscous{};
  };
  // Null `weights`: they are not asked for.
  struct Sorted;
  template <int dimensions>
  Traction traction(const Fields& fields, const Sorted& table, NearParticles& near, const Element& element,
                    const Vec3& wall_velocity, std::vector<PressureWeight>* weights) const;
  // Of every element; with `weights` those of floating bodies alone, and what they are made of, block by block.
  std::vector<Traction> tractions(const Fields& fields, double t,
                                  std::vector<std::vector<PressureWeight>>* weights) const;
  std::vector<SurfaceForce> add_up(const std::vector<Traction>& of) const;
  bool floats(const Element& element) const;
  void add_elements(std::int32_t body);

  const Scene& scene_;
  const Resolution& resolution_;
  const BodyWalls& walls_;
  std::vector<Element> elements_;
};

}  // namespace spume
