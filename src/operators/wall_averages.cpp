// SPDX-License-Identifier: MIT
#include "spume/operators/wall_averages.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/vectors.hpp"

namespace spume {
namespace {

struct WallEntry {
  std::int32_t point, particle, image;
  bool mirrored;
};
using FoundEntries = std::vector<std::vector<WallEntry>>;  // by blocks of particles

// Where the entries of each point begin, in the order of the particles.
void count_entries(const FoundEntries& found, bool mirrored, std::size_t points, Array<std::int64_t>& first) {
  first.resize(points + 1);
  first.fill(0);
  for (const auto& block : found)
    for (const WallEntry& entry : block)
      if (entry.mirrored == mirrored) ++first[static_cast<std::size_t>(entry.point) + 1];
  for (std::size_t g = 0; g < points; ++g) first[g + 1] += first[g];
}

Vec3 offset(const SweepContext& context, std::size_t from, std::size_t to) {
  Vec3 d{};
  for (int axis = 0; axis < context.dimensions; ++axis)
    d[axis] = double{context.list->coordinate(axis)[to]} - double{context.list->coordinate(axis)[from]};
  return d;
}

// Whether the list of a particle has any image, by several entries at a time: most have none, and looking at each
// entry of all takes a tenth of a step.
bool lists_images(const NeighbourList& list, std::size_t i) {
  const std::int32_t* const entry = list.begin(i);
  std::int32_t largest = 0;
  for (std::int32_t k = 0; k < list.count(i); ++k) largest = std::max(largest, entry[k]);
  return largest >= entry_scale * static_cast<std::int32_t>(list.particles());
}

double ratio(const SweepContext& context, const Vec3& d) {
  return std::sqrt(spume::dot(d, d)) / context.smoothing_length;
}

}  // namespace

void WallAverages::find_entries(const SweepContext& context, const std::vector<std::array<float, 3>>& reflection,
                                WallStencils& stencils, bool rates) {
  const std::size_t n = context.list->particles(), points = stencils.size();
  const std::int32_t *wall_point = context.images->wall_point(), *path = context.images->path();
  reflection_ = &reflection;
  FoundEntries found(block_count(n, default_block));
  if (wall_point != nullptr)
    parallel_blocks(n, default_block, [&](std::size_t b, std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        for (const std::int32_t j : context.list->of(i)) {
          const std::int64_t k = j - static_cast<std::int64_t>(n);
          if (k < 0 || wall_point[k] < 0) continue;
          const auto& sign = reflection[static_cast<std::size_t>(path[k])];
          const bool mirrored = sign[0] < 0 || sign[1] < 0 || sign[2] < 0;
          if (!mirrored || rates) found[b].push_back({wall_point[k], static_cast<std::int32_t>(i), j, mirrored});
        }
    });
  count_entries(found, false, points, stencils.first);
  const auto entries = static_cast<std::size_t>(stencils.first[points]);
  stencils.source.resize(entries);
  stencils.coefficient.resize(entries);
  image_.resize(entries);
  std::vector<std::int64_t> next(stencils.first.data(), stencils.first.data() + points);
  for (const auto& block : found)
    for (const WallEntry& entry : block) {
      if (entry.mirrored) continue;
      const std::int64_t slot = next[static_cast<std::size_t>(entry.point)]++;
      stencils.source[slot] = entry.particle;
      image_[slot] = entry.image;
    }
  transposed_ = {};
  if (rates) {
    count_entries(found, true, points, mirrored_.first);
    mirrored_.particle.resize(static_cast<std::size_t>(mirrored_.first[points]));
    mirrored_.image.resize(mirrored_.particle.size());
  }
  std::vector<std::int64_t> next_mirrored;
  if (rates) next_mirrored.assign(mirrored_.first.data(), mirrored_.first.data() + points);
  next.assign(stencils.first.data(), stencils.first.data() + points);
  for (const auto& block : found)
    for (const WallEntry& entry : block) {
      const auto g = static_cast<std::size_t>(entry.point);
      if (entry.mirrored) {
        const std::int64_t slot = next_mirrored[g]++;
        mirrored_.particle[slot] = entry.particle;
        mirrored_.image[slot] = entry.image;
        continue;
      }
      if (transposed_.particle.empty() || transposed_.particle.back() != entry.particle) {
        transposed_.particle.push_back(entry.particle);
        transposed_.first.push_back(static_cast<std::int64_t>(transposed_.entry.size()));
      }
      if (!rates) continue;
      transposed_.entry.push_back(next[g]++);
      transposed_.point.push_back(entry.point);
    }
  transposed_.first.push_back(static_cast<std::int64_t>(transposed_.entry.size()));
}

void WallAverages::weigh(const SweepContext& context, WallStencils& stencils) const {
  parallel_for(stencils.size(), [&](std::size_t g) {
    double sum = 0;
    for (std::int64_t k = stencils.first[g]; k < stencils.first[g + 1]; ++k) {
      const Vec3 d = offset(context, static_cast<std::size_t>(stencils.source[k]), static_cast<std::size_t>(image_[k]));
      stencils.coefficient[k] = WendlandC2::w(ratio(context, d));
      sum += stencils.coefficient[k];
    }
    if (sum > 0)
      for (std::int64_t k = stencils.first[g]; k < stencils.first[g + 1]; ++k) stencils.coefficient[k] /= sum;
  });
}

void WallAverages::extrapolate(const SweepContext& context, const WallStencils& stencils, const Liquid& liquid,
                               double* pressure, double* density) const {
  parallel_for(stencils.size(), [&](std::size_t g) {
    Vec3 pull = liquid.gravity;
    for (int axis = 0; axis < context.dimensions; ++axis)
      if (liquid.wall_acceleration[axis] != nullptr) pull[axis] -= liquid.wall_acceleration[axis][g];
    double p = 0, rho = 0;
    for (std::int64_t k = stencils.first[g]; k < stencils.first[g + 1]; ++k) {
      const auto j = static_cast<std::size_t>(stencils.source[k]);
      const double head = spume::dot(pull, offset(context, j, static_cast<std::size_t>(image_[k])));
      p += stencils.coefficient[k] * (double{liquid.pressure[j]} + liquid.density[j] * head);
      rho += stencils.coefficient[k] * liquid.density[j];
    }
    pressure[g] = p;
    density[g] = rho;
  });
}

// v_i g_ig (u_i - u_g) . (r_g - r_i), without the factor of the kernel gradient.
double WallAverages::flow_to(const SweepContext& context, const WallStencils& stencils, std::size_t point,
                             std::int32_t particle, std::int32_t image, const std::array<const double*, 3>& velocity,
                             const float* volume) const {
  const auto i = static_cast<std::size_t>(particle);
  const Vec3 way = offset(context, i, static_cast<std::size_t>(image));
  const auto k = static_cast<std::size_t>(image) - context.list->particles();
  const auto& sign = (*reflection_)[static_cast<std::size_t>(context.images->path()[k])];
  double along = 0;
  for (int axis = 0; axis < context.dimensions; ++axis)
    along += (velocity[axis][i] - double{sign[axis]} * double{stencils.wall_velocity[axis][point]}) * way[axis];
  return -volume[i] * WendlandC2::f(ratio(context, way)) * along;
}

void WallAverages::add_rates(const SweepContext& context, const WallStencils& stencils,
                             const std::array<const double*, 3>& velocity, const float* volume, double* flow,
                             float* rate) const {
  const int d = context.dimensions;
  const double scale = context.gradient_scale * context.volume * WendlandC2::normalisation(d) /
                       std::pow(context.smoothing_length, d + 2);
  parallel_for(stencils.size(), [&](std::size_t g) {
    double sum = 0;
    for (std::int64_t k = stencils.first[g]; k < stencils.first[g + 1]; ++k)
      sum += flow_to(context, stencils, g, stencils.source[k], image_[k], velocity, volume);
    for (std::int64_t k = mirrored_.first[g]; k < mirrored_.first[g + 1]; ++k)
      sum += flow_to(context, stencils, g, mirrored_.particle[k], mirrored_.image[k], velocity, volume);
    flow[g] = scale * stencils.mirrored(g, volume) * sum;
  });
  parallel_for(transposed_.particle.size(), [&](std::size_t m) {
    const auto i = static_cast<std::size_t>(transposed_.particle[m]);
    double sum = 0;
    for (auto k = static_cast<std::size_t>(transposed_.first[m]);
         k < static_cast<std::size_t>(transposed_.first[m + 1]); ++k)
      sum += stencils.coefficient[transposed_.entry[k]] * flow[static_cast<std::size_t>(transposed_.point[k])];
    rate[i] += static_cast<float>(sum / double{volume[i]});
  });
}

double WallAverages::bytes() const {
  return image_.bytes() + mirrored_.first.bytes() + mirrored_.particle.bytes() + mirrored_.image.bytes() +
         static_cast<double>((transposed_.particle.capacity() + transposed_.point.capacity()) * sizeof(std::int32_t) +
                             (transposed_.first.capacity() + transposed_.entry.capacity()) * sizeof(std::int64_t));
}

std::vector<SurfaceForce> wall_forces(const SweepContext& context, const WallForceFields& fields, std::size_t bodies) {
  const std::size_t n = context.list->particles();
  const std::int32_t *wall_point = context.images->wall_point(), *path = context.images->path();
  std::vector<SurfaceForce> sum(bodies);
  if (wall_point == nullptr) return sum;
  const int d = context.dimensions;
  const double h = context.smoothing_length, V = context.volume;
  const double scale = context.gradient_scale * V * V * WendlandC2::normalisation(d) / std::pow(h, d + 2);
  // Of the liquid before a point, which up to ten particles see in two dimensions and thirty in three: sums over its
  // stencil for every pair take a third of a step.
  struct Before {
    double volume;
    Vec3 velocity;
  };
  std::vector<Before> before(context.walls->size());
  parallel_for(before.size(), [&](std::size_t g) {
    before[g].volume = context.walls->mirrored(g, fields.volume);
    if (fields.viscosity != nullptr)
      before[g].velocity = context.walls->velocity(g, d, fields.velocity, fields.friction, true, false);
  });
  std::vector<std::vector<SurfaceForce>> blocks(block_count(n, default_block), std::vector<SurfaceForce>(bodies));
  const auto add = [&](std::vector<SurfaceForce>& to, std::size_t i) {
    for (const std::int32_t j : context.list->of(i)) {
      const std::int64_t k = j - static_cast<std::int64_t>(n);
      if (k < 0 || wall_point[k] < 0) continue;
      const auto g = static_cast<std::size_t>(wall_point[k]);
      const auto& sign = (*fields.reflection)[static_cast<std::size_t>(path[k])];
      const auto& held = (*fields.held)[static_cast<std::size_t>(path[k])];
      const Vec3 way = offset(context, i, static_cast<std::size_t>(j));
      const double slope = WendlandC2::f(ratio(context, way));
      if (slope == 0) continue;  // of the lists, beyond the support
      const double weight = -scale * slope * fields.volume[i] * before[g].volume;
      double other = fields.wall_pressure[g];
      Vec3 arm{}, pressure{}, viscous{};
      for (int axis = 0; axis < d; ++axis) {
        arm[axis] = fields.arm[axis][g];
        if (fields.gravity[axis] != 0)
          other += (fields.wall_density[g] * fields.gravity[axis] - fields.left_out[axis]) *
                   (context.images->position(axis)[k] - fields.wall_position[axis][g]);
      }
      const Vec3& u = before[g].velocity;
      for (int axis = 0; axis < d; ++axis) {
        pressure[axis] = sign[axis] * weight * (double{fields.pressure[i]} + other) * way[axis];
        if (fields.viscosity != nullptr)
          viscous[axis] = -2 * weight * fields.viscosity[i] * (u[axis] - held[axis] * fields.velocity[axis][i]);
      }
      SurfaceForce& own = to[static_cast<std::size_t>(fields.body[g])];
      own.press(arm, pressure);
      own.rub(arm, viscous);
    }
  };
  // The same blocks either way, for the same sums.
  parallel_blocks(n, default_block, [&](std::size_t b, std::size_t first, std::size_t last) {
    if (fields.near != nullptr) {
      const auto from = [&](std::size_t i) {
        return std::lower_bound(fields.near->begin(), fields.near->end(), static_cast<std::int32_t>(i));
      };
      std::for_each(from(first), from(last), [&](std::int32_t i) { add(blocks[b], static_cast<std::size_t>(i)); });
      return;
    }
    for (std::size_t i = first; i < last; ++i)
      if (lists_images(*context.list, i)) add(blocks[b], i);
  });
  for (const auto& block : blocks)
    for (std::size_t k = 0; k < bodies; ++k) sum[k].add(block[k]);
  return sum;
}

}  // namespace spume
