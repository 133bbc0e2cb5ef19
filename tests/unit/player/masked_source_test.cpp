#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class MaskedSource : public SequenceFolderTest {
 protected:
  void SetUp() override {
    SequenceFolderTest::SetUp();
    Write("images/camera.yaml", kSmallCamera);
    for (int i = 0; i < 3; ++i) WriteImage(fmt::format("images/{}.png", i), 100 + i);
    options_.mask_file = (folder_ / "mask.png").string();
  }
  void WriteMask(int width, int height) {
    cv::Mat mask(height, width, CV_8UC1, cv::Scalar(255));
    mask.rowRange(height / 2, height) = cv::Scalar(0);
    cv::imwrite(options_.mask_file, mask);
  }
  std::unique_ptr<ImageSource> OpenImages() {
    return OpenSource((folder_ / "images").string(), options_);
  }
};

TEST_F(MaskedSource, HasTheMaskThatWasNamed) {
  WriteMask(64, 48);
  const auto source = OpenImages();
  EXPECT_THAT(source->camera().mask_runs, ElementsAre(64 * 24, 64 * 24));
  int frames = 0;
  while (const auto frame = source->Next()) {
    EXPECT_EQ(frame->grey.at<uint8_t>(40, 10), 100 + frames++) << "pixels are as they were";
  }
  EXPECT_EQ(frames, 3);
}

TEST_F(MaskedSource, AMaskOfAnotherSizeIsRefused) {
  WriteMask(32, 24);
  try {
    OpenImages();
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("mask.png"), HasSubstr("32 x 24"), HasSubstr("64 x 48")));
  }
}

}  // namespace
}  // namespace vpslam
