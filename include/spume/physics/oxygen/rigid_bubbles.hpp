// SPDX-License-Identifier: MIT
// Gas in bodies that are released again and again: the bubbles of the hybrid model, resolved in size and given in
// motion.
//
// A body sets out with the gas of its full volume at the pressure of the place where it appears, and keeps that size
// and way whatever it gives. What it holds when it is taken away has left through the surface. With d_ib the distance
// of particle i from the surface of body b, it sees the liquid and returns what it gives by the weights
//   phi_ib = W(d_ib) / sum_k W(d_kb),   W the kernel at h,
// of the particles within a support of its surface. In two dimensions areas, volumes and amounts are those of a unit of
// depth.
#pragma once

#include <cstdint>
#include <vector>

#include "spume/core/saved_state.hpp"
#include "spume/particles/moving_bounds.hpp"
#include "spume/particles/reports.hpp"
#include "spume/particles/resolution.hpp"
#include "spume/physics/oxygen/supply.hpp"
#include "spume/physics/oxygen/transfer.hpp"
#include "spume/scene/scene.hpp"

namespace spume::oxygen {

// The area of the surface of a shape with an end; in two dimensions its circumference.
double surface_area(const Shape& shape, int dimensions);
// What supplies the liquid of a scene without discrete bubbles.
const char* in_words(const Scene& scene);

class RigidBubbles final : public Supply {
 public:
  // `scene` outlives them.
  RigidBubbles(const Scene& scene, const Resolution& resolution, const Gas& gas);
  static bool exist(const Scene& scene);

  struct Liquid {
    std::size_t size = 0;
    double particle_volume = 0;
    VectorField places, velocity;
    const Array<double>& dissolved;
    const Array<std::int64_t>* left_out = nullptr;  // particles with 0 or more, behind openings; null: none
  };
  // A step of dt up to the time t: what the bubbles give changes the concentrations by `change`, float sums of the
  // amount that is returned.
  double exchange(double t, double dt, const Liquid& liquid, Array<float>& change);

  double conductance() const override { return conductance_; }
  double transfer_capacity() const override { return capacity_; }
  double oxygen_feed() const override;
  void each(const Each& see) const override;

  void add_columns(SeriesTable& series) const;
  void save(StateWriter& writer) const;
  void load(StateReader& reader);

 private:
  struct Bubble {
    std::size_t motion = 0;
    ShapePointer shape;
    double area = 0, volume = 0;  // of its full size
    double reach = 0;             // of its full size, from its pivot
    // State: which release it is on its way with, negative while it waits, and what it holds.
    std::int64_t turn = -1;
    Contents contents{};
  };
  // A particle that bubble b sees.
  struct Seen {
    std::int32_t bubble, particle;
    double weight;
  };
  // Of one bubble in a step.
  struct Turn {
    RigidPlace place;
    double weight = 0, concentration = 0;
    Vec3 velocity{};  // of the liquid
    double given = 0, conductance = 0, capacity = 0;
  };
  void set_out(double t);
  void find_particles(const Liquid& liquid);
  Contents first_contents(const Bubble& bubble) const;

  const Scene& scene_;
  const Gas gas_;
  const int dimensions_;
  const double h_, support_;
  std::vector<Bubble> bubbles_;
  std::vector<Turn> turns_;
  std::vector<std::vector<Seen>> seen_;  // per block of particles
  MovingBounds near_;
  double conductance_ = 0, capacity_ = 0, area_ = 0;  // of the last step
  double released_ = 0, given_ = 0, left_ = 0;        // g of oxygen since the start
  SavedNumbers saved_{"rigid_bubble_sums"};
};

}  // namespace spume::oxygen
