#include "core/transport/image_pool.h"

#include <atomic>
#include <cstring>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

namespace vpslam::test {
namespace {

using ::testing::HasSubstr;

ImageFrame Frame(int64_t seq, int width = 64, int height = 48) {
  ImageFrame frame;
  frame.frame_seq = seq;
  frame.stamp_us = 1000 * seq;
  frame.published_us = 77;
  frame.decode_ms = 1.5;
  frame.pixels = cv::Mat(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      frame.pixels.at<uint8_t>(y, x) = static_cast<uint8_t>(x + 3 * y + 7 * seq);
    }
  }
  return frame;
}

bool SamePixels(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int y = 0; y < a.rows; ++y) {
    if (std::memcmp(a.ptr(y), b.ptr(y), a.cols) != 0) return false;
  }
  return true;
}

class ImagePoolTest : public ::testing::Test {
 protected:
  ~ImagePoolTest() override { shm_unlink(name_.c_str()); }
  const std::string name_ = fmt::format("/vpslam-test-{}", getpid());
};

TEST_F(ImagePoolTest, PixelsArriveAsTheyWere) {
  ImagePool pool(name_, 3, 64 * 48);
  ImageFetcher fetcher;
  std::string why;
  for (int i = 0; i < 7; ++i) {
    const ImageFrame frame = Frame(i);
    const ImageMessage message = pool.Store(frame);
    EXPECT_EQ(message.slot, i % 3);
    EXPECT_TRUE(message.bytes.empty());
    const auto fetched = fetcher.Fetch(message, &why);
    ASSERT_TRUE(fetched) << why;
    EXPECT_TRUE(SamePixels(fetched->pixels, frame.pixels));
    EXPECT_EQ(fetched->frame_seq, i);
    EXPECT_EQ(fetched->stamp_us, 1000 * i);
    EXPECT_EQ(fetched->published_us, 77);
    EXPECT_EQ(fetched->decode_ms, 1.5);
  }
}

TEST_F(ImagePoolTest, AViewIntoALargerImageIsCopiedRowByRow) {
  ImagePool pool(name_, 2, 64 * 48);
  ImageFetcher fetcher;
  ImageFrame frame = Frame(1);
  frame.pixels = frame.pixels(cv::Rect(5, 6, 20, 10));
  std::string why;
  for (const ImageMessage& message : {pool.Store(frame), InlineImage(frame)}) {
    const auto fetched = fetcher.Fetch(message, &why);
    ASSERT_TRUE(fetched) << why;
    EXPECT_TRUE(SamePixels(fetched->pixels, frame.pixels));
  }
}

TEST_F(ImagePoolTest, AReusedSlotIsNoticed) {
  ImagePool pool(name_, 2, 64 * 48);
  ImageFetcher fetcher;
  const ImageMessage first = pool.Store(Frame(0));
  pool.Store(Frame(1));
  pool.Store(Frame(2));  // takes the slot of the first
  std::string why;
  EXPECT_FALSE(fetcher.Fetch(first, &why));
  EXPECT_THAT(why, HasSubstr("used again"));
}

// A writer at full speed and a reader that lags: whatever the reader gets is whole.
TEST_F(ImagePoolTest, ATornImageIsNeverDelivered) {
  ImagePool pool(name_, 2, 320 * 240);
  std::atomic<bool> stop{false};
  std::mutex mutex;
  ImageMessage newest;
  const auto uniform = [](int64_t seq) {
    ImageFrame frame;
    frame.frame_seq = seq;
    frame.pixels = cv::Mat(240, 320, CV_8UC1, cv::Scalar(static_cast<double>(seq % 251)));
    return frame;
  };
  newest = pool.Store(uniform(0));
  std::thread writer([&] {
    for (int64_t i = 1; !stop; ++i) {
      const ImageMessage message = pool.Store(uniform(i));
      const std::lock_guard lock(mutex);
      newest = message;
    }
  });
  ImageFetcher fetcher;
  int whole = 0, refused = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
  while (std::chrono::steady_clock::now() < end) {
    ImageMessage message;
    {
      const std::lock_guard lock(mutex);
      message = newest;
    }
    std::string why;
    const auto fetched = fetcher.Fetch(message, &why);
    if (!fetched) {
      ++refused;
      continue;
    }
    ++whole;
    const cv::Mat right(240, 320, CV_8UC1,
                        cv::Scalar(static_cast<double>(message.frame_seq % 251)));
    ASSERT_TRUE(SamePixels(fetched->pixels, right)) << "torn";
  }
  stop = true;
  writer.join();
  EXPECT_GT(whole + refused, 10);
  RecordProperty("whole", whole);
  RecordProperty("refused", refused);
}

