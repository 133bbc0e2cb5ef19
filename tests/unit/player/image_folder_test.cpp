#include "player/image_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "player/folder_reading.h"
#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ImageFolder : public SequenceFolderTest {
 protected:
  void WriteSequence(int n) {
    for (int i = 0; i < n; ++i) WriteImage(fmt::format("shot{}.png", i), 10 + i);
    Write("notes.txt", "not an image");
    Write(".hidden.png", "neither");
    Write("camera.yaml", std::string(kSmallCamera) + "fps: 25\n");
  }
};

TEST_F(ImageFolder, PlaysInNaturalOrderAtTheCalibrationsRate) {
  WriteSequence(12);
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 12u);
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(frames[i].stamp_us, 40'000 * i);
    EXPECT_EQ(frames[i].grey.at<uint8_t>(0, 0), 10 + i);
  }
  EXPECT_EQ(Open()->camera().fps, 25);
}

TEST_F(ImageFolder, TakesTheRateThatIsAskedFor) {
  WriteSequence(3);
  options_.fps = 10;
  EXPECT_EQ(PlayAll().back().stamp_us, 200'000);
  EXPECT_EQ(Open()->camera().fps, 10);
}

TEST_F(ImageFolder, NamesWhatIsWrong) {
  EXPECT_THAT(Error(), AllOf(HasSubstr(folder_.string()), HasSubstr("no images")));
  options_.kind = "images";
  EXPECT_THAT(Error(), AllOf(HasSubstr(folder_.string()), HasSubstr("holds no image")));
  WriteImage("a.png", 1);
  EXPECT_THAT(Error(), AllOf(HasSubstr("camera.yaml"), HasSubstr("--camera")));
  WriteSequence(4);
  WriteImage("shot2.png", 1, 48, 64);
  EXPECT_EQ(PlayAll().size(), 4u);
  EXPECT_THAT(told_, ElementsAre(AllOf(HasSubstr("shot2.png"), HasSubstr("48 x 64"))));
  EXPECT_EQ(report_.skipped.at("is of another size"), 1);
  EXPECT_EQ(report_.expected, 5);
  WriteImage("shot3.png", 1, 48, 64);
  EXPECT_THAT(Error(), AllOf(HasSubstr("shot3.png"), HasSubstr("2 of 5")));
}

TEST_F(ImageFolder, NamesThatAreTimesComeInTheirOrder) {
  WriteImage("1000.25.png", 20);
  WriteImage("1000.5.png", 30);
  WriteImage("999.75.png", 10);
  WriteImage("1001.0.png", 40);
  Write("camera.yaml", kSmallCamera);
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 4u);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(frames[i].grey.at<uint8_t>(0, 0), 10 * (i + 1));
}

TEST_F(ImageFolder, SaysThatThereIsAList) {
  WriteImage("rgb/0.png", 1);
  Write("rgb.txt", "0 rgb/0.png\n");
  Write("camera.yaml", kSmallCamera);
  const std::string images = (folder_ / "rgb").string();
  EXPECT_THROW(OpenSource(images, options_), std::runtime_error);
  options_.camera_file = (folder_ / "camera.yaml").string();
  EXPECT_THAT(OpenSource(images, options_)->Report().notes,
              ElementsAre(AllOf(HasSubstr("rgb.txt"), HasSubstr("not read"))));
}

class MixedFolder : public SequenceFolderTest {
 protected:
  void WriteSeries(const std::string& before, const std::string& behind, int grey) {
    for (int i = 0; i < 12; ++i) WriteImage(fmt::format("{}{:04}{}", before, i, behind), grey + i);
    Write("camera.yaml", kSmallCamera);
  }
};

TEST_F(MixedFolder, LeftAndRightHaveToBeChosen) {
  WriteSeries("left", ".png", 10);
  WriteSeries("right", ".png", 110);
  EXPECT_THAT(Error(), AllOf(HasSubstr("left*.png (12 images)"),
                             HasSubstr("right*.png (12 images)"), HasSubstr("name one")));
  const auto source = OpenSource((folder_ / "right*.png").string(), options_);
  int frames = 0;
  while (const auto frame = source->Next()) {
    EXPECT_EQ(frame->grey.at<uint8_t>(0, 0), 110 + frames++);
  }
  EXPECT_EQ(frames, 12);
  EXPECT_THROW(OpenSource((folder_ / "middle*.png").string(), options_), std::runtime_error);
}

TEST_F(MixedFolder, MasksAndDepthAreLeftOut) {
  WriteSeries("", ".png", 10);
  WriteSeries("", "_mask.png", 200);
  WriteSeries("depth-", ".png", 200);
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 12u);
  for (int i = 0; i < 12; ++i) EXPECT_EQ(frames[i].grey.at<uint8_t>(0, 0), 10 + i);
  EXPECT_THAT(report_.notes, ElementsAre(AllOf(HasSubstr("*_mask.png"), HasSubstr("depth-*.png"),
                                               HasSubstr("*.png is played"))));
}

TEST(NaturalOrder, ComparesNumbersByValue) {
  EXPECT_TRUE(NaturallyBefore("a2.png", "a10.png"));
  EXPECT_FALSE(NaturallyBefore("a10.png", "a2.png"));
  EXPECT_TRUE(NaturallyBefore("0009.png", "10.png"));
  EXPECT_TRUE(NaturallyBefore("a.png", "b.png"));
  EXPECT_TRUE(NaturallyBefore("1-2", "1-10"));
  EXPECT_TRUE(NaturallyBefore("a", "ab"));
  EXPECT_FALSE(NaturallyBefore("a1", "a1"));
  EXPECT_NE(NaturallyBefore("a01", "a1"), NaturallyBefore("a1", "a01"));
}

}  // namespace
}  // namespace vpslam
