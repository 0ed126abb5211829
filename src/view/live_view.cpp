// SPDX-License-Identifier: MIT
#include "spume/view/live_view.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/run/version.hpp"
#include "spume/scene/resolved_case.hpp"
#include "texts.hpp"

namespace spume {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using view::dumped;
using view::most_lines;
using view::shared;
using view::words_of_fields;

constexpr auto shortest_interval = 100ms;  // between two frames
// Frames take a hundredth of the run at most. Where one a second would be more, as with transforms of a large grid,
// they take up to a twentieth.
constexpr int run_over_frames = 100, run_over_slow_frames = 20;
constexpr auto slow_interval = 1s, longest_interval = 5s;
constexpr auto ledger_interval = 1s;
constexpr auto pause_poll = 50ms;  // after which a paused run looks for SIGINT
constexpr auto preparing_words = "preparing";
constexpr std::size_t most_waiting = 64;  // wishes for the first step
constexpr std::size_t longest_line = 2000;

Json steerable_options(const std::vector<OptionInfo>& options, const std::string& resolved) {
  const std::vector<ChangedValue> values = changed_values("", resolved);
  // What the case may have and does not stands in it as a comment below its section.
  const auto may_have = [&](const OptionInfo& option) {
    const std::size_t section = resolved.find("\n[" + option.section + "]");
    if (section == std::string::npos) return false;
    const std::size_t end = resolved.find("\n[", section + 1), key = resolved.find("\n# " + option.key + ' ', section);
    return key != std::string::npos && (end == std::string::npos || key < end);
  };
  Json list = Json::array();
  for (const OptionInfo& option : options) {
    if (!option.steerable) continue;
    const std::string name = option.section + '.' + option.key;
    const auto add = [&](const std::string& key, const std::string& value) {
      list.push_back({{"key", key},
                      {"value", value},
                      {"type", option.type},
                      {"unit", option.unit == "1" ? "" : option.unit},
                      {"range", option.range},
                      {"description", option.description}});
    };
    bool any = false;
    for (const ChangedValue& value : values) {
      if (steered_option(value.name) != name) continue;
      add(value.name, value.now);
      any = true;
    }
    if (!any && may_have(option)) add(name, "");
  }
  return list;
}

Json plan_list(const std::vector<Stage>& plan) {
  Json list = Json::array();
  for (const Stage& stage : plan)
    list.push_back(
        {{"name", stage.name}, {"on", stage.on}, {"start", of_the_start(stage.part)}, {"reason", stage.reason}});
  return list;
}

std::string ledger_text(const Ledger& ledger) {
  Json stages = Json::array();
  for (const Ledger::Entry& entry : ledger.entries())
    stages.push_back({{"name", entry.stage}, {"calls", entry.calls}, {"seconds", entry.seconds}});
  return dumped({{"type", "ledger"}, {"stages", std::move(stages)}});
}

}  // namespace

LiveView::LiveView(Server& server, Observer& next, std::vector<OptionInfo> options, bool paused)
    : server_(server), next_(next), options_(std::move(options)), paused_(paused) {}

void LiveView::progress(const Progress& progress) {
  progress_ = progress;
  next_.progress(progress);
}

void LiveView::note(const std::string& text) {
  lines_.push_back(text.substr(0, longest_line));
  if (lines_.size() > most_lines) {
    lines_.pop_front();
    ++lines_told_;
  }
  next_.note(text);
}

void LiveView::add_row(Simulation& simulation) {
  const std::span<const double> row = simulation.series_row();
  if (row.empty() || row[0] == last_row_step_) return;
  last_row_step_ = row[0];
  history_.add(row);
}

void LiveView::preparing(Simulation& simulation, const std::string& how_far) {
  next_.preparing(simulation, how_far);
  words_ = preparing_words;
  how_far_ = how_far;
  if (!server_.attention()) return;
  for (ViewMessage& message : server_.take_messages()) {
    using Action = ViewMessage::Action;
    if (message.action == Action::stop || message.action == Action::pause || message.action == Action::go ||
        message.action == Action::step)
      obey(simulation, message);
    else if (waiting_.size() < most_waiting)
      waiting_.push_back(std::move(message));
  }
  const auto now = Clock::now();
  if (now < next_frame_) return;
  next_frame_ = now + shortest_interval;
  for (const auto& viewer : server_.viewers()) {
    const std::optional<FrameWish> wish = viewer->idle() ? viewer->take_wish() : std::nullopt;
    if (!wish) continue;
    viewer->send(texts_for(*viewer, simulation));
    viewer->give_back(*wish);  // no frame has answered it
  }
}

