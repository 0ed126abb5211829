// SPDX-License-Identifier: MIT
// The field sweeps against their slow twins, on random fields over every arrangement. The twins are given the float
// correction matrices of the kernel moments sweep: a sweep is held to its own arithmetic.
#include <gtest/gtest.h>

#include <limits>

#include "operators/sph_arrangement.hpp"

namespace spume::test {
namespace {

TEST(SphOperators, VelocityGradientAndFilterAgreeWithTheSlowTwin) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const int d = a.dimensions();
    const Moments moments(a);
    const auto u = random_velocity(a, 11);
    std::array<Array<float>, 9> gradient;
    VectorArrays<float> filtered(a.size(), d);
    VelocityGradientOut out;
    for (int k = 0; k < d * d; ++k) {
      gradient[k].resize(a.size());
      out.gradient[k] = gradient[k].data();
    }
    out.filtered = filtered.write();
    velocity_gradient_sweep(a.context, a.packed, u.read(), a.rule, moments.read_correction(), out);
    Comparison gradients("velocity gradient"), filter("filtered velocity");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double rounding = a.twin.tolerance(i);
      const auto slow = a.twin.velocity_gradient(i, u, moments.correction_of(i, d));
      const auto mean = a.twin.filtered_velocity(i, u);
      for (int r = 0; r < d; ++r) {
        for (int c = 0; c < d; ++c) gradients.add(gradient[r * d + c][i], slow[r][c], rounding, i);
        filter.add(filtered[r][i], mean[r], rounding, i);
      }
    }
    // Without the filter beside it the gradient is code of its own.
    std::array<Array<float>, 9> alone;
    VelocityGradientOut only;
    for (int k = 0; k < d * d; ++k) {
      alone[k].resize(a.size());
      only.gradient[k] = alone[k].data();
    }
    velocity_gradient_sweep(a.context, a.packed, u.read(), a.rule, moments.read_correction(), only);
    Comparison gradients_alone("velocity gradient without the filter");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto slow = a.twin.velocity_gradient(i, u, moments.correction_of(i, d));
      for (int r = 0; r < d; ++r)
        for (int c = 0; c < d; ++c) gradients_alone.add(alone[r * d + c][i], slow[r][c], a.twin.tolerance(i), i);
    }
    // So is what its trace is made of.
    Array<float> trace(a.size());
    gradient_trace_sweep(a.context, a.packed, u.read(), a.rule, moments.read_correction(), trace.data());
    for (std::size_t i = 0; i < a.size(); ++i) {
      float expected = 0;
      for (int r = 0; r < d; ++r)
        for (int c = 0; c < d; ++c) expected += gradient[r * d + c][i] * gradient[c * d + r][i];
      float size = 0;
      for (int k = 0; k < d * d; ++k) size += gradient[k][i] * gradient[k][i];
      // Components of code of its own, each off by the rounding of a sum, in products of two.
      EXPECT_NEAR(trace[i], expected, 16 * std::numeric_limits<float>::epsilon() * size) << "particle " << i;
    }
  }
}

struct BoundedChanges {
  std::size_t cut = 0, free = 0;
};

