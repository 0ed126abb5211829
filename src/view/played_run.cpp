// SPDX-License-Identifier: MIT
#include "spume/view/played_run.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include "spume/core/error.hpp"
#include "spume/io/file.hpp"
#include "texts.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;

bool is_result(const fs::path& path) {
  const std::string ending = path.extension().string();
  return ending == ".vtkhdf" || ending == ".h5part" || ending == ".hdf";
}

// The files of results of a folder. A view for other readers (fluid.h5part of fluid.vtkhdf) is the same once more.
std::vector<fs::path> result_files(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    fs::path same = entry.path();
    const bool view = same.extension() != ".vtkhdf" && fs::exists(same.replace_extension(".vtkhdf"));
    if (is_result(entry.path()) && !view) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> split(const std::string& line, char mark) {
  std::vector<std::string> parts;
  std::istringstream text(line);
  for (std::string part; std::getline(text, part, mark);) parts.push_back(part);
  return parts;
}

}  // namespace

PlayedRun::PlayedRun(fs::path path) : place(path.string()), path_(std::move(path)) {
  if (!fs::exists(path_))
    throw InputError("'" + place + "' is not there; give the folder of a run or a file of results");
  changed_ = last_change();
  open_families();
  read_case();
  read_texts();
  find_box();
}

void PlayedRun::open_families() {
  std::vector<ResultFile> families;
  for (const fs::path& file : result_files(path_)) {
    ResultFile one(file);
    if (!one.times().empty()) families.push_back(std::move(one));
  }
  if (families.empty())
    throw InputError(
        "'" + place +
        "' holds no states: no .vtkhdf or .h5part file with a step; set output.every to have some written");
  std::stable_sort(families.begin(), families.end(),
                   [](const auto& a, const auto& b) { return a.times().size() > b.times().size(); });
  families_ = std::move(families);
}

void PlayedRun::read_case() {
  if (!fs::exists(path_ / "case.toml")) return;
  const toml::table table = [&] {
    try {
      return toml::parse(read_text(path_ / "case.toml"));
    } catch (const toml::parse_error&) {
      return toml::table{};  // what is not read here is not shown
    }
  }();
  title = table["title"].value_or(std::string());
  method = table["method"].value_or(std::string());
  spacing = table["resolution"]["spacing"].value_or(0.0);
  const toml::array* const low = table["domain"]["lower"].as_array();
  const toml::array* const high = table["domain"]["upper"].as_array();
  if (low == nullptr || high == nullptr || low->size() != high->size() || low->size() < 2 || low->size() > 3) return;
  dimensions = static_cast<int>(low->size());
  for (std::size_t axis = 0; axis < low->size(); ++axis) {
    lower[axis] = (*low)[axis].value_or(0.0);
    upper[axis] = (*high)[axis].value_or(0.0);
  }
}

void PlayedRun::read_texts() {
  lines.clear();
  ledger.clear();
  if (fs::exists(path_ / "ledger.json")) ledger = read_text(path_ / "ledger.json");
  if (fs::exists(path_ / "log.txt")) {
    lines = split(read_text(path_ / "log.txt"), '\n');
    if (lines.size() > view::most_lines)
      lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(view::most_lines));
  }
  if (!fs::exists(path_ / "series.csv")) return;
  series.clear();
  columns.clear();
  std::map<std::string, std::string> unit_of;
  std::istringstream text(read_text(path_ / "series.csv"));
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("# ")) {
      const std::size_t colon = line.find(": ");
      if (colon != std::string::npos) unit_of[line.substr(2, colon - 2)] = line.substr(colon + 2);
    } else if (columns.empty()) {
      columns = split(line, ',');
    } else {
      std::vector<double> row;
      for (const std::string& cell : split(line, ',')) {
        double value = std::nan("");
        std::from_chars(cell.data(), cell.data() + cell.size(), value);
        row.push_back(value);
      }
      if (row.size() == columns.size()) series.add(row);  // a last row may be written at this moment
    }
  }
  units.clear();
  for (const std::string& name : columns) units.push_back(unit_of[name] == "1" ? "" : unit_of[name]);
}

