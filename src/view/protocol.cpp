// SPDX-License-Identifier: MIT
#include "spume/view/protocol.hpp"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <nlohmann/json.hpp>

#include "spume/io/file.hpp"

namespace spume {
namespace {

using Json = nlohmann::json;
constexpr std::size_t most_families = 32;
constexpr int deepest_json = 4;
constexpr double most_snapshots = 1e9;  // that a number in a message may mean

const std::map<std::string, ViewMessage::Action>& actions() {
  using A = ViewMessage::Action;
  static const std::map<std::string, A> words{
      {"ready", A::ready},           {"pause", A::pause},       {"go", A::go},     {"step", A::step},
      {"checkpoint", A::checkpoint}, {"snapshot", A::snapshot}, {"stop", A::stop}, {"steer", A::steer}};
  return words;
}

// Null where there is no number, or none within the bounds.
std::optional<double> number_of(const Json& object, const char* name, double low, double high) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number()) return {};
  const double value = found->get<double>();
  if (!(value >= low && value <= high)) return {};
  return value;
}

// A place: up to three finite numbers, a missing one is 0.
std::optional<std::array<double, 3>> place_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_array() || found->size() > 3) return {};
  std::array<double, 3> place{};
  for (std::size_t axis = 0; axis < found->size(); ++axis) {
    const Json& number = (*found)[axis];
    if (!number.is_number() || !std::isfinite(number.get<double>())) return {};
    place[axis] = number.get<double>();
  }
  return place;
}

bool read_pick(const Json& object, FrameWish& wish) {
  if (!object.is_object()) return false;
  const auto family = object.find("family");
  const auto place = place_of(object, "at");
  if (family == object.end() || !family->is_string() || !place) return false;
  wish.picked = PickWish{family->get<std::string>(), *place, {}};
  if (const auto id = object.find("id"); id != object.end()) {
    if (!id->is_number_integer()) return false;
    wish.picked->id = id->get<std::int64_t>();
  }
  return true;
}

bool read_wish(const Json& object, FrameWish& wish) {
  const auto points = number_of(object, "points", 0, static_cast<double>(most_frame_points));
  const auto bits = number_of(object, "bits", 8, 16);
  if (!points || !bits || (*bits != 8 && *bits != 16)) return false;
  wish.points = static_cast<std::size_t>(*points);
  wish.bits = static_cast<int>(*bits);
  if (const auto fields = object.find("fields"); fields != object.end()) {
    if (!fields->is_object() || fields->size() > most_families) return false;
    for (const auto& [family, field] : fields->items()) {
      if (!field.is_string()) return false;
      wish.fields[family] = field.get<std::string>();
    }
  }
  if (const auto plane = object.find("plane"); plane != object.end()) {
    if (!plane->is_object()) return false;
    const auto axis = number_of(*plane, "axis", 0, 2), at = number_of(*plane, "at", 0, 1);
    if (!axis || !at || *axis != std::floor(*axis)) return false;
    wish.plane_axis = static_cast<int>(*axis);
    wish.plane_at = *at;
  }
  if (object.contains("volume")) {
    const auto points = number_of(object, "volume", 0, static_cast<double>(most_volume_points));
    if (!points) return false;
    wish.volume = static_cast<std::size_t>(*points);
  }
  if (const auto phases = object.find("phases"); phases != object.end()) {
    if (!phases->is_boolean()) return false;
    wish.phases = phases->get<bool>();
  }
  if (const auto pick = object.find("pick"); pick != object.end() && !read_pick(*pick, wish)) return false;
  if (object.contains("point")) {
    wish.point = place_of(object, "point");
    if (!wish.point) return false;
  }
  if (object.contains("snapshot")) {
    const auto snapshot = number_of(object, "snapshot", 0, most_snapshots);
    if (!snapshot) return false;
    wish.snapshot = static_cast<std::size_t>(*snapshot);
  }
  return true;
}

}  // namespace

std::optional<ViewMessage> parse_message(std::string_view text) {
  if (text.size() > largest_message) return {};
  const auto shallow = [](int depth, Json::parse_event_t, Json&) { return depth <= deepest_json; };
  const Json object = Json::parse(text, shallow, false);
  if (!object.is_object()) return {};
  const auto word = object.find("do");
  if (word == object.end() || !word->is_string()) return {};
  const auto action = actions().find(word->get<std::string>());
  if (action == actions().end()) return {};
  ViewMessage message{.action = action->second};
  if (message.action == ViewMessage::Action::ready && !read_wish(object, message.wish)) return {};
  if (message.action == ViewMessage::Action::steer) {
    const auto key = object.find("key"), value = object.find("value");
    if (key == object.end() || value == object.end() || !key->is_string() || !value->is_string()) return {};
    message.key = key->get<std::string>();
    message.value = value->get<std::string>();
  }
  return message;
}

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw_file_error("random numbers of the system", "read", errno);
  std::string token;
  for (const unsigned char byte : bytes) {
    token += "0123456789abcdef"[byte >> 4U];
    token += "0123456789abcdef"[byte & 15U];
  }
  return token;
}

bool same_token(std::string_view given, std::string_view expected) {
  if (given.size() != expected.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < given.size(); ++i)
    difference |= static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(expected[i]);
  return difference == 0;
}

std::string query_value(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    if (part.size() > name.size() && part.starts_with(name) && part[name.size()] == '=')
      return std::string(part.substr(name.size() + 1));
    query.remove_prefix(std::min(query.size(), part.size() + 1));
  }
  return {};
}

bool is_own_host(std::string_view host, int port) {
  const std::string end = ":" + std::to_string(port);
  return host == "127.0.0.1" + end || host == "localhost" + end;
}

bool is_own_origin(std::string_view origin, int port) {
  const std::string_view scheme = "http://";
  return origin.starts_with(scheme) && is_own_host(origin.substr(scheme.size()), port);
}

bool RateLimit::allow(Clock::time_point now) {
  if (last_) left_ += per_second_ * std::chrono::duration<double>(now - *last_).count();
  last_ = now;
  left_ = std::min(left_, at_once_);
  if (left_ < 1) return false;
  left_ -= 1;
  return true;
}

}  // namespace spume
