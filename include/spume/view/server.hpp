// SPDX-License-Identifier: MIT
// The server of the live view: hands out the embedded page and holds a socket for every viewer. Bound to 127.0.0.1;
// every request carries a token, and names this machine as host, and a socket the page as its origin. Nothing of
// the file system is served. One token lets its viewer steer, the other only look.
//
// The thread of the run never waits here: what it sends goes into the mailbox of a viewer, which a thread of the
// viewer empties, and it sends only to viewers that have acknowledged what they got before, or, of a run that prepares,
// whose mailbox is empty.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spume/view/protocol.hpp"

namespace spume {

inline constexpr int most_viewers = 4;

struct Packet {
  bool binary = false;
  std::shared_ptr<const std::string> bytes;
};

// One page that looks at the run.
class Viewer {
 public:
  virtual ~Viewer() = default;
  // The wish of a viewer that waits for a frame, once per acknowledgement.
  virtual std::optional<FrameWish> take_wish() = 0;
  // Unless another one has come meanwhile.
  virtual void give_back(FrameWish wish) = 0;
  virtual void send(std::vector<Packet> packets) = 0;
  virtual bool idle() const = 0;  // everything is sent
  virtual bool may_steer() const = 0;
  // Of what the run has told this viewer, kept by the thread of the run.
  struct Told {
    std::int64_t hello = -1, edition = -1, step = -1;
    std::optional<FrameWish> wish = {};
    std::string words = {};
    std::size_t rows = 0;
    std::int64_t lines = 0;
    std::chrono::steady_clock::time_point ledger{};
  } told;
};

class Server {
 public:
  // Port 0: a free one. Throws InputError when the port is taken.
  explicit Server(int port);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  int port() const;
  const std::string& token() const;
  const std::string& looking_token() const;
  std::string address() const;  // "http://127.0.0.1:8080/?token=..."
  std::string looking_address() const;

  // Whether a viewer waits or has asked for something: one load, for the thread of the run.
  bool attention() const;
  std::vector<std::shared_ptr<Viewer>> viewers() const;
  // After both have been served: no attention until there is news.
  void rest();
  // Whether anything has come since the last call, for who serves all of it then.
  bool take_attention();
  // What viewers asked for beside frames, in their order.
  std::vector<ViewMessage> take_messages();
  // Until a viewer asks for something beside a frame, or so long.
  void wait(std::chrono::milliseconds longest);
  // Until a viewer asks for anything, or so long.
  void wait_for_attention(std::chrono::milliseconds longest);
  // Waits until everything is sent, at most so long.
  void drain(std::chrono::milliseconds longest);

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace spume
