// SPDX-License-Identifier: MIT
// Diffusion of scalars and their change by a shift, against the slow twin over every arrangement.
#include "reference/scalar_transport.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "operators/sph_arrangement.hpp"
#include "spume/operators/scalar_transport.hpp"

namespace spume::test {
namespace {

// Scalars of different diffusivity on one arrangement, with what a sweep gives of them.
struct SweptScalars {
  std::vector<Array<double>> values;
  std::vector<float> diffusivity, inverse_schmidt;
  std::vector<double> reference;
  Array<float> eddy, normalisation;
  VectorArrays<float> shift;
  std::vector<Array<float>> rate, change;
  Array<float> exchange;

  SweptScalars(Arrangement& a, const Moments& moments, std::size_t count, bool eddies, bool shifted) {
    const std::size_t n = a.size();
    std::vector<const double*> in;
    std::vector<float*> rates, changes;
    for (std::size_t s = 0; s < count; ++s) {
      values.push_back(a.random(70 + static_cast<std::uint32_t>(s)));
      diffusivity.push_back(0.5F + static_cast<float>(s));
      inverse_schmidt.push_back(1 / (1 + static_cast<float>(s)));
      reference.push_back(-1);
      rate.emplace_back(n);
      change.emplace_back(n);
    }
    for (std::size_t s = 0; s < count; ++s) {
      in.push_back(values[s].data());
      rates.push_back(rate[s].data());
      changes.push_back(change[s].data());
    }
    exchange.resize(n);
    eddy.resize(n);
    for (std::size_t i = 0; i < n; ++i) eddy[i] = eddies ? static_cast<float>(uniform(i, 90)[0]) : 0;
    normalisation.resize(n);
    for (std::size_t i = 0; i < n; ++i) normalisation[i] = static_cast<float>(0.5 + uniform(i, 91)[0]);
    if (shifted)
      for (int axis = 0; axis < a.dimensions(); ++axis) {
        auto way = a.random(60 + static_cast<std::uint32_t>(axis));
        for (double& x : way) x *= 0.1 * a.setup.spacing;
        shift[axis] = to_float(way);
      }
    scalar_transport_sweep(a.context, a.packed,
                           {.values = in,
                            .reference = reference,
                            .diffusivity = diffusivity,
                            .normalisation = normalisation.data(),
                            .eddy_viscosity = eddies ? eddy.data() : nullptr,
                            .inverse_schmidt = inverse_schmidt,
                            .shift = shifted ? shift.read() : std::array<const float*, 3>{},
                            .correction = moments.read_correction()},
                           {.rate = rates, .change = changes, .exchange = exchange.data()});
  }
};

TEST(ScalarTransport, RatesChangesAndExchangeAgreeWithTheSlowTwin) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const Moments moments(a);
    const reference::ScalarTransport twin{a.twin, a.context.smoothing_length, a.context.volume};
    for (const std::size_t count : {1U, 2U, 3U, 4U, 5U, 6U, 9U})
      for (const bool eddies : {false, true})
        for (const bool shifted : {false, true}) {
          const SweptScalars swept(a, moments, count, eddies, shifted);
          Comparison rates("rate"), changes("change"), exchanges("exchange");
          for (std::size_t i = 0; i < a.size(); i += count == 1 ? 7 : 47) {
            // Beside that of a sum: the rounding of the value as a float, of the means of viscosity and a and of four
            // products.
            const double rounding = a.twin.tolerance(i) + 16 * std::ldexp(1.0, -24);
            reference::Sum most;
            for (std::size_t s = 0; s < count; ++s) {
              const double share = eddies ? swept.inverse_schmidt[s] : 0;
              auto rate = twin.rate(i, swept.values[s], swept.diffusivity[s], swept.normalisation, swept.eddy, share);
              const auto weights =
                  twin.rate(i, swept.values[s], swept.diffusivity[s], swept.normalisation, swept.eddy, share, true);
              rate.magnitude += 4 * weights.magnitude;  // values are held relative to -1
              rates.add(swept.rate[s][i], rate, rounding, i);
              if (weights.value > most.value) most = weights;
              if (!shifted) continue;
              reference::Vector way{};
              double length = 0;
              for (int axis = 0; axis < a.dimensions(); ++axis) {
                way[axis] = swept.shift[axis][i];
                length += std::abs(way[axis]);
              }
              auto change = twin.change(i, swept.values[s], way, moments.correction_of(i, a.dimensions()));
              change.magnitude *= 4;
              changes.add(swept.change[s][i], change, rounding, i);
            }
            exchanges.add(swept.exchange[i], most, rounding, i);
          }
        }
  }
}

