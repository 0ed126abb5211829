// SPDX-License-Identifier: MIT
// Pools of a few particles that bodies close off with each other and the sides of the domain: no fit knows a pressure
// there, and still water in pools of one to three particles moved at 0.1 to 3 sqrt(gH). They are left empty.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "filler.hpp"
#include "slots.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

// Particles of the smallest pool that is filled: as many as a linear fit takes (operators/moving_least_squares.hpp).
constexpr std::size_t fewest_2d = 7, fewest_3d = 9;
// Spacings: between neighbours; from the walls to particles that are in no small pool; to whatever such see.
constexpr double next_to = 1.6, far_from_walls = 1, seen_from_walls = 3;
constexpr double along_way = 0.1;           // spacings, between places of a way that are looked at
constexpr double room = 0.4, taken = 0.95;  // spacings: around a place that a particle may stand in, and stands in

// Particles by cells of a neighbour's distance, in their order.
class NearTable {
 public:
  NearTable(const InitialParticles& particles, std::vector<std::size_t> chosen, double reach, int dimensions)
      : particles_(particles), reach_(reach), dimensions_(dimensions) {
    for (const std::size_t i : chosen) entries_.push_back({key(cell_of(place(i))), i});
    std::sort(entries_.begin(), entries_.end());
  }
  Vec3 place(std::size_t i) const {
    Vec3 r{};
    for (int axis = 0; axis < dimensions_; ++axis) r[axis] = particles_.position[axis][i];
    return r;
  }
  // use(j): those nearer to a place than the reach, until one is true.
  template <class Use>
  bool any_near(const Vec3& at, const Use& use) const {
    const std::array<std::int64_t, 3> middle = cell_of(at);
    const std::int64_t deep = dimensions_ == 3 ? 1 : 0;
    for (std::int64_t a = -1; a <= 1; ++a)
      for (std::int64_t b = -1; b <= 1; ++b)
        for (std::int64_t c = -deep; c <= deep; ++c) {
          const std::uint64_t own = key({middle[0] + a, middle[1] + b, middle[2] + c});
          for (auto e = std::lower_bound(entries_.begin(), entries_.end(), std::pair{own, std::size_t{0}});
               e != entries_.end() && e->first == own; ++e)
            if (length(subtract(place(e->second), at)) < reach_ && use(e->second)) return true;
        }
    return false;
  }

 private:
  std::array<std::int64_t, 3> cell_of(const Vec3& at) const {
    std::array<std::int64_t, 3> cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) cell[axis] = static_cast<std::int64_t>(std::floor(at[axis] / reach_));
    return cell;
  }
  static std::uint64_t key(const std::array<std::int64_t, 3>& cell) {
    std::uint64_t sum = 0;
    for (const std::int64_t k : cell) sum = sum << 21 | (static_cast<std::uint64_t>(k) & 0x1fffff);
    return sum;
  }
  const InitialParticles& particles_;
  double reach_;
  int dimensions_;
  std::vector<std::pair<std::uint64_t, std::size_t>> entries_;
};

}  // namespace

// Whether a straight way is before the walls and through no slot.
bool Filler::is_open_way(const Vec3& from, const Vec3& to) const {
  const Vec3 way = subtract(to, from);
  const double pieces = std::ceil(length(way) / (along_way * scene_.spacing));
  for (double k = 0; k <= pieces; ++k) {
    const Vec3 at = scene_.domain.inside(add(from, multiply(k / pieces, way)));
    const double distance = scene_.walls.distance(at);
    if (!(distance > 0)) return false;
    if (distance < too_narrow * scene_.spacing && slot_at(scene_.walls, scene_.domain, at, too_narrow * scene_.spacing))
      return false;
  }
  return true;
}

// Whether a place a spacing from a particle has room, is seen from it, and is outside the domain or taken by nobody.
bool Filler::is_bare(const Vec3& from, const Vec3& to, const std::vector<Vec3>& pool) const {
  const double spacing = scene_.spacing;
  for (int axis = 0; axis < lattice_.dimensions; ++axis)
    for (std::size_t end = 0; end < 2; ++end) {
      const double before = end == 0 ? to[axis] - scene_.domain.lower[axis] : scene_.domain.upper[axis] - to[axis];
      const BoundaryKind kind = scene_.domain.sides[axis][end].kind;
      if (kind != BoundaryKind::free_slip && kind != BoundaryKind::no_slip) {
        if (before < 0) return true;
      } else if (before < room * spacing) {
        return false;
      }
    }
  const auto takes = [&](const Vec3& other) { return length(subtract(other, to)) < taken * spacing; };
  return scene_.walls.distance(to) >= room * spacing && std::none_of(pool.begin(), pool.end(), takes) &&
         is_open_way(from, to);
}

