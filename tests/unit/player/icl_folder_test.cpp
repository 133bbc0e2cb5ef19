#include "player/icl_folder.h"

#include <filesystem>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/camera_file.h"
#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class IclFolder : public SequenceFolderTest {
 protected:
  void WriteSequence(int n, bool with_associations) {
    std::string associations;
    for (int i = 0; i < n; ++i) {
      WriteImage(fmt::format("rgb/{}.png", i), 10 + i, 640, 480);
      associations += fmt::format("{0} depth/{0}.png {0} rgb/{0}.png\n", i);
    }
    if (with_associations) Write("associations.txt", associations);
    Write("livingRoom0.gt.freiburg", "1 0.1 0.2 0.3 0 0 0 1\n2 0.4 0.5 0.6 0.5 0.5 0.5 0.5\n");
  }
};

TEST_F(IclFolder, PlaysImagesByNumber) {
  for (const bool with_associations : {true, false}) {
    fs::remove_all(folder_);
    WriteSequence(12, with_associations);
    const auto frames = PlayAll();
    ASSERT_EQ(frames.size(), 12u);
    for (int i = 0; i < 12; ++i) {  // 2.png before 10.png
      EXPECT_EQ(frames[i].stamp_us, std::llround(i * 1e6 / 30));
      EXPECT_EQ(frames[i].grey.at<uint8_t>(0, 0), 10 + i);
    }
  }
  EXPECT_EQ(Open()->camera().fx, 481.2);
  EXPECT_EQ(Open()->camera().fy, 480);
  EXPECT_THAT(told_, ::testing::Each(HasSubstr("true poses for 2 of 12 images")));
}

TEST_F(IclFolder, TruthIsReflected) {
  WriteSequence(3, true);
  const auto source = Open();
  EXPECT_FALSE(source->WorldFromCam(0));
  EXPECT_EQ(source->WorldFromCam(33'333)->translation, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(source->WorldFromCam(66'667)->translation, Eigen::Vector3d(0.4, -0.5, 0.6));
}

TEST_F(IclFolder, HasTheCameraOfTheConfiguration) {
  const Camera file = ReadCameraFile(VPSLAM_SOURCE_DIR "/config/cameras/icl_nuim.yaml");
  const Camera built_in = IclCamera();
  EXPECT_EQ(file.K(), built_in.K());
  EXPECT_EQ(file.width, built_in.width);
  EXPECT_EQ(file.height, built_in.height);
  EXPECT_EQ(file.fps, built_in.fps);
  EXPECT_FALSE(file.HasDistortion());
}

/// What the published calibration projects with y up is where the reflected one projects it.
TEST(ReflectY, KeepsPixels) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  const Camera camera = IclCamera();
  for (int i = 0; i < 100; ++i) {
    const SE3 world_from_cam(Eigen::Quaterniond::UnitRandom(), vector());
    const Eigen::Vector3d in_cam = vector() + Eigen::Vector3d(0, 0, 10);
    const Eigen::Vector3d in_world = world_from_cam * in_cam;
    const Eigen::Vector2d published(481.2 * in_cam.x() / in_cam.z() + 319.5,
                                    -480.0 * in_cam.y() / in_cam.z() + 239.5);
    const Eigen::Vector3d reflected(in_world.x(), -in_world.y(), in_world.z());
    const SE3 pose = ReflectY(world_from_cam);
    EXPECT_NEAR((camera.Project(pose.Inverse() * reflected) - published).norm(), 0, 1e-9);
    EXPECT_NEAR((ReflectY(pose).translation - world_from_cam.translation).norm(), 0, 1e-12);
  }
}

TEST_F(IclFolder, NamesWhatIsWrong) {
  WriteSequence(3, true);
  Write("associations.txt", "0 depth/0.png\n1 depth/1.png\n");
  EXPECT_THAT(Error(), HasSubstr("associations.txt:1"));
  fs::remove(folder_ / "associations.txt");
  fs::remove_all(folder_ / "rgb");
  fs::create_directories(folder_ / "rgb");
  EXPECT_THAT(Error(), HasSubstr("lists no image"));
}

}  // namespace
}  // namespace vpslam
