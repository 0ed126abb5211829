// SPDX-License-Identifier: MIT
// Bubbles and particles as neighbours, and the volume that bubbles take.
#include "spume/methods/les_sph/bubble_coupling.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace spume::les_sph {
namespace {

using simd::f32x8;

// Kernels expand as if alpha were no less.
constexpr double least_kernel_fraction = 0.5;

bubbles::Population::Models models_of(const Liquid& liquid) {
  const BubbleOptions& options = liquid.options.bubbles;
  return {options.fluctuations, options.breakup, options.surface_interaction && liquid.plan.free_surface};
}

}  // namespace

BubbleCoupling::BubbleCoupling(const Liquid& liquid)
    : options_(liquid.options.bubbles), population_(models_of(liquid)), sources_(liquid.scene) {
  const Fluid& fluid = liquid.scene.fluid;
  gas_.density_ratio = options_.density_ratio;
  gas_.viscosity = fluid.kinematic_viscosity;
  gas_.lift = options_.lift_coefficient;
  gas_.virtual_mass = options_.virtual_mass_coefficient;
  gas_.fluid_inertia = options_.fluid_inertia;
  gas_.gravity = fluid.gravity;
  const double gravity = std::hypot(fluid.gravity[0], fluid.gravity[1], fluid.gravity[2]);
  surface_.spacing = liquid.scene.spacing;
  surface_.persistence_unit =
      bubbles::persistence_unit(options_.tension, fluid.kinematic_viscosity, gravity, options_.schmidt);
  breakup_.tension = options_.tension;
  breakup_.deformation_constant = options_.deformation_constant;
  entrainment_.constant = options_.entrainment_constant;
  entrainment_.threshold = options_.entrainment_threshold;
  entrainment_.density_ratio = options_.density_ratio;
  entrainment_.tension = options_.tension;
  entrainment_.smallest_radius = options_.smallest_entrained_radius;
  entrainment_.largest_radius = liquid.scene.spacing;
  entrainment_.spacing = liquid.scene.spacing;
  entrainment_.seed = liquid.scene.seed;
  if (options_.breakup) child_sizes_.emplace_back();
  if (population_.merge_time != nullptr)
    normal_at_surface_ =
        lattice_surface(3, liquid.options.resolution.kernel, liquid.options.resolution.smoothing_ratio)[0]
            .twice_smoothed_normal;
}

void BubbleCoupling::start(Liquid& liquid) {
  sources_.place_clouds(population_, liquid.time);
  history_.injected = static_cast<std::int64_t>(population_.size());
  history_.injected_volume = population_.total_volume();
  history_before_ = history_;
  if (population_.empty()) return;
  // alpha depends on h, which depends on alpha: a few rounds settle both.
  for (int round = 0; round < 6; ++round) {
    move(liquid, 0);
    make_images(liquid, 0);
    share_volume(liquid);
    parallel_for(liquid.size(), [&](std::size_t i) { (*liquid.volume_fraction)[i] = liquid.next_volume_fraction[i]; });
  }
}

void BubbleCoupling::move(Liquid& liquid, double dt) {
  liquid.varying = !population_.empty();
  liquid.largest_length_ratio = 1;
  liquid.context.length_ratio = liquid.context.volume_ratio = nullptr;
  if (population_.empty()) return;
  parallel_for(population_.size(), [&](std::size_t b) {
    Vec3 r;
    for (std::size_t a = 0; a < 3; ++a) r[a] = (*population_.position[a])[b] + dt * (*population_.velocity[a])[b];
    keep_inside(liquid, liquid.next_walls, r, nullptr);
    for (std::size_t a = 0; a < 3; ++a) (*population_.next_position[a])[b] = r[a];
  });
  population_.sort(liquid.grid);
  measure_sizes(liquid);
}

// h_i from the volume fraction of the last step, King (3.4).
void BubbleCoupling::measure_sizes(Liquid& liquid) {
  const std::size_t n = liquid.size();
  for (auto* array : {&liquid.next_volume_fraction, &liquid.length_ratio, &liquid.volume_ratio, &liquid.reach})
    array->resize(n);
  const double reach = liquid.grid.reach();
  liquid.largest_length_ratio = parallel_max(n, 1.0, [&](std::size_t i) {
    const double alpha = (*liquid.volume_fraction)[i];
    const double ratio = alpha == 1 ? 1 : 1 / std::cbrt(std::max(alpha, least_kernel_fraction));
    liquid.length_ratio[i] = static_cast<float>(ratio);
    liquid.reach[i] = static_cast<float>(reach * ratio);
    return ratio;
  });
}

