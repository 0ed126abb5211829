// SPDX-License-Identifier: MIT
// What a page may say to the program, and who is listened to. Text messages are JSON objects of at most
// largest_message bytes:
//
//   {"do": "ready", "points": 100000, "bits": 16, "fields": {"fluid": "pressure"}, "plane": {"axis": 2, "at": 0.5},
//    "volume": 64, "phases": true, "pick": {"family": "fluid", "at": [0, 0, 1], "id": 17}, "point": [0, 0, 1],
//    "snapshot": 3}
//   {"do": "pause"}  go  step  checkpoint  snapshot  stop
//   {"do": "steer", "key": "fluid.gravity", "value": "3.7"}
//
// "ready" acknowledges the last frame and asks for another; all but points and bits may be missing. A viewer that may
// only look says nothing else.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "spume/view/frame.hpp"

namespace spume {

inline constexpr std::size_t largest_message = 4096;

struct ViewMessage {
  enum class Action { ready, pause, go, step, checkpoint, snapshot, stop, steer };
  Action action = Action::ready;
  FrameWish wish = {};               // of ready
  std::string key = {}, value = {};  // of steer
};

// Nothing for what is no such message: whoever sent it is not a page of this program.
std::optional<ViewMessage> parse_message(std::string_view text);

// 128 bits of the system's random numbers, in hexadecimal digits. Throws FileError without such numbers.
std::string random_token();
// In a time that does not tell how much of it is right.
bool same_token(std::string_view given, std::string_view expected);
// The value of `name` in "a=1&b=2"; empty without it.
std::string query_value(std::string_view query, std::string_view name);
// "127.0.0.1:port" or "localhost:port": another name may be one that a foreign page gave this machine.
bool is_own_host(std::string_view host, int port);
bool is_own_origin(std::string_view origin, int port);

// How many messages a page may send: so many at once, and so many a second on the average.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;
  RateLimit(double at_once, double per_second) : at_once_(at_once), per_second_(per_second), left_(at_once) {}
  bool allow(Clock::time_point now);

 private:
  double at_once_, per_second_, left_;
  std::optional<Clock::time_point> last_;
};

}  // namespace spume
