// SPDX-License-Identifier: MIT
// Rigid bodies that float: their accelerations are found together with the pressure that drives them.
//
// A body of mass M and inertia I about its centre of mass has, in the motions that it is free in,
//
//   M A = M g + F,   I alpha = T - omega x (I omega),
//
// F and T by the pressure p = rho (q - potential) and by viscosity on its surface (particles/body_forces.hpp), linear
// in q: F = F_0 + C q. Behind its surface the pressure follows the acceleration of the surface
// (particles/boundary.hpp), again linearly: unit accelerations add the columns G to the right-hand side of the pressure
// equation. With the matrix m of masses both make one system without a step between them,
//
//   (K - G m^-1 C) q = b + G m^-1 F_0,
//
// K q = b being the equation beside bodies that keep their velocity. Bodies lighter than the water that they accelerate
// are as stable as heavy ones: alternating, steps of body and liquid diverge for them (Causin, Gerbeau and Nobile,
// Comput. Methods Appl. Mech. Engrg. 194 (2005)).
//
// Bodies are stepped as particles are: with centring, velocities half a step apart from places.
//
// Contacts (particles/body_contacts.hpp) are limits J a >= l of the accelerations, met by forces J^T lambda, lambda >=
// 0, without friction. Those held as equalities change m^-1 and add what is given, so that the liquid feels an impact
// in the pressure of the step in which it happens:
//
//   a = W (F_0 + C q) + a_c,   W = m^-1 - m^-1 N^T (N m^-1 N^T)^-1 N m^-1,   a_c = m^-1 N^T (N m^-1 N^T)^-1 l.
//
// Which are held is what the bodies alone would do under the forces of the solution (Gauss's principle of least
// constraint); the pressure is solved for again until both agree, a primal-dual active set (Hintermueller, Ito and
// Kunisch, SIAM J. Optim. 13 (2002)).
#pragma once

#include <memory>
#include <vector>

#include "spume/core/saved_state.hpp"
#include "spume/particles/body_contacts.hpp"
#include "spume/particles/body_forces.hpp"
#include "spume/particles/projection_solver.hpp"
#include "spume/solvers/limited_change.hpp"

namespace spume {

class FloatingBodies {
 public:
  // What is given outlives this. `centred`: velocities lead by half a step.
  FloatingBodies(const Scene& scene, const Resolution& resolution, BodyWalls& walls, bool centred);
  ~FloatingBodies();
  FloatingBodies(const FloatingBodies&) = delete;
  FloatingBodies& operator=(const FloatingBodies&) = delete;

  // Places at the end of a step, with the velocities that they are reached with.
  void advance(double dt);

  struct Liquid {
    BodyForces::Fields fields;                 // at the places of the solve; its pressure is not read
    const Array<double>* potential = nullptr;  // null: zero
  };
  // The matrix with the bodies in it, for a right-hand side without them. Binds that of the solver to the rows.
  ProjectionMatrix& couple(ProjectionSolver& solver, const PressureRows& rows, Arrangement& arrangement,
                           ParticleStore& particles, const Liquid& liquid,
                           const BodyContacts::Surroundings& surroundings);
  // Whether under the pressure found other contacts hold than the matrix has; it then has those.
  bool contacts_change(std::span<const double> q);
  // Of the solution; adds to the pressures behind walls what they bring.
  void find_accelerations(std::span<const double> q, std::span<double> image_pressure);
  void accept(double dt);
  double largest_speed() const;  // a bound of those of their surfaces
  bool overlaps_at_start(std::size_t motion) const { return contacts_at_.overlaps_at_start(motion); }
  // Of them all, in the last state; potential: along periodic axes too, which they may go around.
  double kinetic_energy() const;
  double potential_energy() const;
  // Of the last step, if bodies met in it, else 0. A longer one after it would add to the impact, as accelerations last
  // until the middle of the next step.
  double step_of_impact() const { return step_of_impact_; }
  // Contacts limit the velocity for a step as long as the last one. The longest that takes nothing into a clearance by
  // more than a tenth of it; infinite without contacts.
  double longest_step() const { return longest_step_; }

  void save(StateWriter& writer) const;
  void load(StateReader& reader);

 private:
  struct State {
    RigidPlace place;  // with the velocities at the same time
    Vec3 acceleration{}, angular_acceleration{};
  };
  struct Freedom {
    std::size_t body = 0;  // among those that float
    int axis = 0;          // 0 to 2 along, 3 to 5 about x, y, z
  };
  class Coupled;
  void place_walls();
  void set_forces(const Liquid& liquid);
  void set_columns(ProjectionSolver& solver, const PressureRows& rows, Arrangement& arrangement,
                   ParticleStore& particles);
  void set_contacts(const BodyContacts::Surroundings& surroundings);
  double longest_step_after(double dt) const;
  // n . u of the relative velocity of a contact, as a row over the freedoms and as it is.
  void add_row(const BodyContact& contact, std::size_t motion, double sign, std::span<double> row, double& speed) const;
  // F_0 + C q, or without F_0.
  template <class T>
  std::vector<double> forces(std::span<const T> q, bool given) const;
  std::vector<double> relative_response(std::span<const std::int32_t> members) const;  // of BodyCoupling
  // W times them, with a_c where what is given counts.
  template <class T>
  std::vector<double> accelerations(std::span<const T> q, bool given) const;

  const Scene& scene_;
  BodyWalls& walls_;
  BodyForces forces_;
  bool centred_;
  double spacing_ = 0;
  std::vector<std::size_t> motions_;  // that float, among those of the scene
  std::vector<State> now_, next_;     // at the ends of steps
  double step_ = 0;
  std::vector<Freedom> freedoms_;
  std::vector<double> inverse_mass_;  // square, over freedoms
  BodyContacts contacts_at_;
  std::vector<BodyContact> contacts_;  // of the step
  Limits limits_;                      // of them
  std::vector<double> closing_;        // their n . u before the step
  std::vector<std::size_t> held_;      // in the matrix
  HeldChange held_change_;             // W, a_c
  int rounds_ = 0;
  std::vector<BodyContact::Key> touching_;  // those held at the end of the last step
  double step_of_impact_ = 0, longest_step_ = infinite;
  std::vector<double> given_force_;  // F_0
  // C: the force per unit q, by particle.
  std::vector<std::int32_t> particle_;
  std::vector<double> force_;                  // an entry for each freedom
  std::vector<double> moduli_;                 // of each freedom, what all of them would give along one direction
  std::vector<Array<double>> column_;          // G
  std::vector<Array<double>> image_pressure_;  // behind walls, by unit accelerations
  std::unique_ptr<Coupled> coupled_;
};

}  // namespace spume
