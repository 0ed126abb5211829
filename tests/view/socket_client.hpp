// SPDX-License-Identifier: MIT
// A client of the server that says what a browser would, or would not.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "spume/view/server.hpp"

namespace spume::test {

class Connection {
 public:
  explicit Connection(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { ::close(socket_); }

  // False once the other side has gone.
  bool send(const std::string& bytes) const {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }
  // What comes until `enough` says so, the connection ends or five seconds have passed.
  template <class Enough>
  std::string receive(Enough&& enough) {
    std::string bytes;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (!enough(bytes) && std::chrono::steady_clock::now() < end) {
      pollfd ready{socket_, POLLIN, 0};
      if (::poll(&ready, 1, 100) <= 0) continue;
      char buffer[4096];
      const ssize_t count = ::recv(socket_, buffer, sizeof buffer, 0);
      if (count <= 0) {
        closed_ = true;
        break;
      }
      bytes.append(buffer, static_cast<std::size_t>(count));
    }
    return bytes;
  }
  bool gone() const { return closed_; }
  // Waits for the other side to go.
  bool closed() {
    receive([this](const std::string&) { return closed_; });
    return closed_;
  }

 private:
  int socket_;
  bool closed_ = false;
};

// A frame of the WebSocket protocol (RFC 6455, 5.2) with a mask of zeros.
inline std::string socket_frame(int opcode, const std::string& text, std::uint64_t said_length) {
  std::string frame{static_cast<char>(0x80 | opcode)};
  if (said_length < 126) {
    frame += static_cast<char>(0x80 | said_length);
  } else if (said_length < 65536) {
    frame += static_cast<char>(0x80 | 126);
    frame += static_cast<char>(said_length >> 8U);
    frame += static_cast<char>(said_length & 255U);
  } else {
    frame += static_cast<char>(0x80 | 127);
    for (int shift = 56; shift >= 0; shift -= 8)
      frame += static_cast<char>(said_length >> static_cast<unsigned>(shift));
  }
  return frame + std::string(4, '\0') + text;
}
inline std::string text_frame(const std::string& text) {
  return socket_frame(1, text, text.size());
}

inline const std::string ready = R"({"do":"ready","points":1000,"bits":16})";

// Null when the server refuses it.
inline std::unique_ptr<Connection> open_socket(const Server& server, const std::string& token,
                                               const std::string& origin) {
  auto connection = std::make_unique<Connection>(server.port());
  connection->send("GET /socket?token=" + token + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port()) +
                   "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                   "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                   (origin.empty() ? "" : "Origin: " + origin + "\r\n") + "\r\n");
  const std::string head =
      connection->receive([](const std::string& bytes) { return bytes.find("\r\n\r\n") != std::string::npos; });
  return head.starts_with("HTTP/1.1 101") ? std::move(connection) : nullptr;
}
inline std::unique_ptr<Connection> open_socket(const Server& server) {
  return open_socket(server, server.token(), "http://127.0.0.1:" + std::to_string(server.port()));
}

}  // namespace spume::test
