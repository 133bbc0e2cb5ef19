#include "recorder/results.h"

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/unit/recorder/synthetic_run.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// 6 images went out, frames 0, 1, 3 and 4 were answered; 3 and 4 tracked in map 0.
RunRecord MakeRun() {
  RunRecord run;
  MapDelta delta = MakeDelta(0);
  delta.keyframes = {MakeKeyframe(0, 0, 3, CamAt(0)), MakeKeyframe(1, 0, 4, CamAt(1, -0.5, 2))};
  delta.keyframes[1].parent = KeyframeId(0);
  AddPoint(0, 0, {0.5f, -0.0f, 3.25f}, &delta);
  AddPoint(1, 0, {1, 1, 1}, &delta);
  AddPoint(2, 1, {9, 9, 9}, &delta);
  delta.tombstones = {{PointId(1), PointId(0)}};
  delta.answers = KeyframeId(1);
  delta.times.insertion_ms = 1.5;
  delta.times.local_ba_ms = 20;
  delta.times.total_ms = 21.5;
  EXPECT_TRUE(run.Apply(delta));
  for (const int i : {0, 1, 3, 4}) {
    FramePose pose = MakePose(i, 0, 0, CamAt(i), CamAt(i));
    if (i < 3) pose.state = TrackingState::kInitialising, pose.inliers = 0;
    pose.times.decode_ms = 2;
    pose.times.features_ms = 4 + i;
    pose.times.total_ms = 10 * (i + 1);
    run.Add(pose);
  }
  FramePose late = MakePose(1, 0, 0, CamAt(1), CamAt(1));
  late.live = false;
  run.Add(late);
  run.Add(MakeStatus("player", 1, 6, 0.08, 40));
  run.Add(MakeStatus("frontend", 2, 4, 0.1, 100));  // was restarted: its shares add up
  ProcessStatus again = MakeStatus("frontend", 3, 2, 0.1, 120);
  again.dropped = 2;
  again.gaps = 1;
  again.resent = 5;
  run.Add(again);
  return run;
}

RunInfo MakeInfo() {
  RunInfo info;
  info.options = {{"preset", "points"}};
  info.seed = 3;
  info.commit = "abc";
  return info;
}

TEST(Results, TheNewestPreviewWhereThereIsOne) {
  RunRecord run = MakeRun();
  EXPECT_FALSE(MakeResults(run, MakeInfo()).contains("preview.jpg"));
  run.Add(Preview{.frame_seq = 1, .jpeg = {0xff, 0xd8, 0}});
  run.Add(Preview{.frame_seq = 2, .jpeg = {0xff, 0xd8, 1}});
  EXPECT_EQ(MakeResults(run, MakeInfo()).at("preview.jpg"), std::string("\xff\xd8\x01", 3));
}

TEST(Results, Trajectories) {
  const auto files = MakeResults(MakeRun(), MakeInfo());
  EXPECT_EQ(files.at("trajectory.txt"),
            "0.100000 1.000000000 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 "
            "1.000000000\n"
            "0.300000 3.000000000 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 "
            "1.000000000\n"
            "0.400000 4.000000000 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 "
            "1.000000000\n");
  EXPECT_THAT(files.at("live_trajectory.txt"), StartsWith("0.300000 3.0"));
  EXPECT_EQ(files.at("keyframes.txt"),
            "0.300000 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 "
            "1.000000000\n"
            "0.400000 1.000000000 -0.500000000 2.000000000 0.000000000 0.000000000 0.000000000 "
            "1.000000000\n");
  EXPECT_FALSE(files.contains("trajectory_map2.txt"));
}

TEST(Results, Tables) {
  const auto files = MakeResults(MakeRun(), MakeInfo());
  EXPECT_EQ(files.at("frames.csv"),
            "frame,timestamp,state,inliers,decode_ms,transport_ms,features_ms,lines_ms,vps_ms,"
            "wait_for_lines_ms,initial_pose_ms,rotation_ms,translation_ms,local_map_ms,total_ms\n"
            "0,0.000000,initialising,0,2.000,,4.000,,,,,,,,10.000\n"
            "1,0.100000,tracking,50,2.000,,5.000,,,,,,,,20.000\n"
            "3,0.300000,tracking,50,2.000,,7.000,,,,,,,,40.000\n"
            "4,0.400000,tracking,50,2.000,,8.000,,,,,,,,50.000\n");
  EXPECT_EQ(files.at("keyframes.csv"),
            "keyframe,frame,timestamp,insertion_ms,feature_culling_ms,feature_creation_ms,"
            "keyframe_culling_ms,local_ba_ms,total_ms\n"
            "1,4,0.400000,1.500,,,,20.000,21.500\n");
}

TEST(Results, PointCloud) {
  const std::string ply = MakeResults(MakeRun(), MakeInfo()).at("map.ply");
  EXPECT_THAT(ply, StartsWith("ply\nformat ascii 1.0\n"));
  EXPECT_THAT(ply, HasSubstr("element vertex 3\n"));
  EXPECT_THAT(ply, ::testing::EndsWith("end_header\n0.5 0 3.25 160 160 160\n0 0 0 220 40 40\n"
                                       "1 -0.5 2 220 40 40\n"));
}

