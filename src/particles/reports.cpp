// SPDX-License-Identifier: MIT
#include "spume/particles/reports.hpp"

#include <algorithm>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/scene/side_names.hpp"

namespace spume {

void SeriesTable::add(std::string name, std::string unit, std::function<double()> value) {
  entries_.push_back({{std::move(name), std::move(unit)}, std::move(value)});
}

std::vector<SeriesColumn> SeriesTable::columns() const {
  std::vector<SeriesColumn> list;
  for (const Entry& entry : entries_) list.push_back(entry.column);
  return list;
}

void SeriesTable::values(std::span<double> row) const {
  if (prepare) prepare();
  for (std::size_t k = 0; k < entries_.size(); ++k) row[k] = entries_[k].value();
}

void add_wall_columns(SeriesTable& series, const Boundary& boundary) {
  const Domain& domain = boundary.domain();
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (std::size_t side = 0; side < 2; ++side) {
      const auto& velocity = domain.sides[axis][side].velocity;
      if (!velocity || velocity->component[axis] == nullptr) continue;
      series.add("wall_" + side_names(axis, domain.dimensions)[side], "length, where it stands",
                 [&boundary, axis, side] { return boundary.walls[axis][side]; });
    }
}

void SnapshotTable::add(std::string name, bool standard, const VectorField& vector) {
  Entry entry{.name = std::move(name), .standard = standard};
  for (const Array<double>* component : vector)
    if (component != nullptr) entry.f64.push_back(component);
  entries_.push_back(std::move(entry));
}

void SnapshotTable::add(std::string name, bool standard, const FloatVectorField& vector) {
  Entry entry{.name = std::move(name), .standard = standard};
  for (const Array<float>* component : vector)
    if (component != nullptr) entry.f32.push_back(component);
  entries_.push_back(std::move(entry));
}

void SnapshotTable::add(std::string name, bool standard, const Array<double>& values) {
  entries_.push_back({.name = std::move(name), .standard = standard, .f64 = {&values}});
}

void SnapshotTable::add(std::string name, bool standard, const Array<std::int64_t>& values) {
  entries_.push_back({.name = std::move(name), .standard = standard, .i64 = &values});
}

void SnapshotTable::add(std::string name, bool standard, std::function<double(std::size_t)> value) {
  entries_.push_back({.name = std::move(name), .standard = standard, .value = std::move(value)});
}

ParticleSnapshot SnapshotTable::take(std::string name, std::size_t size, const VectorField& position,
                                     const std::vector<std::string>& wanted) {
  ParticleSnapshot snapshot;
  snapshot.name = std::move(name);
  snapshot.size = size;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (position[axis] == nullptr) continue;
    const double* from = position[axis]->data();
    snapshot.position.push_back(from);
    if (domain_ == nullptr || !domain_->periodic(static_cast<int>(axis))) continue;
    shown_[axis].resize(size);
    double* to = shown_[axis].data();
    parallel_for(size, [=, this](std::size_t i) { to[i] = domain_->inside(static_cast<int>(axis), from[i]); });
    snapshot.position.back() = to;
  }
  for (const Entry& entry : entries_) {
    const bool take =
        wanted.empty() ? entry.standard : std::find(wanted.begin(), wanted.end(), entry.name) != wanted.end();
    if (!take) continue;
    ParticleField field{entry.name, {}, {}};
    for (const Array<double>* component : entry.f64) field.f64.push_back(component->data());
    if (entry.i64 != nullptr && entry.i64->empty()) zeros_.resize(size);
    if (entry.i64 != nullptr) field.i64.push_back(entry.i64->empty() ? zeros_.data() : entry.i64->data());
    if (!entry.f32.empty()) {
      for (std::size_t c = 0; c < entry.f32.size(); ++c) {
        Array<double>& values = computed_[entry.name + '_' + std::to_string(c)];
        values.resize(size);
        field.f64.push_back(values.data());
      }
      field.compute = [this, &entry, size] {
        for (std::size_t c = 0; c < entry.f32.size(); ++c) {
          Array<double>& values = computed_[entry.name + '_' + std::to_string(c)];
          const Array<float>& from = *entry.f32[c];
          parallel_for(size, [&](std::size_t i) { values[i] = from[i]; });
        }
      };
    }
    if (entry.value) {
      Array<double>& values = computed_[entry.name];
      values.resize(size);
      field.f64.push_back(values.data());
      field.compute = [&values, &entry, size] {
        parallel_for(size, [&](std::size_t i) { values[i] = entry.value(i); });
      };
    }
    snapshot.fields.push_back(std::move(field));
  }
  if (left_out_ != nullptr) gather(snapshot);
  return snapshot;
}

// Copies of what is not left out stand for the arrays of the state.
void SnapshotTable::gather(ParticleSnapshot& snapshot) {
  const Array<std::int64_t>& left_out = *left_out_;
  parallel_select(snapshot.size, chosen_, [&](std::size_t i) { return left_out[i] < 0; });
  const std::size_t n = chosen_.size();
  const auto copy = [&](const auto* from, auto& to) {
    to.resize(n);
    parallel_for(n, [&](std::size_t k) { to[k] = from[chosen_[k]]; });
    return to.data();
  };
  const auto copy_components = [&](const std::string& name, std::vector<const double*>& components) {
    std::vector<Array<double>>& copies = chosen_values_[name];
    copies.resize(components.size());
    for (std::size_t a = 0; a < components.size(); ++a) components[a] = copy(components[a], copies[a]);
  };
  copy_components("", snapshot.position);
  for (ParticleField& field : snapshot.fields) {
    if (field.compute) {
      field.compute();
      field.compute = {};
    }
    copy_components(field.name, field.f64);
    for (const std::int64_t*& numbers : field.i64) numbers = copy(numbers, chosen_numbers_[field.name]);
  }
  snapshot.size = n;
}

SavedNumbers& SavedNumbers::add(double& value) {
  numbers_.emplace_back(&value);
  return *this;
}

SavedNumbers& SavedNumbers::add(std::int64_t& value) {
  numbers_.emplace_back(&value);
  return *this;
}

void SavedNumbers::save(StateWriter& writer) const {
  std::vector<double> values;
  for (const auto& number : numbers_)
    values.push_back(std::visit([](const auto* value) { return static_cast<double>(*value); }, number));
  writer.f64(name_, values);
}

void SavedNumbers::load(StateReader& reader) const {
  Array<double> values;
  reader.f64(name_, values);
  if (values.size() != numbers_.size())
    throw FileError("the checkpoint was written by another version of the method: '" + name_ + "' holds " +
                    std::to_string(values.size()) + " numbers, expected " + std::to_string(numbers_.size()));
  for (std::size_t k = 0; k < numbers_.size(); ++k)
    std::visit([&]<class T>(T* value) { *value = static_cast<T>(values[k]); }, numbers_[k]);
}

std::vector<ArrayInfo> particle_arrays(const ParticleStore& particles, const Arrangement& arrangement) {
  std::vector<ArrayInfo> list;
  for (const auto& field : particles.fields.fields())
    list.push_back({field->name, std::visit([](const auto& array) { return array.bytes(); }, field->values)});
  list.push_back({"cell table", arrangement.table.bytes()});
  list.push_back({"images", arrangement.images.bytes()});
  list.push_back({"neighbour lists", arrangement.list.bytes()});
  list.push_back({"packed neighbours", arrangement.packed.bytes()});
  return list;
}

}  // namespace spume
