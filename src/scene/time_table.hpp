// SPDX-License-Identifier: MIT
// A CSV file of values over time: a first line of column names, the first of them t, and rows of numbers; lines that
// begin with # are comments. Between rows values are linear, before the first and after the last constant.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "spume/scene/scene.hpp"

namespace spume {

struct TimeTable {
  std::map<std::string, std::shared_ptr<const Expression>> columns;
  std::string fault;  // what is wrong with the file, with its line; empty: nothing
};

TimeTable read_time_table(const std::string& file);

}  // namespace spume
