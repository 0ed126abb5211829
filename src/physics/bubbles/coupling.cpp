// SPDX-License-Identifier: MIT
// Bubbles and particles as neighbours, and the volume that bubbles take.
#include "spume/physics/bubbles/coupling.hpp"

#include <algorithm>
#include <cmath>

namespace spume::bubbles {
namespace {

// Kernels expand as if alpha were no less: the fixed point of King (3.1) fails below it (see the header).
constexpr double least_kernel_fraction = 0.5;

// Of the chord of x^(-1/3) from 1/2 to 1: 2 (2^(1/3) - 1).
constexpr double chord_slope = 0.5198;
// A Newton step leaves twice the square of the relative error: 2.7 % of the chord become 1.5e-3, 4e-6, 4e-11 and 3e-21.
constexpr int newton_steps = 4;

// x^(-1/3) for x in [1/2, 1], to rounding and exact at 1.
double inverse_cube_root(double x) {
  double y = 1 + (1 - x) * chord_slope;
  for (int k = 0; k < newton_steps; ++k) y *= (4 - x * y * y * y) / 3;
  return y;
}

}  // namespace

BubbleCoupling::BubbleCoupling(ParticleStore& particles, const Carrier& carrier, const BubbleOptions& options,
                               const BubbleSources& sources)
    : carrier_(carrier),
      options_(options),
      population_({options.fluctuations, options.breakup, options.surface_interaction && has_surface(),
                   carrier.gas != nullptr}),
      sources_(sources, carrier.scene.seed) {
  if (const BodyWalls* bodies = carrier.boundary.bodies(); bodies != nullptr)
    sources_.keep_clouds_out([bodies](const Vec3& place) { return bodies->nearer_than(place, 0); });
  particles.add_vector(exchange_, "bubble_exchange", Lifetime::result);
  volume_fraction_ = &particles.fields.add<double>("volume_fraction", Lifetime::state);
  parallel_for(particles.size(), [&](std::size_t i) { (*volume_fraction_)[i] = 1; });

  const Fluid& fluid = carrier.scene.fluid;
  const double spacing = carrier.resolution.spacing;
  gas_ = {.density_ratio = options.density_ratio,
          .viscosity = fluid.kinematic_viscosity,
          .lift = options.lift_coefficient,
          .virtual_mass = options.virtual_mass_coefficient,
          .fluid_inertia = options.fluid_inertia,
          .gravity = fluid.gravity};
  const double gravity = std::hypot(fluid.gravity[0], fluid.gravity[1], fluid.gravity[2]);
  surface_ = {
      .spacing = spacing,
      .persistence_unit = persistence_unit(options.tension, fluid.kinematic_viscosity, gravity, options.schmidt)};
  breakup_ = {.tension = options.tension, .deformation_constant = options.deformation_constant};
  entrainment_ = {.constant = options.entrainment_constant,
                  .threshold = options.entrainment_threshold,
                  .density_ratio = options.density_ratio,
                  .tension = options.tension,
                  .smallest_radius = options.smallest_entrained_radius,
                  .largest_radius = spacing,
                  .spacing = spacing,
                  .seed = carrier.scene.seed,
                  .overdraft = options.entrainment_overdraft};
  add_snapshot_fields();
  if (options_.breakup) child_sizes_.emplace_back();
  if (population_.merge_time != nullptr)
    normal_at_surface_ =
        lattice_surface(3, carrier_.resolution.kernel, carrier_.resolution.smoothing_ratio)[0].twice_smoothed_normal;
}

void BubbleCoupling::place_clouds() {
  sources_.place_clouds(population_, carrier_.time);
  if (exchanges_gas()) fill_new_bubbles(carrier_.gas->fraction);
  history_.injected = static_cast<std::int64_t>(population_.size());
  history_.injected_volume = population_.total_volume();
  history_before_ = history_;
}

void BubbleCoupling::accept_volume_fraction() {
  parallel_for(carrier_.size(), [&](std::size_t i) { (*volume_fraction_)[i] = carrier_.sizes.volume_fraction[i]; });
}

void BubbleCoupling::move(double dt, ParticleSizes& sizes) {
  sizes.variable = !population_.empty();
  sizes.largest_length_ratio = 1;
  if (population_.empty()) return;
  parallel_for(population_.size(), [&](std::size_t b) {
    Vec3 r;
    for (std::size_t a = 0; a < 3; ++a) r[a] = (*population_.position[a])[b] + dt * (*population_.velocity[a])[b];
    carrier_.boundary.apply_walls(carrier_.boundary.next_walls, r, nullptr);
    for (std::size_t a = 0; a < 3; ++a) (*population_.next_position[a])[b] = r[a];
  });
  population_.sort(carrier_.arrangement.grid);
  measure_sizes(sizes);
}

// h_i from the volume fraction of the last step, King (3.4).
void BubbleCoupling::measure_sizes(ParticleSizes& sizes) const {
  const std::size_t n = carrier_.size();
  for (auto* array : {&sizes.volume_fraction, &sizes.length_ratio, &sizes.volume_ratio, &sizes.support_radius})
    array->resize(n);
  const double support_radius = carrier_.arrangement.grid.support_radius();
  const double* fraction = volume_fraction_->data();
  float *length_ratio = sizes.length_ratio.data(), *support_radius_of = sizes.support_radius.data();
  sizes.largest_length_ratio = parallel_reduce(
      n, 1.0F,
      [=](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
          const double ratio = inverse_cube_root(std::max(fraction[i], least_kernel_fraction));
          length_ratio[i] = static_cast<float>(ratio);
          support_radius_of[i] = static_cast<float>(support_radius * ratio);
        }
        return *std::max_element(length_ratio + first, length_ratio + last);
      },
      [](float a, float b) { return std::max(a, b); });
}

