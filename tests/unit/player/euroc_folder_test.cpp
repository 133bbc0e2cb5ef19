#include "player/euroc_folder.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/camera_file.h"
#include "player/euroc_sensor.h"
#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The layout of the published archives, comments and line ends included.
class EurocFolder : public SequenceFolderTest {
 protected:
  static constexpr int64_t kFirst_ns = 1403636579763555584;

  static std::string Sensor(const std::string& size = "[64, 48]",
                            const std::string& model = "radial-tangential",
                            const std::string& intrinsics = "[60, 61, 31.5, 23.5]") {
    // The camera looks along the body's x axis and sits at (0.1, 0.2, 0.3) m.
    return "# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0\n\n"
           "T_BS:\n  cols: 4\n  rows: 4\n  data: [0.0, 0.0, 1.0, 0.1,\n         -1.0, 0.0, 0.0, "
           "0.2,\n"
           "         0.0, -1.0, 0.0, 0.3,\n         0.0, 0.0, 0.0, 1.0]\n\n"
           "rate_hz: 20\nresolution: " +
           size + "\ncamera_model: pinhole\nintrinsics: " + intrinsics +
           " #fu, fv, cu, cv\ndistortion_model: " + model +
           "\ndistortion_coefficients: [-0.28, 0.074, 0.00019, 1.76e-05]\n";
  }
  void WriteSequence(int n) {
    std::string list = "#timestamp [ns],filename\r\n";
    for (int i = 0; i < n; ++i) {
      const std::string name = fmt::format("{}.png", kFirst_ns + 50'000'000 * i);
      WriteImage("mav0/cam0/data/" + name, 10 + i);
      list += fmt::format("{},{}\r\n", kFirst_ns + 50'000'000 * i, name);
    }
    Write("mav0/cam0/data.csv", list);
    Write("mav0/cam0/sensor.yaml", Sensor());
  }
};

TEST_F(EurocFolder, PlaysTheLeftCamera) {
  WriteSequence(3);
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(frames[i].stamp_us, kFirst_ns / 1000 + 1 + 50'000 * i);
    EXPECT_EQ(frames[i].grey.at<uint8_t>(0, 0), 10 + i);
  }
  const Camera camera = Open()->camera();
  EXPECT_EQ(camera.width, 64);
  EXPECT_EQ(camera.height, 48);
  EXPECT_EQ(camera.fps, 20);
  EXPECT_EQ(camera.fy, 61);
  EXPECT_EQ(camera.cx, 31.5);
  EXPECT_EQ(camera.k1, -0.28);
  EXPECT_EQ(camera.k2, 0.074);
  EXPECT_EQ(camera.p1, 0.00019);
  EXPECT_EQ(camera.p2, 1.76e-05);
  EXPECT_EQ(camera.k3, 0);
  EXPECT_FALSE(Open()->WorldFromCam(kFirst_ns / 1000));
  EXPECT_THAT(told_, ElementsAre());

  folder_ /= "mav0";  // the same when that is named
  EXPECT_EQ(PlayAll().size(), 3u);
  folder_ = folder_.parent_path();
}

TEST_F(EurocFolder, TruthIsOfTheCamera) {
  WriteSequence(2);
  // The body at (1, 2, 3) m, turned by 90 degrees about z; then speed and biases.
  Write("mav0/state_groundtruth_estimate0/data.csv",
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
        "q_RS_z [], v_RS_R_x [m s^-1], ...\n" +
            fmt::format("{},1,2,3,0.70710678,0,0,0.70710678,9,9,9,0.1,0.1,0.1,0,0,0\n", kFirst_ns));
  const auto pose = Open()->WorldFromCam(kFirst_ns / 1000 + 1);
  ASSERT_TRUE(pose);
  EXPECT_NEAR((pose->translation - Eigen::Vector3d(1 - 0.2, 2 + 0.1, 3.3)).norm(), 0, 1e-6);
  // Its optical axis is the body's x axis, which is the world's y axis.
  EXPECT_NEAR((pose->rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitY()).norm(), 0,
              1e-6);
  // Down in the image is down in the world.
  EXPECT_NEAR((pose->rotation * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitZ()).norm(), 0,
              1e-6);
}

TEST_F(EurocFolder, TakesAnotherCalibration) {
  WriteSequence(2);
  Write("other.yaml", "width: 64\nheight: 48\nfx: 70\nfy: 71\ncx: 31.5\ncy: 23.5\n");
  options_.camera_file = (folder_ / "other.yaml").string();
  EXPECT_EQ(Open()->camera().fx, 70);
}

TEST_F(EurocFolder, NamesWhatIsWrong) {
  WriteSequence(2);
  const auto error_with = [&](const std::string& sensor) {
    Write("mav0/cam0/sensor.yaml", sensor);
    return Error();
  };
  EXPECT_THAT(error_with(Sensor("[64, 48]", "equidistant")),
              AllOf(HasSubstr("sensor.yaml"), HasSubstr("equidistant"), HasSubstr("--camera")));
  EXPECT_THAT(error_with(Sensor("[64]")), AllOf(HasSubstr("sensor.yaml"), HasSubstr("resolution")));
  EXPECT_THAT(error_with(Sensor("[64, 48]", "radial-tangential", "[.nan, 61, 31.5, 23.5]")),
              AllOf(HasSubstr("sensor.yaml"), HasSubstr("finite")));
  EXPECT_THAT(error_with(Sensor("[64, 48]", "radial-tangential", "[a, 61, 31.5, 23.5]")),
              AllOf(HasSubstr("sensor.yaml"), HasSubstr("intrinsics")));
  EXPECT_THAT(error_with("sensor_type: camera\n"), HasSubstr("'resolution' is missing"));
  EXPECT_THAT(error_with("a: [\n"), AllOf(HasSubstr("sensor.yaml"), HasSubstr("not YAML")));
  EXPECT_THAT(error_with(""), AllOf(HasSubstr("sensor.yaml"), HasSubstr("key: value")));
  fs::remove(folder_ / "mav0/cam0/sensor.yaml");
  EXPECT_THAT(Error(), AllOf(HasSubstr("sensor.yaml"), HasSubstr("--camera")));
  Write("mav0/cam0/sensor.yaml", Sensor());
  Write("mav0/cam0/data.csv", "#timestamp [ns],filename\n1.5,a.png\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("data.csv:2"), HasSubstr("1.5 in seconds")));
}

TEST_F(EurocFolder, SkipsASingleMissingImage) {
  WriteSequence(30);
  fs::remove(folder_ / fmt::format("mav0/cam0/data/{}.png", kFirst_ns + 50'000'000 * 7));
  EXPECT_EQ(PlayAll().size(), 29u);
  EXPECT_THAT(told_, ElementsAre(HasSubstr("is missing")));
}

}  // namespace
}  // namespace vpslam
