// SPDX-License-Identifier: MIT
// The liquid continued into bodies, for what a free surface counts: div r, its normal and its depth beside a body.
//
// Wall points with values (particles/body_walls.hpp) stand for liquid mirrored at a wall. At a wall that does not meet
// the surface at a right angle the mirrored surface has a kink, which turns the normals of particles beside it, and
// points are there or not as a whole: still water reached 0.1 sqrt(g H) around a ball in its surface. Here every wall
// point g counts with the share w_g of its volume that lies below the surface, continued from the surface particles j
// that see no body: a plane through x_j + s_j n_j of normal n_j for each,
//
//   w_g = sum_j W_gj min(1, max(0, 1/2 - z_gj)) / sum_j W_gj,   z_gj = (r_g - x_j - s_j n_j) . n_j / dr,
//
// with a kernel of 2.2 support radii. Where no such particle is near, in a gap between two bodies, wet points count
// whole. Normals and depths of particles that see a body take no part: found in turns with w_g they tend to the kink.
#pragma once

#include <span>
#include <vector>

#include "spume/operators/sph_operators.hpp"
#include "spume/operators/surface_layers.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/moments.hpp"

namespace spume {

class ContinuedLiquid {
 public:
  // `interior`: near the surface are particles of a weight below 1. `resolution` outlives this.
  ContinuedLiquid(const Resolution& resolution, const InteriorWeight& interior)
      : resolution_(resolution), interior_(interior) {}

  // For particles that see a body and one near the surface, by the moments as they are: writes div r to `counted`,
  // replaces their outward normals, and finds depths().
  void find(const Arrangement& arrangement, MomentFields& moments, const Boundary& boundary, const VectorField& at,
            Array<float>& counted);
  std::span<const KnownDepth> depths() const { return depths_; }
  // Whether wall points that particle i sees were counted by planes, and by less than their whole: planes reach eight
  // spacings down, where all of what they count lies below the surface.
  bool sees_planes(std::size_t i) const { return sees_planes_[i] != 0; }
  bool sees_surface(std::size_t i) const { return sees_surface_[i] != 0; }
  // Whether the particles around i, without wall points, are fewer than three quarters of a layer one particle thick:
  // spray. Wall points, there as soon as a particle is near the wall, make up for the neighbours that a corrected
  // gradient needs, and with p > 0 between neighbours that hold p = 0 it pulls the particle towards them or into the
  // wall, the faster the higher p. At the back of a weir such particles reached 28 m/s where the water falls with 2.6.
  bool is_sparse(std::size_t i) const { return sparse_[i] != 0; }

  double bytes() const;

 private:
  struct Plane {
    Vec3 place{}, normal{};
  };
  struct Count {
    double divergence_of_position = 0;
    Vec3 normal{};  // outward, times h
    double depth = 0;
    double of_particles = 0;  // div r without wall points
    bool sees_planes = false, sees_surface = false;
  };
  const WallPoint& sorted_point(const Boundary& boundary, std::size_t sorted) const;
  void sort_points(const Boundary& boundary);
  template <int dimensions>
  void find_planes(const Arrangement& arrangement, const MomentFields& moments, const Boundary& boundary,
                   const VectorField& at);
  template <int dimensions, class Kernel>
  void find_shares(const Arrangement& arrangement, const Boundary& boundary);
  template <int dimensions, class Kernel>
  void count(const Arrangement& arrangement, const Boundary& boundary, const VectorField& at);

  const Resolution& resolution_;
  const InteriorWeight interior_;
  // Wall points in the order of cells of their own, and what they count with.
  CellGrid grid_;
  CellOrder table_;
  std::vector<Vec3> point_;
  Array<std::uint8_t> continued_;                            // 1 where w_g follows from planes
  Array<std::uint8_t> sees_planes_, sees_surface_, sparse_;  // of particles
  Array<float> share_;                                       // w_g
  Array<std::int32_t> planar_;                               // particles with a plane
  std::vector<Plane> plane_;
  std::array<Array<double>, 3> plane_place_;
  CellOrder plane_table_;  // of the planes, by the cells of their particles
  Array<std::int32_t> beside_;
  std::vector<Count> count_;
  std::vector<KnownDepth> depths_;
};

}  // namespace spume
