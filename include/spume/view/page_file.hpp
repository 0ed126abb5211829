// SPDX-License-Identifier: MIT
// The files of the page, embedded in the program: src/view/page and the library that draws. The build makes the list.
#pragma once

#include <span>
#include <string_view>

namespace spume {

struct PageFile {
  std::string_view name;  // "index.html"
  std::string_view type;  // "text/html"
  std::string_view contents;
};

std::span<const PageFile> page_files();

}  // namespace spume
