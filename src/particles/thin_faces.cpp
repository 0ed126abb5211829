// SPDX-License-Identifier: MIT
#include "thin_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/near_particles.hpp"

namespace spume {
namespace {

// Spacings: around an edge, where its faces are looked for.
constexpr double around_edge = 0.3;
// Of the cosine of two normals: those of one face, next to each other.
constexpr double same_face = 0.94;
// Spacings between samples of a face that are next to each other: they stand one apart, at edges by up to a half more.
constexpr double next_to = 1.6;
// Of the sine of the angle between samples and the plane of a face through one of them.
constexpr double in_plane = 1e-3;
// Spacings inside the surface, where normals are those of faces.
constexpr double inside = 0.05;
// Of the cosine of a normal from itself.
constexpr double same_normal = 1 - 1e-6;
// Spacings that a way to a sample ends before it, and how deep in a body it may lead past edges.
constexpr double before_sample = 0.1, past_edges = 0.05;
constexpr int places_of_way = 12;
// A point is seen through a face by ways that enter within 45 degrees of its normal, where no other face is nearer.
constexpr double of_face = 0.7;

}  // namespace

ThinFaces::Sample ThinFaces::sampled(std::size_t body, const NearestPoint& near) const {
  const Vec3 within = subtract(near.point, multiply(inside * spacing_, near.normal));
  return {body, near.point, bodies_[body].solid->nearest(within).normal};
}

// The faces that meet at an edge may be narrower than a spacing.
void ThinFaces::look_around(std::size_t body, const Vec3& edge, std::vector<Sample>& found) const {
  const double radius = around_edge * spacing_;
  std::vector<Sample> faces;
  const auto look = [&](const Vec3& way) {
    const NearestPoint near = bodies_[body].solid->nearest(add(edge, multiply(radius, way)));
    if (length(subtract(near.point, edge)) < 0.3 * radius) return;
    const Sample sample = sampled(body, near);
    if (std::none_of(faces.begin(), faces.end(),
                     [&](const Sample& f) { return dot(f.normal, sample.normal) > same_face; }))
      faces.push_back(sample);
  };
  constexpr int ways = 48, rings = 12;
  for (int k = 0; k < ways; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / ways;
    if (domain_.dimensions == 2) {
      look({std::cos(angle), std::sin(angle), 0});
      continue;
    }
    for (int ring = 0; ring < rings; ++ring) {
      const double z = (2 * ring + 1.0) / rings - 1, across = std::sqrt(1 - z * z);
      look({across * std::cos(angle), across * std::sin(angle), z});
    }
  }
  found.insert(found.end(), faces.begin(), faces.end());
}

void ThinFaces::sample(std::size_t body, const std::vector<Vec3>& places) {
  std::vector<std::vector<Sample>> found(places.size());
  parallel_for(places.size(), [&](std::size_t i) {
    const NearestPoint near = bodies_[body].solid->nearest(places[i]);
    const Sample sample = sampled(body, near);
    if (dot(sample.normal, near.normal) > same_normal)
      found[i].push_back(sample);
    else
      look_around(body, near.point, found[i]);
  });
  for (const auto& some : found) samples_.insert(samples_.end(), some.begin(), some.end());
}

void ThinFaces::sort() {
  const std::size_t d = static_cast<std::size_t>(domain_.dimensions);
  Vec3 lower{}, upper{};
  std::array<std::vector<double>, 3> x;
  for (std::size_t axis = 0; axis < d; ++axis) {
    lower[axis] = domain_.lower[axis] - reach_;
    upper[axis] = domain_.upper[axis] + reach_;
    for (const Sample& sample : samples_) x[axis].push_back(sample.point[axis]);
  }
  grid_ = CellGrid(domain_.dimensions, lower, upper, reach_ + spacing_, samples_.size());
  table_.build(grid_, x[0].data(), x[1].data(), d == 3 ? x[2].data() : nullptr, samples_.size());
}

std::vector<ThinFaces::Sample> ThinFaces::near_samples(const Vec3& place) const {
  std::vector<Sample> near;
  const double farthest = reach_ + spacing_;  // samples stand up to that from the end of a face
  visit_near(domain_, grid_, table_, place, farthest, [&](std::int32_t k, const Vec3& shift) {
    Sample sample = samples_[static_cast<std::size_t>(table_.order()[static_cast<std::size_t>(k)])];
    sample.point = add(sample.point, shift);
    if (length(subtract(sample.point, place)) < farthest) near.push_back(sample);
  });
  return near;
}

bool ThinFaces::sees(const Vec3& place, const Sample& sample) const {
  const Vec3 end = add(sample.point, multiply(before_sample * spacing_, sample.normal));
  for (int k = 1; k <= places_of_way; ++k) {
    const double share = static_cast<double>(k) / places_of_way;
    if (walls_.distance(add(multiply(1 - share, place), multiply(share, end))) < -past_edges * spacing_) return false;
  }
  return true;
}

std::vector<ThinFaces::Face> ThinFaces::around(std::size_t body, const Vec3& place, const NearestPoint& near) const {
  Face own{body, near.point, near.normal, false, false, of_face, {}};
  const bool before_face = dot(sampled(body, near).normal, near.normal) > same_normal;
  std::vector<Sample> samples = near_samples(place);
  const auto is_plain = [&](const Sample& s) {
    const double cosine = dot(s.normal, near.normal);
    return s.body == body &&
           (cosine > same_face || (cosine < -same_face && dot(subtract(place, s.point), s.normal) < 0));
  };
  if (std::all_of(samples.begin(), samples.end(), is_plain) && before_face) {
    own.flat = std::all_of(samples.begin(), samples.end(), [&](const Sample& s) {
      const double cosine = dot(s.normal, near.normal);
      return cosine < 0 ||
             (cosine > same_normal && std::abs(dot(subtract(s.point, near.point), near.normal)) < in_plane * spacing_);
    });
    return {own};
  }

  // Faces, by links of one sample to the next.
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> face_of(samples.size(), none), pending;
  std::size_t faces = 0;
  const auto linked = [&](const Sample& a, const Sample& b) {
    const double cosine = dot(a.normal, b.normal);
    if (a.body != b.body || cosine < same_face) return false;
    const Vec3 way = subtract(b.point, a.point);
    return length(way) < next_to * spacing_ ||
           (cosine > same_normal && std::abs(dot(way, a.normal)) < in_plane * spacing_);
  };
  for (std::size_t first = 0; first < samples.size(); ++first) {
    if (face_of[first] != none) continue;
    face_of[first] = faces;
    pending.assign(1, first);
    while (!pending.empty()) {
      const std::size_t at = pending.back();
      pending.pop_back();
      for (std::size_t next = 0; next < samples.size(); ++next)
        if (face_of[next] == none && linked(samples[at], samples[next])) {
          face_of[next] = faces;
          pending.push_back(next);
        }
    }
    ++faces;
  }
  // The plane of each: that of its sample nearest to the place.
  std::vector<Face> all;
  for (std::size_t f = 0; f < faces; ++f) {
    Face face;
    bool seen = false;
    double least = infinite;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (face_of[k] != f) continue;
      face.samples.push_back(samples[k].point);
      if (const double away = length(subtract(samples[k].point, place)); away < least) {
        least = away;
        face.body = samples[k].body;
        face.point = samples[k].point;
        face.normal = samples[k].normal;
      }
      seen = seen || sees(place, samples[k]);
    }
    const bool is_own = before_face && face.body == body && dot(face.normal, near.normal) > same_face &&
                        length(subtract(face.point, near.point)) < next_to * spacing_;
    if (is_own) {
      face.point = near.point;
      face.normal = near.normal;
    }
    if (!(dot(subtract(place, face.point), face.normal) > 0) || !(seen || is_own)) continue;
    face.beside_edge = true;
    face.least_cosine = of_face;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (face_of[k] == f) continue;
      const double cosine = std::max(dot(samples[k].normal, face.normal), -1.0);
      if (cosine > same_face) continue;  // no ways tell it from this one
      face.least_cosine = std::max(face.least_cosine, std::sqrt((1 + cosine) / 2));
    }
    all.push_back(face);
    if (is_own) std::swap(all.front(), all.back());
  }
  if (all.empty() && before_face) all.push_back(own);
  return all;
}

}  // namespace spume
