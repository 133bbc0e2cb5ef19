#include "core/transport/bus.h"

#include <atomic>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/transport/channels.h"

namespace vpslam::test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

BusOptions Memory() {
  BusOptions options;
  options.url = "memq://";
  return options;
}

const std::vector<uint8_t> kBytes{1, 2, 3};

TEST(Bus, DeliversToEverySubscriberOfTheChannel) {
  Bus bus(Memory());
  std::atomic<int> a{0}, b{0}, other{0};
  const auto sub_a = bus.Subscribe("A", [&](auto bytes) { a += bytes.size(); });
  const auto sub_b = bus.Subscribe("A", [&](auto) { ++b; });
  const auto sub_other = bus.Subscribe("AB", [&](auto) { ++other; });
  bus.Publish("A", kBytes);
  EXPECT_TRUE(bus.WaitFor([&] { return a == 3 && b == 1; }, 2s));
  EXPECT_EQ(other, 0);
  EXPECT_EQ(bus.counters().sent, 1);
  EXPECT_EQ(bus.counters().received, 1);
}

TEST(Bus, NoHandlerRunsAfterItsRegistrationEnded) {
  Bus bus(Memory());
  std::atomic<int> count{0}, all{0};
  const auto sub_all = bus.Subscribe("A", [&](auto) { ++all; });
  {
    const auto sub = bus.Subscribe("A", [&](auto) { ++count; });
    bus.Publish("A", kBytes);
    ASSERT_TRUE(bus.WaitFor([&] { return count == 1; }, 2s));
  }
  bus.Publish("A", kBytes);
  ASSERT_TRUE(bus.WaitFor([&] { return all == 2; }, 2s));
  EXPECT_EQ(count, 1);
}

TEST(Bus, WaitForTimesOutAndIsInterrupted) {
  Bus bus(Memory());
  EXPECT_FALSE(bus.WaitFor([] { return false; }, 20ms));
  EXPECT_TRUE(bus.WaitFor([] { return true; }, 0ms));
  std::thread stopper([&] {
    std::this_thread::sleep_for(30ms);
    bus.Interrupt();
  });
  EXPECT_FALSE(bus.WaitFor([] { return false; }, 20s));
  stopper.join();
  EXPECT_TRUE(bus.interrupted());
}

TEST(Bus, NotifyWakesAWaiter) {
  Bus bus(Memory());
  std::atomic<bool> flag{false};
  std::thread setter([&] {
    std::this_thread::sleep_for(30ms);
    flag = true;
    bus.Notify();
  });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_TRUE(bus.WaitFor([&] { return flag.load(); }, 20s));
  EXPECT_LT(std::chrono::steady_clock::now() - start, 5s);
  setter.join();
}

TEST(Bus, ThrowsAwayTheShareItWasAskedTo) {
  const auto lost = [](uint64_t seed) {
    BusOptions options = Memory();
    options.drop_share = 0.25;
    options.drop_seed = seed;
    Bus bus(options);
    std::vector<int> came;
    const auto sub = bus.Subscribe("A", [&](auto bytes) { came.push_back(bytes[0]); });
    for (int i = 0; i < 200; ++i) bus.Publish("A", std::vector<uint8_t>{static_cast<uint8_t>(i)});
    EXPECT_TRUE(bus.WaitFor([&] { return bus.counters().received == 200; }, 5s));
    return came;
  };
  const std::vector<int> first = lost(1);
  EXPECT_GT(first.size(), 120u);
  EXPECT_LT(first.size(), 180u);
  EXPECT_EQ(first, lost(1));
  EXPECT_NE(first, lost(2));
}

TEST(Bus, TicksUntilItsRegistrationEnds) {
  Bus bus(Memory());
  std::atomic<int> ticks{0};
  {
    const auto timer = bus.OnTick([&] {
      ++ticks;
      bus.Notify();
    });
    EXPECT_TRUE(bus.WaitFor([&] { return ticks >= 2; }, 5s));
  }
  const int then = ticks;
  std::this_thread::sleep_for(3 * Bus::kTick);
  EXPECT_EQ(ticks, then);
}

