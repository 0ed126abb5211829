// SPDX-License-Identifier: MIT
#include "fill.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "checks.hpp"
#include "filler.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/random.hpp"

namespace spume {
namespace {

constexpr double most_particles = 2147483648.0;  // 2^31: particles are numbered by int32

std::string point_in_words(const Vec3& p, int dimensions) {
  std::string words = "(";
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a)
    words.append(a ? ", " : "").append(brief(p[a]));
  return words.append(")");
}

}  // namespace

void Filler::report(const std::vector<std::vector<Chunk>>& chunks) {
  const int dimensions = lattice_.dimensions;
  std::map<std::pair<std::size_t, std::size_t>, Finding> overlaps;
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    const LiquidRegion& region = regions_[r];
    std::size_t count = 0;
    Finding not_finite, beyond_top, in_solid, replaced;
    for (const Chunk& chunk : chunks[r]) {
      count += chunk.position[0].size();
      for (const auto& [target, source] :
           {std::pair{&not_finite, &chunk.not_finite}, std::pair{&beyond_top, &chunk.beyond_top},
            std::pair{&in_solid, &chunk.in_solid}, std::pair{&replaced, &chunk.replaced}}) {
        if (source->count > 0) target->add(source->first, source->count);
      }
      for (const auto& [q, finding] : chunk.overlap) {
        overlaps[{std::max(q, r), std::min(q, r)}].add(finding.first, finding.count);
      }
    }
    const Node& node = *region.node;
    if (not_finite.count > 0) {
      problems_.add(*node.find("where"), region.name + ".where is not finite at " +
                                             point_in_words(not_finite.first, dimensions) +
                                             "; it must have a finite value everywhere in the region's box");
    } else if (beyond_top.count > 0) {
      problems_.add(node, region.name + ".where is still positive at the top, at " +
                              point_in_words(beyond_top.first, dimensions) +
                              "; conform needs the surface below the top: raise the domain, or remove conform");
    } else if (count == 0) {
      problems_.add(node, region.name + (replaced.count > 0 ? " is empty: later regions replace all of it"
                                         : in_solid.count > 0 || lies_in_solids(region)
                                             ? " is empty: all of its particles lie inside solids"
                                             : " is empty: it holds no particle; check its limits against the domain "
                                               "and the spacing " +
                                                   brief(scene_.spacing)));
    }
  }
  for (const auto& [pair, finding] : overlaps) {
    problems_.add(*regions_[pair.first].node,
                  regions_[pair.first].name + " overlaps " + regions_[pair.second].name + ": " +
                      std::to_string(finding.count) + (finding.count == 1 ? " particle lies" : " particles lie") +
                      " in both, the first at " + point_in_words(finding.first, dimensions) +
                      "; change one so that they only touch");
  }
}

// Particles share one volume: that of all regions over their number. Columns that conform each round for themselves, by
// half a layer at most, which evens out below a wave (6e-4 of the volume of breaking_wave at 1/50) and not where all
// are of one depth. Phases share the sites of the lattice, whose cells are the volumes.
void Filler::set_volume(const std::vector<std::vector<Chunk>>& chunks) {
  InitialParticles& particles = scene_.particles;
  particles.volume = lattice_.volume();
  double total = 0, count = 0;
  bool conform = false;
  scene_.fills.resize(layered() ? scene_.phases.size() : regions_.size());
  for (std::size_t n = 0; n < scene_.phases.size() && layered(); ++n) scene_.fills[n].name = scene_.phases[n].name;
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    RegionFill& fill = layered() ? scene_.fills[static_cast<std::size_t>(regions_[r].phase)] : scene_.fills[r];
    if (!layered()) fill = {.name = regions_[r].name, .flat = is_box(regions_[r])};
    double cells = 0, open_cells = 0;
    for (const Chunk& chunk : chunks[r]) {
      fill.asked += chunk.volume * lattice_.volume();
      fill.particles += chunk.position[0].size();
      cells += chunk.cells;
      open_cells += chunk.open_cells;
    }
    if (cells > 0) fill.asked *= open_cells / cells;  // less what walls of bodies take of the region
    total += fill.asked;
    count += static_cast<double>(fill.particles);
    conform = conform || regions_[r].conform;
  }
  const double ratio = total / (count * lattice_.volume());
  if (!layered() && count > 0 && std::abs(ratio - 1) > (conform ? 1e-3 : 1e-9)) particles.volume *= ratio;
  for (RegionFill& fill : scene_.fills) fill.got = static_cast<double>(fill.particles) * particles.volume;
}