// The changes over random displacements of up to `length` spacings, with strain and trace, against the twin. `filter`
// takes the sweep that filters beside, which must give the same.
BoundedChanges compare_changes(double length, bool filter) {
  BoundedChanges changes_made;
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const int d = a.dimensions();
    const Moments moments(a);
    const auto u = random_velocity(a, 11);
    VectorArrays<float> displacement, change(a.size(), d), filtered(a.size(), d);
    for (int axis = 0; axis < d; ++axis) {
      auto values = a.random(60 + static_cast<std::uint32_t>(axis));
      for (double& value : values) value *= length * a.setup.spacing;
      displacement[axis] = to_float(values);
    }
    Array<float> strain(a.size()), trace(a.size());
    VelocityGradientOut out;
    out.strain = strain.data();
    out.trace = trace.data();
    out.displacement = displacement.read();
    out.change = change.write();
    if (filter) out.filtered = filtered.write();
    velocity_gradient_sweep(a.context, a.packed, u.read(), a.rule, moments.read_correction(), out);
    Comparison changes("change"), strains("squared strain"), traces("trace");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double rounding = a.twin.tolerance(i);
      const auto gradient = a.twin.velocity_gradient(i, u, moments.correction_of(i, d));
      reference::Sum square, product;  // their errors to first order in those of the gradient
      reference::Vector s{};
      for (int axis = 0; axis < d; ++axis) s[axis] = displacement[axis][i];
      for (int r = 0; r < d; ++r) {
        reference::Sum along;
        for (int c = 0; c < d; ++c) {
          along.value += gradient[r][c].value * displacement[c][i];
          along.magnitude += gradient[r][c].magnitude * std::abs(displacement[c][i]);
          const double mean = (gradient[r][c].value + gradient[c][r].value) / 2;
          square.value += 2 * mean * mean;
          square.magnitude += 2 * std::abs(mean) * (gradient[r][c].magnitude + gradient[c][r].magnitude);
          product.value += gradient[r][c].value * gradient[c][r].value;
          product.magnitude += 2 * std::abs(gradient[r][c].value) * gradient[c][r].magnitude;
        }
        const auto [low, high] = a.twin.change_bounds(i, u, s, r);
        const double bounded = std::clamp(along.value, allowed_change * low, allowed_change * high);
        (bounded == along.value ? changes_made.free : changes_made.cut) += 1;
        along.value = bounded;
        along.magnitude += std::abs(low) + std::abs(high);
        changes.add(change[r][i], along, rounding, i);
      }
      strains.add(strain[i] * strain[i], square, rounding, i);
      traces.add(trace[i], product, rounding, i);
    }
  }
  return changes_made;
}

// Random velocities are as rough as a field can be: a particle in three is an extreme on one side or on both.
TEST(SphOperators, ChangesOverADisplacementAreBoundedByTheNeighbours) {
  for (const bool filter : {false, true})
    for (const double length : {0.01, 1.0}) {
      const BoundedChanges made = compare_changes(length, filter);
      EXPECT_GT(made.cut, made.free / 20);
      EXPECT_GT(made.free, made.cut / 20);
    }
}

TEST(SphOperators, ViscousForceAgreesWithTheSlowTwin) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const auto u = random_velocity(a, 21);
    // Coefficients over six decades, some zero.
    Array<float> kappa(a.size());
    const auto random = a.random(24);
    for (std::size_t i = 0; i < a.size(); ++i)
      kappa[i] = random[i] > 0.9 ? 0.0F : static_cast<float>(std::pow(10.0, 3 * random[i] - 3));
    VectorArrays<float> fast(a.size(), a.dimensions());
    for (const bool stress : {false, true}) {
      viscous_sweep(a.context, a.packed, u.read(), a.rule, kappa.data(), fast.write(), stress);
      Comparison comparison(stress ? "acceleration by the viscous stress" : "viscous acceleration");
      for (std::size_t i = 0; i < a.size(); ++i) {
        const auto slow = stress ? a.twin.viscous_stress(i, u, kappa) : a.twin.viscous(i, u, kappa);
        for (int axis = 0; axis < a.dimensions(); ++axis)
          comparison.add(fast[axis][i], slow[axis], a.twin.tolerance(i), i);
      }
    }
  }
}

TEST(SphOperators, DivergenceAndPotentialLaplacianAgreeWithTheSlowTwin) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const Moments moments(a);
    const auto u = random_velocity(a, 31);
    const auto potential = a.random(35);
    Array<double> fast(a.size()), alone(a.size());
    Array<float> laplacian(a.size());
    divergence_sweep(a.context, a.packed, u.read(), a.rule, moments.read_correction(), potential.data(), fast.data(),
                     laplacian.data());
    divergence_sweep(a.context, a.packed, u.read(), a.rule, moments.read_correction(), nullptr, alone.data(), nullptr);
    Comparison divergence("divergence"), second("negative Laplacian");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double rounding = a.twin.tolerance(i);
      divergence.add(fast[i], a.twin.divergence(i, u, moments.correction_of(i, a.dimensions())), rounding, i);
      second.add(laplacian[i], a.twin.negative_laplacian(i, potential), rounding, i);
      EXPECT_EQ(fast[i], alone[i]) << "particle " << i << " depends on the potential";
    }
  }
}

