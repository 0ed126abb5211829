// SPDX-License-Identifier: MIT
// Everything a run writes while it goes on:
//   series.csv        a row per step, or per output.series_every
//   probes.csv        a row whenever series.csv has one (run/probes.hpp)
//   lines.csv         long: every line probe at every output time
//   <table>.csv       the tables of the method (methods/records.hpp), such as spectrum.csv, bubble_sizes.csv
//   interface.vtp.series, interface/*.vtp   surfaces between phases, with output.interface, a file per output time
//   <family>.vtkhdf   one per family of particles or of fields on a grid, a step per output time; beside it views for
//                     older readers
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "spume/io/polydata.hpp"
#include "spume/io/series.hpp"
#include "spume/io/vtkhdf.hpp"
#include "spume/io/vtkhdf_grid.hpp"
#include "spume/methods/method.hpp"
#include "spume/run/probe_averages.hpp"
#include "spume/scene/case.hpp"

namespace spume {

class Recorder {
 public:
  // How much of each file belongs to a state: rows per table, steps per family.
  using Extent = std::map<std::string, std::int64_t>;

  // Starts new files, or, with the extent of a checkpoint, continues those that are there and cuts what came later.
  // Precondition: require_probes(). Throws FileError.
  Recorder(std::filesystem::path folder, const LoadedCase& loaded, const Method& method,
           const std::optional<Extent>& resume);

  ProbeAverages& averages() { return averages_; }  // of the probes; take up every step

  void series(Method& method, double dt, std::int64_t retries);  // a row of series.csv and of what goes with it
  void snapshot(Method& method);                                 // families, lines and tables of output times
  void spectrum(Method& method);                                 // tables of the times of spectra
  void flush();
  void sync();
  Extent extent() const;
  std::vector<std::pair<std::string, double>> last_row() const;  // of series.csv, by column
  const std::vector<SeriesColumn>& series_columns() const { return series_.columns; }
  std::span<const double> series_row() const { return series_row_; }  // the last one

 private:
  void cut_families();
  void continue_tables();
  SeriesFile& file_of(const RecordTable& table);
  void fill_tables(Method& method, RecordTable::When when);

  std::filesystem::path folder_;
  const LoadedCase& loaded_;
  std::optional<Extent> resume_;
  ProbeAverages averages_;
  RecordTable series_, probes_, lines_;
  std::vector<RecordTable> method_tables_;
  std::map<std::string, SeriesFile> files_;  // of the tables, by name
  std::map<std::string, VtkhdfFile> particles_;
  std::map<std::string, VtkhdfGridFile> grids_;
  std::optional<PolyDataSeries> interfaces_;
  std::vector<double> series_row_, rows_;
};

}  // namespace spume
