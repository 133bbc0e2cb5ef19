#include "player/kitti_folder.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// sequences/03 of a copy of the benchmark, with ten images per second.
class KittiFolder : public SequenceFolderTest {
 protected:
  void SetUp() override {
    SequenceFolderTest::SetUp();
    root_ = folder_;
    folder_ = root_ / "sequences" / "03";
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(root_); }

  void WriteSequence(int n, const std::string& images = "image_0") {
    std::string times;
    for (int i = 0; i < n; ++i) {
      WriteImage(fmt::format("{}/{:06}.png", images, i), 10 + i);
      times += fmt::format("{:.6e}\n", 0.1 * i);
    }
    Write("times.txt", times);
    Write("calib.txt",
          "P0: 6.0e+01 0.0 3.15e+01 0.0 0.0 6.0e+01 2.35e+01 0.0 0.0 0.0 1.0 0.0\n"
          "P1: 6.0e+01 0.0 3.15e+01 -3.0e+01 0.0 6.0e+01 2.35e+01 0.0 0.0 0.0 1.0 0.0\n"
          "P2: 6.0e+01 0.0 3.15e+01 6.0 0.0 6.0e+01 2.35e+01 0.0 0.0 0.0 1.0 0.0\n"
          "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  }
  /// Camera 0 moves by 1 m per image along z, turned by 90 degrees about y from image 1 on.
  static std::string Poses() {
    return "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 1 0 0 1 0 0 -1 0 0 1\n0 0 1 0 0 1 0 0 -1 0 0 2\n";
  }

  fs::path root_;
};

TEST_F(KittiFolder, PlaysTheGreyCamera) {
  WriteSequence(3);
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(frames[i].stamp_us, 100'000 * i);
    EXPECT_EQ(frames[i].grey.at<uint8_t>(0, 0), 10 + i);
  }
  const Camera camera = Open()->camera();
  EXPECT_EQ(camera.width, 64);
  EXPECT_EQ(camera.height, 48);
  EXPECT_NEAR(camera.fps, 10, 1e-9);
  EXPECT_EQ(camera.fx, 60);
  EXPECT_EQ(camera.cy, 23.5);
  EXPECT_FALSE(camera.HasDistortion());
  EXPECT_FALSE(Open()->WorldFromCam(0));
  EXPECT_THAT(told_, ElementsAre());
}

TEST_F(KittiFolder, FindsTheTruthOfTheBenchmark) {
  WriteSequence(3);
  fs::create_directories(root_ / "poses");
  std::ofstream(root_ / "poses" / "03.txt") << Poses();
  const auto source = Open();
  EXPECT_EQ(source->WorldFromCam(200'000)->translation, Eigen::Vector3d(0, 0, 2));
  EXPECT_NEAR((source->WorldFromCam(100'000)->rotation * Eigen::Vector3d::UnitZ() -
               Eigen::Vector3d::UnitX())
                  .norm(),
              0, 1e-12);
  EXPECT_THAT(told_, ElementsAre());

  Write("poses.txt", "1 0 0 5 0 1 0 5 0 0 1 5\n");  // beside the images it comes first
  EXPECT_EQ(Open()->WorldFromCam(0)->translation, Eigen::Vector3d(5, 5, 5));
}

TEST_F(KittiFolder, PlaysTheColourCameraWithItsOwnTruth) {
  WriteSequence(3, "image_2");
  Write("poses.txt", Poses());
  const auto source = Open();
  EXPECT_EQ(source->camera().fx, 60);
  // P2 = K [I t] with t = (0.1, 0, 0): the camera is 0.1 m to the left of camera 0.
  EXPECT_NEAR((source->WorldFromCam(0)->translation - Eigen::Vector3d(-0.1, 0, 0)).norm(), 0,
              1e-12);
  EXPECT_NEAR((source->WorldFromCam(100'000)->translation - Eigen::Vector3d(0, 0, 1.1)).norm(), 0,
              1e-12);
}

TEST_F(KittiFolder, NamesWhatIsWrong) {
  WriteSequence(3);
  Write("calib.txt", "P0: 6.0e+01 0.0 nan 0.0 0.0 6.0e+01 2.35e+01 0.0 0.0 0.0 1.0 0.0\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("calib.txt"), HasSubstr("P0:")));
  Write("calib.txt", "P0: 0 0 31.5 0 0 60 23.5 0 0 0 1 0\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("calib.txt"), HasSubstr("positive")));
  fs::remove(folder_ / "calib.txt");
  EXPECT_THAT(Error(), AllOf(HasSubstr("calib.txt"), HasSubstr("P0:")));
  Write("other.yaml", kSmallCamera);
  options_.camera_file = (folder_ / "other.yaml").string();
  EXPECT_EQ(Error(), "");

  Write("times.txt", "zero\n0.1\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("times.txt"), HasSubstr("1 lines"), HasSubstr("3 images")));
  Write("times.txt", "time\n0\n0.1\n0.2\n");  // a header takes no image's place
  EXPECT_EQ(PlayAll()[1].grey.at<uint8_t>(0, 0), 11);
  Write("times.txt", "");
  EXPECT_THAT(Error(), AllOf(HasSubstr("times.txt"), HasSubstr("0 lines")));
  fs::remove_all(folder_ / "image_0");
  fs::create_directories(folder_ / "image_0");
  EXPECT_THAT(Error(), AllOf(HasSubstr("image_0"), HasSubstr("no image")));
}

TEST_F(KittiFolder, SkipsASingleBadImageAndKeepsTheNumbers) {
  WriteSequence(30);
  Truncate("image_0/000000.png", 0.5);
  fs::remove(folder_ / "image_0/000009.png");
  Write("poses.txt", "");
  // Two bad images of thirty are too many; the limit is 5 %.
  EXPECT_THAT(Error(), AllOf(HasSubstr("000000.png"), HasSubstr("2 of 30")));
  WriteImage("image_0/000000.png", 10);
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 29u);
  EXPECT_EQ(frames[9].stamp_us, 1'000'000);
  EXPECT_EQ(frames[9].grey.at<uint8_t>(0, 0), 20);
}

}  // namespace
}  // namespace vpslam
