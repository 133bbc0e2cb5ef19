#include "frontend/line_dispatch.h"

#include <algorithm>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vpslam {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

constexpr int64_t kImages = 99;  // session of their sender
constexpr int64_t kA = 1, kB = 2;

class Dispatch : public ::testing::Test {
 protected:
  /// Frame and detector of each request.
  using Asked = std::vector<std::pair<int64_t, int64_t>>;

  Asked Requests() {
    Asked asked;
    for (const LinesRequest& request : dispatch_.Requests(now_)) {
      EXPECT_EQ(request.image_session, kImages);
      asked.emplace_back(request.frame_seq, request.detector);
    }
    return asked;
  }
  Asked Image(int64_t seq) {
    dispatch_.AddImage(kImages, seq);
    return Requests();
  }
  Asked Answer(int64_t detector, int64_t seq) {
    dispatch_.AddAnswer(detector, seq, now_);
    return Requests();
  }
  Asked Heard(int64_t detector, int64_t in_hand) {
    dispatch_.AddDetector(detector, in_hand, now_);
    return Requests();
  }
  /// Time goes by; the detectors of `alive` say that they have something in hand.
  Asked Later(std::chrono::milliseconds time, const std::vector<int64_t>& alive = {}) {
    Asked asked;
    for (const auto end = now_ + time; now_ < end; now_ += 25ms) {
      for (const int64_t detector : alive) dispatch_.AddDetector(detector, 1, now_);
      for (const auto& request : Requests()) asked.push_back(request);
    }
    return asked;
  }

  LineDispatch dispatch_{LineDispatchOptions()};
  LineDispatch::Time now_{1000s};
};

TEST_F(Dispatch, AsksAgainWhereTheLinesWereAnothers) {
  Heard(kA, 0);
  EXPECT_THAT(Image(0), ElementsAre(std::pair(0, kA)));
  EXPECT_THAT(Answer(kA, 0), IsEmpty());
  dispatch_.AskAgain(0);
  EXPECT_THAT(Requests(), ElementsAre(std::pair(0, kA)));
  Answer(kA, 0);
  dispatch_.Pass(0);
  dispatch_.AskAgain(0);
  EXPECT_THAT(Requests(), IsEmpty()) << "it is needed no more";
}

TEST_F(Dispatch, NobodyIsAskedBeforeAnybodyIsThere) {
  EXPECT_THAT(Image(0), IsEmpty());
  EXPECT_THAT(Heard(kA, 0), ElementsAre(std::pair(0, kA)));
}

TEST_F(Dispatch, EveryImageIsAskedForOnce) {
  Heard(kA, 0);
  EXPECT_THAT(Image(0), ElementsAre(std::pair(0, kA)));
  EXPECT_THAT(Image(0), IsEmpty()) << "the image was repeated";
  EXPECT_THAT(Answer(kA, 0), IsEmpty());
  EXPECT_THAT(Image(0), IsEmpty()) << "repeated after the answer";
  dispatch_.Pass(0);
  EXPECT_THAT(Image(0), IsEmpty()) << "repeated after it was passed";
  EXPECT_THAT(Image(1), ElementsAre(std::pair(1, kA)));
}

TEST_F(Dispatch, TheLoadIsShared) {
  Heard(kA, 0);
  Heard(kB, 0);
  std::vector<std::pair<int64_t, int64_t>> asked;
  for (int64_t seq = 0; seq < 6; ++seq) {
    for (const auto& request : Image(seq)) asked.push_back(request);
  }
  EXPECT_EQ(asked.size(), 4u) << "two each, the others wait where they can go to either";
  EXPECT_EQ(std::count_if(asked.begin(), asked.end(), [](auto r) { return r.second == kA; }), 2);
  EXPECT_THAT(Answer(kB, asked[1].first), ElementsAre(std::pair(4, kB))) << "who is faster gets it";
  EXPECT_THAT(Answer(kB, asked[3].first), ElementsAre(std::pair(5, kB)));
}

TEST_F(Dispatch, OneImageAtATimeGoesToEachInTurn) {
  Heard(kA, 0);
  Heard(kB, 0);
  int asked_a = 0;
  for (int64_t seq = 0; seq < 10; ++seq) {
    const Asked asked = Image(seq);
    ASSERT_EQ(asked.size(), 1u);
    asked_a += asked[0].second == kA;
    now_ += 10ms;
    Answer(asked[0].second, seq);
    dispatch_.Pass(seq);
  }
  EXPECT_EQ(asked_a, 5);
}

TEST_F(Dispatch, ADetectorThatStartsLaterTakesItsShareAtOnce) {
  Heard(kA, 0);
  for (int64_t seq = 0; seq < 4; ++seq) Image(seq);
  EXPECT_THAT(Heard(kB, 0), UnorderedElementsAre(std::pair(2, kB), std::pair(3, kB)));
}

