// SPDX-License-Identifier: MIT
// What a run records of its bubbles, and their part of a checkpoint.
#include <algorithm>
#include <cmath>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/physics/bubbles/coupling.hpp"

namespace spume::bubbles {
namespace {

const std::string sizes_table = "bubble_sizes", traces_table = "bubble_traces";

}  // namespace

double BubbleCoupling::per_time(double change) const {
  return last_step_ > 0 ? 1 / last_step_ * change : 0;
}

// Root mean square of the shift over the step.
double BubbleCoupling::shift_speed() const {
  const std::size_t n = carrier_.size();
  if (carrier_.shift[0] == nullptr || n == 0) return 0;
  return per_time(std::sqrt(parallel_sum(n,
                                         [&](std::size_t i) {
                                           double shift2 = 0;
                                           for (const auto* shift : carrier_.shift)
                                             shift2 += double{(*shift)[i]} * (*shift)[i];
                                           return shift2;
                                         }) /
                            static_cast<double>(n)));
}

void BubbleCoupling::add_columns(SeriesTable& table) const {
  const auto number = [](auto value) { return static_cast<double>(value); };
  table.add("bubbles", "1", [this, number] { return number(population_.size()); });
  if (has_hinze_radius()) {
    table.add("bubbles_above_hinze", "1",
              [this, number] { return number(count_about(population_, options_.hinze_radius).above); });
    table.add("bubbles_below_hinze", "1",
              [this, number] { return number(count_about(population_, options_.hinze_radius).below); });
  }
  table.add("bubble_volume", "length^3, alive", [this] { return population_.total_volume(); });
  table.add("injected_volume", "length^3, since the start", [this] { return history_.injected_volume; });
  table.add("entrained_volume", "length^3, since the start", [this] { return history_.entrained_volume; });
  table.add("burst_volume", "length^3, since the start", [this] { return history_.burst_volume; });
  table.add("breakups", "1, since the start", [this, number] { return number(history_.breakups); });
  table.add("entrained_bubbles", "1, since the start", [this, number] { return number(history_.entrained); });
  table.add("bursts", "1, since the start", [this, number] { return number(history_.bursts); });
  table.add("inner_bursts", "1, of these with 6.5 spacings of liquid before them",
            [this, number] { return number(history_.inner_bursts); });
  table.add("breakup_rate", "1/time, last step",
            [this, number] { return per_time(number(history_.breakups - history_before_.breakups)); });
  table.add("entrainment_rate", "length^3/time, last step",
            [this] { return per_time(history_.entrained_volume - history_before_.entrained_volume); });
  table.add("burst_rate", "1/time, last step",
            [this, number] { return per_time(number(history_.bursts - history_before_.bursts)); });
  table.add("bubble_slip", "speed, mean of |u_b - u_l|, u_l resolved", [this] { return mean_slip_; });
  table.add("shift_norm", "speed, root mean square of the shift over dt", [this] { return shift_speed(); });
  table.add("smallest_volume_fraction", "1", [this] { return least_volume_fraction_; });
  table.add("overfull_particles", "1, alpha < 1/2", [this, number] { return number(overfull_); });
  if (exchanges_gas()) add_gas_columns(table);
}

void BubbleCoupling::add_snapshot_fields() {
  snapshot_.add("velocity", true, population_.velocity);
  snapshot_.add("radius", true, [this](std::size_t b) { return population_.radius(b); });
  snapshot_.add("age", true, [this](std::size_t b) { return carrier_.time - (*population_.birth_time)[b]; });
  snapshot_.add("slip", true, *population_.slip);
  snapshot_.add("id", true, *population_.identifier);
  if (exchanges_gas())
    snapshot_.add("oxygen_fraction", true, [this](std::size_t b) {
      return (*population_.oxygen)[b] / ((*population_.oxygen)[b] + (*population_.inert)[b]);
    });
}

ParticleSnapshot BubbleCoupling::snapshot() {
  return snapshot_.take("bubbles", population_.size(), population_.position, {});
}

std::vector<RecordTable> BubbleCoupling::tables() const {
  std::vector<RecordTable> list;
  if (has_hinze_radius())
    list.push_back({sizes_table,
                    "size distribution of the bubbles",
                    {{"t", "time"},
                     {"radius_over_hinze", "1, centre of the bin"},
                     {"count", "1"},
                     {"density", "1, integrates to one over radius_over_hinze"}},
                    RecordTable::When::output});
  if (options_.trace_every > 0)
    list.push_back({traces_table,
                    "chosen bubbles over time",
                    {{"t", "time"},
                     {"id", ""},
                     {"x", "length"},
                     {"y", "length"},
                     {"z", "length"},
                     {"velocity_x", "speed"},
                     {"velocity_y", "speed"},
                     {"velocity_z", "speed"},
                     {"radius", "length"},
                     {"slip", "speed relative to the resolved liquid"}},
                    RecordTable::When::series});
  return list;
}

void BubbleCoupling::table_rows(const std::string& name, std::vector<double>& rows) {
  if (name == sizes_table) {
    const auto sizes = size_distribution(population_, options_.hinze_radius);
    for (int k = 0; k < SizeDistribution::bins; ++k)
      if (sizes.count[static_cast<std::size_t>(k)] > 0)
        rows.insert(rows.end(), {carrier_.time, SizeDistribution::centre(k),
                                 static_cast<double>(sizes.count[static_cast<std::size_t>(k)]), sizes.density(k)});
    return;
  }
  if (options_.trace_every == 0) return;
  if (options_.trace_interval > 0) {
    // Times are multiples of the interval; one row per multiple that a step passes.
    const double due = static_cast<double>(trace_due_) * options_.trace_interval;
    if (carrier_.time < due * (1 - 1e-12)) return;
    trace_due_ = static_cast<std::int64_t>(std::floor(carrier_.time / options_.trace_interval * (1 + 1e-12))) + 1;
  }
  for (std::size_t b = 0; b < population_.size(); ++b) {
    const std::int64_t id = (*population_.identifier)[b];
    if (id % options_.trace_every != 0) continue;
    rows.push_back(carrier_.time);
    rows.push_back(static_cast<double>(id));
    for (const auto* vector : {&population_.position, &population_.velocity})
      for (std::size_t a = 0; a < 3; ++a) rows.push_back((*(*vector)[a])[b]);
    rows.push_back(population_.radius(b));
    rows.push_back((*population_.slip)[b]);
  }
}

std::string BubbleCoupling::note() {
  return std::exchange(note_, {});
}

void BubbleCoupling::save(StateWriter& writer) const {
  const std::int64_t counters[] = {static_cast<std::int64_t>(population_.size()),
                                   population_.next_identifier,
                                   history_.injected,
                                   history_.entrained,
                                   history_.breakups,
                                   history_.bursts,
                                   history_before_.entrained,
                                   history_before_.breakups,
                                   history_before_.bursts,
                                   overfull_,
                                   most_overfull_,
                                   trace_due_,
                                   history_.inner_bursts,
                                   most_inner_bursts_};
  const double scalars[] = {history_.injected_volume,
                            history_.entrained_volume,
                            history_.burst_volume,
                            history_before_.injected_volume,
                            history_before_.entrained_volume,
                            history_before_.burst_volume,
                            last_step_,
                            max_speed_,
                            least_volume_fraction_,
                            mean_slip_};
  writer.i64("bubble_counters", counters);
  writer.f64("bubble_scalars", scalars);
  const auto& sources = sources_.state;
  writer.f64("sparger_pending_volume", sources.pending_volume);
  writer.i64("sparger_emitted", sources.emitted);
  writer.i64("cloud_out", sources.cloud_out);
  save_fields(population_.fields, writer);
  if (!exchanges_gas()) return;
  const double gas[] = {oxygen_.released,        oxygen_.given,        oxygen_.left,     gas_totals_.given,
                        gas_totals_.conductance, gas_totals_.capacity, gas_totals_.area, oxygen_.dissolved};
  writer.f64("bubble_gas", gas);
}

void BubbleCoupling::load(StateReader& reader) {
  Array<std::int64_t> counters, emitted, cloud_out;
  Array<double> scalars, pending;
  reader.i64("bubble_counters", counters);
  reader.f64("bubble_scalars", scalars);
  reader.f64("sparger_pending_volume", pending);
  reader.i64("sparger_emitted", emitted);
  reader.i64("cloud_out", cloud_out);
  auto& sources = sources_.state;
  if (counters.size() != 14 || scalars.size() != 10 || pending.size() != sources.pending_volume.size() ||
      emitted.size() != sources.emitted.size() || cloud_out.size() != sources.cloud_out.size())
    throw FileError("the checkpoint's bubbles do not fit the case: it has other sources or another version");
  load_fields(population_.fields, static_cast<std::size_t>(counters[0]), "bubble", reader);
  population_.next_identifier = counters[1];
  history_ = {counters[2], counters[3], counters[4], counters[5], scalars[0], scalars[1], scalars[2], counters[12]};
  history_before_ = {history_.injected, counters[6], counters[7], counters[8],
                     scalars[3],        scalars[4],  scalars[5],  counters[12]};
  overfull_ = counters[9];
  most_overfull_ = counters[10];
  trace_due_ = counters[11];
  most_inner_bursts_ = counters[13];
  last_step_ = scalars[6];
  max_speed_ = scalars[7];
  least_volume_fraction_ = scalars[8];
  mean_slip_ = scalars[9];
  if (exchanges_gas()) {
    Array<double> gas;
    reader.f64("bubble_gas", gas);
    if (gas.size() != 8) throw FileError("the checkpoint's gas of bubbles is of another version");
    oxygen_ = {gas[0], gas[1], gas[2], gas[7]};
    gas_totals_ = {gas[3], gas[4], gas[5], gas[6]};
  }
  std::copy(pending.begin(), pending.end(), sources.pending_volume.begin());
  std::copy(emitted.begin(), emitted.end(), sources.emitted.begin());
  std::copy(cloud_out.begin(), cloud_out.end(), sources.cloud_out.begin());
}

}  // namespace spume::bubbles