TEST(Results, Summary) {
  const auto summary = nlohmann::json::parse(MakeResults(MakeRun(), MakeInfo()).at("summary.json"));
  const auto expected = nlohmann::json::parse(R"({
    "frames": {"in": 6, "processed": 4, "dropped": 2, "dropped_before_init": 0, "tracked": 3},
    "no_pose": {"dropped": 2, "before a map was started": 1},
    "latency_ms": {"median": 30.0, "p95": 48.5},
    "cpu_ms_per_frame": {"frontend": 50.0, "player": 20.0, "total": 70.0},
    "messages": {
      "frontend": {"processed": 6, "dropped": 2, "gaps": 1, "rejected": 0, "resent": 5},
      "player": {"processed": 6, "dropped": 0, "gaps": 0, "rejected": 0, "resent": 0}},
    "stages_ms": {"decode": 2.0, "transport": null, "features": 6.0, "lines": null, "vps": null,
      "wait_for_lines": null, "initial_pose": null, "rotation": null, "translation": null,
      "local_map": null, "total": 30.0, "insertion": 1.5, "feature_culling": null,
      "feature_creation": null, "keyframe_culling": null, "local_ba": 20.0, "mapping_total": 21.5},
    "maps": 1, "keyframes": 2, "points": 2, "lines": 0, "wall_s": 0.45,
    "peak_rss_mb": {"frontend": 120.0, "player": 40.0},
    "options": {"preset": "points"}, "seed": 3, "commit": "abc"})");
  EXPECT_EQ(summary, expected) << summary.dump(2);
}

TEST(Results, CountsFramesDroppedBeforeTheFirstTrackedOne) {
  RunRecord run;
  for (const int i : {1, 4, 5, 9}) {
    FramePose pose = MakePose(i, 0, 0, SE3(), SE3());
    if (i == 1) pose.state = TrackingState::kInitialising;
    run.Add(pose);
  }
  const auto frames = Summary(run, {})["frames"];
  EXPECT_EQ(frames["in"], 10);
  EXPECT_EQ(frames["dropped"], 6);
  EXPECT_EQ(frames["dropped_before_init"], 3);  // 0, 2 and 3
  EXPECT_EQ(frames["tracked"], 0) << "their map is unknown, so no trajectory has them";
}

TEST(Results, WhatBecameOfTheSequenceIsAsThePlayerSays) {
  RunRecord run = MakeRun();
  EXPECT_FALSE(Summary(run, {}).contains("sequence"));
  run.Add(Outcome{R"({"expected": 9, "played": 6, "skipped": {"is missing": 3}})"});
  EXPECT_EQ(Summary(run, {})["sequence"]["expected"], 9);
  EXPECT_EQ(Summary(run, {})["sequence"]["skipped"]["is missing"], 3);
  run.Add(Outcome{"no JSON"});
  EXPECT_FALSE(Summary(run, {}).contains("sequence"));
}

TEST(Results, FramesWithoutAPoseHaveAReason) {
  RunRecord run;
  for (const int i : {0, 1, 2, 3, 5}) {
    FramePose pose = MakePose(i, 0, 0, SE3(), SE3());
    if (i < 2) pose.state = TrackingState::kInitialising;
    if (i == 3) pose.state = TrackingState::kLost;
    if (i == 5) pose.inliers = 0;
    run.Add(pose);
  }
  const auto expected = nlohmann::json::parse(R"({"dropped": 1, "before a map was started": 2,
    "lost": 1, "in a map that was given up": 1, "without enough of the map in view": 1})");
  EXPECT_EQ(nlohmann::json(Summary(run, {})["no_pose"]), expected);
}

TEST(Results, OfAnEmptyRun) {
  const auto files = MakeResults(RunRecord(), {});
  EXPECT_EQ(files.at("trajectory.txt"), "");
  EXPECT_THAT(files.at("map.ply"), HasSubstr("element vertex 0\n"));
  const auto summary = nlohmann::json::parse(files.at("summary.json"));
  EXPECT_EQ(summary["frames"]["in"], 0);
  EXPECT_TRUE(summary["latency_ms"]["median"].is_null());
  EXPECT_TRUE(summary["cpu_ms_per_frame"]["total"].is_null());
  EXPECT_EQ(summary["options"], nlohmann::json::object());
}

TEST(Results, FurtherMapsGetFilesOfTheirOwnAndStaleOnesGo) {
  RunRecord run = MakeRun();
  MapDelta delta = MakeDelta(1);
  delta.keyframes = {MakeKeyframe(5, 1, 5, CamAt(7))};
  ASSERT_TRUE(run.Apply(delta));
  run.Add(MakePose(5, 1, 5, SE3(), CamAt(7)));
  const fs::path path = fs::temp_directory_path() / fmt::format("vpslam_two_maps_{}", getpid());
  const ResultsFolder folder(path.string());
  WriteResults(run, {}, folder);
  EXPECT_TRUE(fs::exists(path / "trajectory_map2.txt"));
  EXPECT_THAT(MakeResults(run, {}).at("trajectory_map2.txt"), StartsWith("0.500000 7.0"));
  MapDelta erase = MakeDelta(2);
  erase.erased_maps = {MapId(1)};
  ASSERT_TRUE(run.Apply(erase));
  WriteResults(run, {}, folder);
  EXPECT_FALSE(fs::exists(path / "trajectory_map2.txt"));
  EXPECT_EQ(std::distance(fs::directory_iterator(path), {}), 7);
  fs::remove_all(path);
}

}  // namespace
}  // namespace vpslam