void LiveView::between_steps(Simulation& simulation) {
  add_row(simulation);
  if (words_ == preparing_words) {
    words_ = "running";
    ++hello_edition_;  // of the columns
  }
  if (!server_.attention() && !paused_ && waiting_.empty()) return;
  steps_wanted_ = 0;  // the one that was asked for is done
  obey(simulation);
  if (simulation.finished() || simulation.stop_requested()) next_frame_ = {};  // the last picture is the last state
  if (!paused_ || steps_wanted_ > 0 || simulation.finished() || simulation.stop_requested()) return serve(simulation);
  const auto began = Clock::now();
  words_ = "paused";
  next_frame_ = {};
  while (paused_ && steps_wanted_ == 0 && !simulation.finished() && !simulation.stop_requested()) {
    serve(simulation);
    server_.wait(pause_poll);
    obey(simulation);
  }
  next_frame_ = {};
  words_ = "running";
  simulation.note_pause(Clock::now() - began);
}

void LiveView::obey(Simulation& simulation) {
  std::vector<ViewMessage> messages = std::exchange(waiting_, {});
  for (ViewMessage& message : server_.take_messages()) messages.push_back(std::move(message));
  for (const ViewMessage& message : messages) {
    try {
      obey(simulation, message);
    } catch (const InputError& error) {
      std::string text;
      for (const Problem& problem : error.problems()) text += (text.empty() ? "refused: " : "; ") + problem.text;
      note(text);
    }
    next_frame_ = {};  // the answer is not kept waiting
  }
}

void LiveView::obey(Simulation& simulation, const ViewMessage& message) {
  using Action = ViewMessage::Action;
  const std::string place = "after step " + std::to_string(simulation.method().step_count());
  switch (message.action) {
    case Action::ready:
      break;
    case Action::pause:
      paused_ = true;
      break;
    case Action::go:
      paused_ = false;
      steps_wanted_ = 0;
      break;
    case Action::step:
      paused_ = true;
      steps_wanted_ = 1;
      break;
    case Action::checkpoint:
      simulation.checkpoint_now();
      note("checkpoint " + place);
      break;
    case Action::snapshot:
      simulation.snapshot_now();
      note("snapshot " + place);
      break;
    case Action::stop:
      simulation.log("stopped by hand " + place);
      simulation.request_stop();
      break;
    case Action::steer:
      simulation.steer(message.key, message.value);
      ++hello_edition_;
      progress_.end = simulation.loaded().options.time.end;
      note("steered " + place + ": " + message.key + " = " + message.value);
      break;
  }
}

void LiveView::serve(Simulation& simulation) {
  const auto now = Clock::now();
  if (now < next_frame_ || !server_.attention()) return;
  bool any = false;
  for (const auto& viewer : server_.viewers()) {
    const std::optional<FrameWish> wish = viewer->take_wish();
    if (!wish) continue;
    if (knows_all(*viewer, *wish, simulation)) {
      viewer->give_back(*wish);
      continue;
    }
    any = true;
    const auto scope = simulation.time_stage("live view");
    viewer->send(packets_for(*viewer, *wish, simulation));
  }
  server_.rest();
  if (!any) return;
  const auto cost = Clock::now() - now;
  const auto within = std::clamp<Clock::duration>(cost * run_over_frames, shortest_interval, slow_interval);
  next_frame_ = now + std::clamp<Clock::duration>(cost * run_over_slow_frames, within, longest_interval);
}

// A paused run has nothing new.
bool LiveView::knows_all(const Viewer& viewer, const FrameWish& wish, const Simulation& simulation) const {
  const Viewer::Told& told = viewer.told;
  return told.step == simulation.method().step_count() && told.wish == wish && told.words == words_ &&
         told.hello == hello_edition_ && told.lines == lines_told_ + static_cast<std::int64_t>(lines_.size());
}

