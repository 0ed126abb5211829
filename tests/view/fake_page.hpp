// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstring>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "view/socket_client.hpp"

namespace spume::test {

// A page: acknowledges frames and remembers what it was told.
class FakePage {
 public:
  explicit FakePage(const Server& server, bool steers = true)
      : connection_(test::open_socket(server, steers ? server.token() : server.looking_token(),
                                      "http://127.0.0.1:" + std::to_string(server.port()))) {
    say(test::ready);
  }
  void say(const std::string& text) { connection_->send(test::text_frame(text)); }
  // Reads until the condition holds; false after half a minute without that, or when the server has gone.
  bool read_until(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      bytes_ += connection_->receive([](const std::string& some) { return !some.empty(); });
      if (!take_frame() && connection_->gone()) return condition();
      while (take_frame()) {
      }
    }
    return true;
  }
  bool read_until_words(const std::string& words) {
    return read_until([&] { return state.value("words", "") == words; });
  }
  bool reads_line(const std::string& part) {
    return read_until([&] { return log.find(part) != std::string::npos; });
  }

  std::string wish = test::ready;  // said after each frame
  nlohmann::json hello = nlohmann::json::object(), state = hello, frame = hello;
  std::vector<nlohmann::json> rows;
  std::string log;
  std::vector<nlohmann::json> past;  // of the place that is looked at
  int frames = 0;

 private:
  bool take_frame() {
    if (bytes_.size() < 2) return false;
    const auto byte = [&](std::size_t k) { return static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_[k])); };
    std::uint64_t length = byte(1) & 127U;
    const std::size_t extra = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (bytes_.size() < 2 + extra) return false;
    if (extra > 0) length = 0;
    for (std::size_t k = 0; k < extra; ++k) length = length << 8U | byte(2 + k);
    if (bytes_.size() < 2 + extra + length) return false;
    const std::string payload = bytes_.substr(2 + extra, length);
    const std::uint64_t opcode = byte(0) & 15U;
    bytes_.erase(0, 2 + extra + length);
    if (opcode == 1) take_text(nlohmann::json::parse(payload));
    if (opcode != 2) return true;
    std::uint32_t arrays = 0;
    std::memcpy(&arrays, payload.data(), sizeof arrays);
    frame = nlohmann::json::parse(payload.substr(4 + arrays));
    ++frames;
    say(wish);
    return true;
  }
  void take_text(const nlohmann::json& message) {
    if (message["type"] == "hello") hello = message;
    if (message["type"] == "state") state = message;
    if (message["type"] == "series" && message["anew"]) rows.clear();
    if (message["type"] == "series")
      for (const auto& row : message["rows"]) rows.push_back(row);
    if (message["type"] == "history")
      for (const auto& row : message["rows"]) past.push_back(row);
    if (message["type"] == "log")
      for (const auto& line : message["lines"]) log += line.get<std::string>() + '\n';
  }
  std::unique_ptr<test::Connection> connection_;
  std::string bytes_;
};

}  // namespace spume::test
