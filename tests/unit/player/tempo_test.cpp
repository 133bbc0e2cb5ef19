#include "player/tempo.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

using std::chrono::milliseconds;
const Tempo::Clock::time_point kNow = Tempo::Clock::time_point() + std::chrono::hours(100);

TEST(Tempo, ImagesAreDueAsTheyWereTaken) {
  Tempo tempo;
  EXPECT_EQ(tempo.Due(5'000'000, kNow), kNow);
  EXPECT_EQ(tempo.Due(5'033'000, kNow + milliseconds(1)), kNow + milliseconds(33));
  EXPECT_EQ(tempo.Due(5'080'000, kNow + milliseconds(33)), kNow + milliseconds(80));
  EXPECT_EQ(tempo.restarts(), 0);
}

TEST(Tempo, ALatePlayerCatchesUp) {
  Tempo tempo;
  tempo.Due(0, kNow);
  // Image 1 is ready 0.3 s late; it and those after it are due in the past, so they go at once.
  EXPECT_EQ(tempo.Due(33'000, kNow + milliseconds(333)), kNow + milliseconds(33));
  EXPECT_EQ(tempo.Due(400'000, kNow + milliseconds(340)), kNow + milliseconds(400));
  EXPECT_EQ(tempo.restarts(), 0);
}

TEST(Tempo, AfterAWaitThatWasWantedNothingIsOwed) {
  Tempo tempo;
  tempo.Due(0, kNow);
  tempo.StartAnew();  // as after a pause of 20 s
  EXPECT_EQ(tempo.Due(33'000, kNow + milliseconds(20'000)), kNow + milliseconds(20'000));
  EXPECT_EQ(tempo.Due(66'000, kNow + milliseconds(20'001)), kNow + milliseconds(20'033));
  EXPECT_EQ(tempo.restarts(), 0);
}

TEST(Tempo, AVeryLatePlayerDoesNotPourOutWhatItOwes) {
  Tempo tempo;
  tempo.Due(0, kNow);
  const auto later = kNow + std::chrono::seconds(10);
  EXPECT_EQ(tempo.Due(33'000, later), later);
  EXPECT_EQ(tempo.Due(66'000, later), later + milliseconds(33));
  EXPECT_EQ(tempo.restarts(), 1);
}

TEST(Tempo, ACameraSetsItsOwn) {
  Tempo tempo(/*live=*/true);
  tempo.Due(0, kNow);
  EXPECT_EQ(tempo.Due(900'000, kNow + milliseconds(40)), kNow + milliseconds(40));
}

}  // namespace
}  // namespace vpslam
