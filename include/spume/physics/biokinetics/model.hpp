// SPDX-License-Identifier: MIT
// Reaction networks as data: components, processes with their rates as sums of products of switching factors, and a
// Petersen matrix of numbers. Another model is another table. Numbers of the equations are those of README.md beside
// the sources.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace spume::biokinetics {

// A factor of a rate, of the concentrations c[a] and c[b] and the half-saturation K, (2).
struct Factor {
  enum class Kind {
    linear,      // c_a
    saturation,  // c_a / (K + c_a)
    inhibition,  // K / (K + c_a)
    surface      // 1 / (K c_b + c_a): saturation by the ratio c_a / c_b, without the divisions by nothing
  };
  Kind kind;
  std::size_t a;
  double half_saturation = 0;
  std::size_t b = 0;
};

struct Term {
  double coefficient;
  std::vector<Factor> factors;
};

struct Process {
  std::string name;
  std::vector<Term> rate;             // summed, per day
  std::vector<double> stoichiometry;  // one number a component
};

struct Model {
  std::vector<std::string> components;
  std::vector<Process> processes;

  std::size_t size() const { return components.size(); }
  // Throws std::invalid_argument for a name that is not there.
  std::size_t component(const std::string& name) const;
};

// Rate of a process, (1). No concentration may be negative.
double rate(const Process& process, std::span<const double> concentration);

// Sets change[i] to the sum of stoichiometry times rate over the processes, (3), per day.
void reaction(const Model& model, std::span<const double> concentration, std::span<double> change);

// Sum of content[i] times stoichiometry[i]: what the process makes of a conserved quantity.
double production(const Process& process, std::span<const double> content);

}  // namespace spume::biokinetics
