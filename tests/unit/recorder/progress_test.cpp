#include "recorder/progress.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/recorder/synthetic_run.h"

namespace vpslam {
namespace {

TEST(ProgressLine, BeforeTheFirstFrame) {
  const auto line = nlohmann::json::parse(ProgressLine(RunRecord()));
  EXPECT_EQ(line["frame"], -1);
  EXPECT_EQ(line["state"], "initialising");
  EXPECT_EQ(line["dropped"], 0);
}

TEST(ProgressLine, ShowsTheNewestFrameAndItsMap) {
  RunRecord run;
  for (const int i : {0, 1, 2, 5, 6, 20}) {
    run.Add(MakePose(i, i < 5 ? 0 : 1, 0, SE3(), SE3()));  // 10 images a second went out
  }
  MapDelta delta = MakeDelta(0);
  delta.keyframes = {MakeKeyframe(0, 0, 0, CamAt(0)), MakeKeyframe(1, 1, 5, CamAt(0)),
                     MakeKeyframe(2, 1, 6, CamAt(0))};
  AddPoint(0, 0, {1, 2, 3}, &delta);
  AddPoint(1, 1, {1, 2, 3}, &delta);
  ASSERT_TRUE(run.Apply(delta));
  run.Add(MakeStatus("frontend", 3, 6, 0, 0));
  const std::string text = ProgressLine(run);
  EXPECT_EQ(text.find('\n'), std::string::npos);
  const auto line = nlohmann::json::parse(text);
  EXPECT_EQ(line["frame"], 20);
  EXPECT_EQ(line["state"], "tracking");
  EXPECT_EQ(line["keyframes"], 2);
  EXPECT_EQ(line["points"], 1);
  EXPECT_EQ(line["map"], 1);
  EXPECT_EQ(line["maps"], 2);
  EXPECT_EQ(line["maps_merged"], 0);
  EXPECT_EQ(line["frames_lost"], 0);
  EXPECT_EQ(line["dropped"], 15);
  EXPECT_EQ(line["fps"], 0);
  EXPECT_EQ(line["processes"]["frontend"], "running");
  EXPECT_TRUE(line["messages"].empty());
  ProcessStatus player = MakeStatus("player", 4, 6, 0, 0);
  player.message = "the lens is dirty";
  run.Add(player);
  EXPECT_EQ(nlohmann::json::parse(ProgressLine(run))["messages"]["player"], "the lens is dirty");
  player.message = "no lens\xff";
  run.Add(player);
  EXPECT_EQ(nlohmann::json::parse(ProgressLine(run))["messages"]["player"], "no lens\uFFFD");
  run.Add(MakePose(21, 1, 0, SE3(), SE3()));
  run.Add(MakePose(25, 1, 0, SE3(), SE3()));
  EXPECT_EQ(nlohmann::json::parse(ProgressLine(run))["fps"], 4);  // two in half a second
  for (const int i : {26, 27}) {
    FramePose lost = MakePose(i, 1, 0, SE3(), SE3());
    lost.state = TrackingState::kLost;
    run.Add(lost);
  }
  delta = MakeDelta(1);
  delta.merged_maps = {{MapId(1), MapId(0)}};
  ASSERT_TRUE(run.Apply(delta));
  const auto later = nlohmann::json::parse(ProgressLine(run));
  EXPECT_EQ(later["state"], "lost");
  EXPECT_EQ(later["frames_lost"], 2);
  EXPECT_EQ(later["maps_merged"], 1);
}

}  // namespace
}  // namespace vpslam
