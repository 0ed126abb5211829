// SPDX-License-Identifier: MIT
#include "spume/particles/reports.hpp"

#include <algorithm>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"

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

void SnapshotTable::add(std::string name, bool standard, const VectorField& vector) {
  Entry entry{.name = std::move(name), .standard = standard};
  for (const Array<double>* component : vector)
    if (component != nullptr) entry.f64.push_back(component);
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

std::vector<std::string> SnapshotTable::names() const {
  std::vector<std::string> list;
  for (const Entry& entry : entries_) list.push_back(entry.name);
  return list;
}

ParticleSnapshot SnapshotTable::take(std::string name, std::size_t size, const VectorField& position,
                                     const std::vector<std::string>& wanted) {
  ParticleSnapshot snapshot;
  snapshot.name = std::move(name);
  snapshot.size = size;
  for (const Array<double>* component : position)
    if (component != nullptr) snapshot.position.push_back(component->data());
  for (const Entry& entry : entries_) {
    const bool take =
        wanted.empty() ? entry.standard : std::find(wanted.begin(), wanted.end(), entry.name) != wanted.end();
    if (!take) continue;
    ParticleField field{entry.name, {}, {}};
    for (const Array<double>* component : entry.f64) field.f64.push_back(component->data());
    if (entry.i64 != nullptr) field.i64.push_back(entry.i64->data());
    if (entry.value) {
      Array<double>& values = computed_[entry.name];
      values.resize(size);
      parallel_for(size, [&](std::size_t i) { values[i] = entry.value(i); });
      field.f64.push_back(values.data());
    }
    snapshot.fields.push_back(std::move(field));
  }
  return snapshot;
}

SavedNumbers& SavedNumbers::add(double& value) {
  numbers_.push_back(&value);
  return *this;
}

std::vector<double> SavedNumbers::get() const {
  std::vector<double> values;
  for (const double* number : numbers_) values.push_back(*number);
  return values;
}

void SavedNumbers::set(std::span<const double> values) const {
  if (values.size() != numbers_.size())
    throw FileError("the checkpoint was written by another version of the method: '" + name_ + "' holds " +
                    std::to_string(values.size()) + " numbers, expected " + std::to_string(numbers_.size()));
  for (std::size_t k = 0; k < numbers_.size(); ++k) *numbers_[k] = values[k];
}

}  // namespace spume
