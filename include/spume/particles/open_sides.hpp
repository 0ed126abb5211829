// SPDX-License-Identifier: MIT
// Openings of the sides: liquid enters at an inflow and leaves at an outflow, through layers of points behind the side
// that are as deep as a kernel reaches (M. Lastiwka, M. Basa, N. J. Quinlan, Int. J. Numer. Meth. Fluids 61 (2009);
// I. Federico et al., Eur. J. Mech. B 34 (2012); A. Tafuni et al., Comput. Methods Appl. Mech. Engrg. 342 (2018)).
//
// Sweeps see the points as they see wall points (operators/wall_stencils.hpp). Behind an inflow they stand in columns
// that move towards the side with the given normal velocity: by their volume over their cross-section a column brings
// exactly what the velocity gives, to a particle. The foremost becomes a particle where it passes the side, and one
// comes in at the end. Behind an outflow they are the particles that have passed it: they go on with the velocity of
// the liquid at the mirrored place and are dropped out of reach. Where liquid comes back the foremost becomes a
// particle again, and one comes in at the end of its way.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "spume/core/saved_state.hpp"
#include "spume/operators/wall_stencils.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/open_gates.hpp"
#include "spume/particles/opening_points.hpp"

namespace spume {

class OpenSides {
 public:
  // `scene` outlives them; its particles are those of the start.
  OpenSides(const Scene& scene, const Resolution& resolution, double particle_volume);
  OpenSides(const OpenSides&) = delete;
  OpenSides& operator=(const OpenSides&) = delete;
  ~OpenSides();

  // Places of the points at t + dt; accept() takes them over.
  void advance(double t, double dt);
  void accept();

  // Hands particles over at the start of a step: those beyond an outflow become points, points that have come in become
  // particles, which take the fields that they do not have from the nearest particle. Returns whether there were any.
  bool exchange(ParticleStore& particles, double t);

  // Appends the points and their stencils for particles at `at` at time t, of which `thin` hides some; null: none.
  // Throws StepFailure for a velocity that is not finite.
  void find_stencils(const Arrangement& arrangement, const VectorField& at, double t, const ThinWalls* thin,
                     WallStencils& stencils, std::array<Array<double>, 3>& position);
  // give_opening_gradients() for the points that find_stencils() appended.
  void give_gradients(const std::array<const double*, 3>& before, const std::array<const double*, 3>& after, double dt,
                      WallStencils& stencils) const;
  // Pressures over density for the points that find_stencils() appended, with the potential that is part of q.
  void give_pressures(const std::function<double(const Vec3&)>& potential, double t, WallStencils& stencils) const;
  // Velocities with which the points of outflows move on, by the stencils.
  void follow(const WallStencils& stencils, const std::array<const double*, 3>& velocity);

  const OpenGates& gates() const { return open_gates_; }
  // Of the last stencils, first of t = 0: of what enters, and of what has left.
  double largest_speed() const { return largest_speed_; }

  std::int64_t entered() const { return entered_; }  // particles, since the start
  std::int64_t next_identifier() const { return next_identifier_; }
  std::int64_t left() const { return left_; }  // net of those that came back
  std::size_t points() const { return points_.size(); }

  void save(StateWriter& writer) const;
  void load(StateReader& reader);
  double bytes() const;

 private:
  struct Drifting {
    Vec3 place{}, next{}, velocity{};
    int gate = 0;
  };
  // Image of a wall point of a body that goes through an opening.
  struct Corner {
    std::size_t wall_point = 0;
    std::int32_t gate = 0;
    Vec3 foot{};              // on the side, where the liquid that the wall point stands for enters or leaves
    double way = 0;           // along the axis of the opening, from the image of that liquid to itself
    double acceleration = 0;  // of what is given, over the last step
  };
  // Becomes a particle.
  struct Newcomer {
    Vec3 place, velocity;
  };

  void take_entering(int up, double t, std::vector<Newcomer>& newcomers);
  void take_returning(std::vector<Newcomer>& newcomers);
  void add_copies_of_nearest(const ParticleStore& particles, const std::vector<Newcomer>& newcomers,
                             Array<std::int32_t>& order) const;
  void list_points(double t);
  // Corners between the walls of bodies and the sides that openings cover.
  void find_corners(const VectorField& at, double t, const WallStencils& walls,
                    const std::array<Array<double>, 3>& position);
  void append_corners(WallStencils& stencils, std::array<Array<double>, 3>& position);
  void give_corner_gradients(const std::array<const double*, 3>& before, const std::array<const double*, 3>& after,
                             double dt, WallStencils& stencils) const;

  const Scene& scene_;
  const Resolution resolution_;
  const double particle_volume_;
  OpenGates open_gates_;
  std::vector<OpenGate>& gates_;
  std::vector<Drifting> drifting_;
  std::vector<OpeningPoint> points_;  // number: among the drifting points
  std::vector<Corner> corners_;
  std::size_t first_corner_ = 0;
  std::size_t first_point_ = 0;  // among the points of the stencils
  std::int64_t entered_ = 0, left_ = 0, next_identifier_ = 0;
  double largest_speed_ = 0;
  double step_ = 0;  // of the last advance()
};

}  // namespace spume
