// SPDX-License-Identifier: MIT
#include "spume/view/playback.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "places.hpp"
#include "spume/core/error.hpp"
#include "spume/run/version.hpp"
#include "texts.hpp"

namespace spume {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;
using view::dumped;
using view::shared;

constexpr auto look_again = 1s;  // whether a run that goes on has added something
constexpr auto trace_interval = 250ms;

Json description(const PlayedRun& run) {
  Json columns = Json::array();
  for (std::size_t k = 0; k < run.columns.size(); ++k)
    columns.push_back({{"name", run.columns[k]}, {"unit", run.units[k]}});
  const auto numbers = [&](const std::array<double, 3>& place) {
    return std::vector<double>(place.begin(), place.begin() + run.dimensions);
  };
  return {{"title", run.title.empty() ? run.place : run.title},
          {"method", run.method},
          {"folder", run.place},
          {"dimensions", run.dimensions},
          {"lower", numbers(run.lower)},
          {"upper", numbers(run.upper)},
          {"spacing", run.spacing},
          {"columns", std::move(columns)}};
}

std::string ledger_of(const PlayedRun& run) {
  const Json file = Json::parse(run.ledger, nullptr, false);
  Json stages = Json::array();
  if (file.is_object() && file.contains("stages") && file["stages"].is_array())
    for (const Json& stage : file["stages"])
      if (stage.is_object())
        stages.push_back({{"name", stage.value("stage", "")},
                          {"calls", stage.value("calls", 0)},
                          {"seconds", stage.value("seconds", 0.0)}});
  return dumped({{"type", "ledger"}, {"stages", std::move(stages)}});
}

}  // namespace

Playback::Playback(Server& server, std::vector<std::unique_ptr<PlayedRun>> runs)
    : server_(server), runs_(std::move(runs)) {}

std::string Playback::hello() const {
  Json text = description(*runs_.front());
  text["type"] = "hello";
  text["version"] = program_version();
  text["times"] = runs_.front()->times();
  text["may_steer"] = false;
  text["fields"] = view::words_of_fields();
  text["options"] = text["plan"] = Json::array();
  if (runs_.size() > 1) text["beside"] = description(*runs_.back());
  return dumped(text);
}

std::string Playback::state(std::size_t step) const {
  const std::vector<double>& times = runs_.front()->times();
  return dumped(
      {{"type", "state"}, {"words", "results"}, {"step", step}, {"time", times[step]}, {"end", times.back()}});
}

std::vector<Packet> Playback::introduction() const {
  std::vector<Packet> packets{{false, shared(hello())}};
  for (std::size_t side = 0; side < runs_.size(); ++side) {
    Json rows = view::series_message(runs_[side]->series, true, 0);
    rows["side"] = side;
    packets.push_back({false, shared(dumped(rows))});
  }
  const PlayedRun& run = *runs_.front();
  packets.push_back({false, shared(dumped({{"type", "log"}, {"anew", true}, {"lines", run.lines}}))});
  if (!run.ledger.empty()) packets.push_back({false, shared(ledger_of(run))});
  return packets;
}

bool Playback::refresh() {
  if (Clock::now() - looked_ < look_again) return false;
  looked_ = Clock::now();
  bool grown = false;
  for (const auto& run : runs_) grown = run->refresh() || grown;
  if (grown) ++edition_;
  return grown;
}

void Playback::show(const std::shared_ptr<Viewer>& viewer, const FrameWish& wish) {
  Viewer::Told& told = viewer->told;
  if (told.hello == edition_ && told.wish == wish) return viewer->give_back(wish);  // it is seen already
  std::vector<Packet> packets;
  if (told.hello != edition_) packets = introduction();
  told.hello = edition_;
  told.wish = wish;
  const std::size_t step = std::min(wish.snapshot, runs_.front()->times().size() - 1);
  packets.push_back({false, shared(state(step))});
  try {
    std::vector<FrameSide> sides{runs_.front()->state(step)};
    if (runs_.size() > 1) sides.push_back(runs_.back()->state(runs_.back()->nearest(sides.front().time)));
    packets.push_back({true, frames_.make(static_cast<std::int64_t>(step), sides, wish)});
  } catch (const FileError& error) {
    told.hello = -1;
    packets.push_back({false, shared(dumped({{"type", "log"}, {"lines", {error.what()}}}))});
    packets.push_back({false, shared(dumped({{"type", "unreadable"}}))});
  }
  viewer->send(std::move(packets));
  Trace& trace = traces_[viewer.get()];
  if (!wish.point)
    traces_.erase(viewer.get());
  else if (trace.viewer.expired() || trace.place != *wish.point)
    trace = {viewer, *wish.point, 0, {}, {}};
}

// One state of one place; false when there is none to read.
bool Playback::trace_a_step() {
  std::erase_if(traces_, [](const auto& one) { return one.second.viewer.expired(); });
  for (auto& [who, trace] : traces_) {
    const std::vector<double>& times = runs_.front()->times();
    if (trace.next >= times.size()) continue;
    try {
      ResultStep step;
      runs_.front()->read(trace.next, step);
      const FrameSide side{times[trace.next], step.families, step.grids, runs_.front()->spacing};
      Json row = values_at(side, trace.place);
      row["time"] = side.time;
      trace.rows.push_back(dumped(row));
    } catch (const FileError&) {
      // a state that cannot be read has no value
    }
    ++trace.next;
    const auto now = Clock::now();
    if (trace.next < times.size() && now - trace.told < trace_interval) return true;
    trace.told = now;
    std::string rows;
    for (const std::string& row : trace.rows) rows += (rows.empty() ? "" : ",") + row;
    trace.rows.clear();
    if (const auto viewer = trace.viewer.lock())
      viewer->send({{false, shared("{\"type\":\"history\",\"place\":" + dumped(trace.place) +
                                   ",\"of\":" + std::to_string(times.size()) + ",\"rows\":[" + rows + "]}")}});
    return true;
  }
  return false;
}

void Playback::serve(std::chrono::milliseconds longest) {
  const bool grown = refresh();
  if (server_.take_attention() || grown) {
    server_.take_messages();  // nothing can be steered
    for (const auto& viewer : server_.viewers())
      if (const std::optional<FrameWish> wish = viewer->take_wish()) show(viewer, *wish);
  }
  if (trace_a_step()) return;
  server_.wait_for_attention(longest);
}

}  // namespace spume
