// SPDX-License-Identifier: MIT
#include "fill.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include "checks.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/random.hpp"

namespace spume {
namespace {

// Columns per block: a block is some ten thousand evaluations, so that its bookkeeping is noise.
constexpr std::size_t column_block = 32;
// In spacings: one layer has more than four times the volume of thinner liquid.
constexpr double least_depth = 0.25;
constexpr double most_particles = 2147483648.0;  // 2^31: particles are numbered by int32

std::string point_in_words(const Vec3& p, int dimensions) {
  std::string words = "(";
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a)
    words.append(a ? ", " : "").append(brief(p[a]));
  return words.append(")");
}

// One thread's own copies of the expressions of all regions.
struct ThreadRegions {
  std::vector<std::unique_ptr<Expression>> where;
  std::vector<VectorExpression> velocity;
  explicit ThreadRegions(const std::vector<LiquidRegion>& regions) {
    for (const LiquidRegion& region : regions) {
      where.push_back(region.where ? region.where->clone() : nullptr);
      velocity.push_back(region.velocity.clone());
    }
  }
};

struct Finding {
  std::size_t count = 0;
  Vec3 first{};
  void add(const Vec3& place, std::size_t more = 1) {
    if (count == 0) first = place;
    count += more;
  }
};

// What one block of columns found, merged in block order.
struct Chunk {
  std::vector<double> position[3];
  std::map<std::size_t, Finding> overlap;  // by the other region
  Finding not_finite, beyond_top, in_solid, replaced;
};

class Filler {
 public:
  Filler(Scene& scene, const Lattice& lattice, const std::vector<LiquidRegion>& regions, double most,
         Problems& problems)
      : scene_(scene),
        lattice_(lattice),
        regions_(regions),
        most_(most),
        problems_(problems),
        threads_(static_cast<std::size_t>(thread_count())) {}

  // False when there are more than allowed: what was found until then is dropped.
  bool place_particles() {
    std::vector<std::vector<Chunk>> chunks;
    for (std::size_t r = 0; r < regions_.size(); ++r) chunks.push_back(fill_region(r));
    if (too_many()) return false;
    report(chunks);
    gather(chunks);
    return true;
  }

  void jitter(double fraction);
  void set_velocities();
  bool fills_domain() const;

 private:
  // Regions of phases lie on each other, the later above.
  bool layered() const { return regions_.front().phase >= 0; }

  bool too_many() const { return static_cast<double>(found_.load()) > most_; }

  ThreadRegions& own() {
    auto& regions = threads_[static_cast<std::size_t>(omp_get_thread_num())];
    if (!regions) regions = std::make_unique<ThreadRegions>(regions_);
    return *regions;
  }

  double centre(std::size_t axis, double k) const { return lattice_.origin[axis] + (k + 0.5) * lattice_.spacing[axis]; }

  bool in_box_and_ball(const LiquidRegion& region, const Vec3& p) const {
    double distance = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
      // Half-open, so that regions that share a face share no particle; the slack keeps a face that falls on
      // cell centres from splitting a layer by rounding.
      const double slack = 1e-9 * lattice_.spacing[a];
      if (p[a] < region.lower[a] - slack || p[a] >= region.upper[a] - slack) return false;
      distance += (p[a] - region.centre[a]) * (p[a] - region.centre[a]);
    }
    return !region.ball || distance < region.radius * region.radius;
  }

  bool contains(ThreadRegions& own, std::size_t r, const Vec3& p, Chunk& chunk) const {
    if (!in_box_and_ball(regions_[r], p)) return false;
    if (!own.where[r]) return true;
    const double value = (*own.where[r])(p[0], p[1], p[2], 0);
    if (!std::isfinite(value)) chunk.not_finite.add(p);
    return std::isfinite(value) && value > 0;
  }

  // The same of another region, which reports its own faults.
  bool covers(ThreadRegions& own, std::size_t r, const Vec3& p) const {
    if (!in_box_and_ball(regions_[r], p)) return false;
    if (!own.where[r]) return true;
    const double value = (*own.where[r])(p[0], p[1], p[2], 0);
    return std::isfinite(value) && value > 0;
  }

