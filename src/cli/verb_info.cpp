// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "spume/core/error.hpp"
#include "spume/io/checkpoint.hpp"
#include "spume/io/file.hpp"
#include "spume/io/vtkhdf.hpp"
#include "spume/io/vtkhdf_grid.hpp"
#include "spume/run/report.hpp"
#include "verbs.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;

void describe_grid(const fs::path& path) {
  const GridContents contents = read_grid_contents(path);
  std::printf("%s: fields on a grid over time (VTKHDF), %zu snapshots\n", path.c_str(), contents.times.size());
  if (!contents.times.empty())
    std::printf("  time       %.10g to %.10g\n", contents.times.front(), contents.times.back());
  std::printf("  grid       %lld x %lld x %lld\n", static_cast<long long>(contents.points[0]),
              static_cast<long long>(contents.points[1]), static_cast<long long>(contents.points[2]));
  for (const auto& field : contents.fields) std::printf("  field      %s\n", field.c_str());
}

void describe_particles(const fs::path& path) {
  if (is_grid_file(path)) return describe_grid(path);

  const VtkhdfContents contents = read_vtkhdf_contents(path);
  std::printf("%s: particles over time (VTKHDF), %zu snapshots\n", path.c_str(), contents.times.size());
  if (!contents.times.empty()) {
    const auto [fewest, most] = std::minmax_element(contents.sizes.begin(), contents.sizes.end());
    std::printf("  time       %.10g to %.10g\n", contents.times.front(), contents.times.back());
    std::printf("  particles  %lld", static_cast<long long>(*fewest));
    if (*most != *fewest) std::printf(" to %lld", static_cast<long long>(*most));
    std::printf("\n");
  }
  for (const auto& field : contents.fields)
    std::printf("  field      %s%s\n", field.name.c_str(),
                field.components > 1 ? (" (" + std::to_string(field.components) + " components)").c_str() : "");
}

void describe_checkpoint(const fs::path& path) {
  const CheckpointReader file(path);
  Array<double> clock;
  Array<std::int64_t> counters;
  std::printf("%s: checkpoint, format %d\n", path.c_str(), checkpoint_format);
  std::printf("  written by Spume %s (%s)\n", file.origin().program_version.c_str(), file.origin().commit.c_str());
  if (file.has("driver/clock") && file.has("driver/counters")) {
    file.f64("driver/clock", clock);
    file.i64("driver/counters", counters);
    if (!clock.empty() && !counters.empty())
      std::printf("  step %lld, t = %.10g\n", static_cast<long long>(counters[0]), clock[0]);
  }
  for (const auto& entry : file.entries())
    std::printf("  %-32s %s  %lld\n", entry.name.c_str(), entry.type.c_str(), static_cast<long long>(entry.size));
}

void describe_folder(const fs::path& folder) {
  std::printf("%s: run folder\n", folder.c_str());
  if (fs::exists(folder / "summary.json")) {
    try {
      const auto summary = nlohmann::json::parse(read_text(folder / "summary.json"));
      for (const char* key : {"title", "method", "state", "message", "time", "end", "steps", "retries", "particles",
                              "program_version", "commit", "threads", "wall_seconds", "particle_steps_per_second"})
        if (summary.contains(key)) {
          const nlohmann::json& value = summary[key];
          const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
          if (!text.empty()) std::printf("  %-26s %s\n", key, text.c_str());
        }
      for (const auto& one : summary.value("verdicts", nlohmann::json::array())) {
        const std::string value = one.at("value").is_null() ? "not a number" : short_number(one.at("value"));
        std::printf("  %-26s %s, bound %s: %s\n", one.at("quantity").get<std::string>().c_str(), value.c_str(),
                    short_number(one.at("bound")).c_str(), one.at("verdict").get<std::string>().c_str());
      }
    } catch (const nlohmann::json::exception& error) {
      throw FileError("cannot read '" + (folder / "summary.json").string() + "': " + error.what());
    }
  } else {
    std::printf("  no summary.json: the run is in progress, or was killed\n");
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && !entry.is_symlink()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files)
    std::printf("  %-26s %s\n", file.filename().c_str(), human_bytes(static_cast<double>(fs::file_size(file))).c_str());
  for (const auto& file : files)
    if (file.extension() == ".vtkhdf") describe_particles(file);
}

void describe_case(const std::string& path, const Program& program) {
  const LoadedCase loaded = program.load_case(path, {});
  const auto& grid = loaded.scene.grid;
  if (grid[0] > 0)
    std::printf("%s: case for method %s, grid %zu x %zu x %zu, until t = %g\n", path.c_str(),
                loaded.options.method.c_str(), grid[0], grid[1], grid[2], loaded.options.time.end);
  else
    std::printf("%s: case for method %s, %d-D, %zu particles, spacing %g, until t = %g\n", path.c_str(),
                loaded.options.method.c_str(), loaded.scene.domain.dimensions, loaded.scene.particles.size(),
                loaded.scene.spacing, loaded.options.time.end);
  for (const auto& [name, value] : loaded.options.groups) std::printf("  %-12s %s\n", name.c_str(), value.c_str());
}

bool starts_with(const fs::path& path, const std::string& mark) {
  std::ifstream stream(path, std::ios::binary);
  std::string head(mark.size(), '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  return stream && head == mark;
}

}  // namespace

int info_verb(const std::string& file, const Program& program) {
  const fs::path path = file;
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    if (fs::exists(path / "log.txt"))
      describe_folder(path);
    else
      describe_case(file, program);
  } else if (!fs::exists(path, ignored)) {
    throw InputError("there is no file '" + file + "'; give a result, a checkpoint, a run folder or a case");
  } else if (path.extension() == ".toml") {
    describe_case(file, program);
  } else if (starts_with(path, "\x89HDF\r\n\x1a\n")) {
    describe_particles(path);
  } else if (path.extension() == ".h5" || starts_with(path, "SPUME CHECKPOINT")) {
    describe_checkpoint(path);
  } else {
    throw InputError("'" + file +
                     "' is neither a result (.vtkhdf), a checkpoint (.h5), a run folder nor a case (.toml)");
  }
  return exit_done;
}

}  // namespace spume