// Antisymmetric but for the rounding of floats: of coordinates across periodic sides too, whose error of 2^-24 of the
// domain changes a kernel by at most 4 |F(0)| per smoothing length (SphSums::tolerance).
TEST(ScalarTransport, WhatAParticleGainsAnotherLoses) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const Moments moments(a);
    const reference::ScalarTransport twin{a.twin, a.context.smoothing_length, a.context.volume};
    const SweptScalars swept(a, moments, 2, true, false);
    for (std::size_t s = 0; s < 2; ++s) {
      double sum = 0, bound = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        sum += swept.rate[s][i];
        const auto weights = twin.rate(i, swept.values[s], swept.diffusivity[s], swept.normalisation, swept.eddy,
                                       swept.inverse_schmidt[s], true);
        bound += 4 * weights.magnitude *
                 (a.twin.tolerance(i) + (16 + 8 / a.context.smoothing_length) * std::ldexp(1.0, -24));
      }
      EXPECT_LE(std::abs(sum), bound);
      EXPECT_GT(swept.exchange[0], 0);
    }
  }
}

TEST(ScalarTransport, AUniformValueStays) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const Moments moments(a);
    Array<double> uniform_value(a.size());
    uniform_value.fill(0.3);
    Array<float> rate(a.size()), change(a.size()), exchange(a.size()), normalisation(a.size());
    normalisation.fill(1);
    VectorArrays<float> shift;
    for (int axis = 0; axis < a.dimensions(); ++axis) shift[axis] = to_float(a.random(60));
    const double* in[] = {uniform_value.data()};
    const double reference[] = {-0.1};
    const float diffusivity[] = {2};
    float* const rates[] = {rate.data()};
    float* const changes[] = {change.data()};
    scalar_transport_sweep(a.context, a.packed,
                           {.values = in,
                            .reference = reference,
                            .diffusivity = diffusivity,
                            .normalisation = normalisation.data(),
                            .inverse_schmidt = {},
                            .shift = shift.read(),
                            .correction = moments.read_correction()},
                           {.rate = rates, .change = changes, .exchange = exchange.data()});
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(rate[i], 0);
      EXPECT_EQ(change[i], 0);
    }
  }
}

// Scalars of different diffusivity that ride on a viscous sweep of uniform viscosity.
struct RiddenScalars {
  static constexpr double viscosity = 0.3;
  std::vector<Array<double>> values;
  std::vector<float> diffusivity;
  Array<float> kappa, normalisation, none;
  std::vector<Array<float>> rate, change;
  VectorArrays<double> velocity;
  VectorArrays<float> shift, acceleration;

  RiddenScalars(Arrangement& a, const Moments& moments, std::size_t count, bool stress, bool shifted, bool held)
      : velocity(random_velocity(a, 40)), acceleration(a.size(), a.dimensions()) {
    const std::size_t n = a.size();
    std::vector<const double*> in;
    std::vector<float*> rates, changes;
    for (std::size_t s = 0; s < count; ++s) {
      values.push_back(a.random(70 + static_cast<std::uint32_t>(s)));
      diffusivity.push_back(0.7F + static_cast<float>(s));
      rate.emplace_back(n);
      change.emplace_back(n);
    }
    for (std::size_t s = 0; s < count; ++s) {
      in.push_back(values[s].data());
      rates.push_back(rate[s].data());
      changes.push_back(change[s].data());
    }
    for (auto* array : {&kappa, &normalisation, &none}) array->resize(n);
    none.fill(0);
    for (std::size_t i = 0; i < n; ++i) {
      kappa[i] = static_cast<float>(viscosity * (0.5 + uniform(i, 91)[0]));
      normalisation[i] = static_cast<float>(kappa[i] / viscosity);
    }
    if (shifted)
      for (int axis = 0; axis < a.dimensions(); ++axis) {
        auto way = a.random(60 + static_cast<std::uint32_t>(axis));
        for (double& x : way) x *= 0.1 * a.setup.spacing;
        shift[axis] = to_float(way);
      }
    const std::vector<double> least(count, -1.0);
    const RidingScalars scalars{.values = in,
                                .reference = least,
                                .diffusivity = diffusivity,
                                .viscosity = viscosity,
                                .shift = shifted ? shift.read() : std::array<const float*, 3>{},
                                .correction = moments.read_correction(),
                                .rate = rates,
                                .change = changes};
    Array<float> share(n);
    share.fill(0.5);
    viscous_sweep(a.context, a.packed, velocity.read(), a.rule, kappa.data(), acceleration.write(), stress,
                  {held ? share.data() : nullptr, moments.read_correction()}, &scalars);
  }
};

