// SPDX-License-Identifier: MIT
#include "spume/physics/turbulence/eddy_viscosity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "spume/core/parallel.hpp"
#include "spume/physics/turbulence/closures.hpp"

namespace spume::turbulence {
namespace {

template <int d>
Gradient<d> gradient_at(const ResolvedMotion& motion, std::size_t i) {
  Gradient<d> gradient;
  for (int k = 0; k < d * d; ++k) gradient[k] = motion.velocity_gradient[static_cast<std::size_t>(k)][i];
  return gradient;
}

// Test-filtered products of the dynamic closure: components of u u, S and |S| S, filtered two at a time. Velocities are
// taken from their mean, which the closure does not depend on and floats would lose L in. Those of images are the
// mirrored ones: at a no-slip wall products and strain change sign by component.
template <int d>
struct TestFilter {
  static constexpr int symmetric = d * (d + 1) / 2;
  static constexpr int count = 3 * symmetric;
  std::array<Array<float>, count> value, filtered;
  std::array<double, d> mean{};
  ScratchPool& scratch;

  explicit TestFilter(const ResolvedMotion& motion) : scratch(motion.particles.scratch()) {
    scratch.lease(value, count, motion.particles.size());
    scratch.lease(filtered, count, motion.particles.size());
  }
  TestFilter(const TestFilter&) = delete;
  TestFilter& operator=(const TestFilter&) = delete;
  ~TestFilter() {
    scratch.release(value);
    scratch.release(filtered);
  }

  // Component k at image m of the products as they stand in `value`.
  float at_image(const ResolvedMotion& motion, const ImageMap& map, std::size_t k, std::size_t m) const {
    const std::size_t source = map.source(m);
    if (k < symmetric) {
      const auto [a, b] = components(k);
      const auto velocity = [&](int axis) {
        return map.velocity(m, axis, motion.velocity[static_cast<std::size_t>(axis)][source]) - mean[axis];
      };
      return static_cast<float>(velocity(a) * velocity(b));
    }
    Gradient<d> gradient = gradient_at<d>(motion, source);
    for (int a = 0; a < d; ++a)
      for (int b = 0; b < d; ++b) gradient[a * d + b] = map.gradient(m, a, b, gradient[a * d + b]);
    const auto strain = strain_rate<d, double>(gradient);
    if (k < 2 * symmetric) return static_cast<float>(strain[k - symmetric]);
    return static_cast<float>(strain[k - 2 * symmetric] * strain_magnitude<d, double>(strain));
  }

  static std::pair<int, int> components(std::size_t k) {
    for (int a = 0; a < d; ++a)
      for (int b = a; b < d; ++b)
        if (symmetric_index<d>(a, b) == k) return {a, b};
    return {};
  }

  void run(const ResolvedMotion& motion) {
    const std::size_t n = motion.particles.size();
    for (int a = 0; a < d; ++a)
      mean[a] = parallel_sum(n, [&](std::size_t i) { return motion.velocity[static_cast<std::size_t>(a)][i]; }) /
                static_cast<double>(n);
    parallel_for(n, [&](std::size_t i) {
      const auto strain = strain_rate<d, double>(gradient_at<d>(motion, i));
      for (int a = 0; a < d; ++a)
        for (int b = a; b < d; ++b) {
          const std::size_t k = symmetric_index<d>(a, b);
          value[k][i] = static_cast<float>((motion.velocity[static_cast<std::size_t>(a)][i] - mean[a]) *
                                           (motion.velocity[static_cast<std::size_t>(b)][i] - mean[b]));
          value[symmetric + k][i] = static_cast<float>(strain[k]);
          value[2 * symmetric + k][i] = static_cast<float>(strain[k]) * motion.strain[i];
        }
    });
    const ImageMap map = motion.boundary.image_map(motion.arrangement.images);
    std::array<const float*, count> in;
    std::array<float*, count> out;
    for (int k = 0; k < count; ++k) {
      in[k] = value[k].data();
      out[k] = filtered[k].data();
    }
    filter_scalars(motion.arrangement.context, motion.arrangement.packed, in, out,
                   [&](std::size_t k, std::size_t m) { return at_image(motion, map, k, m); });
  }

