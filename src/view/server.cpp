// SPDX-License-Identifier: MIT
#include "spume/view/server.hpp"

#include <civetweb.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <list>
#include <mutex>
#include <thread>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/view/page_file.hpp"

namespace spume {
namespace {

using Clock = std::chrono::steady_clock;

// A page sends an acknowledgement per frame, ten a second, and now and then what its user clicks. Once beyond this it
// is dropped.
constexpr double messages_at_once = 100, messages_per_second = 40;
constexpr std::size_t most_commands = 64;
// Of a viewer that takes nothing: hello, the last frame and what belongs to it are seven.
constexpr std::size_t most_packets = 32;
constexpr const char* socket_path = "/socket";

std::string_view text_or_empty(const char* text) {
  return text == nullptr ? std::string_view() : std::string_view(text);
}

class Socket final : public Viewer {
 public:
  Socket(mg_connection* connection, bool may_steer)
      : connection_(connection), may_steer_(may_steer), sender_([this] { empty_mailbox(); }) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() override { close(); }

  std::optional<FrameWish> take_wish() override {
    const std::lock_guard lock(mutex_);
    return std::exchange(wish_, {});
  }
  void give_back(FrameWish wish) override {
    const std::lock_guard lock(mutex_);
    if (!wish_) wish_ = std::move(wish);
  }
  void send(std::vector<Packet> packets) override {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    if (packets_.size() + packets.size() > most_packets) {
      closed_ = true;
    } else {
      for (Packet& packet : packets) packets_.push_back(std::move(packet));
    }
    changed_.notify_one();
  }

  bool may_steer() const override { return may_steer_; }

  void set_wish(FrameWish wish) {
    const std::lock_guard lock(mutex_);
    wish_ = std::move(wish);
  }
  bool waits() const {
    const std::lock_guard lock(mutex_);
    return wish_.has_value() && !closed_;
  }
  bool allow_message() { return rate_.allow(Clock::now()); }
  bool closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }
  bool idle() const override {
    const std::lock_guard lock(mutex_);
    return closed_ || (packets_.empty() && !sending_);
  }
  // Afterwards the connection is not used any more.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      changed_.notify_one();
    }
    if (sender_.joinable()) sender_.join();
  }

 private:
  void empty_mailbox() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return closed_ || !packets_.empty(); });
      if (closed_) return;
      const Packet packet = std::move(packets_.front());
      packets_.pop_front();
      sending_ = true;
      lock.unlock();
      const int opcode = packet.binary ? MG_WEBSOCKET_OPCODE_BINARY : MG_WEBSOCKET_OPCODE_TEXT;
      const bool sent = mg_websocket_write(connection_, opcode, packet.bytes->data(), packet.bytes->size()) > 0;
      lock.lock();
      sending_ = false;
      if (!sent) closed_ = true;
    }
  }

  mg_connection* connection_;
  bool may_steer_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Packet> packets_;
  std::optional<FrameWish> wish_;
  bool closed_ = false, sending_ = false;
  RateLimit rate_{messages_at_once, messages_per_second};
  std::thread sender_;
};

}  // namespace

struct Server::Inside {
  mg_context* context = nullptr;
  int port = 0;
  std::string token = random_token(), looking_token = random_token();
  mutable std::mutex mutex;
  std::condition_variable news;
  std::list<std::shared_ptr<Socket>> sockets;
  std::vector<ViewMessage> messages;
  std::atomic<bool> attention = false;

  void call_attention() {
    {
      const std::lock_guard lock(mutex);  // who waits sees it now or is told below
      attention = true;
    }
    news.notify_all();
  }

  // What the library calls must not throw: who asked gets `failure`.
  template <class Work>
  static int guarded(int failure, Work&& work) {
    try {
      return work();
    } catch (const std::exception&) {
      return failure;
    }
  }

  enum class Right { none, look, steer };
  Right right_of(const mg_connection* connection) const {
    if (!is_own_host(text_or_empty(mg_get_header(connection, "Host")), port)) return Right::none;
    const std::string given = query_value(text_or_empty(mg_get_request_info(connection)->query_string), "token");
    if (same_token(given, token)) return Right::steer;
    return same_token(given, looking_token) ? Right::look : Right::none;
  }

