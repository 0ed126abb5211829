// SPDX-License-Identifier: MIT
// Texts that pages of runs and of results are sent alike.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "spume/view/field_words.hpp"
#include "spume/view/history.hpp"

namespace spume::view {

inline constexpr std::size_t most_lines = 200;  // of a log

inline std::shared_ptr<const std::string> shared(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

// Texts of a case may hold any bytes.
inline std::string dumped(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

inline nlohmann::json words_of_fields() {
  nlohmann::json words = nlohmann::json::object();
  for (const auto& [name, of] : field_words()) words[name] = {{"unit", of.unit}, {"formula", of.formula}};
  return words;
}

inline nlohmann::json series_message(const SeriesHistory& history, bool anew, std::size_t first) {
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t k = first; k < history.rows(); ++k) {
    const auto row = history.row(k);
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return {{"type", "series"}, {"anew", anew}, {"rows", std::move(rows)}};
}

}  // namespace spume::view