std::string ThrownBy(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

TEST(Bus, WhatAHandlerThrowsReachesTheWaiter) {
  Bus bus(Memory());
  std::atomic<int> calls{0};
  const auto sub = bus.Subscribe("A", [&](auto) {
    ++calls;
    throw std::runtime_error("first");
  });
  const auto after = bus.Subscribe("A", [](auto) { throw std::runtime_error("second"); });
  std::thread publisher([&] {
    std::this_thread::sleep_for(30ms);
    bus.Publish("A", kBytes);
  });
  EXPECT_EQ(ThrownBy([&] { bus.WaitFor([] { return false; }, 20s); }), "first");
  publisher.join();
  // The thread goes on, and the one failure is told once: what comes after it may be its result.
  bus.Publish("A", kBytes);
  EXPECT_TRUE(bus.WaitFor([&] { return calls == 2; }, 5s));
  EXPECT_NO_THROW(bus.ThrowFailure());
}

TEST(Bus, WhatATimerThrowsReachesTheWaiterOrWhoAsks) {
  Bus bus(Memory());
  std::atomic<int> ticks{0};
  const auto timer = bus.OnTick([&] {
    ++ticks;
    throw std::runtime_error("out of time");
  });
  while (ticks < 2) std::this_thread::sleep_for(5ms);  // the thread outlives the first
  EXPECT_EQ(ThrownBy([&] { bus.ThrowFailure(); }), "out of time");
  EXPECT_FALSE(bus.WaitFor([] { return false; }, 10ms));
}

TEST(Bus, SessionsAreRandomUnlessGiven) {
  BusOptions given = Memory();
  given.session = 42;
  EXPECT_EQ(Bus(given).session(), 42);
  const int64_t a = Bus(Memory()).session(), b = Bus(Memory()).session();
  EXPECT_GT(a, 0);
  EXPECT_NE(a, b);
}

TEST(Bus, RefusesNonsense) {
  BusOptions options;
  options.url = "http://localhost";
  EXPECT_THROW(Bus bus(options), std::runtime_error);
  for (const char* url : {"udpm://127.0.0.1:7667", "udpm://10.0.0.1:7667?ttl=0", "udpm://here:1"}) {
    options.url = url;
    ASSERT_TRUE(options.Validate()) << url;
    EXPECT_THAT(*options.Validate(), HasSubstr("no multicast address")) << url;
  }
  for (const char* url : {"udpm://", "udpm://:7668", "udpm://239.255.76.67:7667?ttl=0"}) {
    options.url = url;
    EXPECT_EQ(options.Validate(), std::nullopt) << url;
  }
  options = Memory();
  options.drop_share = 1.5;
  EXPECT_THROW(Bus bus(options), std::runtime_error);
  options.drop_share = 0;
  options.url = "file:///nonexistent/directory/log";
  EXPECT_THROW(Bus bus(options), std::runtime_error);
}

TEST(Bus, TakesTestSettingsFromTheEnvironment) {
  setenv("VPSLAM_DROP", "0.05", 1);
  setenv("VPSLAM_DROP_SEED", "9", 1);
  setenv("VPSLAM_RECV_BUFFER", "212992", 1);
  const BusOptions options = BusOptions().WithEnvironment();
  unsetenv("VPSLAM_DROP");
  unsetenv("VPSLAM_DROP_SEED");
  unsetenv("VPSLAM_RECV_BUFFER");
  EXPECT_EQ(options.drop_share, 0.05);
  EXPECT_EQ(options.drop_seed, 9u);
  EXPECT_EQ(options.receive_buffer, 212992);
}

TEST(Bus, ALogHoldsEverythingAndIsReadFromItsStart) {
  const std::string path = ::testing::TempDir() + "bus_test.lcmlog";
  {
    BusOptions options;
    options.url = "file://" + path + "?mode=w";
    Bus bus(options);
    for (uint8_t i = 0; i < 50; ++i) bus.Publish("A", std::vector<uint8_t>{i});
  }
  BusOptions options;
  options.url = "file://" + path + "?speed=0";
  Bus bus(options);
  std::vector<int> came;
  std::atomic<int> count{0};
  const auto sub = bus.Subscribe("A", [&](auto bytes) {
    came.push_back(bytes[0]);
    ++count;
  });
  EXPECT_TRUE(bus.WaitFor([&] { return count == 50; }, 5s));
  EXPECT_EQ(came.front(), 0);
  std::remove(path.c_str());
}

TEST(Channels, OnlyRequiredConsumersAreWaitedFor) {
  EXPECT_THAT(RequiredConsumers(kMapConsumers, {"recorder", "backend"}), ElementsAre("recorder"));
  EXPECT_TRUE(RequiredConsumers(kPoseConsumers, {}).empty());
}

}  // namespace
}  // namespace vpslam::test