// To the tolerance of the test above: kappa stands for nu a, and D / nu is rounded once.
TEST(ScalarTransport, ThoseThatRideOnTheViscousSweepAgreeWithTheSlowTwin) {
  for (Arrangement& a : all_arrangements()) {
    if (a.setup.sizes) continue;
    SCOPED_TRACE(a.setup.name);
    const Moments moments(a);
    const reference::ScalarTransport twin{a.twin, a.context.smoothing_length, a.context.volume};
    for (std::size_t count = 1; count <= most_riding_scalars; ++count)
      for (const bool stress : {false, true})
        for (const bool shifted : {false, true}) {
          const RiddenScalars ridden(a, moments, count, stress, shifted, stress != shifted);
          Comparison rates("rate"), changes("change");
          for (std::size_t i = 0; i < a.size(); i += count == 1 ? 7 : 47) {
            const double rounding = a.twin.tolerance(i) + 16 * std::ldexp(1.0, -24);
            reference::Vector way{};
            if (shifted)
              for (int axis = 0; axis < a.dimensions(); ++axis) way[axis] = ridden.shift[axis][i];
            for (std::size_t s = 0; s < count; ++s) {
              const auto& c = ridden.values[s];
              const double diffusivity = ridden.diffusivity[s];
              auto rate = twin.rate(i, c, diffusivity, ridden.normalisation, ridden.none, 0);
              const auto weights = twin.rate(i, c, diffusivity, ridden.normalisation, ridden.none, 0, true);
              rate.magnitude += 4 * weights.magnitude;
              rates.add(ridden.rate[s][i], rate, rounding, i);
              if (!shifted) continue;
              auto change = twin.change(i, c, way, moments.correction_of(i, a.dimensions()));
              change.magnitude *= 4;
              changes.add(ridden.change[s][i], change, rounding, i);
            }
          }
        }
  }
}

TEST(ScalarTransport, RidingScalarsChangeNoBitOfTheViscousAcceleration) {
  for (Arrangement& a : all_arrangements()) {
    if (a.setup.sizes) continue;
    SCOPED_TRACE(a.setup.name);
    const Moments moments(a);
    for (std::size_t count = 1; count <= most_riding_scalars; ++count)
      for (const bool stress : {false, true})
        for (const bool held : {false, true}) {
          const RiddenScalars ridden(a, moments, count, stress, true, held);
          Array<float> share(a.size());
          share.fill(0.5);
          VectorArrays<float> alone(a.size(), a.dimensions());
          viscous_sweep(a.context, a.packed, ridden.velocity.read(), a.rule, ridden.kappa.data(), alone.write(), stress,
                        {held ? share.data() : nullptr, moments.read_correction()});
          for (int axis = 0; axis < a.dimensions(); ++axis)
            EXPECT_TRUE(std::equal(alone[axis].begin(), alone[axis].end(), ridden.acceleration[axis].begin()));
        }
  }
}

TEST(ScalarTransport, NoMoreThanFiveScalarsRide) {
  Arrangement& a = all_arrangements().front();
  const Moments moments(a);
  EXPECT_THROW(RiddenScalars(a, moments, most_riding_scalars + 1, false, false, false), std::logic_error);
}

TEST(ScalarTransport, NoScalarRidesBesideParticlesOfDifferentSizes) {
  Arrangement& a = all_arrangements().back();
  ASSERT_TRUE(a.setup.sizes);
  const Moments moments(a);
  EXPECT_THROW(RiddenScalars(a, moments, 1, false, false, false), std::logic_error);
}

}  // namespace
}  // namespace spume::test
