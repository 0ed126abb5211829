// SPDX-License-Identifier: MIT
// What is taken from a page and from whom, and the history that it is told.
#include "spume/view/protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "spume/view/history.hpp"

namespace spume {
namespace {

using Action = ViewMessage::Action;
using testing::Each;
using testing::SizeIs;
using namespace std::chrono_literals;

TEST(Protocol, MessagesOfAPageAreRead) {
  for (const auto& [word, action] : {std::pair{"pause", Action::pause},
                                     {"go", Action::go},
                                     {"step", Action::step},
                                     {"checkpoint", Action::checkpoint},
                                     {"snapshot", Action::snapshot},
                                     {"stop", Action::stop}}) {
    const auto message = parse_message(std::string("{\"do\": \"") + word + "\"}");
    ASSERT_TRUE(message);
    EXPECT_EQ(message->action, action);
  }
  const auto steer = parse_message(R"({"do": "steer", "key": "fluid.gravity", "value": "[\"0\", \"-1\"]"})");
  ASSERT_TRUE(steer);
  EXPECT_EQ(steer->key, "fluid.gravity");
  EXPECT_EQ(steer->value, "[\"0\", \"-1\"]");
  const auto ready = parse_message(
      R"({"do":"ready","points":1000,"bits":8,"fields":{"fluid":"pressure"},"plane":{"axis":1,"at":0.25}})");
  ASSERT_TRUE(ready);
  EXPECT_EQ(ready->wish.points, 1000U);
  EXPECT_EQ(ready->wish.bits, 8);
  EXPECT_EQ(ready->wish.fields.at("fluid"), "pressure");
  EXPECT_EQ(ready->wish.plane_axis, 1);
  EXPECT_EQ(ready->wish.plane_at, 0.25);
}

TEST(Protocol, AViewerPointsAtThings) {
  const auto ready = parse_message(
      R"({"do":"ready","points":10,"bits":8,"volume":64,"phases":true,"pick":{"family":"bubbles","at":[1,-2.5],"id":17},)"
      R"("point":[0.5,0,3],"snapshot":12})");
  ASSERT_TRUE(ready);
  EXPECT_EQ(ready->wish.volume, 64U);
  EXPECT_TRUE(ready->wish.phases);
  EXPECT_EQ(ready->wish.picked, (PickWish{"bubbles", {1, -2.5, 0}, 17}));
  EXPECT_EQ(ready->wish.point, (std::array<double, 3>{0.5, 0, 3}));
  EXPECT_EQ(ready->wish.snapshot, 12U);
  for (const char* part :
       {R"("volume":129)", R"("volume":-1)", R"("phases":1)", R"("pick":3)", R"("pick":{"at":[0,0,0]})",
        R"("pick":{"family":"a"})", R"("pick":{"family":3,"at":[0]})", R"("pick":{"family":"a","at":[0,0,0,0]})",
        R"("pick":{"family":"a","at":[0],"id":0.5})", R"("point":[0,"1"])", R"("point":[1e999])", R"("point":{})",
        R"("snapshot":-1)", R"("snapshot":1e300)"})
    EXPECT_FALSE(parse_message(R"({"do":"ready","points":10,"bits":8,)" + std::string(part) + "}")) << part;
}

TEST(Protocol, WhatIsNoMessageIsRefused) {
  std::string long_value = R"({"do": "steer", "key": "a", "value": ")" + std::string(largest_message, '1') + "\"}";
  for (const std::string& text :
       std::vector<std::string>{"",
                                "null",
                                "3",
                                "[]",
                                "{}",
                                "{",
                                "{\"do\": 3}",
                                R"({"do": "format the disk"})",
                                R"({"do": "steer"})",
                                R"({"do": "steer", "key": "a", "value": 3})",
                                R"({"do": "ready"})",
                                R"({"do":"ready","points":-1,"bits":8})",
                                R"({"do":"ready","points":1e300,"bits":8})",
                                R"({"do":"ready","points":10,"bits":12})",
                                R"({"do":"ready","points":10,"bits":8,"fields":3})",
                                R"({"do":"ready","points":10,"bits":8,"fields":{"a":1}})",
                                R"({"do":"ready","points":10,"bits":8,"plane":{"axis":3,"at":0}})",
                                R"({"do":"ready","points":10,"bits":8,"plane":{"axis":0.5,"at":0}})",
                                R"({"do":"ready","points":10,"bits":8,"plane":{"axis":0,"at":2}})",
                                "{\"do\": \"pause\xff\"}",
                                std::string(2000, '[') + std::string(2000, ']'),

                                long_value})
    EXPECT_FALSE(parse_message(text)) << text.substr(0, 80);
  std::string families = R"({"do":"ready","points":10,"bits":8,"fields":{)";
  for (int k = 0; k < 40; ++k) families += (k ? ",\"" : "\"") + std::to_string(k) + "\":\"a\"";
  EXPECT_FALSE(parse_message(families + "}}"));
}

// Whatever bytes of a good message are changed, there is an answer and no exception.
TEST(Protocol, DamagedMessagesDoNoHarm) {
  const std::string good =
      R"({"do":"ready","points":1000,"bits":8,"fields":{"fluid":"x"},"plane":{"axis":1,"at":0.5}})";
  std::mt19937 random(1);
  for (int k = 0; k < 20000; ++k) {
    std::string text = good;
    for (unsigned changes = random() % 4 + 1; changes > 0; --changes)
      text[random() % text.size()] = static_cast<char>(random());
    if (random() % 4 == 0) text.resize(random() % text.size());
    const auto message = parse_message(text);
    if (!message || message->action != Action::ready) continue;
    EXPECT_LE(message->wish.points, most_frame_points);
    EXPECT_TRUE(message->wish.bits == 8 || message->wish.bits == 16);
    EXPECT_TRUE(message->wish.plane_at >= 0 && message->wish.plane_at <= 1);
  }
}

TEST(Protocol, TokensAreLongDifferentAndComparedAsAWhole) {
  std::set<std::string> tokens;
  for (int k = 0; k < 100; ++k) tokens.insert(random_token());
  EXPECT_THAT(tokens, SizeIs(100));
  EXPECT_THAT(tokens, Each(SizeIs(32)));
  const std::string token = *tokens.begin();
  EXPECT_TRUE(same_token(token, token));
  for (const std::string& other : {std::string(), token + "0", token.substr(1), std::string(32, '0')})
    EXPECT_FALSE(same_token(other, token));
  std::string changed = token;
  changed.back() = changed.back() == '0' ? '1' : '0';
  EXPECT_FALSE(same_token(changed, token));
}

TEST(Protocol, TheTokenIsFoundInAQuery) {
  EXPECT_EQ(query_value("token=ab", "token"), "ab");
  EXPECT_EQ(query_value("x=1&token=ab&y=2", "token"), "ab");
  EXPECT_EQ(query_value("nottoken=ab&tokens=cd&token", "token"), "");
  EXPECT_EQ(query_value("", "token"), "");
  EXPECT_EQ(query_value("&&&token=", "token"), "");
}

TEST(Protocol, OnlyThisMachinesOwnNamesAreHosts) {
  EXPECT_TRUE(is_own_host("127.0.0.1:8080", 8080));
  EXPECT_TRUE(is_own_host("localhost:8080", 8080));
  for (const char* host :
       {"", "127.0.0.1", "127.0.0.1:80", "evil.example:8080", "127.0.0.1:8080.evil.example", "[::1]:8080"})
    EXPECT_FALSE(is_own_host(host, 8080)) << host;
  EXPECT_TRUE(is_own_origin("http://127.0.0.1:8080", 8080));
  for (const char* origin : {"", "null", "http://evil.example", "https://127.0.0.1:8080", "http://127.0.0.1:8081",
                             "http://127.0.0.1:8080/", "http://evil.example:8080"})
    EXPECT_FALSE(is_own_origin(origin, 8080)) << origin;
}

TEST(Protocol, MessagesAreLimitedAtOnceAndPerSecond) {
  RateLimit limit(5, 10);
  RateLimit::Clock::time_point now{};
  for (int k = 0; k < 5; ++k) EXPECT_TRUE(limit.allow(now));
  EXPECT_FALSE(limit.allow(now));
  EXPECT_FALSE(limit.allow(now + 50ms));
  EXPECT_TRUE(limit.allow(now + 151ms));
  int allowed = 0;
  for (int k = 0; k < 1000; ++k) allowed += limit.allow(now + 200ms + k * 1ms) ? 1 : 0;
  EXPECT_LE(allowed, 11);
  EXPECT_GE(allowed, 9);
}

TEST(History, KeepsABoundedNumberOfEvenlySpacedRows) {
  SeriesHistory history(100);
  for (int k = 0; k < 1000; ++k) {
    const double row[] = {static_cast<double>(k), 2.0 * k};
    history.add(row);
  }
  ASSERT_GT(history.rows(), 50U);
  ASSERT_LE(history.rows(), 100U);
  EXPECT_EQ(history.row(0)[0], 0);
  const double stride = history.row(1)[0] - history.row(0)[0];
  for (std::size_t k = 1; k < history.rows(); ++k) {
    EXPECT_EQ(history.row(k)[0] - history.row(k - 1)[0], stride);
    EXPECT_EQ(history.row(k)[1], 2 * history.row(k)[0]);
  }
}

TEST(History, SaysWhenRowsWereTakenOut) {
  SeriesHistory history(4);
  const double row[] = {1, 2, 3};
  for (int k = 0; k < 4; ++k) history.add(row);
  const auto edition = history.edition();
  history.add(row);
  EXPECT_NE(history.edition(), edition);
  const double wider[] = {1, 2, 3, 4};
  history.add(wider);
  EXPECT_EQ(history.rows(), 1U);
}

}  // namespace
}  // namespace spume
