#include "core/base/mask_file.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include "core/base/camera_file.h"
#include "core/geometry/image_mask.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class MaskFile : public ::testing::Test {
 protected:
  MaskFile() : folder_(fs::temp_directory_path() / fmt::format("vpslam_mask_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~MaskFile() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  /// Black below row 20 of 48, and white above; or all of one value.
  std::string Write(const std::string& name, const cv::Mat& picture) const {
    cv::imwrite(Path(name), picture);
    return Path(name);
  }
  static cv::Mat LowerPart(int type = CV_8UC1) {
    cv::Mat picture(48, 64, type, cv::Scalar::all(255));
    picture.rowRange(20, 48) = cv::Scalar::all(0);
    return picture;
  }
  template <class F>
  static std::string Error(F&& read) {
    try {
      read();
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return {};
  }

  const fs::path folder_;
};

TEST_F(MaskFile, BlackIsHidden) {
  EXPECT_THAT(ReadMaskFile(Write("mask.png", LowerPart()), 64, 48), ElementsAre(20 * 64, 28 * 64));
  EXPECT_THAT(ReadMaskFile(Write("colour.png", LowerPart(CV_8UC3)), 64, 48),
              ElementsAre(20 * 64, 28 * 64));
  EXPECT_THAT(ReadMaskFile(Write("white.png", cv::Mat(48, 64, CV_8UC1, cv::Scalar(255))), 64, 48),
              IsEmpty());
  // What was lost in storage makes shades of black and white.
  const auto runs = ReadMaskFile(Write("mask.jpg", LowerPart()), 64, 48);
  EXPECT_THAT(runs, ElementsAre(20 * 64, 28 * 64));
}

TEST_F(MaskFile, NamesWhatIsWrong) {
  const std::string path = Write("mask.png", LowerPart());
  EXPECT_THAT(Error([&] { ReadMaskFile(path, 640, 480); }),
              AllOf(HasSubstr(path), HasSubstr("64 x 48"), HasSubstr("640 x 480")));
  EXPECT_THAT(Error([&] { ReadMaskFile(Path("none.png"), 64, 48); }),
              AllOf(HasSubstr("none.png"), HasSubstr("missing")));
  const std::string black = Write("black.png", cv::Mat(48, 64, CV_8UC1, cv::Scalar(0)));
  EXPECT_THAT(Error([&] { ReadMaskFile(black, 64, 48); }),
              AllOf(HasSubstr("black.png"), HasSubstr("hides the whole image")));
}

TEST_F(MaskFile, ACalibrationNamesTheOneBesideIt) {
  Write("mask.png", LowerPart());
  const char* kCamera = "width: 64\nheight: 48\nfx: 60\nfy: 60\ncx: 32\ncy: 24\nmask: ";
  std::ofstream(Path("camera.yaml")) << kCamera << "mask.png\n";
  EXPECT_THAT(ReadCameraFile(Path("camera.yaml")).mask_runs, ElementsAre(20 * 64, 28 * 64));
  std::ofstream(Path("absolute.yaml")) << kCamera << Path("mask.png") << "\n";
  EXPECT_THAT(ReadCameraFile(Path("absolute.yaml")).mask_runs, ElementsAre(20 * 64, 28 * 64));
  std::ofstream(Path("lost.yaml")) << kCamera << "lost.png\n";
  EXPECT_THAT(Error([&] { ReadCameraFile(Path("lost.yaml")); }), HasSubstr("lost.png"));
  std::ofstream(Path("list.yaml")) << kCamera << "[a, b]\n";
  EXPECT_THAT(Error([&] { ReadCameraFile(Path("list.yaml")); }),
              AllOf(HasSubstr("list.yaml"), HasSubstr("'mask'")));
}

}  // namespace
}  // namespace vpslam