// Whether nothing but air lies within a spacing around some particles of a region.
bool Filler::stands_alone(std::size_t r, const std::vector<std::vector<Chunk>>& chunks) const {
  if (!scene_.walls.empty()) return false;
  const auto dimensions = static_cast<std::size_t>(lattice_.dimensions);
  const auto extent_of = [&](std::size_t region) {
    std::array<std::pair<double, double>, 3> extent{};
    for (std::size_t a = 0; a < dimensions; ++a) {
      extent[a] = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
      for (const Chunk& chunk : chunks[region])
        for (const double x : chunk.position[a])
          extent[a] = {std::min(extent[a].first, x), std::max(extent[a].second, x)};
    }
    return extent;
  };
  const auto own = extent_of(r);
  const auto apart = [&](auto&& lower, auto&& upper) {
    for (std::size_t a = 0; a < dimensions; ++a)
      if (own[a].first - 2 * lattice_.spacing[a] > upper(a) || own[a].second + 2 * lattice_.spacing[a] < lower(a))
        return true;
    return false;
  };
  for (std::size_t a = 0; a < dimensions; ++a)
    for (int side = 0; side < 2; ++side) {
      if (!scene_.domain.sides[a][side].bounds_liquid()) continue;
      const double gap = side == 0 ? own[a].first - scene_.domain.lower[a] : scene_.domain.upper[a] - own[a].second;
      if (gap < 1.5 * lattice_.spacing[a]) return false;
    }
  for (const SolidBox& box : scene_.domain.boxes)
    if (!apart([&](std::size_t a) { return box.lower[a]; }, [&](std::size_t a) { return box.upper[a]; })) return false;
  for (std::size_t q = 0; q < regions_.size(); ++q) {
    if (q == r) continue;
    const auto other = extent_of(q);
    if (!apart([&](std::size_t a) { return other[a].first; }, [&](std::size_t a) { return other[a].second; }))
      return false;
  }
  return true;
}

// Sites of the lattice whose particles have another volume than its cells are drawn together or apart about their
// centre where they touch nothing: else the number density, 0.6 % off in a drop with a radius of 10 spacings, evens out
// in the first steps; central_force_drop then loses 3.4 % of its energy, in place of 1.8 %. Boxes have columns of their
// volume.
void Filler::fit_lattice(const std::vector<std::vector<Chunk>>& chunks) {
  InitialParticles& particles = scene_.particles;
  const double stretch = std::pow(particles.volume / lattice_.volume(), 1.0 / lattice_.dimensions);
  if (layered() || stretch == 1) return;
  for (std::size_t r = 0, first = 0; r < regions_.size(); ++r) {
    std::size_t count = 0;
    for (const Chunk& chunk : chunks[r]) count += chunk.position[0].size();
    const std::size_t begin = first, end = first += count;
    if (count == 0 || is_box(regions_[r]) || regions_[r].conform || !stands_alone(r, chunks)) continue;
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
      Array<double>& x = particles.position[a];
      double centre = 0;
      for (std::size_t i = begin; i < end; ++i) centre += x[i] / static_cast<double>(count);
      parallel_for(count, [&](std::size_t i) { x[begin + i] = centre + stretch * (x[begin + i] - centre); });
    }
  }
}

void Filler::gather(const std::vector<std::vector<Chunk>>& chunks) {
  std::vector<const Chunk*> all;
  std::vector<std::size_t> start{0};
  std::vector<std::int32_t> region;
  for (std::size_t r = 0; r < chunks.size(); ++r) {
    for (const Chunk& chunk : chunks[r]) {
      all.push_back(&chunk);
      start.push_back(start.back() + chunk.position[0].size());
      region.push_back(static_cast<std::int32_t>(r));
    }
  }
  InitialParticles& particles = scene_.particles;
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
    particles.position[a].resize(start.back());
    particles.velocity[a].resize(start.back());
  }
  particles.region.resize(start.back());
  if (layered()) particles.phase.resize(start.back());
  set_volume(chunks);
  parallel_blocks(all.size(), 1, [&](std::size_t c, std::size_t, std::size_t) {
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
      std::copy(all[c]->position[a].begin(), all[c]->position[a].end(), particles.position[a].data() + start[c]);
    }
    std::fill(particles.region.data() + start[c], particles.region.data() + start[c + 1], region[c]);
    if (layered())
      std::fill(particles.phase.data() + start[c], particles.phase.data() + start[c + 1],
                regions_[static_cast<std::size_t>(region[c])].phase);
  });
  fit_lattice(chunks);
}