// The bubbles and their images as neighbours.
void BubbleCoupling::place_bubbles() {
  const std::size_t nb = population_.size();
  ImageRules rules =
      carrier_.boundary.image_rules(carrier_.arrangement.grid.support_radius() * carrier_.sizes.largest_length_ratio);
  rules.only_nearest = true;  // places are looked up without asking what they see
  WallPointView beside_walls;
  if (beside_bodies()) {
    reflect_bubbles(rules);
    beside_walls = reflections();
  }
  images_.build(rules, carrier_.arrangement.grid, population_.next_position[0]->data(),
                population_.next_position[1]->data(), population_.next_position[2]->data(), nb,
                beside_walls.size > 0 ? &beside_walls : nullptr);
  const std::size_t all = nb + images_.size();
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    bubble_point_[a].resize(all + simd::pair_lanes);
    float* out = bubble_point_[a].data();
    const double* bubble = population_.next_position[a]->data();
    const double* image = images_.position(axis);
    const double zero = carrier_.arrangement.origin[a];
    parallel_for(nb, [=](std::size_t k) { out[k] = static_cast<float>(bubble[k] - zero); });
    parallel_for(all - nb, [=](std::size_t k) { out[nb + k] = static_cast<float>(image[k] - zero); });
  }
}

CrossSearch BubbleCoupling::bubble_search() const {
  const CrossSearch::Points sets[] = {{&population_.table(), population_.size()}, images_as_points(images_)};
  return {carrier_.arrangement.grid,
          carrier_.arrangement.origin,
          {bubble_point_[0].data(), bubble_point_[1].data(), bubble_point_[2].data()},
          sets};
}

CrossSearch BubbleCoupling::liquid_search() const {
  const NeighbourList& list = carrier_.arrangement.list;
  const CrossSearch::Points sets[] = {{&carrier_.arrangement.table, carrier_.size()},
                                      images_as_points(carrier_.arrangement.images)};
  return {carrier_.arrangement.grid,
          carrier_.arrangement.origin,
          {list.coordinate(0), list.coordinate(1), list.coordinate(2)},
          sets};
}

