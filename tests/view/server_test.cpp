// SPDX-License-Identifier: MIT
// The server, talked to by sockets that say what a browser would not.
#include "spume/view/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "spume/core/error.hpp"
#include "spume/view/page_file.hpp"
#include "view/server_fixture.hpp"
#include "view/socket_client.hpp"

namespace spume {
namespace {

using namespace std::chrono_literals;
using namespace std::string_literals;
using test::Connection;
using test::open_socket;
using test::ready;
using test::socket_frame;
using test::text_frame;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class LiveServer : public test::WithServer<testing::Test> {
 protected:
  std::string host() const { return "127.0.0.1:" + std::to_string(server_.port()); }
  std::string answer(const std::string& request) const {
    Connection connection(server_.port());
    connection.send(request);
    return connection.receive([](const std::string&) { return false; });
  }
  std::string get(const std::string& path, const std::string& named = {}) const {
    return answer("GET " + path + " HTTP/1.1\r\nHost: " + (named.empty() ? host() : named) + "\r\n\r\n");
  }
  std::string with_token(const std::string& path) const { return path + "?token=" + server_.token(); }

  std::unique_ptr<Connection> socket(const std::string& token, const std::string& origin) const {
    return open_socket(server_, token, origin);
  }
  std::unique_ptr<Connection> socket() const { return open_socket(server_); }

  std::optional<FrameWish> wish_of_first() {
    std::optional<FrameWish> wish;
    soon([&] {
      const auto viewers = server_.viewers();
      if (!viewers.empty()) wish = viewers.front()->take_wish();
      return wish.has_value();
    });
    return wish;
  }
};

TEST_F(LiveServer, HandsOutItsPageToWhoHasTheToken) {
  const std::string page = get(with_token("/"));
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(page, HasSubstr("Content-Security-Policy: default-src 'none'"));
  EXPECT_THAT(page, HasSubstr("view.js?token=" + server_.token()));
  EXPECT_THAT(page, Not(HasSubstr("@TOKEN@")));
  EXPECT_EQ(server_.address(), "http://" + host() + "/?token=" + server_.token());
  for (const PageFile& file : page_files()) {
    EXPECT_GT(file.contents.size(), 100U) << file.name;
    EXPECT_THAT(get(with_token("/" + std::string(file.name))), StartsWith("HTTP/1.1 200")) << file.name;
  }
}

TEST_F(LiveServer, RefusesStrangers) {
  std::string wrong = server_.token();
  wrong[0] = wrong[0] == '0' ? '1' : '0';
  for (const std::string& path :
       std::vector<std::string>{"/", "/?token=", "/?token=" + wrong, "/view.js?token=" + wrong})
    EXPECT_THAT(get(path), StartsWith("HTTP/1.1 403")) << path;
  // A name that a foreign page gave this machine (DNS rebinding).
  EXPECT_THAT(get(with_token("/"), "evil.example:" + std::to_string(server_.port())), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(answer("POST " + with_token("/") + " HTTP/1.1\r\nHost: " + host() + "\r\nContent-Length: 0\r\n\r\n"),
              StartsWith("HTTP/1.1 405"));
}

TEST_F(LiveServer, ReachesNoFile) {
  for (const char* path : {"/etc/passwd", "/../../../../etc/passwd", "/%2e%2e/%2e%2e/%2e%2e/%2e%2e/etc/passwd",
                           "//etc/passwd", "/page/index.html", "/..%5c..%5cetc", "/socket"}) {
    const std::string given = get(with_token(path));
    EXPECT_THAT(given, Not(HasSubstr("root:"))) << path;
    EXPECT_THAT(given, Not(StartsWith("HTTP/1.1 200"))) << path;
  }
}

TEST_F(LiveServer, SurvivesRequestsThatAreNone) {
  for (const std::string& request : std::vector<std::string>{
           std::string("\r\n\r\n"), std::string("GET"), std::string(100, '\0'),
           "GET / HTTP/1.1\r\n" + std::string(20000, 'a'), "GET /" + std::string(20000, 'a') + " HTTP/1.1\r\n\r\n",
           "\xff\xfe\x00\x01 / HTTP/9\r\n\r\n"s}) {
    Connection connection(server_.port());
    connection.send(request);
  }
  EXPECT_THAT(get(with_token("/")), StartsWith("HTTP/1.1 200"));
}

TEST_F(LiveServer, OpensASocketOnlyForItsPage) {
  const std::string own = "http://" + host();
  EXPECT_EQ(socket("0123", own), nullptr);
  EXPECT_EQ(socket(server_.token(), ""), nullptr);
  EXPECT_EQ(socket(server_.token(), "http://evil.example"), nullptr);
  EXPECT_TRUE(server_.viewers().empty());
  EXPECT_NE(socket(server_.token(), own), nullptr);
}

TEST_F(LiveServer, SendsWhenAViewerIsReady) {
  const auto page = socket();
  ASSERT_NE(page, nullptr);
  EXPECT_FALSE(server_.attention());
  page->send(text_frame(ready));
  const auto wish = wish_of_first();
  ASSERT_TRUE(wish);
  EXPECT_EQ(wish->points, 1000U);
  EXPECT_TRUE(server_.attention());
  server_.rest();
  EXPECT_FALSE(server_.attention());
  EXPECT_FALSE(server_.viewers().front()->take_wish());  // one frame per acknowledgement
  server_.viewers().front()->send({{false, std::make_shared<const std::string>("hello")}});
  EXPECT_EQ(page->receive([](const std::string& bytes) { return bytes.size() >= 7; }), "\x81\x05hello");
}

TEST_F(LiveServer, PassesMessagesOn) {
  const auto page = socket();
  page->send(text_frame(R"({"do":"pause"})") + text_frame(R"({"do":"steer","key":"a.b","value":"3"})"));
  std::vector<ViewMessage> messages;
  EXPECT_TRUE(soon([&] {
    for (ViewMessage& message : server_.take_messages()) messages.push_back(std::move(message));
    return messages.size() == 2;
  }));
  EXPECT_EQ(messages[0].action, ViewMessage::Action::pause);
  EXPECT_EQ(messages[1].key, "a.b");
}

TEST_F(LiveServer, DropsWhoSendsWhatIsNoMessage) {
  const std::string huge = socket_frame(1, "x", std::uint64_t{1} << 62U);
  for (const std::string& bytes :
       {text_frame("format the disk"), text_frame(std::string(5000, '1')), socket_frame(2, ready, ready.size()),
        socket_frame(0, ready, ready.size()), socket_frame(7, ready, ready.size()), huge}) {
    const auto page = socket();
    ASSERT_NE(page, nullptr);
    page->send(bytes);
    EXPECT_TRUE(page->closed());
  }
  EXPECT_TRUE(soon([&] { return server_.viewers().empty(); }));
  EXPECT_NE(socket(), nullptr);
}

TEST_F(LiveServer, DropsWhoSendsTooMuch) {
  const auto page = socket();
  for (int k = 0; k < 10000; ++k)
    if (!page->send(text_frame(ready))) break;
  EXPECT_TRUE(page->closed());
  EXPECT_TRUE(server_.take_messages().size() <= 64);
  EXPECT_NE(socket(), nullptr);
}

TEST_F(LiveServer, TakesABoundedNumberOfViewers) {
  std::vector<std::unique_ptr<Connection>> pages;
  for (int k = 0; k < most_viewers; ++k) {
    pages.push_back(socket());
    ASSERT_NE(pages.back(), nullptr);
    // A viewer counts once its socket is open.
    ASSERT_TRUE(soon([&] { return server_.viewers().size() == pages.size(); }));
  }
  EXPECT_EQ(socket(), nullptr);
  EXPECT_THAT(get(with_token("/")), StartsWith("HTTP/1.1 200"));
  pages.pop_back();
  EXPECT_TRUE(soon([&] { return server_.viewers().size() < most_viewers; }));
  EXPECT_NE(socket(), nullptr);
}

// The run hands over what it has and goes on, whether anybody reads or not.
TEST_F(LiveServer, NeverWaitsForAViewerThatDoesNotRead) {
  const auto page = socket();
  page->send(text_frame(ready));
  ASSERT_TRUE(wish_of_first());
  const auto viewer = server_.viewers().front();
  const auto large = std::make_shared<const std::string>(std::size_t{32} << 20U, 'x');
  const auto began = std::chrono::steady_clock::now();
  for (int k = 0; k < 1000; ++k) viewer->send({{true, large}});
  EXPECT_LT(std::chrono::steady_clock::now() - began, 500ms);
  EXPECT_FALSE(viewer->take_wish());
}

TEST_F(LiveServer, WhoMayOnlyLookIsDroppedWhenItSteers) {
  EXPECT_NE(server_.looking_token(), server_.token());
  // The page of a viewer that looks knows nothing of the token that steers.
  const std::string page = get("/?token=" + server_.looking_token());
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(page, HasSubstr("view.js?token=" + server_.looking_token()));
  EXPECT_THAT(page, Not(HasSubstr(server_.token())));
  const auto looking = socket(server_.looking_token(), "http://" + host());
  ASSERT_NE(looking, nullptr);
  looking->send(text_frame(ready));
  EXPECT_TRUE(wish_of_first());
  EXPECT_FALSE(server_.viewers().front()->may_steer());
  looking->send(text_frame(R"({"do":"stop"})"));
  EXPECT_TRUE(looking->closed());
  EXPECT_TRUE(server_.take_messages().empty());
  const auto steering = socket();
  EXPECT_TRUE(soon([&] { return server_.viewers().size() == 1 && server_.viewers().front()->may_steer(); }));
}

TEST_F(LiveServer, SaysThatItsPortIsTaken) {
  EXPECT_THROW(Server second(server_.port()), InputError);
}

}  // namespace
}  // namespace spume
