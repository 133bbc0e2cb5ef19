#include "player/source_factory.h"

#include <limits>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class SourceFactory : public SequenceFolderTest {
 protected:
  std::string ErrorOf(const std::string& name) {
    try {
      OpenSource(name, options_);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return {};
  }
};

TEST_F(SourceFactory, ForcesAKind) {
  WriteImage("rgb/0.png", 1);
  WriteImage("1.png", 2);
  WriteImage("2.png", 3);
  Write("camera.yaml", kSmallCamera);
  Write("rgb.txt", "0 rgb/0.png\n");
  EXPECT_EQ(PlayAll().size(), 1u);
  options_.kind = "images";
  EXPECT_EQ(PlayAll().size(), 2u);
  options_.kind = "euroc";
  EXPECT_THAT(Error(), HasSubstr("sensor.yaml"));
  options_.kind = "kitti";
  EXPECT_THAT(Error(), HasSubstr("image_0"));
  options_.kind = "bonn";
  EXPECT_THAT(Error(), AllOf(HasSubstr("--source bonn"), HasSubstr("euroc")));
}

TEST_F(SourceFactory, RefusesWhatASourceHasNoUseFor) {
  WriteImage("rgb/0.png", 1);
  Write("camera.yaml", kSmallCamera);
  Write("rgb.txt", "0 rgb/0.png\n");
  options_.fps = 10;
  EXPECT_THAT(Error(), AllOf(HasSubstr("--fps"), HasSubstr("time stamps")));
  options_.fps = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(Error(), HasSubstr("fps"));
  options_.fps = 0;
  options_.width = 320;
  EXPECT_THAT(Error(), HasSubstr("--width"));
}

TEST_F(SourceFactory, NamesWhatIsNotThere) {
  EXPECT_THAT(ErrorOf((folder_ / "nowhere").string()),
              AllOf(HasSubstr("nowhere"), HasSubstr("exist")));
  EXPECT_THAT(ErrorOf(folder_.string()), AllOf(HasSubstr("no sequence"), HasSubstr("EuRoC")));
  EXPECT_THAT(ErrorOf("camera:0"), HasSubstr("--camera"));
  Write("camera.yaml", kSmallCamera);
  options_.camera_file = (folder_ / "camera.yaml").string();
  EXPECT_THAT(ErrorOf("camera:97"), AllOf(HasSubstr("/dev/video97"), HasSubstr("no such camera")));
  EXPECT_THAT(ErrorOf("/dev/video97"), HasSubstr("no such camera"));
  options_.width = 64;
  options_.height = 64;
  EXPECT_THAT(ErrorOf("camera:97"), AllOf(HasSubstr("camera.yaml"), HasSubstr("64 x 48")));
}

}  // namespace
}  // namespace vpslam
