// SPDX-License-Identifier: MIT
// What thin bodies (particles/thin_bodies.hpp) hide: points that a straight way through one of them leads to.
//
// A way is asked for by distances at a few of its places. Balls around the ends as large as the distances there, and a
// twentieth of a spacing more, that meet leave nothing between them; else the middle is asked and then both halves. A
// middle deeper than a twentieth of a spacing in a body ends the way. So ways no deeper than a tenth of a spacing may
// pass, at edges, and none that leads through a plate a quarter of a spacing thick or more.
// Where bounds of a distance (particles/near_distances.hpp) do, it is not asked for.
//
// Behind a face stand wall points that belong to it: a particle sees one of them when the way there enters the bodies
// through a face with its normal, within 45 degrees and half of the angle to the next face. Other wall points it sees
// when it sees what they mirror, and of those that the faces of a corner turn about it when the way to them enters one
// of these faces, too: past its ends others hide them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "spume/neighbours/images.hpp"
#include "spume/neighbours/sight.hpp"
#include "spume/particles/rigid_walls.hpp"

namespace spume {

class ThinWalls final : public Sight {
 public:
  // Of the parts that have thin bodies, which outlive this.
  ThinWalls(const Scene& scene, const Resolution& resolution, std::vector<const RigidWalls*> parts);

  const std::vector<const RigidWalls*>& parts() const { return parts_; }
  // Sides of the domain: bodies are mirrored and repeated at them as the liquid is.
  void set_sides(const ImageRules& rules);

  // From the thin bodies where they are now; infinite where it is surely more than twice the reach of measure().
  double distance(const Vec3& place) const;
  NearDistances::Range range(const Vec3& place) const;  // bounds of it
  double free_distance(const Vec3& place) const;        // the lower one where that tells that the place is free
  bool hides(const Vec3& from, const Vec3& to) const;
  bool hides(const Vec3& from, double from_distance, const Vec3& to, double to_distance) const;
  // Where a straight way enters a thin body.
  struct Entry {
    Vec3 place{}, normal{};
  };
  std::optional<Entry> entry(const Vec3& from, double from_distance, const Vec3& to) const;
  // Where it meets the surface of those of one part, within a thousandth of a spacing.
  std::optional<Entry> entry(const RigidWalls& part, const Vec3& from, const Vec3& to) const;

  // A wall point of that kind, or a mirror image of one, from a place within the reach of measure(); `unfolded`:
  // WallPoint::unfolded() of it.
  bool sees(const Vec3& eye, double eye_distance, const Vec3& point, const Vec3& unfolded, const WallPoint& kind) const;

  // Distances of particles as far as `reach`, and then of their images. What is given outlives the lists made with it.
  void measure(const std::array<const double*, 3>& position, std::size_t particles, double reach);
  double particle_distance(std::size_t particle) const { return distance_[particle]; }
  void measure(const Images& images, const std::vector<WallPoint>& points, const std::vector<std::int32_t>& wet);

  // Points behind a face reach out of the other side of a body by as much as a particle sees.
  bool open_around(std::size_t particle) const override { return distance_[particle] >= 2 * reach_; }
  bool sees(std::size_t particle, std::size_t point) const override;
  double bytes() const { return distance_.bytes(); }

 private:
  // A place beyond a side in the domain, and the signs of directions there.
  Vec3 folded(const Vec3& place, Vec3* sign = nullptr) const;
  NearestPoint nearest(const Vec3& place) const;
  NearestPoint nearest(const RigidWalls& part, const Vec3& place) const;
  bool hides(const Vec3& a, double da, const Vec3& b, double db, double length, int depth) const;
  bool is_behind_face(std::size_t point) const;
  bool sees_face(const Vec3& eye, double eye_distance, const Vec3& point, const Vec3& unfolded,
                 const WallPoint& kind) const;
  bool enters_between(const Vec3& eye, double eye_distance, const Vec3& point, const Vec3& mirror) const;
  Vec3 imaged(const ImagePath& path, const Vec3& place) const;
  Vec3 particle_place(std::size_t particle) const;
  Vec3 image_place(std::size_t image) const;

  std::vector<const RigidWalls*> parts_;
  ImageRules sides_;
  double spacing_, reach_;
  std::array<const double*, 3> position_{};
  std::size_t particles_ = 0;
  const Images* images_ = nullptr;
  const std::vector<WallPoint>* points_ = nullptr;
  const std::vector<std::int32_t>* wet_ = nullptr;
  Array<float> distance_;  // of particles, then images
};

}  // namespace spume
