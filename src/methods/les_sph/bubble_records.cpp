// SPDX-License-Identifier: MIT
// What a run records of its bubbles, and their part of a checkpoint.
#include <algorithm>
#include <cmath>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/methods/les_sph/bubble_coupling.hpp"

namespace spume::les_sph {
namespace {

const std::string sizes_table = "bubble_sizes", traces_table = "bubble_traces";

bool saved(const FieldSet::Field& field) {
  return field.lifetime == Lifetime::carried && field.name.rfind("bubble_next_position", 0) != 0;
}

}  // namespace

void BubbleCoupling::add_columns(std::vector<SeriesColumn>& columns) const {
  columns.push_back({"bubbles", "1"});
  if (has_hinze_radius()) {
    columns.push_back({"bubbles_above_hinze", "1"});
    columns.push_back({"bubbles_below_hinze", "1"});
  }
  for (const auto& [name, unit] : std::initializer_list<std::pair<const char*, const char*>>{
           {"bubble_volume", "length^3, alive"},
           {"injected_volume", "length^3, since the start"},
           {"entrained_volume", "length^3, since the start"},
           {"burst_volume", "length^3, since the start"},
           {"breakups", "1, since the start"},
           {"entrained_bubbles", "1, since the start"},
           {"bursts", "1, since the start"},
           {"breakup_rate", "1/time, last step"},
           {"entrainment_rate", "length^3/time, last step"},
           {"burst_rate", "1/time, last step"},
           {"bubble_slip", "speed, mean of |u_b - u_l|, u_l resolved"},
           {"shift_norm", "speed, root mean square of the shift over dt"},
           {"smallest_volume_fraction", "1"},
           {"overfull_particles", "1, alpha < 1/2"}})
    columns.push_back({name, unit});
}

void BubbleCoupling::put_values(const Liquid& liquid, std::vector<double>& values) const {
  const double per_time = last_step_ > 0 ? 1 / last_step_ : 0;
  const auto rate = [&](auto now, auto before) { return per_time * static_cast<double>(now - before); };
  double shift_norm = 0;
  if (liquid.plan.shifting && liquid.size() > 0)
    shift_norm = per_time * std::sqrt(parallel_sum(liquid.size(),
                                                   [&](std::size_t i) {
                                                     double shift2 = 0;
                                                     for (const auto* shift : liquid.shift)
                                                       shift2 += double{(*shift)[i]} * (*shift)[i];
                                                     return shift2;
                                                   }) /
                                      static_cast<double>(liquid.size()));
  values = {static_cast<double>(population_.size())};
  if (has_hinze_radius()) {
    const auto counts = bubbles::count_about(population_, options_.hinze_radius);
    values.insert(values.end(), {static_cast<double>(counts.above), static_cast<double>(counts.below)});
  }
  values.insert(
      values.end(),
      {population_.total_volume(), history_.injected_volume, history_.entrained_volume, history_.burst_volume,
       static_cast<double>(history_.breakups), static_cast<double>(history_.entrained),
       static_cast<double>(history_.bursts), rate(history_.breakups, history_before_.breakups),
       rate(history_.entrained_volume, history_before_.entrained_volume), rate(history_.bursts, history_before_.bursts),
       mean_slip_, shift_norm, least_volume_fraction_, static_cast<double>(overfull_)});
}

ParticleSnapshot BubbleCoupling::family(const Liquid& liquid) {
  ParticleSnapshot family;
  family.name = "bubbles";
  family.size = population_.size();
  for (auto& array : snapshot_) array.resize(population_.size());
  parallel_for(population_.size(), [&](std::size_t b) {
    snapshot_[0][b] = population_.radius(b);
    snapshot_[1][b] = liquid.time - (*population_.birth_time)[b];
  });
  ParticleField velocity{"velocity", {}, {}};
  for (std::size_t a = 0; a < 3; ++a) {
    family.position.push_back(population_.position[a]->data());
    velocity.f64.push_back(population_.velocity[a]->data());
  }
  family.fields.push_back(velocity);
  family.fields.push_back({"radius", {snapshot_[0].data()}, {}});
  family.fields.push_back({"age", {snapshot_[1].data()}, {}});
  family.fields.push_back({"slip", {population_.slip->data()}, {}});
  family.fields.push_back({"id", {}, {population_.identifier->data()}});
  return family;
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

void BubbleCoupling::table_rows(const Liquid& liquid, const std::string& name, std::vector<double>& rows) {
  if (name == sizes_table) {
    const auto sizes = bubbles::size_distribution(population_, options_.hinze_radius);
    for (int k = 0; k < bubbles::SizeDistribution::bins; ++k)
      if (sizes.count[static_cast<std::size_t>(k)] > 0)
        rows.insert(rows.end(), {liquid.time, bubbles::SizeDistribution::centre(k),
                                 static_cast<double>(sizes.count[static_cast<std::size_t>(k)]), sizes.density(k)});
    return;
  }
  if (options_.trace_every == 0) return;
  if (options_.trace_interval > 0) {
    // Times are multiples of the interval; one row per multiple that a step passes.
    const double due = static_cast<double>(trace_due_) * options_.trace_interval;
    if (liquid.time < due * (1 - 1e-12)) return;
    trace_due_ = static_cast<std::int64_t>(std::floor(liquid.time / options_.trace_interval * (1 + 1e-12))) + 1;
  }
  for (std::size_t b = 0; b < population_.size(); ++b) {
    const std::int64_t id = (*population_.identifier)[b];
    if (id % options_.trace_every != 0) continue;
    rows.push_back(liquid.time);
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
                                   trace_due_};
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
  for (const auto& field : population_.fields.fields()) {
    if (!saved(*field)) continue;
    if (const auto* f64 = std::get_if<Array<double>>(&field->values)) writer.f64(field->name, *f64);
    if (const auto* i64 = std::get_if<Array<std::int64_t>>(&field->values)) writer.i64(field->name, *i64);
  }
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
  if (counters.size() != 12 || scalars.size() != 10 || pending.size() != sources.pending_volume.size() ||
      emitted.size() != sources.emitted.size() || cloud_out.size() != sources.cloud_out.size())
    throw FileError("the checkpoint's bubbles do not fit the case: it has other sources or another version");
  const auto n = static_cast<std::size_t>(counters[0]);
  population_.fields.resize(n);
  for (const auto& field : population_.fields.fields()) {
    if (!saved(*field)) continue;
    if (auto* f64 = std::get_if<Array<double>>(&field->values)) reader.f64(field->name, *f64);
    if (auto* i64 = std::get_if<Array<std::int64_t>>(&field->values)) reader.i64(field->name, *i64);
    if (std::visit([](const auto& array) { return array.size(); }, field->values) != n)
      throw FileError("the checkpoint's array '" + field->name + "' does not have one value per bubble");
  }
  population_.next_identifier = counters[1];
  history_ = {counters[2], counters[3], counters[4], counters[5], scalars[0], scalars[1], scalars[2]};
  history_before_ = {history_.injected, counters[6], counters[7], counters[8], scalars[3], scalars[4], scalars[5]};
  overfull_ = counters[9];
  most_overfull_ = counters[10];
  trace_due_ = counters[11];
  last_step_ = scalars[6];
  max_speed_ = scalars[7];
  least_volume_fraction_ = scalars[8];
  mean_slip_ = scalars[9];
  std::copy(pending.begin(), pending.end(), sources.pending_volume.begin());
  std::copy(emitted.begin(), emitted.end(), sources.emitted.begin());
  std::copy(cloud_out.begin(), cloud_out.end(), sources.cloud_out.begin());
}

}  // namespace spume::les_sph
