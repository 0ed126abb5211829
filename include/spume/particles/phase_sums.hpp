// SPDX-License-Identifier: MIT
// Mass, centre and momentum of each phase, for the series of methods with several.
#pragma once

#include <string>
#include <vector>

#include "spume/particles/reports.hpp"
#include "spume/particles/store.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

class PhaseSums {
 public:
  struct Sums {
    double mass = 0;
    Vec3 momentum{}, moment{};  // sum m u, sum m x
  };
  // `density` of each phase; `phase` of each particle, its index, not read of one phase. `left_out`: particles with 0
  // or more do not count; null: all do.
  PhaseSums(const ParticleStore& particles, const Array<std::int64_t>& phase, std::vector<double> density,
            const Array<std::int64_t>* left_out = nullptr)
      : particles_(particles),
        phase_(phase),
        density_(std::move(density)),
        left_out_(left_out),
        sums_(density_.size()) {}
  // Of the phases of a scene.
  PhaseSums(const ParticleStore& particles, const Array<std::int64_t>& phase, const Scene& scene,
            const Array<std::int64_t>* left_out);

  // Particles count inside along periodic axes of the domain, which outlives the sums, wherever they are.
  void go_round(const Domain& domain) { domain_ = &domain; }
  std::size_t size() const { return density_.size(); }
  void find();  // of the present state
  const Sums& of(std::size_t phase) const { return sums_[phase]; }
  // Columns centre_<name>_x ... and velocity_<name>_x ..., of the sums as they were found last.
  void add_columns(SeriesTable& series, std::size_t phase, const std::string& name) const;

 private:
  template <int dimensions>
  std::vector<Sums> sums_of(std::size_t first, std::size_t last) const;  // per phase

  const ParticleStore& particles_;
  const Array<std::int64_t>& phase_;
  std::vector<double> density_;
  const Array<std::int64_t>* left_out_;
  const Domain* domain_ = nullptr;
  std::vector<Sums> sums_;
};

}  // namespace spume
