// SPDX-License-Identifier: MIT
// What a run has left, or a file of results alone, as the live view shows it.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "spume/io/result_file.hpp"
#include "spume/view/frame.hpp"
#include "spume/view/history.hpp"

namespace spume {

class PlayedRun {
 public:
  // A run folder or any folder with result files, or one such file. Throws InputError when there is nothing to show,
  // FileError for a file that cannot be read.
  explicit PlayedRun(std::filesystem::path path);

  std::string title, method, place;  // empty where the case tells none
  int dimensions = 3;
  std::array<double, 3> lower{}, upper{};   // of the case, or of the first and the last state
  double spacing = 0;                       // of the case, or of as many particles in that box
  std::vector<std::string> columns, units;  // of series.csv
  SeriesHistory series;
  std::vector<std::string> lines;  // of log.txt, the last ones
  std::string ledger;              // ledger.json; empty without

  const std::vector<double>& times() const { return families_.front().times(); }
  std::size_t nearest(double time) const;
  // The state that is shown; it is read once as long as the same one is asked for.
  FrameSide state(std::size_t step);
  // Into other arrays, for who goes through many.
  void read(std::size_t step, ResultStep& into) const;
  // Whether a run has added states or rows meanwhile; they are read.
  bool refresh();

 private:
  void open_families();
  void read_case();
  void read_texts();
  void find_box();
  std::filesystem::file_time_type last_change() const;

  std::filesystem::path path_;
  std::vector<ResultFile> families_;  // that with the most states first: its times are those of the run
  std::filesystem::file_time_type changed_{};
  ResultStep shown_;
  std::size_t shown_step_ = static_cast<std::size_t>(-1);
};

}  // namespace spume