  bool in_solid(const Vec3& p) const {
    for (const SolidBox& box : scene_.domain.boxes) {
      bool inside = true;
      for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
        inside = inside && p[a] >= box.lower[a] && p[a] <= box.upper[a];
      }
      if (inside) return true;
    }
    return false;
  }

  void accept(ThreadRegions& own, std::size_t r, const Vec3& p, Chunk& chunk) const {
    if (in_solid(p)) {
      chunk.in_solid.add(p);
      return;
    }
    if (layered()) {
      for (std::size_t q = r + 1; q < regions_.size(); ++q)
        if (covers(own, q, p)) {
          chunk.replaced.add(p);
          return;
        }
    }
    for (std::size_t q = 0; q < regions_.size() && !layered(); ++q) {
      // Lattice regions share sites, so one direction suffices; a conforming one has its own places.
      if (q == r || (q > r && regions_[q].conform == regions_[r].conform)) continue;
      if (covers(own, q, p)) chunk.overlap[q].add(p);
    }
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) chunk.position[a].push_back(p[a]);
  }

  // Indices of cells whose centres may lie in the region's box.
  std::pair<double, double> index_range(const LiquidRegion& region, std::size_t axis) const {
    double low = region.lower[axis], high = region.upper[axis];
    if (region.ball) {
      low = std::max(low, region.centre[axis] - region.radius);
      high = std::min(high, region.centre[axis] + region.radius);
    }
    const double first = std::floor((low - lattice_.origin[axis]) / lattice_.spacing[axis] - 0.5);
    const double last = std::ceil((high - lattice_.origin[axis]) / lattice_.spacing[axis] + 0.5);
    return {std::clamp(first, 0.0, lattice_.count[axis]), std::clamp(last, 0.0, lattice_.count[axis])};
  }

  std::vector<Chunk> fill_region(std::size_t r);
  void conform_column(ThreadRegions& own, std::size_t r, Vec3 p, Chunk& chunk) const;
  void report(const std::vector<std::vector<Chunk>>& chunks);
  void gather(const std::vector<std::vector<Chunk>>& chunks);

  Scene& scene_;
  const Lattice& lattice_;
  const std::vector<LiquidRegion>& regions_;
  double most_;
  std::atomic<std::size_t> found_ = 0;
  Problems& problems_;
  std::vector<std::unique_ptr<ThreadRegions>> threads_;
};

std::vector<Chunk> Filler::fill_region(std::size_t r) {
  const LiquidRegion& region = regions_[r];
  const std::size_t up = static_cast<std::size_t>(lattice_.dimensions) - 1;
  std::array<std::pair<double, double>, 3> range{{{0, 1}, {0, 1}, {0, 1}}};
  for (std::size_t a = 0; a <= up; ++a) range[a] = index_range(region, a);
  const auto extent = [&](std::size_t a) { return static_cast<std::size_t>(range[a].second - range[a].first); };
  const std::size_t rows = up == 2 ? extent(1) : 1;
  const std::size_t columns = extent(0) * rows;

  std::vector<Chunk> chunks(block_count(columns, column_block));
  parallel_blocks_dynamic(columns, column_block, [&](std::size_t block, std::size_t first, std::size_t last) {
    if (too_many()) return;
    ThreadRegions& own = this->own();
    Chunk& chunk = chunks[block];
    for (std::size_t column = first; column < last; ++column) {
      Vec3 p{};
      p[0] = centre(0, range[0].first + static_cast<double>(column / rows));
      if (up == 2) p[1] = centre(1, range[1].first + static_cast<double>(column % rows));
      if (region.conform) {
        conform_column(own, r, p, chunk);
        continue;
      }
      for (double k = range[up].first; k < range[up].second; ++k) {
        p[up] = centre(up, k);
        if (contains(own, r, p, chunk)) accept(own, r, p, chunk);
      }
    }
    found_ += chunk.position[0].size();
  });
  return chunks;
}

