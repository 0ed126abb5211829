// SPDX-License-Identifier: MIT
// A reaction network over time, in many particles at once.
//
// The table of a Model is walked for `lanes` particles at a time, so that reading it costs little beside the
// arithmetic. Steps are those of Dormand & Prince (1980), of fifth order with an error of fourth, chosen for each
// particle by itself: a particle that has arrived gives its lane to the next. Runge-Kutta steps keep every sum that the
// stoichiometry keeps (COD, nitrogen, charge) to rounding. A step that would make a concentration negative is taken
// again at a quarter of its length: what consumes a substance vanishes with it, so that a short one does not.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "spume/physics/biokinetics/model.hpp"

namespace spume::biokinetics {

class Integrator {
 public:
  static constexpr std::size_t lanes = 32;

  // A step is accepted when its error is below tolerance (|c| + 0.01 g/m^3) in every component.
  Integrator(const Model& model, double tolerance);

  std::size_t size() const { return components_; }
  struct Work {
    std::int64_t steps = 0, refused = 0;
  };
  // Advances particles [first, last) by `days`; concentration[i] holds component i of all particles. Throws
  // std::runtime_error when steps vanish, which a model does whose consumption goes on without its substance.
  Work advance(std::span<double* const> concentration, std::size_t first, std::size_t last, double days) const;

  // What reaction() gives, for one block: value of component i in lane l at [i * lanes + l].
  void rates(const double* concentration, double* change) const;

 private:
  struct Entry {
    std::size_t component;
    double number;
  };
  struct Product {
    double coefficient;
    std::vector<std::size_t> linear, factors;  // components, and entries of factors_
  };
  struct Row {
    std::vector<Product> terms;
    std::vector<Entry> stoichiometry;
  };
  std::size_t factor_index(const Factor& factor);

  std::size_t components_;
  double tolerance_;
  std::vector<Factor> factors_;  // those with a division, once each
  std::vector<Row> rows_;
};

}  // namespace spume::biokinetics
