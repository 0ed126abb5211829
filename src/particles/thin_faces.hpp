// SPDX-License-Identifier: MIT
// Faces of thin bodies around places before them, by samples of their surfaces, about one for the square of a spacing.
//
// Samples nearer to a place than the support radius and a spacing whose normals change by less than 20 degrees from one
// to the next are of one face: a surface that bends over a few spacings is one, a fold of 20 degrees or more makes two.
// Normals are those a twentieth of a spacing inside the body, which next to an edge are those of its faces and none
// between.
#pragma once

#include <cstdint>
#include <vector>

#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/particles/thin_bodies.hpp"

namespace spume {

class ThinFaces {
 public:
  // What is given outlives the faces.
  ThinFaces(const std::vector<StandingBody>& bodies, const Combination& walls, const Domain& domain, double spacing,
            double reach)
      : bodies_(bodies), walls_(walls), domain_(domain), spacing_(spacing), reach_(reach) {}

  // Samples a body at places outside it, a spacing apart along its surface and at most half a spacing from it; then
  // ends with the samples of all bodies.
  void sample(std::size_t body, const std::vector<Vec3>& places);
  void sort();

  struct Face {
    std::size_t body = 0;      // among `bodies`
    Vec3 point{}, normal{};    // the plane that stands for it around the place
    bool beside_edge = false;  // of that body, or in a corner
    bool flat = false;
    // Of the cosine of the angle between its normal and that of a place of the surface that belongs to it.
    double least_cosine = 0;
    std::vector<Vec3> samples;
  };
  // Those that a place is before and sees some of; `near`: of the thin body `body`, whose face there is the first if
  // the place is before no edge of it.
  std::vector<Face> around(std::size_t body, const Vec3& place, const NearestPoint& near) const;

 private:
  struct Sample {
    std::size_t body = 0;
    Vec3 point{}, normal{};
  };
  Sample sampled(std::size_t body, const NearestPoint& near) const;
  void look_around(std::size_t body, const Vec3& edge, std::vector<Sample>& found) const;
  std::vector<Sample> near_samples(const Vec3& place) const;
  bool sees(const Vec3& place, const Sample& sample) const;

  const std::vector<StandingBody>& bodies_;
  const Combination& walls_;
  const Domain& domain_;
  double spacing_, reach_;
  std::vector<Sample> samples_;
  CellGrid grid_;
  CellOrder table_;
};

}  // namespace spume