TEST(SphOperators, GradientAgreesWithTheSlowTwin) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const Moments moments(a);
    auto values = a.random(41);
    for (double& value : values) value += 1e6;  // a large constant part costs no digits
    VectorArrays<float> fast(a.size(), a.dimensions());
    gradient_sweep(a.context, a.packed, values.data(), 1e6, moments.read_correction(), fast.write());
    Comparison comparison("gradient");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto slow = a.twin.gradient(i, values, 1e6, moments.correction_of(i, a.dimensions()));
      for (int axis = 0; axis < a.dimensions(); ++axis)
        comparison.add(fast[axis][i], slow[axis], a.twin.tolerance(i), i);
    }
  }
}

TEST(SphOperators, ShiftCurvatureAgreesWithTheSlowTwin) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const int d = a.dimensions();
    const Moments moments(a);
    std::array<Array<float>, 9> gradient;
    std::array<const float*, 9> read{};
    for (int k = 0; k < d * d; ++k) {
      gradient[k] = to_float(a.random(50 + static_cast<std::uint32_t>(k)));
      read[k] = gradient[k].data();
    }
    VectorArrays<float> shift, fast(a.size(), d);  // added to zeros
    for (int axis = 0; axis < d; ++axis) {
      auto values = a.random(60 + static_cast<std::uint32_t>(axis));
      for (double& value : values) value *= 0.1 * a.setup.spacing;
      shift[axis] = to_float(values);
    }
    shift_curvature_sweep(a.context, a.packed, read, a.rule, a.reflection, shift.read(), moments.read_correction(),
                          fast.write());
    Comparison comparison("shift curvature");
    for (std::size_t i = 0; i < a.size(); ++i) {
      reference::Vector s{};
      for (int axis = 0; axis < d; ++axis) s[axis] = shift[axis][i];
      const auto slow = a.twin.shift_curvature(i, gradient, s, moments.correction_of(i, d));
      for (int axis = 0; axis < d; ++axis) comparison.add(fast[axis][i], slow[axis], a.twin.tolerance(i), i);
    }
  }
}

TEST(SphOperators, ShepardFiltersAgreeWithTheSlowTwin) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const int d = a.dimensions();
    std::array<Array<float>, 3> in, out;
    for (int k = 0; k < 3; ++k) {
      in[k] = to_float(a.random(70 + static_cast<std::uint32_t>(k)));
      out[k].resize(a.size());
    }
    const std::array<const float*, 3> read{in[0].data(), in[1].data(), in[2].data()};
    const std::array<float*, 3> write{out[0].data(), out[1].data(), out[2].data()};
    filter_scalars(a.context, a.packed, read, write);  // a pair, then a single
    Comparison scalars("filtered scalar"), vectors("filtered vector");
    for (std::size_t i = 0; i < a.size(); ++i)
      for (int k = 0; k < 3; ++k) scalars.add(out[k][i], a.twin.filtered_scalar(i, in[k]), a.twin.tolerance(i), i);

    const auto expect_filtered_vector = [&] {
      for (std::size_t i = 0; i < a.size(); ++i) {
        const auto slow = a.twin.filtered_vector(i, in);
        for (int axis = 0; axis < d; ++axis) vectors.add(out[axis][i], slow[axis], a.twin.tolerance(i), i);
      }
    };
    filter_vector(a.context, a.packed, read, a.reflection, write);
    expect_filtered_vector();
    // Scalars whose images are told: the components of the same vector.
    filter_scalars(a.context, a.packed, std::span(read).first(static_cast<std::size_t>(d)),
                   std::span(write).first(static_cast<std::size_t>(d)), [&](std::size_t k, std::size_t m) {
                     const Images& images = *a.context.images;
                     return a.reflection[static_cast<std::size_t>(images.path()[m])][k] *
                            in[k][static_cast<std::size_t>(images.source()[m])];
                   });
    expect_filtered_vector();

    std::vector<std::int32_t> subset;
    for (std::size_t i = 0; i < a.size(); i += 3) subset.push_back(static_cast<std::int32_t>(i));
    for (auto& array : out) array.fill(-7);
    filter_vector_subset(a.context, a.packed, read, a.reflection, subset, write);
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (i % 3 != 0) {
        EXPECT_EQ(out[0][i], -7) << "particle " << i << " is not in the subset";
        continue;
      }
      const auto slow = a.twin.filtered_vector(i, in);
      for (int axis = 0; axis < d; ++axis) vectors.add(out[axis][i], slow[axis], a.twin.tolerance(i), i);
    }
  }
}

}  // namespace
}  // namespace spume::test