TEST_F(Dispatch, WhatIsNotAnsweredIsAskedOfAnother) {
  Heard(kA, 0);
  EXPECT_THAT(Image(0), ElementsAre(std::pair(0, kA)));
  Heard(kB, 0);
  EXPECT_THAT(Later(500ms, {kB}), ElementsAre(std::pair(0, kB)));
  EXPECT_THAT(Answer(kB, 0), IsEmpty());
  dispatch_.Pass(0);
  for (int64_t seq = 1; seq < 5; ++seq) {
    EXPECT_THAT(Image(seq), ElementsAre(std::pair(seq, kB))) << "the other one is suspect";
    Answer(kB, seq);
    dispatch_.Pass(seq);
  }
  EXPECT_THAT(Answer(kA, 0), IsEmpty()) << "it goes on, and answers what is not needed any more";
  EXPECT_THAT(Image(5), ElementsAre(std::pair(5, kA))) << "rehabilitated, and longest idle";
}

TEST_F(Dispatch, ASuspectWhoHasNothingInHandMissedTheRequest) {
  Heard(kA, 0);
  Image(0);
  Heard(kB, 0);
  Later(500ms, {kB});
  Answer(kB, 0);
  EXPECT_THAT(Image(1), ElementsAre(std::pair(1, kB)));
  Heard(kA, 1);
  EXPECT_THAT(Image(2), ElementsAre(std::pair(2, kB))) << "still busy";
  Heard(kA, 0);
  EXPECT_THAT(Image(3), ElementsAre(std::pair(3, kA)));
}

TEST_F(Dispatch, AnOnlyDetectorIsAskedAgainAtGrowingIntervals) {
  Heard(kA, 0);
  Image(0);
  const Asked asked = Later(5s, {kA});
  EXPECT_THAT(asked, ::testing::Each(std::pair<int64_t, int64_t>(0, kA)));
  EXPECT_GE(asked.size(), 3u);
  EXPECT_LE(asked.size(), 5u) << "after 0.25, 0.75, 1.75 and 3.75 s";
}

TEST_F(Dispatch, SlowDetectorsAreGivenTheTimeThatTheyTake) {
  Heard(kA, 0);
  Heard(kB, 0);
  for (int64_t seq = 0; seq < 8; ++seq) {
    const Asked asked = Image(seq);
    ASSERT_EQ(asked.size(), 1u);
    EXPECT_THAT(Later(200ms, {kA, kB}), IsEmpty());
    Answer(asked[0].second, seq);
    dispatch_.Pass(seq);
  }
  Image(8);
  EXPECT_THAT(Later(1s, {kA, kB}), IsEmpty()) << "five times as long as usual is not too long";
  EXPECT_EQ(Later(500ms, {kA, kB}).size(), 1u);
}

TEST_F(Dispatch, WhatADetectorHadInHandWhenItEndedIsAskedOfAnother) {
  Heard(kA, 0);
  Image(0);
  Image(1);
  Heard(kB, 0);
  dispatch_.RemoveDetector(kA);
  EXPECT_THAT(Requests(), ElementsAre(std::pair(0, kB), std::pair(1, kB)));
  EXPECT_EQ(dispatch_.detectors(), 1);
}

TEST_F(Dispatch, ASilentDetectorIsForgotten) {
  Heard(kA, 0);
  Later(6s);
  EXPECT_EQ(dispatch_.detectors(), 0);
  EXPECT_THAT(Image(0), IsEmpty());
}

TEST_F(Dispatch, ImagesOfANewSenderMakeThoseBeforeObsolete) {
  Heard(kA, 0);
  Image(7);
  dispatch_.AddImage(kImages + 1, 0);
  const auto requests = dispatch_.Requests(now_);
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_EQ(requests[0].frame_seq, 0);
  EXPECT_EQ(requests[0].image_session, kImages + 1);
  EXPECT_THAT(dispatch_.Requests(now_ + 10s), IsEmpty()) << "and nobody is left";
}

TEST(RealtimeDispatch, OnlyTheNewestImageWaits) {
  LineDispatchOptions options;
  options.keep_all = false;
  options.max_in_hand = 1;
  LineDispatch dispatch(options);
  const LineDispatch::Time now{1000s};
  dispatch.AddDetector(kA, 0, now);
  std::vector<int64_t> asked;
  for (int64_t seq = 0; seq < 5; ++seq) {
    dispatch.AddImage(kImages, seq);
    for (const LinesRequest& request : dispatch.Requests(now)) asked.push_back(request.frame_seq);
  }
  EXPECT_THAT(asked, ElementsAre(0));
  dispatch.AddAnswer(kA, 0, now + 100ms);
  for (const auto& request : dispatch.Requests(now + 100ms)) asked.push_back(request.frame_seq);
  EXPECT_THAT(asked, ElementsAre(0, 4));
}

TEST(DispatchOptions, AreValidated) {
  LineDispatchOptions options;
  options.max_in_hand = 0;
  EXPECT_THROW(LineDispatch{options}, std::invalid_argument);
  options = {};
  options.forget_after = options.patience;
  EXPECT_THROW(LineDispatch{options}, std::invalid_argument);
}

}  // namespace
}  // namespace vpslam