// Each coordinate moves by up to `fraction` of the spacing either way. Walls and solids are not crossed.
void Filler::jitter(double fraction) {
  InitialParticles& particles = scene_.particles;
  parallel_for(particles.size(), [&](std::size_t i) {
    const auto random = random_uniform(scene_.seed, RandomPurpose::initial_jitter, i, 0, 0);
    Vec3 moved{};
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
      const double lower = scene_.domain.lower[a], upper = scene_.domain.upper[a], d = lattice_.spacing[a];
      double q = particles.position[a][i] + fraction * d * (2 * random[a] - 1);
      if (scene_.domain.periodic(static_cast<int>(a))) {
        if (q < lower) q += upper - lower;
        if (q >= upper) q -= upper - lower;
      } else {
        const double gap = 1e-3 * d;
        if (scene_.domain.sides[a][0].bounds_liquid()) q = std::max(q, lower + gap);
        if (scene_.domain.sides[a][1].bounds_liquid()) q = std::min(q, upper - gap);
      }
      moved[a] = q;
    }
    if (in_solid(moved)) return;
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) particles.position[a][i] = moved[a];
  });
}

void Filler::set_velocities() {
  bool moving = false;
  for (const LiquidRegion& region : regions_) {
    for (const auto& component : region.velocity.component) moving = moving || component;
  }
  if (!moving) return;
  InitialParticles& particles = scene_.particles;
  const std::size_t dimensions = static_cast<std::size_t>(lattice_.dimensions);
  std::vector<Finding> not_finite(regions_.size() * block_count(particles.size(), default_block));
  parallel_blocks(particles.size(), default_block, [&](std::size_t block, std::size_t first, std::size_t last) {
    ThreadRegions& own = this->own();
    for (std::size_t i = first; i < last; ++i) {
      const auto r = static_cast<std::size_t>(particles.region[i]);
      Vec3 p{};
      for (std::size_t a = 0; a < dimensions; ++a) p[a] = particles.position[a][i];
      const Vec3 velocity = own.velocity[r](p, 0);
      bool finite = true;
      for (std::size_t a = 0; a < dimensions; ++a) {
        particles.velocity[a][i] = velocity[a];
        finite = finite && std::isfinite(velocity[a]);
      }
      if (!finite) not_finite[block * regions_.size() + r].add(p);
    }
  });
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    for (std::size_t k = r; k < not_finite.size(); k += regions_.size()) {
      if (not_finite[k].count == 0) continue;
      problems_.add(*regions_[r].node, regions_[r].name + ".velocity is not finite at " +
                                           point_in_words(not_finite[k].first, lattice_.dimensions));
      break;
    }
  }
}

// Whether walls of bodies cover a side of the domain: no liquid reaches it.
bool Filler::behind_walls(std::size_t axis, int side) const {
  if (scene_.walls.empty()) return false;
  const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
  const auto columns = static_cast<std::size_t>(lattice_.count[b]), rows = static_cast<std::size_t>(lattice_.count[c]);
  return parallel_max(columns * rows, 0.0, [&](std::size_t k) {
           const std::size_t column = k % columns, row = k / columns;
           Vec3 p{};
           p[axis] = side == 0 ? scene_.domain.lower[axis] : scene_.domain.upper[axis];
           p[b] = b < static_cast<std::size_t>(lattice_.dimensions) ? centre(b, static_cast<double>(column)) : 0;
           p[c] = c < static_cast<std::size_t>(lattice_.dimensions) ? centre(c, static_cast<double>(row)) : 0;
           return scene_.walls.distance(p) > 0.5 * scene_.spacing ? 1.0 : 0.0;
         }) == 0;
}