CrossTargets BubbleCoupling::particle_targets() const {
  return {carrier_.size(),
          read(carrier_.intermediate_position),
          carrier_.arrangement.origin,
          carrier_.resolution.smoothing_length,
          carrier_.sizes.length_ratio.data(),
          carrier_.sizes.support_radius.data()};
}

void BubbleCoupling::share_volume(ParticleSizes& sizes) {
  if (population_.empty()) return;
  place_bubbles();
  if (beside_bodies()) weigh_reflections();
  const std::size_t n = carrier_.size(), nb = population_.size(), all = nb + images_.size();
  constexpr std::size_t width = 4;
  bubble_records_.resize(all * 8);
  float* records = bubble_records_.data();
  parallel_for(all, [&](std::size_t k) {
    const std::size_t b = k < nb ? k : static_cast<std::size_t>(images_.source()[k - nb]);
    for (std::size_t a = 0; a < 3; ++a) records[k * width + a] = bubble_point_[a][k];
    records[k * width + 3] = static_cast<float>((*population_.volume)[b]);
  });
  if (beside_bodies())
    parallel_for(images_.size(), [&](std::size_t k) { records[(nb + k) * width + 3] *= share_of_image(k); });

  near_.resize(n);
  with_plain_kernel(3, carrier_.resolution.kernel, [&]<int d, class Kernel>() {
    if constexpr (d == 3) {
      const double h = carrier_.resolution.smoothing_length;
      const auto peak = static_cast<float>(Kernel::normalisation(3) / (h * h * h));
      const auto store = [&](std::size_t i, const float* sums) {
        near_[i] = sums != nullptr ? 1 : 0;
        double sum = 0;
        if (sums != nullptr) {
          const float inverse = 1 / sizes.length_ratio[i];
          sum = double{peak * inverse * inverse * inverse} * sums[0];
        }
        const double alpha = sum <= 0.5 ? 1 - sum : 1 / (4 * sum);
        sizes.volume_fraction[i] = static_cast<float>(alpha);
        sizes.volume_ratio[i] = static_cast<float>(1 / std::max(alpha, least_kernel_fraction));
      };
      sum_over_points<1, Kernel>(particle_targets(), bubble_search(), carrier_.arrangement.grid.support_radius(),
                                 records, store);
    }
  });
}

std::vector<ArrayInfo> BubbleCoupling::arrays() const {
  std::vector<ArrayInfo> list;
  const auto bytes = [](const auto&... arrays) {
    return (0.0 + ... + static_cast<double>(arrays.capacity() * sizeof(arrays[0])));
  };
  list.push_back({"bubbles", population_.fields.bytes()});
  list.push_back({"bubble images", images_.bytes()});
  if (beside_bodies())
    list.push_back({"bubbles beside bodies",
                    bytes(wall_near_, received_weight_, beside_walls_, reflection_share_, mirrored_place_[0],
                          mirrored_place_[1], mirrored_place_[2], reflection_[0], reflection_[1], reflection_[2],
                          liquid_point_[0], liquid_point_[1], liquid_point_[2])});
  list.push_back({"bubble records",
                  bytes(bubble_point_[0], bubble_point_[1], bubble_point_[2], inverse_support_radius_, liquid_records_,
                        bubble_records_, interpolated_, dissipation_, next_merge_time_, reaction_[0], reaction_[1],
                        reaction_[2], dead_, near_, near_particles_, dissolved_, dissolution_, dissolved_at_bubble_,
                        next_gas_, beside_surface_, surface_normal_[0], surface_normal_[1], surface_normal_[2],
                        smoothed_normal_[0], smoothed_normal_[1], smoothed_normal_[2])});
  return list;
}

}  // namespace spume::bubbles
