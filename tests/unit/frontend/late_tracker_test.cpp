#include "frontend/late_tracker.h"

#include <gtest/gtest.h>

#include "tests/unit/frontend/tracking_scene.h"

namespace vpslam {
namespace {

constexpr int64_t kFirst = 10, kSecond = 20;  // frames of the map's first two keyframes

/// Frame `seq` stands at 0.03 x (seq - 10): the keyframes of the map at 0 and 0.3 are 10 and 20.
SE3 PoseOf(int64_t seq) { return PoseAt({0.03 * static_cast<double>(seq - kFirst), 0, 0}); }

struct Fixture {
  explicit Fixture(uint64_t seed, int num_frames = 25, const TrackerOptions& options = {})
      : s(seed, {}, 4), late(options) {
    first = s.TrackedFrame(PoseOf(kFirst), kFirst);
    for (int seq = 0; seq < num_frames; ++seq) frames.push_back(s.NewFrame(PoseOf(seq), seq));
  }
  /// All that can be placed.
  std::vector<Frame> Run() {
    std::vector<Frame> placed;
    for (int i = 0; late.Busy() && i < 1000; ++i) {
      if (auto frame = late.Step(s.context())) placed.push_back(std::move(*frame));
    }
    EXPECT_FALSE(late.Busy());
    return placed;
  }
  static std::vector<int64_t> SeqsOf(const std::vector<Frame>& placed) {
    std::vector<int64_t> seqs;
    for (const Frame& frame : placed) seqs.push_back(frame.seq());
    return seqs;
  }

