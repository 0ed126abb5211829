// SPDX-License-Identifier: MIT
// Which arrays exist, and small accessors.
#include "spume/methods/les_sph/liquid.hpp"

#include <string>

#include "spume/core/parallel.hpp"

namespace spume::les_sph {
namespace {

const std::string axis_suffix[3] = {"_x", "_y", "_z"};

template <class T>
void add_vector(FieldSet& fields, std::array<Array<T>*, 3>& vector, const std::string& name, int dimensions,
                Lifetime lifetime) {
  for (int axis = 0; axis < dimensions; ++axis) vector[axis] = &fields.add<T>(name + axis_suffix[axis], lifetime);
}

double threshold_of(const LoadedCase& loaded) {
  if (loaded.options.get<SurfaceOptions>().threshold > 0) return loaded.options.get<SurfaceOptions>().threshold;
  return loaded.scene.domain.dimensions == 3 ? 2.3 : 1.5;
}

double support_of(KernelKind kernel) {
  return kernel == KernelKind::wendland_c2 ? WendlandC2::support : QuinticSpline::support;
}

// Whether a vector expression has the same value everywhere: sampled at points that share no coordinate.
bool uniform(const VectorExpression& expression, const Domain& domain) {
  for (const double t : {0.0, 0.37, 1.9}) {
    const Vec3 first = expression(domain.lower, t);
    for (int k = 1; k <= 7; ++k) {
      Vec3 r{};
      for (int axis = 0; axis < 3; ++axis) {
        const double fraction = 0.0917 + 0.1287 * ((k * (axis + 2)) % 7);
        r[axis] = domain.lower[axis] + fraction * (domain.upper[axis] - domain.lower[axis]);
      }
      if (expression(r, t) != first) return false;
    }
  }
  return true;
}

}  // namespace

Liquid::Liquid(const LoadedCase& loaded_case)
    : loaded(loaded_case),
      options(loaded_case.options),
      scene(loaded_case.scene),
      plan(make_plan(loaded_case)),
      dimensions(scene.domain.dimensions),
      smoothing_length(options.resolution.smoothing_ratio * scene.spacing),
      volume(scene.particles.volume),
      lattice(lattice_constants(dimensions, options.resolution.kernel, options.resolution.smoothing_ratio)),
      largest_shift(largest_stable_shift(dimensions, options.resolution.kernel, options.resolution.smoothing_ratio,
                                         plan.drift_removal)),
      surface_threshold(threshold_of(loaded_case)),
      origin{(scene.domain.lower[0] + scene.domain.upper[0]) / 2, (scene.domain.lower[1] + scene.domain.upper[1]) / 2,
             (scene.domain.lower[2] + scene.domain.upper[2]) / 2} {
  const std::size_t n = scene.particles.size();
  const int d = dimensions;
  fields.resize(n);
  add_vector(fields, position, "position", d, Lifetime::carried);
  add_vector(fields, velocity, "velocity", d, Lifetime::carried);
  pressure = &fields.add<double>("pressure", Lifetime::carried);
  identifier = &fields.add<std::int64_t>("identifier", Lifetime::carried);
  if (options.get<TurbulenceOptions>().model == TurbulenceModel::dynamic_lagrangian) {
    lagrangian_average[0] = &fields.add<double>("average_leonard_germano", Lifetime::carried);
    lagrangian_average[1] = &fields.add<double>("average_germano_germano", Lifetime::carried);
  }

  if (plan.bubbles) {
    volume_fraction = &fields.add<double>("volume_fraction", Lifetime::carried);
    add_vector(fields, material_acceleration, "material_acceleration", d, Lifetime::carried);
    add_vector(fields, exchange, "bubble_exchange", d, Lifetime::scratch);
  }

  // r* is sorted with the state: it is what the order refers to.
  add_vector(fields, intermediate, "intermediate_position", d, Lifetime::carried);
  add_vector(fields, predicted, "predicted_velocity", d, Lifetime::scratch);
  reduced_pressure = &fields.add<double>("reduced_pressure", Lifetime::scratch);
  if (plan.gravity || plan.body_force) potential = &fields.add<double>("potential", Lifetime::scratch);
  divergence_of_position = &fields.add<float>("divergence_of_position", Lifetime::scratch);
  if (plan.density_relaxation) kernel_sum = &fields.add<float>("kernel_sum", Lifetime::scratch);
  laplacian_diagonal = &fields.add<float>("coupling", Lifetime::scratch);
  for (int k = 0; k < d * (d + 1) / 2; ++k)
    correction[k] = &fields.add<float>("gradient_correction_" + std::to_string(k), Lifetime::scratch);
  if (plan.shifting) add_vector(fields, shift, "shift", d, Lifetime::scratch);
  if (plan.shift_correction) add_vector(fields, shift_velocity, "shift_velocity", d, Lifetime::scratch);
  if (plan.free_surface) {
    add_vector(fields, normal, "normal", d, Lifetime::scratch);
    add_vector(fields, smoothed_normal, "smoothed_normal", d, Lifetime::scratch);
  }
  if (plan.stored_gradient)
    for (int k = 0; k < d * d; ++k)
      velocity_gradient[k] = &fields.add<float>("velocity_gradient_" + std::to_string(k), Lifetime::scratch);
  // Without a stage that differentiates the velocity this serves the first pressure only, and is released after it.
  strain = &fields.add<float>("strain", Lifetime::scratch);
  if (!plan.no_slip) gradient_trace = &fields.add<float>("gradient_trace", Lifetime::scratch);
  if (plan.eddy_viscosity) eddy_viscosity = &fields.add<float>("eddy_viscosity", Lifetime::scratch);
  if (plan.viscosity) diffusivity = &fields.add<float>("diffusivity", Lifetime::scratch);
  add_vector(fields, acceleration, "acceleration", d, Lifetime::scratch);
  if (plan.test_filter && plan.bubbles)
    add_vector(fields, filtered_velocity, "filtered_velocity", d, Lifetime::scratch);
  else if (plan.test_filter)
    filtered_velocity = acceleration;  // the closure is through with it before there is an acceleration
  fields.resize(n);

  parallel_for(n, [&](std::size_t i) {
    for (int axis = 0; axis < d; ++axis) {
      (*position[axis])[i] = scene.particles.position[axis][i];
      (*velocity[axis])[i] = scene.particles.velocity[axis][i];
    }
    (*identifier)[i] = static_cast<std::int64_t>(i);
    if (volume_fraction != nullptr) (*volume_fraction)[i] = 1;
  });

  const double support_radius = support_of(options.resolution.kernel) * smoothing_length;
  std::array<double, 3> lower{}, upper{};
  for (int axis = 0; axis < d; ++axis) {
    walls[axis] = {scene.domain.lower[axis], scene.domain.upper[axis]};
    lower[axis] = scene.domain.lower[axis] - support_radius;
    upper[axis] = scene.domain.upper[axis] + support_radius;
  }
  next_walls = walls;
  grid = CellGrid(d, lower, upper, support_radius, n);
  if (scene.body_force) uniform_body_force = uniform(*scene.body_force, scene.domain);

  context.list = &list;
  context.images = &images;
  context.dimensions = d;
  context.kernel = options.resolution.kernel;
  context.smoothing_length = smoothing_length;
  context.volume = volume;
  update_extremes(*this);
}

bool Liquid::dynamic_closure() const {
  return options.get<TurbulenceOptions>().model == TurbulenceModel::dynamic_shepard ||
         options.get<TurbulenceOptions>().model == TurbulenceModel::dynamic_lagrangian;
}

std::array<const double*, 3> Liquid::read(const VectorField& v) const {
  std::array<const double*, 3> pointers{};
  for (int axis = 0; axis < dimensions; ++axis) pointers[axis] = v[axis]->data();
  return pointers;
}

std::array<const float*, 3> Liquid::read(const FloatVectorField& v) const {
  std::array<const float*, 3> pointers{};
  for (int axis = 0; axis < dimensions; ++axis) pointers[axis] = v[axis]->data();
  return pointers;
}

std::array<float*, 3> Liquid::write(const FloatVectorField& v) const {
  std::array<float*, 3> pointers{};
  for (int axis = 0; axis < dimensions && v[axis] != nullptr; ++axis) pointers[axis] = v[axis]->data();
  return pointers;
}

std::array<const float*, 6> Liquid::read_correction() const {
  std::array<const float*, 6> pointers{};
  for (int k = 0; k < dimensions * (dimensions + 1) / 2; ++k) pointers[k] = correction[k]->data();
  return pointers;
}

double Liquid::potential_at(const Vec3& r) const {
  double sum = 0;
  for (int axis = 0; axis < dimensions; ++axis) sum -= uniform_acceleration[axis] * (r[axis] - origin[axis]);
  return sum;
}

}  // namespace spume::les_sph
