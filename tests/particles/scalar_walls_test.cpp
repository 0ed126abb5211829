// SPDX-License-Identifier: MIT
// Scalars beside walls of bodies: wall points exchange nothing, images of sides as the particles that they mirror.
#include <gtest/gtest.h>

#include "particles/walled.hpp"
#include "spume/operators/scalar_transport.hpp"
#include "spume/operators/sph_operators.hpp"

namespace spume::test {
namespace {

struct Field {
  Array<double> values;
  Array<float> kappa, normalisation;
  std::array<Array<double>, 3> velocity;
  std::array<Array<float>, 3> shift;
  std::array<Array<float>, 6> identity;

  explicit Field(const Walled& walled) {
    const std::size_t n = walled.particles.size();
    const int d = walled.particles.dimensions;
    values.resize(n);
    kappa.resize(n);
    normalisation.resize(n);
    for (int axis = 0; axis < d; ++axis) {
      velocity[axis].resize(n);
      shift[axis].resize(n);
    }
    for (std::size_t i = 0; i < n; ++i) {
      values[i] = uniform(i, 70)[0];
      kappa[i] = static_cast<float>(viscosity * (0.5 + uniform(i, 71)[0]));
      normalisation[i] = static_cast<float>(kappa[i] / viscosity);
      for (int axis = 0; axis < d; ++axis) {
        velocity[axis][i] = uniform(i, 72)[static_cast<std::size_t>(axis)];
        shift[axis][i] =
            static_cast<float>(0.1 * walled.scene().spacing * (uniform(i, 73)[static_cast<std::size_t>(axis)] - 0.5));
      }
    }
    for (std::size_t k = 0; k < 6; ++k) {
      const bool diagonal = d == 2 ? k == 0 || k == 2 : k == 0 || k == 3 || k == 5;
      identity[k] = Array<float>(n, diagonal ? 1.0F : 0.0F);
    }
  }
  std::array<const float*, 3> moves() const { return {shift[0].data(), shift[1].data(), shift[2].data()}; }
  std::array<const float*, 6> correction() const {
    std::array<const float*, 6> pointers{};
    for (std::size_t k = 0; k < 6; ++k) pointers[k] = identity[k].data();
    return pointers;
  }

  static constexpr double viscosity = 0.3;
  static constexpr float diffusivity = 0.7F;
};

struct Found {
  Array<float> rate, change, exchange;
  explicit Found(std::size_t n) : rate(n), change(n), exchange(n) {}
};

Found by_own_sweep(Walled& walled, const Field& field) {
  Found found(walled.particles.size());
  const double* values[] = {field.values.data()};
  const double reference[] = {0};
  const float diffusivity[] = {Field::diffusivity};
  float* const rates[] = {found.rate.data()};
  float* const changes[] = {found.change.data()};
  scalar_transport_sweep(walled.arrangement.context, walled.arrangement.packed,
                         {.values = values,
                          .reference = reference,
                          .diffusivity = diffusivity,
                          .normalisation = field.normalisation.data(),
                          .inverse_schmidt = {},
                          .shift = field.moves(),
                          .correction = field.correction()},
                         {.rate = rates, .change = changes, .exchange = found.exchange.data()});
  return found;
}

// As the last of `count` scalars.
Found beside_viscosity(Walled& walled, const Field& field, std::size_t count, bool stress) {
  const std::size_t n = walled.particles.size();
  Found found(n);
  std::array<Array<float>, 3> acceleration{Array<float>(n), Array<float>(n), Array<float>(n)};
  const std::vector<const double*> values(count, field.values.data());
  const std::vector<double> least(count, 0.0);
  const std::vector<float> diffusivity(count, Field::diffusivity);
  std::vector<Array<float>> others(count - 1, Array<float>(n));
  std::vector<float*> rate, change;
  for (Array<float>& other : others) {
    rate.push_back(other.data());
    change.push_back(other.data());
  }
  rate.push_back(found.rate.data());
  change.push_back(found.change.data());
  const RidingScalars scalars{.values = values,
                              .reference = least,
                              .diffusivity = diffusivity,
                              .viscosity = Field::viscosity,
                              .shift = field.moves(),
                              .correction = field.correction(),
                              .rate = rate,
                              .change = change};
  viscous_sweep(walled.arrangement.context, walled.arrangement.packed,
                {field.velocity[0].data(), field.velocity[1].data(), field.velocity[2].data()},
                walled.boundary.velocity_rule(), field.kappa.data(),
                {acceleration[0].data(), acceleration[1].data(), acceleration[2].data()}, stress, {}, &scalars);
  return found;
}

// All over all pairs in double. Of a pair in float, coordinates below 1 are off by 2^-24 each, which changes a kernel
// by at most 4 |F(0)| per smoothing length; the value, the factors and their products by 40 roundings.
TEST(ScalarWalls, WallPointsExchangeNothingByEitherSweep) {
  for (const Layout& layout : wall_layouts()) {
    SCOPED_TRACE(layout.name);
    Walled walled(layout.text);
    const Field field(walled);
    reference::WallSums twin = walled.twin(smooth);
    for (std::size_t i = 0; i < twin.value.size(); ++i) twin.value[i].scalar = static_cast<double>(i);
    const int d = walled.particles.dimensions;
    const double epsilon = std::ldexp(1.0, -24), of_place = 4 * 2 * epsilon / walled.resolution.smoothing_length;
    std::vector<Found> ways;
    ways.push_back(by_own_sweep(walled, field));
    for (const std::size_t count : {1U, 3U, 5U})
      for (const bool stress : {false, true}) ways.push_back(beside_viscosity(walled, field, count, stress));
    for (std::size_t i = 0; i < walled.particles.size(); i += 3) {
      double rate = 0, exchange = 0, change = 0, low = 0, high = 0;
      double bound_of_rate = 0, bound_of_exchange = 0, bound_of_change = 0;
      twin.sum(i, {}, {}, true, [&](const Vec3& way, double r, const reference::Carried& other) {
        const auto j = static_cast<std::size_t>(other.scalar);
        const double a = double{field.normalisation[i]} + field.normalisation[j];
        const double weight = Field::diffusivity * twin.g(r) * a, difference = field.values[j] - field.values[i];
        const double error = of_place * twin.g(0) + 40 * epsilon * twin.g(r);
        double along = 0;
        for (int axis = 0; axis < d; ++axis) along += field.shift[axis][i] * way[axis];
        rate += weight * difference;
        exchange += weight;
        change += twin.g(r) * along * difference;
        low = std::min(low, difference);
        high = std::max(high, difference);
        bound_of_rate += Field::diffusivity * a * error;
        bound_of_exchange += Field::diffusivity * a * error;
        bound_of_change += error * length(way) * 0.1 * walled.scene().spacing;
      });
      EXPECT_NEAR(ways[0].exchange[i], exchange, bound_of_exchange);
      for (const Found& found : ways) {
        EXPECT_NEAR(found.rate[i], rate, bound_of_rate);
        EXPECT_NEAR(found.change[i], std::clamp(change, low / 2, high / 2), bound_of_change + 2 * epsilon);
      }
    }
  }
}

}  // namespace
}  // namespace spume::test