std::vector<Packet> LiveView::texts_for(Viewer& viewer, const Simulation& simulation) {
  std::vector<Packet> packets;
  if (progress_.step == 0) progress_.end = simulation.loaded().options.time.end;
  const auto add = [&](std::string text) { packets.push_back({false, shared(std::move(text))}); };
  if (viewer.told.hello != hello_edition_) {
    viewer.told.hello = hello_edition_;
    add(hello(simulation, viewer.may_steer()));
  }
  add(state());
  if (viewer.told.edition != history_.edition() || viewer.told.rows < history_.rows()) {
    add(series_for(viewer));
    viewer.told.edition = history_.edition();
    viewer.told.rows = history_.rows();
  }
  if (viewer.told.lines < lines_told_ + static_cast<std::int64_t>(lines_.size())) {
    add(lines_for(viewer));
    viewer.told.lines = lines_told_ + static_cast<std::int64_t>(lines_.size());
  }
  if (const auto now = Clock::now(); now - viewer.told.ledger > ledger_interval) {
    viewer.told.ledger = now;
    add(ledger_text(simulation.ledger()));
  }
  viewer.told.words = words_;
  return packets;
}

std::vector<Packet> LiveView::packets_for(Viewer& viewer, const FrameWish& wish, Simulation& simulation) {
  std::vector<Packet> packets = texts_for(viewer, simulation);
  viewer.told.step = simulation.method().step_count();
  viewer.told.wish = wish;
  packets.push_back(
      {true, frames_.make(simulation.method().step_count(), simulation.method().time(), simulation.particles(),
                          simulation.grids(), wish, simulation.loaded().options.spacing)});
  return packets;
}

std::string LiveView::hello(const Simulation& simulation, bool may_steer) const {
  const Case& options = simulation.loaded().options;
  const Domain& domain = simulation.loaded().scene.domain;
  Json lower = Json::array(), upper = Json::array(), columns = Json::array();
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    lower.push_back(domain.lower[axis]);
    upper.push_back(domain.upper[axis]);
  }
  for (const SeriesColumn& column : simulation.series_columns())
    columns.push_back({{"name", column.name}, {"unit", column.unit == "1" ? "" : column.unit}});
  return dumped({{"type", "hello"},
                 {"title", options.title},
                 {"method", options.method},
                 {"folder", simulation.folder().string()},
                 {"version", program_version()},
                 {"dimensions", domain.dimensions},
                 {"lower", std::move(lower)},
                 {"upper", std::move(upper)},
                 {"spacing", options.spacing},
                 {"particles", simulation.method().particle_count()},
                 {"columns", std::move(columns)},
                 {"may_steer", may_steer},
                 {"fields", words_of_fields()},
                 {"options", steerable_options(options_, options.resolved)},
                 {"plan", plan_list(simulation.method().plan())}});
}

std::string LiveView::state() const {
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(); };
  return dumped({{"type", "state"},
                 {"words", words_},
                 {"held", paused_},
                 {"step", progress_.step},
                 {"time", progress_.time},
                 {"end", progress_.end},
                 {"dt", progress_.dt},
                 {"limit", words_ == preparing_words ? how_far_ : progress_.limited_by},
                 {"rate", number(progress_.particle_steps_per_second)},
                 {"remaining", progress_.step == 0 ? Json() : number(progress_.remaining_seconds)}});
}

std::string LiveView::series_for(Viewer& viewer) const {
  const bool anew = viewer.told.edition != history_.edition();
  return dumped(view::series_message(history_, anew, anew ? 0 : viewer.told.rows));
}

std::string LiveView::lines_for(Viewer& viewer) const {
  Json lines = Json::array();
  const std::int64_t first = std::max<std::int64_t>(0, viewer.told.lines - lines_told_);
  for (auto k = static_cast<std::size_t>(first); k < lines_.size(); ++k) lines.push_back(lines_[k]);
  return dumped({{"type", "log"}, {"lines", std::move(lines)}});
}

void LiveView::finish(const std::string& state_in_words, const std::string& reason) {
  words_ = state_in_words;
  if (!reason.empty()) lines_.push_back(reason);
  for (const auto& viewer : server_.viewers()) {
    std::vector<Packet> packets;
    for (std::string text : {series_for(*viewer), lines_for(*viewer), state()})
      packets.push_back({false, shared(std::move(text))});
    viewer->send(std::move(packets));
  }
  server_.drain(1s);
}

}  // namespace spume
