// SPDX-License-Identifier: MIT
#include "spume/run/recorder.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/run/version.hpp"

namespace spume {
namespace {

constexpr const char* axes[] = {"x", "y", "z"};

std::vector<SeriesColumn> series_headings(const Method& method) {
  std::vector<SeriesColumn> columns = {{"step", "1"}, {"t", "time"}, {"dt", "time"}};
  for (const SeriesColumn& column : method.series_columns()) columns.push_back(column);
  columns.push_back({"retries", "steps refused so far"});
  return columns;
}

std::vector<SeriesColumn> probe_headings(const LoadedCase& loaded) {
  std::vector<SeriesColumn> columns = {{"t", "time"}};
  const int dimensions = loaded.scene.domain.dimensions;
  for (const auto& probe : loaded.options.probes) {
    if (probe.kind == ProbeKind::point || probe.kind == ProbeKind::plane) {
      if (probe.kind == ProbeKind::plane)
        columns.push_back({probe.name + "_area", dimensions == 2 ? "length" : "area"});
      columns.push_back({probe.name + "_pressure", "pressure"});
      for (int axis = 0; axis < dimensions; ++axis)
        columns.push_back({probe.name + "_velocity_" + axes[axis], "velocity"});
    } else if (probe.kind != ProbeKind::line) {
      columns.push_back({probe.name, "length"});
    }
  }
  return columns;
}

const std::vector<SeriesColumn> line_headings = {{"t", "time"},
                                                 {"name", ""},
                                                 {"s", "length"},
                                                 {"x", "length"},
                                                 {"y", "length"},
                                                 {"z", "length"},
                                                 {"velocity_x", "velocity"},
                                                 {"velocity_y", "velocity"},
                                                 {"velocity_z", "velocity"},
                                                 {"pressure", "pressure"}};
const std::vector<SeriesColumn> spectrum_headings = {
    {"t", "time"}, {"wavenumber", "1/length"}, {"energy", "velocity^2 length"}};

void probe_values(Method& method, const LoadedCase& loaded, std::vector<double>& row) {
  row.assign(1, method.time());
  for (const auto& probe : loaded.options.probes) {
    switch (probe.kind) {
      case ProbeKind::point: {
        const PointSample sample = method.sample(probe.position);
        row.push_back(sample.pressure);
        row.insert(row.end(), sample.velocity.begin(), sample.velocity.begin() + loaded.scene.domain.dimensions);
        break;
      }
      case ProbeKind::plane: {
        const PlaneSample sample =
            method.plane_average(probe.axis, probe.position[static_cast<std::size_t>(probe.axis)]);
        row.insert(row.end(), {sample.area, sample.pressure});
        row.insert(row.end(), sample.velocity.begin(), sample.velocity.begin() + loaded.scene.domain.dimensions);
        break;
      }
      case ProbeKind::elevation:
        row.push_back(method.elevation(probe.position));
        break;
      case ProbeKind::wetted:
        row.push_back(method.wetted_length(probe.position));
        break;
      case ProbeKind::front:
        row.push_back(method.front(probe.axis, probe.height));
        break;
      case ProbeKind::line:
        break;
    }
  }
}

std::vector<SeriesColumn> distribution_columns(const Distribution& distribution) {
  std::vector<SeriesColumn> columns = {{"t", "time"}};
  columns.insert(columns.end(), distribution.columns.begin(), distribution.columns.end());
  return columns;
}

}  // namespace

Recorder::Recorder(std::filesystem::path folder, const LoadedCase& loaded, const Method& method,
                   const std::optional<Extent>& resume)
    : folder_(std::move(folder)),
      loaded_(loaded),
      resume_(resume),
      series_columns_(series_headings(method)),
      probe_columns_(probe_headings(loaded)),
      method_tables_(method.tables()) {
  if (!resume_) return;
  // Files that began after the checkpoint do not belong to the state that continues.
  for (const char* name : table_names)
    if (resume_->count(name) == 0) std::filesystem::remove(folder_ / (std::string(name) + ".csv"));
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    const auto name = entry.path().stem().string();
    if (entry.path().extension() != ".vtkhdf") continue;
    const auto found = resume_->find(name + ".vtkhdf");
    const std::int64_t kept = found == resume_->end() ? 0 : found->second;
    if (is_grid_file(entry.path()))
      VtkhdfGridFile(entry.path(), {}).keep_steps(kept);
    else
      VtkhdfFile(entry.path(), {loaded.options.output.h5part_view, {}}).keep_steps(kept);
  }
  for (const auto& [name, count] : *resume_)
    if (count > 0 && name.ends_with(".vtkhdf") && !std::filesystem::exists(folder_ / name))
      throw FileError("cannot continue '" + (folder_ / name).string() +
                      "': the file is gone; bring it back, or run the case anew into another folder");
  if (resume_->count("series") != 0) table("series", "", series_columns_);
  if (resume_->count("probes") != 0) table("probes", "", probe_columns_);
  if (resume_->count("lines") != 0) table("lines", "", line_headings);
  if (resume_->count("spectrum") != 0) table("spectrum", "", spectrum_headings);
  for (const auto& distribution : method.distribution_headings()) {
    if (resume_->count(distribution.name) != 0)
      table(distribution.name, "", distribution_columns(distribution));
    else
      std::filesystem::remove(folder_ / (distribution.name + ".csv"));
  }
  for (const RecordTable& own : method_tables_)
    if (resume_->count(own.name) != 0) table(own.name, "", own.columns);
}

