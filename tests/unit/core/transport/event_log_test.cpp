#include "core/transport/event_log.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace vpslam::test {
namespace {

namespace fs = std::filesystem;

class EventLog : public ::testing::Test {
 protected:
  EventLog() : path_(fs::temp_directory_path() / fmt::format("vpslam_event_log_{}", getpid())) {}
  ~EventLog() override { fs::remove_all(path_); }

  void Write(int events) {
    EventLogWriter log(path_.string());
    for (int i = 0; i < events; ++i) {
      log.Write(1000 + i, i % 2 ? "ODD" : "EVEN", std::vector<uint8_t>(i, static_cast<uint8_t>(i)));
    }
    log.Flush();
  }

  const fs::path path_;
};

TEST_F(EventLog, GivesBackWhatWasWritten) {
  Write(300);
  EXPECT_TRUE(IsEventLog(path_.string()));
  EventLogReader log(path_.string());
  for (int i = 0; i < 300; ++i) {
    const auto event = log.Next();
    ASSERT_TRUE(event);
    EXPECT_EQ(event->stamp_us, 1000 + i);
    EXPECT_EQ(event->channel, i % 2 ? "ODD" : "EVEN");
    EXPECT_EQ(event->bytes, std::vector<uint8_t>(i, static_cast<uint8_t>(i)));
  }
  EXPECT_FALSE(log.Next());
  EXPECT_EQ(log.damaged_bytes(), 0);
}

TEST_F(EventLog, EndsBeforeAnEventThatWasCutOff) {
  Write(20);
  for (const int cut : {1, 10, 30}) {
    fs::resize_file(path_, fs::file_size(path_) - cut);
    EventLogReader log(path_.string());
    int events = 0;
    while (log.Next()) ++events;
    EXPECT_GE(events, 17);
    EXPECT_LT(events, 20);
    EXPECT_GT(log.damaged_bytes(), 0);
  }
}

TEST_F(EventLog, TellsWhatWasOverwritten) {
  Write(20);
  {
    EventLogReader sound(path_.string());
    while (sound.Next()) {
    }
    EXPECT_EQ(sound.damaged_bytes(), 0);
  }
  constexpr int kFirst = 28 + 4, kSecond = 28 + 3 + 1;
  std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
  for (int at = 0; at < 4; ++at) file.seekp(kFirst + kSecond + at).put('\0');
  file.close();
  EventLogReader log(path_.string());
  int events = 0;
  while (log.Next()) ++events;
  EXPECT_EQ(events, 19) << "all but the one whose sync word is gone";
  EXPECT_EQ(log.damaged_bytes(), 28 + 4 + 2);
  EXPECT_EQ(log.damaged_places(), 1);
}

TEST_F(EventLog, GoesOnBehindForeignBytes) {
  Write(20);
  std::ifstream in(path_, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  constexpr int kFirstTwo = 28 + 4 + 28 + 3 + 1;
  bytes.insert(kFirstTwo, "\xED\xA1 nine");
  std::ofstream(path_, std::ios::binary) << bytes;
  EventLogReader log(path_.string());
  int events = 0;
  for (; const auto event = log.Next(); ++events) EXPECT_EQ(event->stamp_us, 1000 + events);
  EXPECT_EQ(events, 20);
  EXPECT_EQ(log.damaged_bytes(), 7);
  EXPECT_EQ(log.damaged_places(), 1);
  EXPECT_FALSE(log.cut_off());
}

TEST_F(EventLog, IsKnownBehindADamagedBeginning) {
  Write(20);
  std::fstream(path_, std::ios::in | std::ios::out | std::ios::binary).put('x');
  EXPECT_TRUE(IsEventLog(path_.string()));
  EventLogReader log(path_.string());
  int events = 0;
  while (log.Next()) ++events;
  EXPECT_EQ(events, 19);
  EXPECT_EQ(log.damaged_bytes(), 28 + 4);
}

TEST_F(EventLog, FindsWhatWasAppendedToACutEvent) {
  Write(20);
  std::ifstream in(path_, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const std::string cut = bytes.substr(0, bytes.size() - 10);
  std::ofstream(path_, std::ios::binary) << cut << bytes << cut;
  EventLogReader log(path_.string());
  std::vector<int64_t> stamps, positions;
  while (const auto event = log.Next()) {
    stamps.push_back(event->stamp_us);
    positions.push_back(log.position());
  }
  ASSERT_EQ(stamps.size(), 19u + 20 + 19);
  EXPECT_EQ(log.damaged_bytes(), 2 * (28 + 3 + 19 - 10));
  EXPECT_EQ(log.damaged_places(), 2);
  EXPECT_TRUE(log.cut_off());
  for (const size_t i : {5u, 19u, 57u}) {
    EXPECT_EQ(log.ReadAt(positions[i]).stamp_us, stamps[i]);
  }
}

TEST_F(EventLog, RefusesWhatIsNoLog) {
  EXPECT_FALSE(IsEventLog("/nowhere/log.lcm"));
  EXPECT_THROW(EventLogReader("/nowhere/log.lcm"), std::runtime_error);
  EXPECT_THROW(EventLogWriter("/nowhere/log.lcm"), std::runtime_error);
  std::ofstream(path_) << "# timestamp tx ty tz";
  EXPECT_FALSE(IsEventLog(path_.string()));
  EXPECT_THROW(EventLogReader(path_.string()), std::runtime_error);
}

TEST_F(EventLog, TellsWhenTheDiskIsFull) {
  if (!fs::exists("/dev/full")) GTEST_SKIP();
  EventLogWriter log("/dev/full");
  const std::vector<uint8_t> bytes(1000);
  EXPECT_THROW(
      {
        for (int i = 0; i < 100; ++i) log.Write(0, "CHANNEL", bytes);
        log.Flush();
      },
      std::runtime_error);
}

}  // namespace
}  // namespace vpslam::test