  TrackingScene s;
  LateTracker late;
  Frame first;
  std::vector<Frame> frames;
};

std::vector<int64_t> BetweenThenBackwards() {
  std::vector<int64_t> seqs;
  for (int64_t i = kFirst + 1; i < kSecond; ++i) seqs.push_back(i);
  for (int64_t i = kFirst - 1; i >= 0; --i) seqs.push_back(i);
  return seqs;
}

TEST(LateTracker, PlacesFramesBetweenAndBefore) {
  Fixture f(1);
  EXPECT_FALSE(f.late.Busy());
  f.late.Start(f.frames, f.first, kSecond);
  EXPECT_TRUE(f.late.Busy());
  const std::vector<Frame> placed = f.Run();
  EXPECT_EQ(Fixture::SeqsOf(placed), BetweenThenBackwards());
  for (const Frame& frame : placed) {
    EXPECT_LT(f.s.PositionError(frame), 4 * 3 * 5 * 1.5 / 520 / 10);
    EXPECT_GE(frame.placement.inliers, 30);
    SE3 reference;
    ASSERT_TRUE(f.s.map.map.CamFromWorld(frame.placement.reference, &reference));
    EXPECT_LT(LocalCoordinates(frame.placement.cam_from_reference * reference,
                               frame.placement.cam_from_world)
                  .norm(),
              1e-9);
  }
}

TEST(LateTracker, FollowsTheMapWhenItMoves) {
  Fixture f(2);
  f.late.Start(f.frames, f.first, kSecond);
  int placed = 0;
  SE3 world;  // the scene's, as the map has it now
  while (f.late.Busy()) {
    const auto frame = f.late.Step(f.s.context());
    if (!frame) continue;
    ++placed;
    EXPECT_LT(
        ((frame->placement.cam_from_world * world).Center() - f.s.TruthOf(*frame).Center()).norm(),
        0.1);
    // Everything is shifted by more than any window after each step.
    const SE3 shift(ExpSo3({0.1, 0.2, -0.1}), {1, -2, 0.5});
    OwnedMap& map = f.s.map.map;
    for (int i = 0; i < 4; ++i) {
      const KeyframeId k(i);
      map.SetPose(k, map.Find(k)->cam_from_world * shift.Inverse());
    }
    for (const auto& [id, p] : f.s.map.truth) {
      const MapPoint& point = *map.Find(id);
      map.SetPosition(id, shift * point.position);
      map.SetView(id, shift.rotation * point.normal, point.max_distance);
    }
    world = shift * world;
  }
  EXPECT_EQ(placed, 19);
}

TEST(LateTracker, StopsWhereTheMapEnds) {
  Fixture f(3);
  // Frames 4 and before show another place; 7 is blind.
  SyntheticScene elsewhere(99);
  for (int seq = 0; seq <= 4; ++seq) {
    f.s.SetFeatures(elsewhere.Look(PoseOf(seq)).features, &f.frames[seq]);
  }
  f.s.SetFeatures(Features(), &f.frames[7]);
  f.late.Start(f.frames, f.first, kSecond);
  const std::vector<Frame> placed = f.Run();
  std::vector<int64_t> expected = BetweenThenBackwards();
  std::erase_if(expected, [](int64_t seq) { return seq == 7 || seq <= 4; });
  EXPECT_EQ(Fixture::SeqsOf(placed), expected);
}

TEST(LateTracker, GivesUpAfterThreeFailures) {
  Fixture f(4);
  for (const int seq : {5, 6, 7}) f.s.SetFeatures(Features(), &f.frames[seq]);
  f.late.Start(f.frames, f.first, kSecond);
  std::vector<int64_t> expected = BetweenThenBackwards();
  std::erase_if(expected, [](int64_t seq) { return seq <= 7; });
  EXPECT_EQ(Fixture::SeqsOf(f.Run()), expected);
}

TEST(LateTracker, BackFromAFrameThatWasFoundAgain) {
  Fixture f(7);
  const Frame found = f.s.TrackedFrame(PoseOf(18), 18);
  f.late.Return(f.frames, found);
  std::vector<int64_t> expected;
  for (int64_t seq = 17; seq >= 0; --seq) expected.push_back(seq);
  EXPECT_EQ(Fixture::SeqsOf(f.Run()), expected);
}

TEST(LateTracker, MergersOfMapsAreFollowed) {
  Fixture f(8);
  f.late.Return(f.frames, f.s.TrackedFrame(PoseOf(20), 20));
  std::vector<Frame> placed;
  for (int i = 0; f.late.Busy() && i < 100; ++i) {
    if (i == 8) f.s.map.map.Transform(MapId(0), {ExpSo3({0.5, 1, -0.5}), {1, 2, 3}, 4});
    if (auto frame = f.late.Step(f.s.context())) placed.push_back(std::move(*frame));
  }
  ASSERT_EQ(placed.size(), 20u);
  for (const Frame& frame : placed) {
    SE3 cam_from_world;
    ASSERT_TRUE(f.s.map.map.Place(frame.placement.reference, frame.placement.cam_from_reference,
                                  &cam_from_world));
    const SE3 truth = TransformWorld(PoseOf(frame.seq()), {ExpSo3({0.5, 1, -0.5}), {1, 2, 3}, 4});
    EXPECT_LT((cam_from_world.Center() - truth.Center()).norm() / 4, 0.02) << frame.seq();
  }
}

TEST(LateTracker, GoesOnFromAKeyframeThatItsFrameBecame) {
  Fixture f(9);
  f.late.Return(f.frames, f.s.TrackedFrame(PoseOf(20), 20));
  std::vector<int64_t> placed;
  const KeyframeId next(KeyframeEnd(f.s.map.map));
  while (f.late.Busy()) {
    auto frame = f.late.Step(f.s.context());
    if (!frame) continue;
    placed.push_back(frame->seq());
    if (frame->seq() != 8) continue;
    EXPECT_EQ(f.late.frames_since_keyframe(), 12);
    SyntheticView view = f.s.scene.Look(PoseOf(8));
    frame->placement.BecomeKeyframe(next);
    f.late.GoOnFrom(*frame);
    EXPECT_EQ(f.late.frames_since_keyframe(), 0);
    EXPECT_TRUE(f.late.Waits(f.s.map.map));
    EXPECT_EQ(f.s.map.AddKeyframe(view), next);
    EXPECT_FALSE(f.late.Waits(f.s.map.map));
  }
  std::vector<int64_t> expected;
  for (int64_t seq = 19; seq >= 0; --seq) expected.push_back(seq);
  EXPECT_EQ(placed, expected);
}

TEST(LateTracker, NothingToPlace) {
  Fixture f(5);
  f.late.Start({}, f.first, kSecond);
  EXPECT_TRUE(f.Run().empty());
  EXPECT_FALSE(f.late.Busy());
  EXPECT_FALSE(f.late.Step(f.s.context()));
  // A map that is gone.
  f.late.Start(f.frames, f.first, kSecond);
  f.s.map.map.EraseMap(MapId(0));
  EXPECT_TRUE(f.Run().empty());
}

}  // namespace
}  // namespace vpslam
