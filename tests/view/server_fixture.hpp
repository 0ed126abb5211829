// SPDX-License-Identifier: MIT
// One server for all tests of a suite, since the library takes two seconds to stop one. After each test it is as
// before.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>

#include "spume/view/server.hpp"

namespace spume::test {

template <class Fixture>
class WithServer : public Fixture {
 protected:
  static void SetUpTestSuite() { shared() = std::make_unique<Server>(0); }
  static void TearDownTestSuite() { shared().reset(); }
  void TearDown() override {
    EXPECT_TRUE(soon([&] { return server_.viewers().empty(); }));
    server_.take_messages();
    server_.rest();
  }
  // Whether the condition holds within five seconds.
  template <class Condition>
  static bool soon(Condition&& condition) {
    for (int k = 0; k < 500; ++k) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

 private:
  static std::unique_ptr<Server>& shared() {
    static std::unique_ptr<Server> server;
    return server;
  }

 protected:
  Server& server_ = *shared();
};

}  // namespace spume::test
