// SPDX-License-Identifier: MIT
#include "spume/scene/find_case.hpp"

#include "spume/core/error.hpp"
#include "spume/scene/document.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> names_in(const fs::path& library) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (fs::directory_iterator entry(library, ignored), end; !ignored && entry != end; entry.increment(ignored))
    names.push_back(entry->path().filename().string());
  return names;
}

}  // namespace

std::string find_case_file(const std::string& path, const std::vector<fs::path>& libraries) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    const fs::path inside = fs::path(path) / "case.toml";
    std::error_code refused;
    if (fs::exists(inside, refused)) return inside.string();
    if (refused) throw InputError("cannot read '" + inside.string() + "': " + refused.message());
    throw InputError("the folder '" + path + "' holds no case.toml");
  }
  if (fs::exists(path, ignored)) return path;
  std::vector<std::string> names;
  std::string places;
  for (const fs::path& library : libraries) {
    const fs::path named = library / path / "case.toml";
    if (!path.empty() && fs::exists(named, ignored)) return named.string();
    places += ", nor " + named.string();
    for (auto& name : names_in(library)) names.push_back(std::move(name));
  }
  throw InputError("there is no case '" + path + "': neither a file, nor a folder" + places +
                   did_you_mean(path, names));
}

}  // namespace spume
