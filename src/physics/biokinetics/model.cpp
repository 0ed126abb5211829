// SPDX-License-Identifier: MIT
#include "spume/physics/biokinetics/model.hpp"

#include <algorithm>
#include <stdexcept>

namespace spume::biokinetics {
namespace {

// A quotient without anything above and below is nothing: the substrate is used up.
double quotient(double above, double below) {
  return above > 0 ? above / below : 0;
}

double value(const Factor& factor, std::span<const double> c) {
  const double a = c[factor.a], k = factor.half_saturation;
  switch (factor.kind) {
    case Factor::Kind::linear:
      return a;
    case Factor::Kind::saturation:
      return quotient(a, k + a);
    case Factor::Kind::inhibition:
      return quotient(k, k + a);
    case Factor::Kind::surface: {
      const double below = k * c[factor.b] + a;
      return below > 0 ? 1 / below : 0;
    }
  }
  return 0;
}

}  // namespace

std::size_t Model::component(const std::string& name) const {
  const auto found = std::find(components.begin(), components.end(), name);
  if (found == components.end()) throw std::invalid_argument("the model has no component '" + name + "'");
  return static_cast<std::size_t>(found - components.begin());
}

double rate(const Process& process, std::span<const double> concentration) {
  double sum = 0;
  for (const Term& term : process.rate) {
    double product = term.coefficient;
    for (const Factor& factor : term.factors) product *= value(factor, concentration);
    sum += product;
  }
  return sum;
}

void reaction(const Model& model, std::span<const double> concentration, std::span<double> change) {
  std::fill(change.begin(), change.end(), 0.0);
  for (const Process& process : model.processes) {
    const double speed = rate(process, concentration);
    for (std::size_t i = 0; i < change.size(); ++i) change[i] += process.stoichiometry[i] * speed;
  }
}

double production(const Process& process, std::span<const double> content) {
  double sum = 0;
  for (std::size_t i = 0; i < content.size(); ++i) sum += process.stoichiometry[i] * content[i];
  return sum;
}

}  // namespace spume::biokinetics
