// SPDX-License-Identifier: MIT
// Velocity gradients and the closures of the sub-resolution stress.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/liquid.hpp"
#include "spume/physics/turbulence/closures.hpp"

namespace spume::les_sph {
namespace {

template <int d>
turbulence::Gradient<d> gradient_at(const Liquid& liquid, std::size_t i) {
  turbulence::Gradient<d> gradient;
  for (int k = 0; k < d * d; ++k) gradient[k] = (*liquid.velocity_gradient[k])[i];
  return gradient;
}

template <int d>
void find_static_viscosity(Liquid& liquid) {
  const TurbulenceOptions& options = liquid.options.get<TurbulenceOptions>();
  const bool mixed = options.model == TurbulenceModel::mixed_scale;
  parallel_for(liquid.size(), [&](std::size_t i) {
    const double strain = (*liquid.strain)[i], width = liquid.width_at(i);
    double viscosity = 0;
    if (mixed) {
      std::array<double, d> u, filtered;
      for (int a = 0; a < d; ++a) {
        u[a] = (*liquid.velocity[a])[i];
        filtered[a] = (*liquid.filtered_velocity[a])[i];
      }
      const double energy = turbulence::test_filter_energy<d, double>(u, filtered);
      viscosity = turbulence::mixed_scale_viscosity(strain, energy, width, options.mixed_scale_constant);
    } else {
      viscosity = turbulence::smagorinsky_viscosity(strain, width, options.smagorinsky_constant);
    }
    (*liquid.eddy_viscosity)[i] = static_cast<float>(viscosity);
  });
}

// Test-filtered products of the dynamic closure: components of u u, S and |S| S, filtered two at a time. Velocities are
// taken from their mean, which the closure does not depend on and floats would lose L in. Those of images are the
// mirrored ones: at a no-slip wall products and strain change sign by component.
template <int d>
struct TestFilter {
  static constexpr int symmetric = d * (d + 1) / 2;
  static constexpr int count = 3 * symmetric;
  std::span<Array<float>> value, filtered;
  std::array<double, d> mean{};

  explicit TestFilter(Liquid& liquid) {
    liquid.test_filter_scratch.resize(2 * count);
    for (auto& array : liquid.test_filter_scratch) array.resize(liquid.size());
    value = std::span(liquid.test_filter_scratch).first(count);
    filtered = std::span(liquid.test_filter_scratch).last(count);
  }

  // Component k at image m of the products as they stand in `value`.
  float at_image(const Liquid& liquid, std::size_t k, std::size_t m) const {
    const auto source = static_cast<std::size_t>(liquid.images.source()[m]);
    const auto path = static_cast<std::size_t>(liquid.images.path()[m]);
    const auto& sign = liquid.velocity_rule.sign[path];
    if (k < symmetric) {
      const auto [a, b] = components(k);
      const auto velocity = [&](int axis) {
        const bool moving = !liquid.velocity_rule.offset[axis].empty();
        return sign[axis] * (*liquid.velocity[axis])[source] + (moving ? liquid.velocity_rule.offset[axis][m] : 0.0F) -
               mean[axis];
      };
      return static_cast<float>(velocity(a) * velocity(b));
    }
    turbulence::Gradient<d> gradient = gradient_at<d>(liquid, source);
    for (int a = 0; a < d; ++a)
      for (int b = 0; b < d; ++b) gradient[a * d + b] *= sign[a] * liquid.reflection[path][b];
    const auto strain = turbulence::strain_rate<d, double>(gradient);
    if (k < 2 * symmetric) return static_cast<float>(strain[k - symmetric]);
    return static_cast<float>(strain[k - 2 * symmetric] * turbulence::strain_magnitude<d, double>(strain));
  }

  static std::pair<int, int> components(std::size_t k) {
    for (int a = 0; a < d; ++a)
      for (int b = a; b < d; ++b)
        if (turbulence::symmetric_index<d>(a, b) == k) return {a, b};
    return {};
  }

  void run(Liquid& liquid) {
    const std::size_t n = liquid.size();
    for (int a = 0; a < d; ++a)
      mean[a] = parallel_sum(n, [&](std::size_t i) { return (*liquid.velocity[a])[i]; }) / static_cast<double>(n);
    parallel_for(n, [&](std::size_t i) {
      const auto strain = turbulence::strain_rate<d, double>(gradient_at<d>(liquid, i));
      for (int a = 0; a < d; ++a)
        for (int b = a; b < d; ++b) {
          const std::size_t k = turbulence::symmetric_index<d>(a, b);
          value[k][i] = static_cast<float>(((*liquid.velocity[a])[i] - mean[a]) * ((*liquid.velocity[b])[i] - mean[b]));
          value[symmetric + k][i] = static_cast<float>(strain[k]);
          value[2 * symmetric + k][i] = static_cast<float>(strain[k]) * (*liquid.strain)[i];
        }
    });
    std::array<const float*, count> in;
    std::array<float*, count> out;
    for (int k = 0; k < count; ++k) {
      in[k] = value[k].data();
      out[k] = filtered[k].data();
    }
    filter_scalars(liquid.context, liquid.records, in, out,
                   [&](std::size_t k, std::size_t m) { return at_image(liquid, k, m); });
  }