  static void answer(mg_connection* connection, const char* status, std::string_view type, std::string_view body,
                     const std::string& more = {}) {
    const std::string head = std::string("HTTP/1.1 ") + status + "\r\nContent-Type: " + std::string(type) +
                             "\r\nContent-Length: " + std::to_string(body.size()) +
                             "\r\nCache-Control: no-store\r\nReferrer-Policy: no-referrer"
                             "\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n" +
                             more + "\r\n";
    mg_write(connection, head.data(), head.size());
    mg_write(connection, body.data(), body.size());
  }

  int serve(mg_connection* connection) const {
    const mg_request_info* const request = mg_get_request_info(connection);
    const Right right = right_of(connection);
    if (right == Right::none) {
      answer(connection, "403 Forbidden", "text/plain; charset=utf-8",
             "The address needs the token that the program printed.\n");
      return 403;
    }
    if (text_or_empty(request->request_method) != "GET") {
      answer(connection, "405 Method Not Allowed", "text/plain", "Only GET is served.\n", "Allow: GET\r\n");
      return 405;
    }
    std::string_view name = text_or_empty(request->local_uri).substr(1);
    if (name.empty()) name = "index.html";
    for (const PageFile& file : page_files()) {
      if (file.name != name) continue;
      if (file.type != "text/html") {
        answer(connection, "200 OK", file.type, file.contents);
        return 200;
      }
      // The page asks for its parts with the token that it was asked for with.
      std::string text(file.contents);
      const std::string_view place = "@TOKEN@";
      for (std::size_t at = text.find(place); at != std::string::npos; at = text.find(place, at))
        text.replace(at, place.size(), right == Right::steer ? token : looking_token);
      answer(connection, "200 OK", "text/html; charset=utf-8", text, policy());
      return 200;
    }
    answer(connection, "404 Not Found", "text/plain", "There is no such file.\n");
    return 404;
  }

  // Nothing is loaded from elsewhere, and no other page may frame this one.
  std::string policy() const {
    const std::string end = ":" + std::to_string(port);
    return "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
           "connect-src 'self' ws://127.0.0.1" +
           end + " ws://localhost" + end + "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n";
  }

  // A non-zero result refuses the connection.
  int connect(const mg_connection* connection) const {
    if (right_of(connection) == Right::none) return 1;
    if (!is_own_origin(text_or_empty(mg_get_header(connection, "Origin")), port)) return 1;
    const std::lock_guard lock(mutex);
    return sockets.size() >= most_viewers ? 1 : 0;
  }

  void open(mg_connection* connection) {
    auto socket = std::make_shared<Socket>(connection, right_of(connection) == Right::steer);
    const std::lock_guard lock(mutex);
    mg_set_user_connection_data(connection, socket.get());
    sockets.push_back(std::move(socket));
  }

  // Zero drops the viewer.
  int receive(mg_connection* connection, int bits, std::string_view text) {
    auto* const socket = static_cast<Socket*>(mg_get_user_connection_data(connection));
    if (socket == nullptr || socket->closed()) return 0;
    const int opcode = bits & 0xf;
    if (opcode == MG_WEBSOCKET_OPCODE_PONG || opcode == MG_WEBSOCKET_OPCODE_PING) return 1;
    const bool whole = (bits & 0x80) != 0;
    if (opcode != MG_WEBSOCKET_OPCODE_TEXT || !whole || !socket->allow_message()) return 0;
    std::optional<ViewMessage> message = parse_message(text);
    if (!message) return 0;
    if (message->action == ViewMessage::Action::ready) {
      socket->set_wish(std::move(message->wish));
    } else if (!socket->may_steer()) {
      return 0;
    } else {
      const std::lock_guard lock(mutex);
      if (messages.size() >= most_commands) return 0;
      messages.push_back(std::move(*message));
    }
    call_attention();
    return 1;
  }

  void close(const mg_connection* connection) {
    std::shared_ptr<Socket> closed;
    {
      const std::lock_guard lock(mutex);
      const auto found = std::find_if(sockets.begin(), sockets.end(), [&](const auto& socket) {
        return socket.get() == mg_get_user_connection_data(connection);
      });
      if (found == sockets.end()) return;
      closed = *found;
      sockets.erase(found);
    }
    closed->close();
  }
};

