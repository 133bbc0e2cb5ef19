#include "player/truth_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

class TruthFileTest : public SequenceFolderTest {};

TEST_F(TruthFileTest, IsReadBackAsTumTruth) {
  const SE3 pose(Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), {1, -2, 3.25});
  {
    TruthFile file((folder_ / "groundtruth.txt").string());
    file.Add(1'403'636'579'763'556, pose);
  }
  WriteImage("a.png", 1);
  Write("camera.yaml", kSmallCamera);
  Write("rgb.txt", "1403636579.763556 a.png\n");
  const auto read = Open()->WorldFromCam(1'403'636'579'763'556);
  ASSERT_TRUE(read);
  EXPECT_NEAR(LocalCoordinates(pose, *read).norm(), 0, 1e-8);
}

TEST_F(TruthFileTest, LeavesNothingWhereThereIsNoTruth) {
  Write("truth.txt", "of an earlier run");
  TruthFile file((folder_ / "truth.txt").string());
  EXPECT_FALSE(fs::exists(folder_ / "truth.txt"));
}

TEST_F(TruthFileTest, SaysThatItCannotBeWritten) {
  TruthFile file((folder_ / "nowhere" / "truth.txt").string());
  EXPECT_THROW(file.Add(0, SE3()), std::runtime_error);
}

}  // namespace
}  // namespace vpslam
