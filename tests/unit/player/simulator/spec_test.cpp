#include "player/simulator/spec.h"

#include <stdexcept>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vpslam::simulator {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string ErrorOf(const std::string& text) {
  try {
    ParseSpec(text);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "no error";
}

TEST(Spec, HasDefaults) {
  const Spec room = ParseSpec("sim:room");
  EXPECT_EQ(room.scene, SceneKind::kRoom);
  EXPECT_EQ(room.seed, 1u);
  EXPECT_EQ(room.frames, 600);
  EXPECT_EQ(room.noise, 1);
  EXPECT_FALSE(room.distortion);
  EXPECT_EQ(ParseSpec("sim:corridor").scene, SceneKind::kCorridor);
}

TEST(Spec, ReadsEveryKeyInAnyOrder) {
  const Spec spec = ParseSpec("sim:corridor?noise=0.25&distortion=1&frames=42&seed=7");
  EXPECT_EQ(spec.scene, SceneKind::kCorridor);
  EXPECT_EQ(spec.seed, 7u);
  EXPECT_EQ(spec.frames, 42);
  EXPECT_EQ(spec.noise, 0.25);
  EXPECT_TRUE(spec.distortion);
}

TEST(Spec, NamesFaultAndRemedyInOneLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"room", "starts with 'sim:'"},
      {"sim:", "no scene ''"},
      {"sim:garden", "no scene 'garden', only room and corridor"},
      {"sim:room?", "'' is not of the form key=value"},
      {"sim:room?seed", "'seed' is not of the form key=value"},
      {"sim:room?speed=2", "no key 'speed'"},
      {"sim:room?seed=1&seed=2", "seed is given twice"},
      {"sim:room?seed=-1", "seed='-1' is not a number in 0 to"},
      {"sim:room?frames=0", "frames='0' is not a number in 1 to"},
      {"sim:room?frames=10x", "frames='10x' is not a number"},
      {"sim:room?frames=", "frames='' is not a number"},
      {"sim:room?noise=nan", "noise='nan' is not a number in 0 to 20"},
      {"sim:room?distortion=2", "distortion='2' is not a number in 0 to 1"},
      {"sim:room?frames=5&", "'' is not of the form key=value"},
  };
  for (const auto& [text, fault] : cases) {
    EXPECT_THAT(ErrorOf(text), AllOf(HasSubstr(text), HasSubstr(fault),
                                     HasSubstr("write for example sim:room"), Not(HasSubstr("\n"))))
        << text;
  }
}

}  // namespace
}  // namespace vpslam::simulator