SeriesFile& Recorder::table(const std::string& name, const std::string& title,
                            const std::vector<SeriesColumn>& columns) {
  const auto found = tables_.find(name);
  if (found != tables_.end()) return found->second;
  const auto path = folder_ / (name + ".csv");
  const bool continues = resume_ && resume_->count(name) != 0;
  return tables_
      .emplace(name, continues ? SeriesFile::resume(path, columns, resume_->at(name))
                               : SeriesFile::create(path, title, columns))
      .first->second;
}

void Recorder::series(Method& method, double dt, std::int64_t retries) {
  series_row_.assign(series_columns_.size(), std::nan(""));
  series_row_[0] = static_cast<double>(method.step_count());
  series_row_[1] = method.time();
  series_row_[2] = dt;
  method.series_values(std::span(series_row_).subspan(3, series_row_.size() - 4));
  series_row_.back() = static_cast<double>(retries);
  table("series", loaded_.options.title + ": quantities of the whole domain over time", series_columns_)
      .row(series_row_);
  own_tables(method, true);
  if (probe_columns_.size() == 1) return;
  probe_values(method, loaded_, probe_row_);
  table("probes", loaded_.options.title + ": probes over time", probe_columns_).row(probe_row_);
}

void Recorder::lines(Method& method) {
  for (const auto& probe : loaded_.options.probes) {
    if (probe.kind != ProbeKind::line) continue;
    SeriesFile& file = table("lines", loaded_.options.title + ": values along lines at output times", line_headings);
    const int last = std::max(probe.samples - 1, 1);
    for (int i = 0; i < std::max(probe.samples, 1); ++i) {
      const double fraction = static_cast<double>(i) / last;
      Vec3 position{};
      double distance = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double run = fraction * (probe.end[axis] - probe.position[axis]);
        position[axis] = probe.position[axis] + run;
        distance += run * run;
      }
      const PointSample sample = method.sample(position);
      const double time = method.time();
      const double values[] = {std::sqrt(distance), position[0],        position[1],        position[2],
                               sample.velocity[0],  sample.velocity[1], sample.velocity[2], sample.pressure};
      file.row(std::span(&time, 1), probe.name, values);
    }
  }
}

std::vector<std::pair<std::string, std::string>> Recorder::notes() const {
  return {{"case", loaded_.options.resolved}, {"program_version", program_version()}, {"commit", program_commit()}};
}

void Recorder::snapshot(Method& method) {
  for (const auto& family : method.snapshot()) {
    const std::string name = family.name + ".vtkhdf";
    auto found = families_.find(name);
    if (found == families_.end()) {
      const VtkhdfFile::Options options{loaded_.options.output.h5part_view, notes()};
      found = families_.emplace(name, VtkhdfFile(folder_ / name, options)).first;
    }
    found->second.append(method.time(), family);
  }
  for (const auto& family : method.grid_snapshot()) {
    const std::string name = family.name + ".vtkhdf";
    auto found = grids_.find(name);
    if (found == grids_.end()) found = grids_.emplace(name, VtkhdfGridFile(folder_ / name, notes())).first;
    found->second.append(method.time(), family);
  }
  lines(method);
  own_tables(method, false);
}

void Recorder::own_tables(Method& method, bool with_series) {
  for (const RecordTable& own : method_tables_) {
    if (own.with_series != with_series) continue;
    method.table_rows(own.name, own_rows_);
    if (own_rows_.empty()) continue;
    SeriesFile& file = table(own.name, loaded_.options.title + ": " + own.title, own.columns);
    const std::size_t width = own.columns.size();
    for (std::size_t k = 0; k < own_rows_.size(); k += width) file.row(std::span(own_rows_).subspan(k, width));
  }
}

void Recorder::spectrum(Method& method) {
  std::vector<double> wavenumber, energy;
  if (method.spectrum(wavenumber, energy)) {
    SeriesFile& file = table("spectrum", loaded_.options.title + ": energy spectra", spectrum_headings);
    for (std::size_t i = 0; i < wavenumber.size(); ++i) {
      const double row[] = {method.time(), wavenumber[i], energy[i]};
      file.row(row);
    }
  }
  for (const auto& distribution : method.distributions()) {
    SeriesFile& file =
        table(distribution.name, loaded_.options.title + ": " + distribution.name, distribution_columns(distribution));
    const std::size_t columns = distribution.columns.size();
    std::vector<double> row(columns + 1, method.time());
    for (std::size_t i = 0; i + columns <= distribution.values.size(); i += columns) {
      std::copy_n(distribution.values.begin() + static_cast<std::ptrdiff_t>(i), columns, row.begin() + 1);
      file.row(row);
    }
  }
}

void Recorder::flush() {
  for (auto& [name, file] : tables_) file.flush();
}

void Recorder::sync() {
  for (auto& [name, file] : tables_) file.sync();
}

Recorder::Extent Recorder::extent() const {
  Extent extent;
  // Families that have not been written since the run was continued keep the extent they had.
  if (resume_)
    for (const auto& [name, count] : *resume_)
      if (name.ends_with(".vtkhdf")) extent[name] = count;
  for (const auto& [name, file] : tables_) extent[name] = file.rows();
  for (const auto& [name, file] : families_) extent[name] = file.steps();
  for (const auto& [name, file] : grids_) extent[name] = file.steps();
  return extent;
}

std::vector<std::pair<std::string, double>> Recorder::last_row() const {
  std::vector<std::pair<std::string, double>> row;
  for (std::size_t i = 0; i < series_row_.size(); ++i) row.emplace_back(series_columns_[i].name, series_row_[i]);
  return row;
}

}  // namespace spume
