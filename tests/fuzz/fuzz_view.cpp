// SPDX-License-Identifier: MIT
// Fuzzer of what the live view is sent: the server gets the bytes of a client on a socket, the reader of messages gets
// them as a message, and what is asked for in one is made a frame. The first byte chooses: bytes instead of a request,
// behind the head of a request that has the token, or behind a socket's opening, there as they are or as one text.
// Afterwards the server still hands out its page, and who has no token got nothing of it.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "spume/view/server.hpp"

namespace {

using spume::FrameWish;

spume::Server& server() {
  static spume::Server one(0);
  return one;
}

class Client {
 public:
  Client() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(server().port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    while (::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
      // Of connections that the server closed first the ports rest for a minute: 28,000 are used up in seconds.
      if (errno != EADDRNOTAVAIL) __builtin_trap();
      std::this_thread::sleep_for(std::chrono::seconds(1));
    }
    // Closed at once and with no state left behind: thousands a second would use up the ports.
    const linger none{1, 0};
    setsockopt(socket_, SOL_SOCKET, SO_LINGER, &none, sizeof none);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client() { ::close(socket_); }

  void send(const std::string& bytes) const { ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  void end() const { ::shutdown(socket_, SHUT_WR); }
  // Until `mark` has come, the server has gone, or so long without anything.
  std::string receive(const std::string& mark, int milliseconds) const {
    std::string bytes;
    char buffer[4096];
    while (mark.empty() || bytes.find(mark) == std::string::npos) {
      pollfd ready{socket_, POLLIN, 0};
      if (::poll(&ready, 1, milliseconds) <= 0) break;
      const ssize_t count = ::recv(socket_, buffer, sizeof buffer, 0);
      if (count <= 0) break;
      bytes.append(buffer, static_cast<std::size_t>(count));
    }
    return bytes;
  }

 private:
  int socket_;
};

std::string own_host() {
  return "127.0.0.1:" + std::to_string(server().port());
}

std::string opening() {
  return "GET /socket?token=" + server().token() + " HTTP/1.1\r\nHost: " + own_host() + "\r\nOrigin: http://" +
         own_host() +
         "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
}

std::string text_frame(const std::string& text) {
  std::string frame{static_cast<char>(0x81)};
  if (text.size() < 126)
    frame += static_cast<char>(0x80 | text.size());
  else
    frame += {static_cast<char>(0x80 | 126), static_cast<char>(text.size() >> 8U & 255U),
              static_cast<char>(text.size() & 255U)};
  return frame + std::string(4, '\0') + text;
}

void make_frame_of(const FrameWish& wish) {
  static const std::vector<double> x{0, 1, 2, 3}, y{1, 1, 1, 1};
  static const std::vector<std::int64_t> id{0, 1, 2, 3};
  static const std::vector<float> values(4 * 4 * 4, 1.0F);
  static spume::FrameMaker frames;
  const spume::ParticleSnapshot family{
      "fluid",
      4,
      {x.data(), y.data()},
      {{"velocity", {x.data(), y.data()}, {}}, {"id", {}, {id.data()}}, {"phase", {}, {id.data()}}}};
  const spume::GridSnapshot grid{
      "grid", {4, 4, 4}, {0, 0, 0}, {1, 1, 1}, {{"velocity", {values.data(), values.data(), values.data()}}}};
  const auto frame = frames.make(1, 0.5, {family}, {grid}, wish, 1);
  std::uint32_t arrays = 0;
  std::memcpy(&arrays, frame->data(), sizeof arrays);
  if (!nlohmann::json::accept(frame->substr(4 + arrays))) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  if (const auto message = spume::parse_message(bytes); message && message->action == spume::ViewMessage::Action::ready)
    make_frame_of(message->wish);
  spume::query_value(bytes, "token");
  if (spume::is_own_host(bytes, server().port()) && bytes.find(std::to_string(server().port())) == std::string::npos)
    __builtin_trap();
  // A connection costs a hundred times a message.
  if (data[0] % 64 != 0) return 0;
  switch (data[0] / 64) {
    case 0: {
      const Client client;
      client.send(bytes);
      client.end();
      const std::string answer = client.receive("", 1000);
      // An address with the right token is no fuzzer's guess.
      if (answer.find("<!doctype html>") != std::string::npos || answer.find(server().token()) != std::string::npos)
        __builtin_trap();
      break;
    }
    case 1: {
      const Client client;
      client.send("GET /?token=" + server().token() + " HTTP/1.1\r\nHost: " + own_host() + "\r\n" + bytes);
      client.end();
      client.receive("", 1000);
      break;
    }
    default: {
      const Client client;
      client.send(opening());
      if (client.receive("\r\n\r\n", 1000).find(" 101 ") == std::string::npos) break;
      client.send(data[0] / 64 == 2 ? bytes : text_frame(bytes));
      client.end();
      client.receive("", 20);
      break;
    }
  }
  for (const auto& viewer : server().viewers())
    if (const auto wish = viewer->take_wish()) viewer->send({{true, std::make_shared<const std::string>(100, 'x')}});
  server().take_messages();
  server().rest();
  static unsigned tested = 0;
  if (++tested % 256 == 0) {
    const Client client;
    client.send("GET /?token=" + server().token() + " HTTP/1.1\r\nHost: " + own_host() + "\r\n\r\n");
    if (client.receive("</html>", 10000).find("<!doctype html>") == std::string::npos) __builtin_trap();
  }
  return 0;
}