  TestFiltered<d> at(const ResolvedMotion& motion, std::size_t i) const {
    TestFiltered<d> result;
    for (int a = 0; a < d; ++a) result.velocity[a] = motion.filtered_velocity[static_cast<std::size_t>(a)][i] - mean[a];
    for (int k = 0; k < symmetric; ++k) {
      result.velocity_product[k] = filtered[k][i];
      result.strain[k] = filtered[symmetric + k][i];
      result.strain_times_magnitude[k] = filtered[2 * symmetric + k][i];
    }
    return result;
  }
};

}  // namespace

EddyViscosity::EddyViscosity(ParticleStore& particles, const TurbulenceOptions& options) : options_(options) {
  viscosity_ = &particles.fields.add<float>("eddy_viscosity", Lifetime::result);
  if (options.model != TurbulenceModel::dynamic_lagrangian) return;
  lagrangian_average_[0] = &particles.fields.add<double>("average_leonard_germano", Lifetime::state);
  lagrangian_average_[1] = &particles.fields.add<double>("average_germano_germano", Lifetime::state);
}

template <int d>
void EddyViscosity::find_static(const ResolvedMotion& motion) {
  const bool mixed = options_.model == TurbulenceModel::mixed_scale;
  parallel_for(motion.particles.size(), [&](std::size_t i) {
    const double strain = motion.strain[i], width = motion.sizes.smoothing_length(motion.resolution, i);
    double viscosity = 0;
    if (mixed) {
      std::array<double, d> u, filtered;
      for (int a = 0; a < d; ++a) {
        u[a] = motion.velocity[static_cast<std::size_t>(a)][i];
        filtered[a] = motion.filtered_velocity[static_cast<std::size_t>(a)][i];
      }
      const double energy = test_filter_energy<d, double>(u, filtered);
      viscosity = mixed_scale_viscosity(strain, energy, width, options_.mixed_scale_constant);
    } else {
      viscosity = smagorinsky_viscosity(strain, width, options_.smagorinsky_constant);
    }
    (*viscosity_)[i] = static_cast<float>(viscosity);
  });
}

template <int d>
void EddyViscosity::find_dynamic(const ResolvedMotion& motion, double dt) {
  TestFilter<d> test_filter(motion);
  test_filter.run(motion);
  const std::size_t n = motion.particles.size();
  double ratio = 0;
  with_kernel(motion.arrangement.context, [&]<int dimensions, class Kernel>() {
    ratio = test_filter_width_ratio(1, Kernel::variance(dimensions));
  });
  const double nu = motion.kinematic_viscosity;
  const bool lagrangian = options_.model == TurbulenceModel::dynamic_lagrangian;

  if (lagrangian) motion.particles.scratch().lease(next_average_, 2, n);
  Array<float>&leonard = test_filter.value[0], &germano = test_filter.value[1];
  parallel_for(n, [&](std::size_t i) {
    const double width = motion.sizes.smoothing_length(motion.resolution, i);
    const auto c = germano_contractions<d, double>(test_filter.at(motion, i), width, ratio);
    if (lagrangian) {
      const GermanoContractions<double> memory{(*lagrangian_average_[0])[i], (*lagrangian_average_[1])[i]};
      const auto average = lagrangian_average(memory, c, width, dt);
      next_average_[0][i] = average.leonard_germano;
      next_average_[1][i] = average.germano_germano;
      (*viscosity_)[i] = static_cast<float>(dynamic_viscosity(average, motion.strain[i], width, nu));
    } else {
      leonard[i] = static_cast<float>(c.leonard_germano);
      germano[i] = static_cast<float>(c.germano_germano);
    }
  });
  if (lagrangian) return;
  const std::array<const float*, 2> in{leonard.data(), germano.data()};
  const std::array<float*, 2> out{test_filter.filtered[0].data(), test_filter.filtered[1].data()};
  filter_scalars(motion.arrangement.context, motion.arrangement.packed, in, out);
  parallel_for(n, [&](std::size_t i) {
    const GermanoContractions<double> average{out[0][i], out[1][i]};
    (*viscosity_)[i] = static_cast<float>(
        dynamic_viscosity(average, motion.strain[i], motion.sizes.smoothing_length(motion.resolution, i), nu));
  });
}

void EddyViscosity::find(const ResolvedMotion& motion, double dt) {
  const bool plane = motion.particles.dimensions == 2;
  if (dynamic())
    plane ? find_dynamic<2>(motion, dt) : find_dynamic<3>(motion, dt);
  else
    plane ? find_static<2>(motion) : find_static<3>(motion);
}

void EddyViscosity::accept(ParticleStore& particles) {
  if (options_.model != TurbulenceModel::dynamic_lagrangian) return;
  for (std::size_t k = 0; k < 2; ++k) lagrangian_average_[k]->swap(next_average_[k]);
  particles.scratch().release(next_average_);
}

double EddyViscosity::largest(std::size_t particles) const {
  return parallel_max(particles, 0.0, [&](std::size_t i) { return double{(*viscosity_)[i]}; });
}

bool EddyViscosity::dynamic() const {
  return options_.model == TurbulenceModel::dynamic_shepard || options_.model == TurbulenceModel::dynamic_lagrangian;
}

}  // namespace spume::turbulence
