// SPDX-License-Identifier: MIT
// Particles that lie against the wall of a body at rest.
//
// Where a wedge between a body and another wall becomes narrower than a particle no liquid stands, and the pressure
// drives those at its mouth into it, with 1 to 12 g in still water. What holds them is the wall:
// Boundary::hold_liquid() puts a particle back, and the acceleration that drove it there is borne by the body. A
// particle is in contact where the next step would bring it to a place from which the walls would put it back.
#pragma once

#include <vector>

#include "spume/core/vectors.hpp"
#include "spume/operators/wall_averages.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/phase_law.hpp"

namespace spume {

// The direction, of length 1, in which the walls of bodies at rest would put back what goes from `place` by `way`; zero
// where they would not, farther than 0.6 spacings from such walls and beside moving bodies. There are bodies.
Vec3 direction_of_contact(const Boundary& boundary, const Vec3& place, const Vec3& way);

// The end of a way from `place`, or, where walls of bodies at rest would put a particle back from it, the place between
// the two from which on they would, and the direction in which they do: along a wall the particle goes on. Sides and
// bodies that move hold as Boundary::hold_liquid(). Places go round periodic sides.
struct WayToContact {
  Vec3 end{}, outwards{};
};
WayToContact go_to_contact(const Boundary& boundary, const Vec3& place, const Vec3& way);

// A vector without what of it goes into the wall.
inline Vec3 without_inward(const Vec3& vector, const Vec3& outwards) {
  const double into = dot(vector, outwards);
  return into < 0 ? subtract(vector, multiply(into, outwards)) : vector;
}

class WallContacts {
 public:
  explicit WallContacts(const Boundary& boundary) : boundary_(boundary) {}

  // Particles at the end of a step, whose velocities have had its half of the accelerations; the next step begins with
  // as much.
  struct Liquid {
    ParticleStore& particles;
    const FloatVectorField& acceleration;
    ParticleLaws law;
    double dt;
  };
  // Takes from accelerations and velocities of the particles `near` walls what the bodies bear in place of what they
  // bore before. Same bits for any thread count.
  void bear(const std::vector<std::int32_t>& near, const Liquid& liquid);
  // Adds what the bodies bear: in a wedge of two the part of each, along its normal.
  void add_to_bodies(std::vector<SurfaceForce>& forces) const;

 private:
  struct Borne {
    std::size_t body = 0;
    Vec3 foot{}, force{};
  };
  void share(const Vec3& place, const Vec3& outwards, double force, std::vector<Borne>& borne) const;

  const Boundary& boundary_;
  std::vector<std::vector<Borne>> found_;
};

}  // namespace spume
