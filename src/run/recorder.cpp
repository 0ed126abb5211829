// SPDX-License-Identifier: MIT
#include "spume/run/recorder.hpp"

#include <cmath>

#include "spume/core/error.hpp"
#include "spume/run/probes.hpp"
#include "spume/run/version.hpp"

namespace spume {
namespace {

const char* const interface_name = "interface";

std::vector<SeriesColumn> series_headings(const Method& method) {
  std::vector<SeriesColumn> columns = {{"step", "1"}, {"t", "time"}, {"dt", "time"}};
  for (const SeriesColumn& column : method.series_columns()) columns.push_back(column);
  columns.push_back({"retries", "steps refused so far"});
  return columns;
}

std::vector<std::pair<std::string, std::string>> notes_of(const LoadedCase& loaded) {
  return {{"case", loaded.options.resolved}, {"program_version", program_version()}, {"commit", program_commit()}};
}

}  // namespace

Recorder::Recorder(std::filesystem::path folder, const LoadedCase& loaded, const Method& method,
                   const std::optional<Extent>& resume)
    : folder_(std::move(folder)),
      loaded_(loaded),
      resume_(resume),
      averages_(loaded.options.probes, loaded.probe_scalars),
      series_{"series", "quantities of the whole domain over time", series_headings(method)},
      probes_{"probes", "probes over time", probe_columns(loaded)},
      lines_{"lines", "values along lines at output times", line_columns(loaded)},
      method_tables_(method.tables()) {
  if (loaded.options.output.interface) interfaces_.emplace(folder_, interface_name);
  if (!resume_) return;
  cut_families();
  continue_tables();
}

// Steps after the checkpoint do not belong to the state that continues, nor do families that began after it.
void Recorder::cut_families() {
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    if (entry.path().extension() != ".vtkhdf") continue;
    const auto found = resume_->find(entry.path().filename().string());
    const std::int64_t kept = found == resume_->end() ? 0 : found->second;
    if (is_grid_file(entry.path()))
      VtkhdfGridFile(entry.path(), {loaded_.options.output.h5part_view, {}}).keep_steps(kept);
    else
      VtkhdfFile(entry.path(), {loaded_.options.output.h5part_view, {}}).keep_steps(kept);
  }
  if (interfaces_) {
    const auto found = resume_->find(PolyDataSeries::index_name(interface_name));
    interfaces_->keep_steps(found == resume_->end() ? 0 : found->second);
  }
  for (const auto& [name, count] : *resume_)
    if (count > 0 && name.ends_with(".vtkhdf") && !std::filesystem::exists(folder_ / name))
      throw FileError("cannot continue '" + (folder_ / name).string() +
                      "': the file is missing; restore it, or run the case again into another folder");
}

void Recorder::continue_tables() {
  std::vector<const RecordTable*> tables = {&series_, &probes_, &lines_};
  for (const RecordTable& table : method_tables_) tables.push_back(&table);
  for (const RecordTable* table : tables) {
    if (resume_->count(table->name) != 0)
      file_of(*table);
    else
      std::filesystem::remove(folder_ / (table->name + ".csv"));
  }
}

SeriesFile& Recorder::file_of(const RecordTable& table) {
  const auto found = files_.find(table.name);
  if (found != files_.end()) return found->second;
  const auto path = folder_ / (table.name + ".csv");
  const bool continues = resume_ && resume_->count(table.name) != 0;
  const std::string title = loaded_.options.title + ": " + table.title;
  return files_
      .emplace(table.name, continues ? SeriesFile::resume(path, table.columns, resume_->at(table.name))
                                     : SeriesFile::create(path, title, table.columns))
      .first->second;
}

void Recorder::series(Method& method, double dt, std::int64_t retries) {
  series_row_.assign(series_.columns.size(), std::nan(""));
  series_row_[0] = static_cast<double>(method.step_count());
  series_row_[1] = method.time();
  series_row_[2] = dt;
  method.series_values(std::span(series_row_).subspan(3, series_row_.size() - 4));
  series_row_.back() = static_cast<double>(retries);
  file_of(series_).row(series_row_);
  fill_tables(method, RecordTable::When::series);
  if (probes_.columns.size() == 1) return;
  probe_values(loaded_, method, averages_, rows_);
  file_of(probes_).row(rows_);
}

void Recorder::snapshot(Method& method) {
  for (const ParticleSnapshot& family : method.snapshot()) {
    const std::string name = family.name + ".vtkhdf";
    auto found = particles_.find(name);
    if (found == particles_.end()) {
      const VtkhdfFile::Options options{loaded_.options.output.h5part_view, notes_of(loaded_)};
      found = particles_.emplace(name, VtkhdfFile(folder_ / name, options)).first;
    }
    found->second.append(method.time(), family);
  }
  for (const GridSnapshot& family : method.grid_snapshot()) {
    const std::string name = family.name + ".vtkhdf";
    auto found = grids_.find(name);
    if (found == grids_.end()) {
      const VtkhdfGridFile::Options options{loaded_.options.output.h5part_view, notes_of(loaded_)};
      found = grids_.emplace(name, VtkhdfGridFile(folder_ / name, options)).first;
    }
    found->second.append(method.time(), family);
  }
  if (interfaces_) interfaces_->append(method.time(), method.interface_surface());
  for (const ProbeOptions& probe : loaded_.options.probes)
    if (probe.kind == ProbeKind::line) write_line(probe, method, file_of(lines_));
  fill_tables(method, RecordTable::When::output);
}

void Recorder::spectrum(Method& method) {
  fill_tables(method, RecordTable::When::spectrum);
}

void Recorder::fill_tables(Method& method, RecordTable::When when) {
  for (const RecordTable& table : method_tables_) {
    if (table.when != when) continue;
    rows_.clear();
    method.table_rows(table.name, rows_);
    if (rows_.empty()) continue;
    SeriesFile& file = file_of(table);
    const std::size_t width = table.columns.size();
    for (std::size_t k = 0; k < rows_.size(); k += width) file.row(std::span(rows_).subspan(k, width));
  }
}

void Recorder::flush() {
  for (auto& [name, file] : files_) file.flush();
}

void Recorder::sync() {
  for (auto& [name, file] : files_) file.sync();
}

Recorder::Extent Recorder::extent() const {
  Extent extent;
  // Families that have not been written since the run was continued keep the extent they had.
  if (resume_)
    for (const auto& [name, count] : *resume_)
      if (name.ends_with(".vtkhdf")) extent[name] = count;
  for (const auto& [name, file] : files_) extent[name] = file.rows();
  for (const auto& [name, file] : particles_) extent[name] = file.steps();
  for (const auto& [name, file] : grids_) extent[name] = file.steps();
  if (interfaces_) extent[PolyDataSeries::index_name(interface_name)] = interfaces_->steps();
  return extent;
}

std::vector<std::pair<std::string, double>> Recorder::last_row() const {
  std::vector<std::pair<std::string, double>> row;
  for (std::size_t i = 0; i < series_row_.size(); ++i) row.emplace_back(series_.columns[i].name, series_row_[i]);
  return row;
}

}  // namespace spume