  turbulence::TestFiltered<d> at(const Liquid& liquid, std::size_t i) const {
    turbulence::TestFiltered<d> result;
    for (int a = 0; a < d; ++a) result.velocity[a] = (*liquid.filtered_velocity[a])[i] - mean[a];
    for (int k = 0; k < symmetric; ++k) {
      result.velocity_product[k] = filtered[k][i];
      result.strain[k] = filtered[symmetric + k][i];
      result.strain_times_magnitude[k] = filtered[2 * symmetric + k][i];
    }
    return result;
  }
};

template <int d>
void find_dynamic_viscosity(Liquid& liquid, double dt) {
  TestFilter<d> test_filter(liquid);
  test_filter.run(liquid);
  const std::size_t n = liquid.size();
  double ratio = 0;
  with_kernel(liquid.context, [&]<int dimensions, class Kernel>() {
    ratio = turbulence::test_filter_width_ratio(1, Kernel::variance(dimensions));
  });
  const double nu = liquid.scene.fluid.kinematic_viscosity;
  const bool lagrangian = liquid.options.get<TurbulenceOptions>().model == TurbulenceModel::dynamic_lagrangian;

  Array<float>&leonard = test_filter.value[0], &germano = test_filter.value[1];
  parallel_for(n, [&](std::size_t i) {
    const double width = liquid.width_at(i);
    const auto c = turbulence::germano_contractions<d, double>(test_filter.at(liquid, i), width, ratio);
    if (lagrangian) {
      const turbulence::GermanoContractions<double> memory{(*liquid.lagrangian_average[0])[i],
                                                           (*liquid.lagrangian_average[1])[i]};
      const auto average = turbulence::lagrangian_average(memory, c, width, dt);
      // Written when the step is accepted would need two more arrays; a rejected step only ages the memory.
      (*liquid.lagrangian_average[0])[i] = average.leonard_germano;
      (*liquid.lagrangian_average[1])[i] = average.germano_germano;
      (*liquid.eddy_viscosity)[i] =
          static_cast<float>(turbulence::dynamic_viscosity(average, (*liquid.strain)[i], width, nu));
    } else {
      leonard[i] = static_cast<float>(c.leonard_germano);
      germano[i] = static_cast<float>(c.germano_germano);
    }
  });
  if (lagrangian) return;
  const std::array<const float*, 2> in{leonard.data(), germano.data()};
  const std::array<float*, 2> out{test_filter.filtered[0].data(), test_filter.filtered[1].data()};
  filter_scalars(liquid.context, liquid.records, in, out);
  parallel_for(n, [&](std::size_t i) {
    const turbulence::GermanoContractions<double> average{out[0][i], out[1][i]};
    (*liquid.eddy_viscosity)[i] =
        static_cast<float>(turbulence::dynamic_viscosity(average, (*liquid.strain)[i], liquid.width_at(i), nu));
  });
}

}  // namespace

void differentiate_velocity(Liquid& liquid) {
  VelocityGradientOut out;
  if (liquid.plan.stored_gradient)
    for (int k = 0; k < liquid.dimensions * liquid.dimensions; ++k)
      out.gradient[k] = liquid.velocity_gradient[k]->data();
  if (liquid.plan.test_filter) out.filtered = liquid.write(liquid.filtered_velocity);
  out.strain = liquid.strain->data();
  const bool first = !liquid.started;  // the first pressure
  if (liquid.gradient_trace != nullptr && (liquid.options.get<SchemeOptions>().centred || first))
    out.trace = liquid.gradient_trace->data();
  if (liquid.plan.shift_correction) {
    out.displacement = liquid.read(liquid.shift);
    out.change = liquid.write(liquid.shift_velocity);
  }
  velocity_gradient_sweep(liquid.context, liquid.records, liquid.read(liquid.velocity), liquid.velocity_rule,
                          liquid.read_correction(), out);
}

void find_shift_curvature(Liquid& liquid) {
  std::array<const float*, 9> gradient{};
  for (int k = 0; k < liquid.dimensions * liquid.dimensions; ++k) gradient[k] = liquid.velocity_gradient[k]->data();
  shift_curvature_sweep(liquid.context, liquid.records, gradient, liquid.velocity_rule, liquid.reflection,
                        liquid.read(liquid.shift), liquid.read_correction(), liquid.write(liquid.shift_velocity));
}

void find_eddy_viscosity(Liquid& liquid, double dt) {
  if (liquid.dynamic_closure()) {
    if (liquid.dimensions == 2)
      find_dynamic_viscosity<2>(liquid, dt);
    else
      find_dynamic_viscosity<3>(liquid, dt);
  } else {
    if (liquid.dimensions == 2)
      find_static_viscosity<2>(liquid);
    else
      find_static_viscosity<3>(liquid);
  }
}

}  // namespace spume::les_sph
