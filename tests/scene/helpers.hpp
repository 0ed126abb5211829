// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "spume/core/error.hpp"
#include "spume/methods/registry.hpp"
#include "spume/scene/case_schema.hpp"
#include "spume/scene/load.hpp"

namespace spume::test {

// A case file that lives as long as the object.
class CaseFile {
 public:
  explicit CaseFile(const std::string& text, const std::string& name = "bad.toml") {
    static std::atomic<int> serial{0};
    folder_ = std::filesystem::temp_directory_path() /
              ("spume_scene_" + std::to_string(::getpid()) + "_" + std::to_string(serial++));
    std::filesystem::create_directories(folder_);
    path_ = (folder_ / name).string();
    std::ofstream(path_, std::ios::binary) << text;
  }
  CaseFile(const CaseFile&) = delete;
  CaseFile& operator=(const CaseFile&) = delete;
  ~CaseFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  const std::string& path() const { return path_; }
  std::string folder() const { return folder_.string(); }

 private:
  std::filesystem::path folder_;
  std::string path_;
};

inline LoadedCase load_text(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const CaseFile file(text);
  return load_case(file.path(), overrides);
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

inline LoadedCase load_text(const std::string& text, const CaseSchema& schema) {
  const CaseFile file(text);
  return load_case(file.path(), {}, schema);
}

// What loading a case file throws, as "line:col text", or of an override as "--set a=b text".
template <class Load>
std::vector<std::string> problems_found(const std::string& text, Load&& load) {
  const CaseFile file(text);
  std::vector<std::string> found;
  try {
    load(file.path());
  } catch (const InputError& error) {
    for (const Problem& problem : error.problems()) {
      EXPECT_TRUE(problem.line == 0 || problem.file == file.path()) << problem.message();
      found.push_back(
          (problem.line > 0 ? std::to_string(problem.line) + ":" + std::to_string(problem.column) : problem.file) +
          " " + problem.text);
    }
  }
  return found;
}

inline std::vector<std::string> problems_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return problems_found(text, [&](const std::string& path) { load_case(path, overrides); });
}

inline std::vector<std::string> problems_of(const std::string& text, const CaseSchema& schema) {
  return problems_found(text, [&](const std::string& path) { load_case(path, {}, schema); });
}

// A closed 2-D box full of liquid, 10 x 10 particles; `extra` goes at the end.
inline std::string small_case(const std::string& extra = "", const std::string& fluid = "reynolds = 100\n") {
  return "method = \"les-sph\"\n"  // 1
         "[domain]\n"              // 2
         "lower = [0, 0]\n"        // 3
         "upper = [1, 1]\n"        // 4
         "x = \"periodic\"\n"      // 5
         "y = \"periodic\"\n"      // 6
         "[resolution]\n"          // 7
         "spacing = 0.1\n"         // 8
         "[time]\n"                // 9
         "end = 1\n"               // 10
         "[fluid]\n" +
         fluid +           // 11, 12
         "[[liquid]]\n" +  // 13
         extra;            // 14
}

inline const std::string plunging_breaker = R"toml(title  = "Plunging breaker"
method = "les-sph"

[domain]                      # three entries: 3-D, z is up
lower = [0, 0, -0.5]
upper = [1, 0.25, 0.5]
x = "periodic"
y = "periodic"
bottom = "free-slip"          # left, right, front, back, bottom, top: free-slip | no-slip | open

[resolution]
spacing = 0.01

[fluid]
reynolds = 4e4
froude = 1
mach = 0.05

[[liquid]]                    # regions filled with liquid: a shape or where an expression is positive
where = "eta - z"
velocity = ["a*cos(2*pi*x)*exp(2*pi*z)", "0", "a*sin(2*pi*x)*exp(2*pi*z)"]
conform = true                # columns of particles end exactly on the surface

[constants]
chi = 0.55
eta = "(chi*cos(2*pi*x) + chi^2/2*cos(4*pi*x) + 3/8*chi^3*cos(6*pi*x))/(2*pi)"
a   = "chi*sqrt(1+chi^2)/sqrt(2*pi)"

[turbulence]
model = "mixed-scale"

[time]
end = 2.5

[output]
every = 0.05
)toml";

}  // namespace spume::test
