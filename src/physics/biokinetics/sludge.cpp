// SPDX-License-Identifier: MIT
#include "spume/physics/biokinetics/sludge.hpp"

#include <utility>

#include "spume/core/parallel.hpp"

namespace spume::biokinetics {
namespace {

constexpr double day = 86400, hour = 3600;  // s
// Of rounding in a sum of steps that shall fill an interval.
constexpr double full = 1 - 1e-9;
// Particles of a block: 16 lanes full.
constexpr std::size_t block = 16 * Integrator::lanes;

}  // namespace

Sludge::Sludge(Scalars& scalars, const BiokineticsOptions& options)
    : scalars_(scalars),
      options_(options),
      integrator_(asm1_model(options.parameters), options.tolerance),
      values_(options.scalars.size()) {
  saved_.add(pending_).add(uptake_).add(rate_).add(steps_);
}

void Sludge::react(double dt) {
  pending_ += dt;
  if (pending_ < options_.interval * full) return;
  const std::size_t n = scalars_.particles();
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = scalars_.values(options_.scalars[i]).data();
  const std::size_t oxygen = options_.scalars[asm1::s_o];
  const double before = scalars_.amount(oxygen);
  keep_left_out();
  const double steps = parallel_reduce(
      n, 0.0,
      [&](std::size_t first, std::size_t last) {
        double sum = 0;
        for (std::size_t i = first; i < last; i += block)
          sum += static_cast<double>(integrator_.advance(values_, i, std::min(i + block, last), pending_ / day).steps);
        return sum;
      },
      [](double a, double b) { return a + b; });
  restore_left_out();
  const double taken = before - scalars_.amount(oxygen), volume = scalars_.liquid_volume();
  uptake_ += taken;
  rate_ = volume > 0 ? taken / volume / pending_ * hour : 0;
  steps_ = n > 0 ? steps / static_cast<double>(n) : 0;
  pending_ = 0;
}

// Layers behind openings stand among the particles that react a vector at a time: their values are put back.
void Sludge::keep_left_out() {
  kept_.clear();
  if (scalars_.left_out() == nullptr) return;
  parallel_select(scalars_.particles(), members_, [this](std::size_t i) { return !scalars_.counts(i); });
  for (const std::int32_t i : members_)
    for (const double* values : values_) kept_.push_back(values[i]);
}

void Sludge::restore_left_out() {
  if (kept_.empty()) return;
  auto kept = kept_.begin();
  for (const std::int32_t i : members_)
    for (double* values : values_) values[i] = *kept++;
}

void Sludge::react_in_cells(double dt, std::vector<std::vector<double>>& values, const std::vector<double>& volumes) {
  const std::size_t n = volumes.size();
  dt += std::exchange(pending_, 0.0);  // of the last interval between reactions, before the record
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = values[options_.scalars[i]].data();
  const double* oxygen = values_[asm1::s_o];
  double all = 0, before = 0, after = 0, steps = 0;
  for (std::size_t a = 0; a < n; ++a) {
    all += volumes[a];
    before += volumes[a] * oxygen[a];
  }
  for (std::size_t a = 0; a < n; a += block)
    steps += static_cast<double>(integrator_.advance(values_, a, std::min(a + block, n), dt / day).steps);
  for (std::size_t a = 0; a < n; ++a) after += volumes[a] * oxygen[a];
  uptake_ += before - after;
  rate_ = all > 0 ? (before - after) / all / dt * hour : 0;
  steps_ = n > 0 ? steps / static_cast<double>(n) : 0;
}

void Sludge::add_columns(SeriesTable& series) const {
  series.add("oxygen_uptake", "g, by the reactions since the start", [this] { return uptake_; });
  series.add("oxygen_uptake_rate", "g/m3/h, mean over the liquid", [this] { return rate_; });
  series.add("reaction_steps", "1, per particle in the last reaction", [this] { return steps_; });
}

}  // namespace spume::biokinetics
