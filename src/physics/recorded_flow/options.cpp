// SPDX-License-Identifier: MIT
#include "spume/physics/recorded_flow/options.hpp"

#include <cmath>

#include "spume/physics/recorded_flow/recorded_flow.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/option.hpp"

namespace spume {
namespace {

// A share of an exchange that 10 windows find is uncertain by the root of a tenth of it.
constexpr double fewest_windows = 10;

constexpr const char* to_give = "has to be given with the section";

}  // namespace

Section recorded_flow_section() {
  using R = RecordedFlowOptions;
  return section<R>("recorded_flow")
      .option("from", &R::from, "time", positive(), "recording begins: the flow is statistically steady")
      .absent(to_give)
      .option("until", &R::until, "time", positive(),
              "recording ends: from here on the recorded exchange carries the scalars, and the flow stands still")
      .absent(to_give)
      .option("lag", &R::lag, "time", positive(),
              "time over which the exchange between cells is recorded; the step of what follows")
      .absent(to_give)
      .option("cell", &R::cell, "length", positive(), "longest side of the cells of the record")
      .absent(to_give)
      .whole_optional();
}

void check_recorded_flow(Draft& draft, Problems& problems) {
  RecordedFlowOptions& options = draft.options.get<RecordedFlowOptions>();
  const Node* section = draft.node("recorded_flow");
  options.on = section != nullptr;
  if (!options.on) return;
  if (draft.options.get<ScalarOptions>().scalars.empty())
    problems.add(*section,
                 "[recorded_flow] carries scalars, and the case has none; add a  [[scalar]],  or remove the section");
  const auto misses = [&](const char* key, const std::optional<double>& value) {
    if (value) return false;
    if (draft.usable(std::string("recorded_flow.") + key))
      problems.add(*section, std::string("[recorded_flow] has no ") + key + "; add  " + key + " = <number>");
    return true;
  };
  const bool no_from = misses("from", options.from), no_until = misses("until", options.until),
             no_lag = misses("lag", options.lag), no_cell = misses("cell", options.cell);
  if (no_from || no_until || no_lag || no_cell) return;
  const double from = *options.from, end = *options.until, lag = *options.lag, cell = *options.cell;
  const Node& until = *draft.node("recorded_flow.until");
  if (!(end >= from + fewest_windows * lag * (1 - 1e-9)))
    problems.add(until, "recorded_flow.until is " + brief(end) + ", which leaves " + brief((end - from) / lag) +
                            " times the lag for the record; expected at least " + brief(fewest_windows) +
                            ": raise it to " + brief(from + fewest_windows * lag) + ", or shorten the lag");
  // The record ends with a lag.
  if (const double lags = (end - from) / lag; std::abs(lags - std::round(lags)) > 1e-6 * lags)
    problems.add(until, "recorded_flow.until is " + brief(end) + ", which is " + brief(lags) +
                            " times the lag behind recorded_flow.from; expected a whole number: set it to " +
                            brief(from + std::ceil(lags) * lag));
  if (draft.options.time.end > 0 && end >= draft.options.time.end)
    problems.add(until, "recorded_flow.until is " + brief(end) + ", and the run ends at " +
                            brief(draft.options.time.end) +
                            ", before the record carries anything; raise time.end, or remove the section");
  if (draft.lower.size() == draft.upper.size()) {
    double cells = 1;
    for (std::size_t a = 0; a < draft.lower.size(); ++a) {
      const double length = draft.upper[a] - draft.lower[a];
      if (cell > length)
        problems.add(*draft.node("recorded_flow.cell"), "recorded_flow.cell is " + brief(cell) +
                                                            ", more than the domain is long, " + brief(length) +
                                                            "; give a tenth of it or so");
      cells *= RecordedFlow::cells_along(length, cell);
    }
    if (cells > RecordedFlow::most_cells)
      problems.add(*draft.node("recorded_flow.cell"),
                   "recorded_flow.cell is " + brief(cell) + ", which makes " + brief(cells) + " cells; at most " +
                       brief(RecordedFlow::most_cells) + " are possible: lengthen it");
  }
  for (const char* other : {"scalar_wall.0", "inflow.0", "outflow.0"})
    if (const Node* node = draft.node(other))
      problems.add(*node, "a record holds the exchange within a closed liquid, and the case has [[" +
                              std::string(other).substr(0, std::string(other).find('.')) +
                              "]]; remove it, or [recorded_flow]");
}

}  // namespace spume