TEST_F(ImagePoolTest, TheSegmentGoesWithItsOwnerAndAStaleOneIsReplaced) {
  {
    ImagePool pool(name_, 2, 100);
    EXPECT_EQ(access(("/dev/shm" + name_).c_str(), F_OK), 0);
  }
  EXPECT_NE(access(("/dev/shm" + name_).c_str(), F_OK), 0);
  const int fd = shm_open(name_.c_str(), O_CREAT | O_RDWR, 0600);  // left by a killed player
  ASSERT_GE(fd, 0);
  close(fd);
  ImagePool pool(name_, 2, 64 * 48);
  ImageFetcher fetcher;
  std::string why;
  EXPECT_TRUE(fetcher.Fetch(pool.Store(Frame(0)), &why)) << why;
}

TEST_F(ImagePoolTest, WhatIsNoPoolIsRefused) {
  ImageMessage message;
  message.width = 10;
  message.height = 10;
  message.generation = 2;
  std::string why;
  ImageFetcher fetcher;
  message.segment = name_;
  EXPECT_FALSE(fetcher.Fetch(message, &why));
  EXPECT_THAT(why, HasSubstr("cannot be opened"));
  message.segment = "/other";
  EXPECT_FALSE(fetcher.Fetch(message, &why));
  EXPECT_THAT(why, HasSubstr("alien"));

  const int fd = shm_open(name_.c_str(), O_CREAT | O_RDWR, 0600);
  ASSERT_GE(fd, 0);
  message.segment = name_;
  EXPECT_FALSE(fetcher.Fetch(message, &why)) << "empty";
  ASSERT_EQ(ftruncate(fd, 4096), 0);
  EXPECT_FALSE(fetcher.Fetch(message, &why)) << "zeros";
  // A head that promises more than the segment holds: magic, slots, bytes per slot.
  {
    ImagePool real(name_ + "r", 1, 64);
    const int real_fd = shm_open((name_ + "r").c_str(), O_RDONLY, 0);
    uint64_t head[3];
    ASSERT_EQ(pread(real_fd, head, sizeof head, 0), static_cast<ssize_t>(sizeof head));
    close(real_fd);
    head[1] = 1000;
    ASSERT_EQ(pwrite(fd, head, sizeof head, 0), static_cast<ssize_t>(sizeof head));
  }
  EXPECT_FALSE(fetcher.Fetch(message, &why)) << "too short";
  close(fd);
}

TEST_F(ImagePoolTest, ReaderChecksSlotAndSize) {
  ImagePool pool(name_, 2, 64 * 48);
  ImageFetcher fetcher;
  const ImageMessage good = pool.Store(Frame(0));
  std::string why;
  ImageMessage bad = good;
  bad.slot = 2;
  EXPECT_FALSE(fetcher.Fetch(bad, &why));
  bad = good;
  bad.width = 63;
  EXPECT_FALSE(fetcher.Fetch(bad, &why));
  EXPECT_THAT(why, HasSubstr("size"));
  EXPECT_TRUE(fetcher.Fetch(good, &why));
}

TEST_F(ImagePoolTest, TheWriterRefusesWhatItCannotHold) {
  EXPECT_THROW(ImagePool("no-slash", 2, 100), std::runtime_error);
  EXPECT_THROW(ImagePool(name_, 0, 100), std::runtime_error);
  ImagePool pool(name_, 2, 100);
  EXPECT_THROW(pool.Store(Frame(0)), std::runtime_error) << "too large";
  ImageFrame colour;
  colour.pixels = cv::Mat(5, 5, CV_8UC3, cv::Scalar(0));
  EXPECT_THROW(pool.Store(colour), std::runtime_error);
  EXPECT_THROW(InlineImage(colour), std::runtime_error);
}

}  // namespace
}  // namespace vpslam::test
