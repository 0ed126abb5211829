// SPDX-License-Identifier: MIT
// A CSV file of values over time: a first line of column names, the first of them t, and rows of numbers; lines that
// begin with # are comments. Between rows values are linear, or smooth: cubic with continuous derivatives (modified
// Akima, which does not overshoot), as what moves a wall has to be. Before the first row and after the last they are
// constant.
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

enum class TableValues { linear, smooth };

TimeTable read_time_table(const std::string& file, TableValues values = TableValues::linear);

}  // namespace spume