bool Filler::is_closed(const std::vector<Vec3>& pool) const {
  const int deep = lattice_.dimensions == 3 ? 1 : 0;
  for (const Vec3& at : pool)
    for (int a = -1; a <= 1; ++a)
      for (int b = -1; b <= 1; ++b)
        for (int c = -deep; c <= deep; ++c) {
          if (a == 0 && b == 0 && c == 0) continue;
          const Vec3 way{static_cast<double>(a), static_cast<double>(b), static_cast<double>(c)};
          if (is_bare(at, add(at, multiply(scene_.spacing / length(way), way)), pool)) return false;
        }
  return true;
}

void Filler::leave_out_small_pools() {
  InitialParticles& particles = scene_.particles;
  const std::size_t n = particles.size();
  const double spacing = scene_.spacing;
  const std::size_t fewest = lattice_.dimensions == 3 ? fewest_3d : fewest_2d;
  std::vector<double> distance(n);
  parallel_blocks(n, default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    ThreadRegions& own = this->own();
    for (std::size_t i = first; i < last; ++i) {
      Vec3 r{};
      for (int axis = 0; axis < lattice_.dimensions; ++axis) r[axis] = particles.position[axis][i];
      distance[i] = own.walls.at(r);
    }
  });
  std::vector<std::size_t> beside;
  for (std::size_t i = 0; i < n; ++i)
    if (distance[i] < seen_from_walls * spacing) beside.push_back(i);
  const NearTable table(particles, beside, next_to * spacing, lattice_.dimensions);
  enum : std::uint8_t { unknown, open, seen };
  std::vector<std::uint8_t> state(n, open);
  // Balls that no wall is in cover the way to a particle far from walls.
  for (const std::size_t i : beside) {
    const Vec3 own = table.place(i);
    const bool covered = distance[i] >= far_from_walls * spacing || table.any_near(own, [&](std::size_t j) {
      return distance[j] >= far_from_walls * spacing &&
             distance[i] + far_from_walls * spacing > length(subtract(table.place(j), own));
    });
    if (!covered) state[i] = unknown;
  }
  Finding left;
  std::vector<std::uint8_t> out(n, 0);
  for (const std::size_t start : beside) {
    if (state[start] != unknown) continue;
    std::vector<std::size_t> pool{start};
    state[start] = seen;
    bool is_open = false;
    for (std::size_t k = 0; k < pool.size() && !is_open; ++k) {
      const Vec3 own = table.place(pool[k]);
      is_open = table.any_near(own, [&](std::size_t j) {
        if (state[j] == seen || !is_open_way(own, table.place(j))) return false;
        if (state[j] == open) return true;
        state[j] = seen;
        pool.push_back(j);
        return false;
      });
    }
    std::vector<Vec3> places;
    for (const std::size_t i : pool) places.push_back(table.place(i));
    const bool small = !is_open && pool.size() < fewest && is_closed(places);
    for (const std::size_t i : pool) {
      state[i] = open;
      if (!small) continue;
      out[i] = 1;
      left.add(table.place(i));
    }
  }
  if (left.count == 0) return;
  take_out(out);
  std::string place = "(" + brief(left.first[0]);
  for (std::size_t axis = 1; axis < static_cast<std::size_t>(lattice_.dimensions); ++axis)
    place += ", " + brief(left.first[axis]);
  problems_.warn(*regions_.front().node,
                 std::to_string(left.count) + (left.count == 1 ? " particle, at " : " particles, the first at ") +
                     place + "), in pools of fewer than " + std::to_string(fewest) +
                     " that bodies close off, left out: too few to tell a pressure; refine resolution.spacing, or move "
                     "the bodies apart or together");
}

void Filler::take_out(const std::vector<std::uint8_t>& out) {
  InitialParticles& particles = scene_.particles;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i] != 0) {
      --scene_.fills[static_cast<std::size_t>(particles.region[i])].particles;
      continue;
    }
    for (auto* vectors : {&particles.position, &particles.velocity})
      for (Array<double>& component : *vectors)
        if (i < component.size()) component[kept] = component[i];
    particles.region[kept] = particles.region[i];
    ++kept;
  }
  for (auto* vectors : {&particles.position, &particles.velocity})
    for (Array<double>& component : *vectors)
      if (kept < component.size()) component.resize(kept);
  particles.region.resize(kept);
  for (RegionFill& fill : scene_.fills) fill.got = static_cast<double>(fill.particles) * particles.volume;
}

}  // namespace spume