// Of the domain, outside the walls of bodies.
double Filler::open_volume() const {
  const auto columns = static_cast<std::size_t>(lattice_.count[0]), rows = static_cast<std::size_t>(lattice_.count[1]);
  const auto layers = static_cast<std::size_t>(lattice_.count[2]);
  return lattice_.volume() * parallel_sum(rows * layers, [&](std::size_t row) {
           const std::size_t layer = row / rows;
           ThreadRegions own(regions_, wall_distance());
           double cells = 0;
           for (std::size_t i = 0; i < columns; ++i) {
             const Vec3 p{centre(0, static_cast<double>(i)), centre(1, static_cast<double>(row % rows)),
                          lattice_.dimensions == 3 ? centre(2, static_cast<double>(layer)) : 0.0};
             cells += open_part(own, p);
           }
           return cells;
         });
}

bool Filler::fills_domain() const {
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
    for (int side = 0; side < 2; ++side)
      if (!scene_.domain.sides[a][side].bounds_liquid() && !behind_walls(a, side)) return false;
  }
  for (const LiquidRegion& region : regions_) {
    if (region.conform) return false;
  }
  if (!layered()) {
    double domain = 1, filled = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a)
      domain *= scene_.domain.upper[a] - scene_.domain.lower[a];
    if (solids_ != nullptr) domain = solids_->free_volume(scene_.domain.lower, scene_.domain.upper);
    for (const RegionFill& fill : scene_.fills) filled += fill.asked;
    // Bodies cut the cells of the lattice, by which both are counted, each off by a part of its own.
    if (!scene_.walls.empty()) return open_volume() - filled < 1e-3 * filled + 0.5 * lattice_.volume();
    return domain - filled < 0.5 * lattice_.volume();
  }
  const double missing = lattice_.sites() - static_cast<double>(scene_.particles.size());
  // Solids are counted site by site, which pays only where they could make up for what is missing.
  if (missing > most_particles) return false;
  double in_solids = 0;
  if (missing > 0 && (!scene_.domain.boxes.empty() || !scene_.walls.empty())) {
    const std::size_t planes = static_cast<std::size_t>(lattice_.count[0]);
    std::vector<double> per_plane(planes);
    parallel_blocks(planes, 1, [&](std::size_t i, std::size_t, std::size_t) {
      ThreadRegions own(regions_, wall_distance());
      Vec3 p{centre(0, static_cast<double>(i)), 0, 0};
      for (double j = 0; j < lattice_.count[1]; ++j) {
        p[1] = centre(1, j);
        for (double k = 0; k < lattice_.count[2]; ++k) {
          p[2] = lattice_.dimensions == 3 ? centre(2, k) : 0;
          per_plane[i] += in_solid(p) || !is_open_site(own, p);
        }
      }
    });
    for (const double count : per_plane) in_solids += count;
  }
  return missing == in_solids;
}

void fill_scene(Scene& scene, const Lattice& lattice, const std::vector<LiquidRegion>& regions, double jitter,
                double most, Problems& problems) {
  double sites = 0, certain = 0;
  for (const LiquidRegion& region : regions) {
    double cells = 1;
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimensions); ++a) {
      double length = region.upper[a] - region.lower[a];
      if (region.ball) length = std::min(length, 2 * region.radius);
      cells *= std::max(1.0, length / lattice.spacing[a]);
    }
    sites += cells;
    // What phases replace counts once.
    const bool layered = region.phase >= 0;
    if (!region.where && !region.ball && !region.body && scene.domain.boxes.empty())
      certain = layered ? std::max(certain, cells) : certain + cells;
  }
  if (regions.front().phase >= 0) sites = std::min(sites, lattice.sites());
  if (!(sites <= most_particles) || !(lattice.sites() <= 1e15)) {
    problems.add(*regions.front().node, "the liquid regions hold up to " + brief(sites) + " particles at spacing " +
                                            brief(scene.spacing) +
                                            "; at most 2^31 are possible: enlarge the spacing or shrink the regions");
    return;
  }
  Filler filler(scene, lattice, regions, most, problems);
  if (certain > most || !filler.place_particles()) {
    problems.add(*regions.front().node, "the liquid regions hold more particles at spacing " + brief(scene.spacing) +
                                            " than the " + brief(most) +
                                            " for which this machine has memory: enlarge the spacing or shrink the "
                                            "regions");
    return;
  }
  if (!problems.empty()) return;
  if (jitter > 0) filler.jitter(jitter);
  filler.set_velocities();
  scene.free_surface = !filler.fills_domain();
}

}  // namespace spume