// Float coordinates of what the lists join, and the lists.
void BubbleCoupling::build_lists(Liquid& liquid) {
  const std::size_t n = liquid.size(), m = liquid.images.size(), nb = population_.size();
  const auto centre = liquid.read(liquid.intermediate);
  const auto pack = [&](std::array<Array<float>, 3>& to, std::size_t first, std::size_t size, int axis,
                        const double* from) {
    float* out = to[static_cast<std::size_t>(axis)].data() + first;
    const double zero = liquid.origin[static_cast<std::size_t>(axis)];
    parallel_for(size, [=](std::size_t k) { out[k] = static_cast<float>(from[k] - zero); });
  };
  images_.build(image_rules(liquid, liquid.next_walls), liquid.grid, population_.next_position[0]->data(),
                population_.next_position[1]->data(), population_.next_position[2]->data(), nb);
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    point_[a].resize(n + m + simd::lanes);
    bubble_point_[a].resize(nb + images_.size() + simd::lanes);
    pack(point_, 0, n, axis, centre[a]);
    pack(point_, n, m, axis, liquid.images.position(axis));
    pack(bubble_point_, 0, nb, axis, population_.next_position[a]->data());
    pack(bubble_point_, nb, images_.size(), axis, images_.position(axis));
  }
  point_reach_.resize(n + m + simd::lanes);
  parallel_for(n, [&](std::size_t i) { point_reach_[i] = liquid.reach[i]; });
  parallel_for(m, [&](std::size_t k) {
    point_reach_[n + k] = liquid.reach[static_cast<std::size_t>(liquid.images.source()[k])];
  });

  CrossList::Geometry geometry;
  geometry.grid = &liquid.grid;
  geometry.origin = liquid.origin;
  geometry.largest_reach = static_cast<float>(liquid.grid.reach() * liquid.largest_length_ratio);
  const auto pointers = [](const std::array<Array<float>, 3>& arrays) {
    return std::array<const float*, 3>{arrays[0].data(), arrays[1].data(), arrays[2].data()};
  };
  geometry.centre = pointers(bubble_point_);
  geometry.point = pointers(point_);
  geometry.point_reach = point_reach_.data();
  const std::array<CrossList::Points, 2> particles{{{&liquid.table, n}, {&liquid.images.table(), m}}};
  particles_of_.build(geometry, nb, particles);
  // Only particles that some bubble has found need a list. Threads may store the same 1 twice.
  touched_.resize(n);
  parallel_for(n, [&](std::size_t i) { touched_[i] = 0; });
  parallel_for(nb, [&](std::size_t b) {
    for (const std::int32_t j : particles_of_.of(b)) {
      const auto k = static_cast<std::size_t>(j);
      const std::size_t i = k < n ? k : static_cast<std::size_t>(liquid.images.source()[k - n]);
      std::atomic_ref(touched_[i]).store(1, std::memory_order_relaxed);
    }
  });
  geometry.wanted = touched_.data();
  std::swap(geometry.centre, geometry.point);
  geometry.point_reach = nullptr;
  geometry.centre_reach = liquid.reach.data();
  const std::array<CrossList::Points, 2> bubbles{{{&population_.table(), nb}, {&images_.table(), images_.size()}}};
  bubbles_of_.build(geometry, n, bubbles);
}

void BubbleCoupling::share_volume(Liquid& liquid) {
  if (population_.empty()) return;
  build_lists(liquid);
  const std::size_t n = liquid.size(), nb = population_.size(), all = nb + images_.size();
  constexpr int width = 4;
  bubble_records_.resize((all + 1) * 8);
  float* records = bubble_records_.data();
  parallel_for(all, [&](std::size_t k) {
    const std::size_t b = k < nb ? k : static_cast<std::size_t>(images_.source()[k - nb]);
    for (std::size_t a = 0; a < 3; ++a) records[k * width + a] = bubble_point_[a][k];
    records[k * width + 3] = static_cast<float>((*population_.volume)[b]);
  });
  for (std::size_t a = 0; a < 4; ++a) records[all * width + a] = a < 3 ? 1e6F * liquid.reach[0] : 0.0F;

  with_kernel(liquid.context, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      const double h = liquid.smoothing_length;
      const auto peak = static_cast<float>(Kernel::normalisation(3) / (h * h * h));
      sweep(n, [&](std::size_t i) {
        double sum = 0;
        if (bubbles_of_.count(i) > 0) {
          const float inverse = 1 / liquid.length_ratio[i];
          const float inverse_h = inverse / static_cast<float>(h);
          f32x8 total{};
          for (const std::int32_t* k = bubbles_of_.begin(i); k != bubbles_of_.padded_end(i); k += simd::lanes) {
            f32x8 v[4];
            simd::load_records<width>(records, k, 0, v);
            f32x8 r2{};
            for (std::size_t a = 0; a < 3; ++a) {
              const f32x8 offset = v[a] - point_[a][i];
              r2 = r2 + offset * offset;
            }
            total = total + v[3] * Kernel::w(simd::sqrt(r2) * inverse_h);
          }
          sum = double{peak * inverse * inverse * inverse} * simd::sum(total);
        }
        const double alpha = sum <= 0.5 ? 1 - sum : 1 / (4 * sum);
        liquid.next_volume_fraction[i] = static_cast<float>(alpha);
        liquid.volume_ratio[i] = static_cast<float>(1 / std::max(alpha, least_kernel_fraction));
      });
    }
  });
  liquid.context.length_ratio = liquid.length_ratio.data();
  liquid.context.volume_ratio = liquid.volume_ratio.data();
}

std::vector<ArrayInfo> BubbleCoupling::arrays() const {
  std::vector<ArrayInfo> list;
  const auto bytes = [](const auto&... arrays) {
    return (0.0 + ... + static_cast<double>(arrays.capacity() * sizeof(arrays[0])));
  };
  list.push_back({"bubbles", population_.fields.bytes()});
  list.push_back({"bubble lists", particles_of_.bytes() + bubbles_of_.bytes() + images_.bytes()});
  list.push_back({"bubble records",
                  bytes(point_[0], point_[1], point_[2], bubble_point_[0], bubble_point_[1], bubble_point_[2],
                        point_reach_, liquid_records_, bubble_records_, interpolated_, dissipation_, next_merge_time_,
                        reaction_[0], reaction_[1], reaction_[2], dead_, touched_, near_bubbles_)});
  return list;
}

}  // namespace spume::les_sph