Server::Server(int port) : inside_(std::make_unique<Inside>()) {
  mg_init_library(0);
  const std::string place = "127.0.0.1:" + std::to_string(port);
  // A viewer holds a thread as long as it looks; two more hand out the page. A request and a write that take longer
  // than the timeout are dropped.
  const std::string threads = std::to_string(most_viewers + 2);
  const char* const options[] = {"listening_ports",
                                 place.c_str(),
                                 "num_threads",
                                 threads.c_str(),
                                 "request_timeout_ms",
                                 "5000",
                                 "websocket_timeout_ms",
                                 "20000",
                                 "enable_websocket_ping_pong",
                                 "yes",
                                 "enable_directory_listing",
                                 "no",
                                 "enable_keep_alive",
                                 "no",
                                 "max_request_size",
                                 "8192",
                                 nullptr};
  mg_callbacks callbacks{};
  callbacks.log_message = [](const mg_connection*, const char*) { return 1; };  // not to the terminal
  inside_->context = mg_start(&callbacks, inside_.get(), const_cast<const char**>(options));
  if (inside_->context == nullptr) {
    mg_exit_library();
    throw InputError("port " + std::to_string(port) +
                     " of 127.0.0.1 is taken or not allowed; choose another with --port");
  }
  mg_server_port ports[1];
  std::memset(ports, 0, sizeof ports);
  mg_get_server_ports(inside_->context, 1, ports);
  inside_->port = ports[0].port;
  mg_set_request_handler(
      inside_->context, "/",
      [](mg_connection* connection, void* inside) {
        return Inside::guarded(500, [&] { return static_cast<Inside*>(inside)->serve(connection); });
      },
      inside_.get());
  mg_set_websocket_handler(
      inside_->context, socket_path,
      [](const mg_connection* connection, void* inside) {
        return Inside::guarded(1, [&] { return static_cast<Inside*>(inside)->connect(connection); });
      },
      [](mg_connection* connection, void* inside) {
        Inside::guarded(0, [&] {
          static_cast<Inside*>(inside)->open(connection);
          return 1;
        });
      },
      [](mg_connection* connection, int bits, char* data, std::size_t size, void* inside) {
        return Inside::guarded(
            0, [&] { return static_cast<Inside*>(inside)->receive(connection, bits, std::string_view(data, size)); });
      },
      [](const mg_connection* connection, void* inside) { static_cast<Inside*>(inside)->close(connection); },
      inside_.get());
}

Server::~Server() {
  mg_stop(inside_->context);
  mg_exit_library();
}

int Server::port() const {
  return inside_->port;
}

const std::string& Server::token() const {
  return inside_->token;
}

const std::string& Server::looking_token() const {
  return inside_->looking_token;
}

std::string Server::address() const {
  return "http://127.0.0.1:" + std::to_string(port()) + "/?token=" + token();
}

std::string Server::looking_address() const {
  return "http://127.0.0.1:" + std::to_string(port()) + "/?token=" + looking_token();
}

bool Server::attention() const {
  return inside_->attention.load(std::memory_order_relaxed);
}

std::vector<std::shared_ptr<Viewer>> Server::viewers() const {
  const std::lock_guard lock(inside_->mutex);
  return {inside_->sockets.begin(), inside_->sockets.end()};
}

std::vector<ViewMessage> Server::take_messages() {
  const std::lock_guard lock(inside_->mutex);
  return std::exchange(inside_->messages, {});
}

void Server::wait(std::chrono::milliseconds longest) {
  std::unique_lock lock(inside_->mutex);
  inside_->news.wait_for(lock, longest, [this] { return !inside_->messages.empty(); });
}

bool Server::take_attention() {
  return inside_->attention.exchange(false);
}

void Server::wait_for_attention(std::chrono::milliseconds longest) {
  std::unique_lock lock(inside_->mutex);
  inside_->news.wait_for(lock, longest, [this] { return inside_->attention.load(); });
}

void Server::rest() {
  inside_->attention = false;
  const std::lock_guard lock(inside_->mutex);
  const bool waits = !inside_->messages.empty() || std::any_of(inside_->sockets.begin(), inside_->sockets.end(),
                                                               [](const auto& socket) { return socket->waits(); });
  if (waits) inside_->attention = true;
}

void Server::drain(std::chrono::milliseconds longest) {
  const auto end = Clock::now() + longest;
  const auto idle = [this] {
    const std::lock_guard lock(inside_->mutex);
    return std::all_of(inside_->sockets.begin(), inside_->sockets.end(),
                       [](const auto& socket) { return socket->idle(); });
  };
  while (!idle() && Clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace spume
