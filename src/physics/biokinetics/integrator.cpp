// SPDX-License-Identifier: MIT
#include "spume/physics/biokinetics/integrator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "spume/core/array.hpp"

namespace spume::biokinetics {
namespace {

constexpr std::size_t lanes = Integrator::lanes;

// Dormand & Prince (1980), RK5(4)7M.
constexpr std::size_t stages = 7;
constexpr double a[stages][stages - 1] = {{},
                                          {1.0 / 5},
                                          {3.0 / 40, 9.0 / 40},
                                          {44.0 / 45, -56.0 / 15, 32.0 / 9},
                                          {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                                          {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                                          {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
constexpr double difference[stages] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                       -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

// Hairer, Norsett & Wanner (1993), section II.4.
constexpr double safety = 0.9, least_growth = 0.25, largest_growth = 5, exponent = 0.2;
// g/m^3, below which an error counts absolutely.
constexpr double least_scale = 0.01;
// A step of this share of the interval is shorter than its rounding.
constexpr double least_step = 16 * std::numeric_limits<double>::epsilon();

// A block of values: component i of lane l at [i * lanes + l].
using Values = Array<double>;

struct Lanes {
  std::array<std::size_t, lanes> particle{};
  std::array<double, lanes> t{}, h{};
  std::array<bool, lanes> busy{};
};

}  // namespace

Integrator::Integrator(const Model& model, double tolerance) : components_(model.size()), tolerance_(tolerance) {
  for (const Process& process : model.processes) {
    Row row;
    for (const Term& term : process.rate) {
      Product product{.coefficient = term.coefficient, .linear = {}, .factors = {}};
      for (const Factor& factor : term.factors)
        if (factor.kind == Factor::Kind::linear)
          product.linear.push_back(factor.a);
        else
          product.factors.push_back(factor_index(factor));
      row.terms.push_back(product);
    }
    for (std::size_t i = 0; i < components_; ++i)
      if (process.stoichiometry[i] != 0) row.stoichiometry.push_back({i, process.stoichiometry[i]});
    rows_.push_back(row);
  }
}

std::size_t Integrator::factor_index(const Factor& factor) {
  const auto same = [&](const Factor& f) {
    return f.kind == factor.kind && f.a == factor.a && f.b == factor.b && f.half_saturation == factor.half_saturation;
  };
  const auto found = std::find_if(factors_.begin(), factors_.end(), same);
  const auto index = static_cast<std::size_t>(found - factors_.begin());
  if (found == factors_.end()) factors_.push_back(factor);
  return index;
}

// Concentrations below zero, of stages, count as zero.
void Integrator::rates(const double* concentration, double* change) const {
  thread_local Values thread_values;
  thread_values.resize((components_ + factors_.size() + 2) * lanes);
  double* const c = thread_values.data();
  double* const quotient = c + components_ * lanes;
  double* const product = quotient + factors_.size() * lanes;
  double* const sum = product + lanes;
  for (std::size_t k = 0; k < components_ * lanes; ++k) c[k] = std::max(concentration[k], 0.0);
  for (std::size_t f = 0; f < factors_.size(); ++f) {
    const double *x = c + factors_[f].a * lanes, *y = c + factors_[f].b * lanes, k = factors_[f].half_saturation;
    double* out = quotient + f * lanes;
    // A quotient without anything above and below is nothing. Divisors that vanish are replaced before the division.
    switch (factors_[f].kind) {
      case Factor::Kind::saturation:
        for (std::size_t l = 0; l < lanes; ++l) out[l] = x[l] / (k + x[l] > 0 ? k + x[l] : 1.0);
        break;
      case Factor::Kind::inhibition:
        for (std::size_t l = 0; l < lanes; ++l) out[l] = k / (k + x[l] > 0 ? k + x[l] : 1.0);
        break;
      case Factor::Kind::surface:
        for (std::size_t l = 0; l < lanes; ++l) {
          const double below = k * y[l] + x[l];
          out[l] = (below > 0 ? 1.0 : 0.0) / (below > 0 ? below : 1.0);
        }
        break;
      case Factor::Kind::linear:
        break;
    }
  }
  std::fill_n(change, components_ * lanes, 0.0);
  for (const Row& row : rows_) {
    std::fill_n(sum, lanes, 0.0);
    for (const Product& term : row.terms) {
      std::fill_n(product, lanes, term.coefficient);
      for (const std::size_t i : term.linear)
        for (std::size_t l = 0; l < lanes; ++l) product[l] *= c[i * lanes + l];
      for (const std::size_t f : term.factors)
        for (std::size_t l = 0; l < lanes; ++l) product[l] *= quotient[f * lanes + l];
      for (std::size_t l = 0; l < lanes; ++l) sum[l] += product[l];
    }
    for (const Entry& entry : row.stoichiometry)
      for (std::size_t l = 0; l < lanes; ++l) change[entry.component * lanes + l] += entry.number * sum[l];
  }
}

Integrator::Work Integrator::advance(std::span<double* const> concentration, std::size_t first, std::size_t last,
                                     double days) const {
  thread_local Values thread_values;
  const std::size_t block = components_ * lanes;
  thread_values.resize((stages + 2) * block);
  double* const c = thread_values.data();
  double* const stage = c + block;
  double* const k = stage + block;
  std::fill_n(c, block, 0.0);
  Lanes lane;
  Work work;
  std::size_t next = first, busy = 0;
  const auto take = [&](std::size_t l) {
    lane.busy[l] = next < last;
    lane.t[l] = 0;
    lane.h[l] = lane.busy[l] ? days : 0;
    if (!lane.busy[l]) return;
    ++busy;
    lane.particle[l] = next++;
    for (std::size_t i = 0; i < components_; ++i) c[i * lanes + l] = concentration[i][lane.particle[l]];
  };
  for (std::size_t l = 0; l < lanes && days > 0; ++l) take(l);
  while (busy > 0) {
    rates(c, k);
    for (std::size_t s = 1; s < stages; ++s) {
      for (std::size_t i = 0; i < components_; ++i) {
        double sum[lanes] = {};
        for (std::size_t r = 0; r < s; ++r)
          for (std::size_t l = 0; l < lanes; ++l) sum[l] += a[s][r] * k[r * block + i * lanes + l];
        for (std::size_t l = 0; l < lanes; ++l) stage[i * lanes + l] = c[i * lanes + l] + lane.h[l] * sum[l];
      }
      rates(stage, k + s * block);
    }
    // The last stage is the result.
    double worst[lanes] = {};
    std::array<double, lanes> negative{};
    for (std::size_t i = 0; i < components_; ++i) {
      double error[lanes] = {};
      for (std::size_t r = 0; r < stages; ++r)
        for (std::size_t l = 0; l < lanes; ++l) error[l] += difference[r] * k[r * block + i * lanes + l];
      for (std::size_t l = 0; l < lanes; ++l) {
        const double before = c[i * lanes + l], after = stage[i * lanes + l];
        const double share = std::abs(lane.h[l] * error[l]) / (std::abs(before) + least_scale);
        worst[l] = share > worst[l] ? share : worst[l];
        negative[l] = after >= 0 || after >= before ? negative[l] : 1.0;  // also what is not a number
      }
    }
    for (std::size_t l = 0; l < lanes; ++l) {
      if (!lane.busy[l]) continue;
      const bool accepted = worst[l] <= tolerance_ && negative[l] == 0;
      const double growth = negative[l] != 0 ? least_growth
                                             : std::clamp(safety * std::pow(tolerance_ / worst[l], exponent),
                                                          least_growth, largest_growth);
      ++(accepted ? work.steps : work.refused);
      if (accepted) {
        const bool arrives = lane.t[l] + lane.h[l] >= days;
        lane.t[l] += lane.h[l];
        for (std::size_t i = 0; i < components_; ++i) c[i * lanes + l] = stage[i * lanes + l];
        if (arrives) {
          for (std::size_t i = 0; i < components_; ++i) concentration[i][lane.particle[l]] = c[i * lanes + l];
          --busy;
          take(l);
          continue;
        }
      }
      // A refused step may not grow, an error that is not a number shortens it.
      lane.h[l] *= accepted ? growth : growth < 1 ? growth : least_growth;
      if (!(lane.h[l] > least_step * days))
        throw std::runtime_error("concentrations of a particle cannot be kept above zero");
      if (lane.t[l] + lane.h[l] > days * (1 - least_step)) lane.h[l] = days - lane.t[l];
    }
  }
  return work;
}

}  // namespace spume::biokinetics
