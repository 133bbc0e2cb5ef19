#include "player/decode_ahead.h"

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

using std::chrono::milliseconds;

/// Frames stamped 0, 1, 2, ...; throws at `throw_at`.
class CountingSource : public ImageSource {
 public:
  CountingSource(int frames, int throw_at, std::atomic<int>* asked)
      : frames_(frames), throw_at_(throw_at), asked_(asked) {}
  const Camera& camera() const override { return camera_; }
  std::optional<SourceFrame> Next() override {
    const int i = (*asked_)++;
    if (i == throw_at_) throw std::runtime_error("broken");
    if (i >= frames_) return std::nullopt;
    if (i % 3 == 0) std::this_thread::sleep_for(milliseconds(1));  // uneven decoding times
    return SourceFrame{i, cv::Mat(4, 4, CV_8UC1, cv::Scalar(i % 256)), 0.5};
  }
  SourceReport Report() override {
    SourceReport report;
    report.expected = *asked_;
    return report;
  }

 private:
  Camera camera_;
  int frames_, throw_at_;
  std::atomic<int>* asked_;
};

std::unique_ptr<ImageSource> Counting(int frames, int throw_at, std::atomic<int>* asked) {
  return std::make_unique<CountingSource>(frames, throw_at, asked);
}

TEST(DecodeAhead, KeepsTheOrderAndEnds) {
  std::atomic<int> asked = 0;
  DecodeAhead source(Counting(200, -1, &asked));
  for (int i = 0; i < 200; ++i) {
    const auto frame = source.Next();
    ASSERT_TRUE(frame) << i;
    EXPECT_EQ(frame->stamp_us, i);
    EXPECT_EQ(frame->grey.at<uint8_t>(3, 3), i % 256);
    if (i % 7 == 0) std::this_thread::sleep_for(milliseconds(1));
  }
  EXPECT_FALSE(source.Next());
  EXPECT_FALSE(source.Next());
  EXPECT_EQ(source.Report().expected, 201);
}

TEST(DecodeAhead, ReadsAheadButNoFurtherThanItsCapacity) {
  std::atomic<int> asked = 0;
  DecodeAhead source(Counting(100, -1, &asked), 4);
  for (int i = 0; i < 500 && asked < 5; ++i) std::this_thread::sleep_for(milliseconds(2));
  std::this_thread::sleep_for(milliseconds(20));
  EXPECT_EQ(asked, 5);  // four wait in the queue, the fifth for a place in it
}

TEST(DecodeAhead, PassesAnErrorOnBehindTheFramesBeforeIt) {
  std::atomic<int> asked = 0;
  DecodeAhead source(Counting(100, 3, &asked));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(source.Next()->stamp_us, i);
  EXPECT_THROW(source.Next(), std::runtime_error);
  EXPECT_FALSE(source.Next());
}

TEST(DecodeAhead, CanBeLeftInTheMiddle) {
  std::atomic<int> asked = 0;
  DecodeAhead source(Counting(1000, -1, &asked));
  EXPECT_TRUE(source.Next());
}

}  // namespace
}  // namespace vpslam
