// SPDX-License-Identifier: MIT
// Everything a run writes while it goes on: series.csv, probes.csv, lines.csv, spectrum.csv, one <distribution>.csv
// per distribution (t, then its columns, at every spectrum time) and one <family>.vtkhdf per family of particles or
// of fields on a grid.
//
// probes.csv has a row whenever series.csv has one: t, then <name>_pressure and <name>_velocity_x, _y (, _z) of a
// point, <name> of an elevation or a front, <name>_area, _pressure and _velocity_x, ... of a plane: the averages over
// its liquid part, not a number where there is none. lines.csv and spectrum.csv are long tables:
// t,name,s,x,y,z,velocity_x, velocity_y,velocity_z,pressure at every output time, with s the distance from the start of
// the line, and t,wavenumber,energy at every spectrum time. Tables of the method (bubble_sizes.csv, bubble_traces.csv)
// are long too.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spume/io/series.hpp"
#include "spume/io/vtkhdf.hpp"
#include "spume/io/vtkhdf_grid.hpp"
#include "spume/methods/method.hpp"
#include "spume/scene/case.hpp"

namespace spume {

class Recorder {
 public:
  // How much of each file belongs to a state: rows per table, steps per family.
  using Extent = std::map<std::string, std::int64_t>;

  // Starts new files, or, with the extent of a checkpoint, continues those that are there and cuts what came later.
  Recorder(std::filesystem::path folder, const LoadedCase& loaded, const Method& method,
           const std::optional<Extent>& resume);

  void series(Method& method, double dt, std::int64_t retries);  // a row of series.csv and of probes.csv
  void snapshot(Method& method);                                 // every family, and the line probes
  void spectrum(Method& method);
  void flush();
  void sync();
  Extent extent() const;
  std::vector<std::pair<std::string, double>> last_row() const;  // of series.csv, by column
  const std::vector<SeriesColumn>& series_columns() const { return series_columns_; }
  std::span<const double> series_row() const { return series_row_; }  // the last one

 private:
  SeriesFile& table(const std::string& name, const std::string& title, const std::vector<SeriesColumn>& columns);
  void lines(Method& method);
  std::vector<std::pair<std::string, std::string>> notes() const;
  void own_tables(Method& method, bool with_series);

  std::filesystem::path folder_;
  const LoadedCase& loaded_;
  std::optional<Extent> resume_;
  std::map<std::string, SeriesFile> tables_;
  std::map<std::string, VtkhdfFile> families_;
  std::map<std::string, VtkhdfGridFile> grids_;
  std::vector<SeriesColumn> series_columns_, probe_columns_;
  std::vector<RecordTable> method_tables_;
  std::vector<double> series_row_, probe_row_, own_rows_;
};

// Names of the tables whose extents a checkpoint holds.
inline constexpr const char* table_names[] = {"series", "probes", "lines", "spectrum", "bubble_sizes", "bubble_traces"};

}  // namespace spume