// The column through p: the surface is the highest root of `where`, found from above in steps of half a
// spacing and bisected to the last bit. Over a depth D the n particles stand D/n apart, the highest half a distance
// below the surface and the lowest half a distance above the bottom: the column's liquid ends on both. A depth below
// a quarter spacing holds no particle.
void Filler::conform_column(ThreadRegions& own, std::size_t r, Vec3 p, Chunk& chunk) const {
  const LiquidRegion& region = regions_[r];
  const std::size_t up = static_cast<std::size_t>(lattice_.dimensions) - 1;
  const double spacing = lattice_.spacing[up];
  const double bottom = region.lower[up], top = region.upper[up];
  p[up] = 0.5 * (bottom + top);
  if (!in_box_and_ball(region, p)) return;

  const auto inside = [&](double height) {
    p[up] = height;
    const double value = (*own.where[r])(p[0], p[1], p[2], 0);
    if (!std::isfinite(value)) chunk.not_finite.add(p);
    return value > 0;
  };
  // The last height inside, between one that is and one that is not.
  const auto bisect = [&](double in, double out) {
    for (int i = 0; i < 200; ++i) {  // ends at rounding, after some 50
      const double middle = 0.5 * (in + out);
      if (middle == in || middle == out) break;
      (inside(middle) ? in : out) = middle;
    }
    return in;
  };

  if (inside(top)) {
    chunk.beyond_top.add(p);
    return;
  }
  const double steps = std::ceil((top - bottom) / (0.5 * spacing));
  double surface = bottom, floor = bottom;
  bool found = false;
  for (double i = 1; i <= steps; ++i) {
    const double above = top - (top - bottom) * (i - 1) / steps;
    const double height = i == steps ? bottom : top - (top - bottom) * i / steps;
    const bool wet = inside(height);
    if (!found && wet) {
      surface = bisect(height, above);
      found = true;
    } else if (found && !wet) {
      floor = bisect(above, height);
      break;
    }
  }
  const double depth = surface - floor;
  if (!found || depth < least_depth * spacing) return;

  const auto distance = [&](double n) { return depth / n; };
  double layers = std::max(1.0, std::floor(depth / spacing));
  if (std::abs(distance(layers + 1) - spacing) < std::abs(distance(layers) - spacing)) ++layers;
  for (double k = layers - 1; k >= 0; --k) {
    p[up] = surface - (k + 0.5) * distance(layers);
    accept(own, r, p, chunk);
  }
}

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
                                         : in_solid.count > 0
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
  particles.volume = lattice_.volume();
  parallel_blocks(all.size(), 1, [&](std::size_t c, std::size_t, std::size_t) {
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
      std::copy(all[c]->position[a].begin(), all[c]->position[a].end(), particles.position[a].data() + start[c]);
    }
    std::fill(particles.region.data() + start[c], particles.region.data() + start[c + 1], region[c]);
    if (layered())
      std::fill(particles.phase.data() + start[c], particles.phase.data() + start[c + 1],
                regions_[static_cast<std::size_t>(region[c])].phase);
  });
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
        if (scene_.domain.sides[a][0].kind != BoundaryKind::open) q = std::max(q, lower + gap);
        if (scene_.domain.sides[a][1].kind != BoundaryKind::open) q = std::min(q, upper - gap);
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

bool Filler::fills_domain() const {
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
    for (const Side& side : scene_.domain.sides[a]) {
      if (side.kind == BoundaryKind::open) return false;
    }
  }
  for (const LiquidRegion& region : regions_) {
    if (region.conform) return false;
  }
  const double missing = lattice_.sites() - static_cast<double>(scene_.particles.size());
  // Solids are counted site by site, which pays only where they could make up for what is missing.
  if (missing > most_particles) return false;
  double in_solids = 0;
  if (missing > 0 && !scene_.domain.boxes.empty()) {
    const std::size_t planes = static_cast<std::size_t>(lattice_.count[0]);
    std::vector<double> per_plane(planes);
    parallel_blocks(planes, 1, [&](std::size_t i, std::size_t, std::size_t) {
      Vec3 p{centre(0, static_cast<double>(i)), 0, 0};
      for (double j = 0; j < lattice_.count[1]; ++j) {
        p[1] = centre(1, j);
        for (double k = 0; k < lattice_.count[2]; ++k) {
          p[2] = lattice_.dimensions == 3 ? centre(2, k) : 0;
          per_plane[i] += in_solid(p);
        }
      }
    });
    for (const double count : per_plane) in_solids += count;
  }
  return missing == in_solids;
}

}  // namespace

Lattice make_lattice(const Domain& domain, double spacing) {
  Lattice lattice;
  lattice.dimensions = domain.dimensions;
  lattice.spacing = {1, 1, 1};
  for (std::size_t a = 0; a < static_cast<std::size_t>(domain.dimensions); ++a) {
    const double length = domain.upper[a] - domain.lower[a];
    const bool lower_closed = domain.sides[a][0].kind != BoundaryKind::open;
    const bool upper_closed = domain.sides[a][1].kind != BoundaryKind::open;
    lattice.origin[a] = domain.lower[a];
    if (lower_closed && upper_closed) {
      lattice.count[a] = std::max(1.0, std::round(length / spacing));
      lattice.spacing[a] = length / lattice.count[a];
    } else {
      lattice.count[a] = std::max(1.0, std::ceil(length / spacing - 0.5 - 1e-9));
      lattice.spacing[a] = spacing;
      if (upper_closed) lattice.origin[a] = domain.upper[a] - lattice.count[a] * spacing;
    }
  }
  return lattice;
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
    if (!region.where && !region.ball && scene.domain.boxes.empty())
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