void PlayedRun::find_box() {
  const bool known = upper[0] > lower[0];
  if (known && spacing > 0) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::array<double, 3> low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  std::size_t most = 0;
  const auto cover = [&](double place, std::size_t axis) {
    if (!std::isfinite(place)) return;
    low[axis] = std::min(low[axis], place);
    high[axis] = std::max(high[axis], place);
  };
  bool particles = false;
  for (const std::size_t step : {std::size_t{0}, times().size() - 1}) {
    const FrameSide side = state(step);
    for (const ParticleSnapshot& family : side.families) {
      particles = true;
      most = std::max(most, family.size);
      for (std::size_t axis = 0; axis < family.position.size(); ++axis)
        for (std::size_t i = 0; i < family.size; ++i) cover(family.position[axis][i], axis);
    }
    for (const GridSnapshot& grid : side.grids)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        cover(grid.origin[axis], axis);
        cover(grid.origin[axis] + grid.spacing[axis] * static_cast<double>(grid.points[axis] - (grid.periodic ? 0 : 1)),
              axis);
      }
  }
  if (!known) {
    dimensions = low[2] == high[2] && particles ? 2 : 3;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis] = low[axis] <= high[axis] ? low[axis] : 0;
      upper[axis] =
          low[axis] < high[axis] ? high[axis] : lower[axis] + (axis < static_cast<std::size_t>(dimensions) ? 1 : 0);
    }
  }
  if (spacing > 0 || most == 0) return;
  double volume = 1;
  for (int axis = 0; axis < dimensions; ++axis)
    volume *= upper[static_cast<std::size_t>(axis)] - lower[static_cast<std::size_t>(axis)];
  spacing = std::pow(volume / static_cast<double>(most), 1.0 / dimensions);
}

std::size_t PlayedRun::nearest(double time) const {
  const std::vector<double>& all = times();
  std::size_t best = 0;
  for (std::size_t k = 1; k < all.size(); ++k)
    if (std::abs(all[k] - time) < std::abs(all[best] - time)) best = k;
  return best;
}

void PlayedRun::read(std::size_t step, ResultStep& into) const {
  into = {};
  const double time = times()[step];
  for (const ResultFile& family : families_) {
    // Families are written at the same times; one that has none at this time was not there.
    const auto& own = family.times();
    const auto found = std::find(own.begin(), own.end(), time);
    if (found != own.end()) family.read(static_cast<std::size_t>(found - own.begin()), into);
  }
  std::sort(into.families.begin(), into.families.end(), [](const auto& a, const auto& b) { return a.size > b.size; });
  // Files keep their fields by name; the first one colours until another is wanted.
  const auto velocity_first = [](auto& fields) {
    std::stable_partition(fields.begin(), fields.end(), [](const auto& field) { return field.name == "velocity"; });
  };
  for (ParticleSnapshot& family : into.families) velocity_first(family.fields);
  for (GridSnapshot& grid : into.grids) velocity_first(grid.fields);
}

FrameSide PlayedRun::state(std::size_t step) {
  step = std::min(step, times().size() - 1);
  if (step != shown_step_) {
    shown_step_ = static_cast<std::size_t>(-1);  // also after a file that could not be read
    read(step, shown_);
    shown_step_ = step;
  }
  return {times()[step], shown_.families, shown_.grids, spacing};
}

fs::file_time_type PlayedRun::last_change() const {
  fs::file_time_type last = fs::file_time_type::min();
  std::error_code none;
  for (const fs::path& file : result_files(path_)) last = std::max(last, fs::last_write_time(file, none));
  if (fs::exists(path_ / "series.csv")) last = std::max(last, fs::last_write_time(path_ / "series.csv", none));
  return last;
}

bool PlayedRun::refresh() {
  const fs::file_time_type change = last_change();
  if (change == changed_) return false;
  try {
    open_families();
    read_texts();
    changed_ = change;
  } catch (const std::exception&) {
    return false;  // a state is being written: at another time
  }
  return true;
}

}  // namespace spume
