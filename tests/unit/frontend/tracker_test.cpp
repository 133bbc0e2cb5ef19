// The frontend from end to end: images of a made-up place in, poses out; the backend answers.
#include "frontend/tracker.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/geometry/sim3.h"
#include "core/geometry/so3.h"
#include "core/map/owned_map.h"
#include "tests/unit/frontend/lockstep.h"

namespace vpslam {
namespace {

/// RMSE of centres after Sim(3) alignment, of the frames that have poses; `index_of_seq` tells
/// where a frame was taken.
template <class F>
double Rmse(const Lockstep& run, F&& index_of_seq, int* count) {
  std::vector<Eigen::Vector3d> estimate, truth;
  for (const auto& [seq, pose] : run.poses) {
    SE3 cam_from_world;
    if (!run.PoseOf(seq, &cam_from_world)) continue;
    estimate.push_back(cam_from_world.Center());
    truth.push_back(OnTheWay(index_of_seq(seq)).Center());
  }
  *count = static_cast<int>(truth.size());
  const auto truth_from_map = AlignPoints(estimate, truth);
  if (!truth_from_map) return 1e9;
  double sum = 0;
  for (size_t i = 0; i < truth.size(); ++i) {
    sum += (*truth_from_map * estimate[i] - truth[i]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

TEST(Tracker, StartsTracksAndPlacesEarlierFrames) {
  Lockstep run;
  int i = 0;
  for (; run.keyframes.empty() && i < 30; ++i) {
    const TrackingState state = run.Track(ImageOf(i)).state;
    EXPECT_EQ(state == TrackingState::kTracking, !run.keyframes.empty());
  }
  ASSERT_EQ(run.keyframes.size(), 2u);
  EXPECT_EQ(run.keyframes[0].role, KeyframeRole::kMapFirst);
  EXPECT_EQ(run.keyframes[1].role, KeyframeRole::kMapSecond);
  EXPECT_FALSE(run.keyframes[0].discarded_map.IsValid());
  EXPECT_GE(run.keyframes[1].initial_points.size(), 50u);
  EXPECT_EQ(run.keyframes[1].frame_seq, i - 1);
  for (; i < 50; ++i) {
    const FramePose pose = run.Track(ImageOf(i));
    EXPECT_EQ(pose.state, TrackingState::kTracking) << i;
    EXPECT_TRUE(pose.live);
    EXPECT_GE(pose.inliers, 30);
    EXPECT_GE(pose.matches, pose.inliers);
  }
  run.Finish();
  for (size_t k = 0; k < run.keyframes.size(); ++k) {
    EXPECT_EQ(run.keyframes[k].id.value, static_cast<int>(k));
  }
  int count = 0;
  // A pixel is 0.01 at a depth of 4; corners are better than that, and many.
  EXPECT_LT(Rmse(
                run, [](int64_t seq) { return static_cast<int>(seq); }, &count),
            0.01);
  EXPECT_EQ(count, 50);
  EXPECT_FALSE(run.poses.at(1).live);
}

TEST(Tracker, ATurningCameraStartsNoMap) {
  Lockstep run;
  for (int i = 0; i < 12; ++i) {
    const cv::Mat image = Room().Render(PoseAt({0, 0, 0}, {0.01 * i, 0.02 * i, 0}));
    EXPECT_EQ(run.Track(image).state, TrackingState::kInitialising);
  }
  run.Finish();
  EXPECT_TRUE(run.keyframes.empty());
}

TEST(Tracker, LostAndFoundAgain) {
  Lockstep run;
  run.Walk(0, 40);
  ASSERT_GE(run.replica.NumKeyframes(MapId(0)), 6);
  const size_t keyframes = run.keyframes.size();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(run.Track(Room().Blank()).state, TrackingState::kLost);
  }
  EXPECT_EQ(run.keyframes.size(), keyframes);
  // Carried back, far from where it was lost. Frame 43 and on show places 22 and on.
  for (int i = 22; i < 28; ++i) {
    const FramePose pose = run.Track(ImageOf(i));
    EXPECT_EQ(pose.state, TrackingState::kTracking);
    EXPECT_EQ(pose.map, MapId(0));
    EXPECT_GE(pose.inliers, 50);
  }
  run.Finish();
  const auto index = [](int64_t seq) { return static_cast<int>(seq < 40 ? seq : seq - 21); };
  int count = 0;
  EXPECT_LT(Rmse(run, index, &count), 0.01);
  EXPECT_EQ(count, 46);
}

/// Walks along the left of the wall, is covered, carried to the far right, and walks back from
/// there. What is seen of the wall from the places up to -10 and from those down to 110 does not
/// overlap.
class CarriedAway : public ::testing::Test {
 protected:
  static constexpr int kWalk = 40, kCovered = 3, kFar = 140, kMet = 85;

  Lockstep run;
  std::vector<int> places;  ///< by frame; -1000 for an image of nothing

  FramePose Visit(int place) {
    places.push_back(place);
    return run.Track(place == -1000 ? Room().Blank() : ImageOf(place));
  }
  void GoFarAway() {
    for (int i = 0; i < kWalk; ++i) Visit(i - 10 - kWalk);
    for (int i = 0; i < kCovered; ++i) Visit(-1000);
    for (int place = kFar; place >= kMet; --place) Visit(place);
  }
  double RmseOfAll(int* count) {
    return Rmse(
        run, [this](int64_t seq) { return places[static_cast<size_t>(seq)]; }, count);
  }
};

TEST_F(CarriedAway, ANewMapIsBegunAndTheOldOneStays) {
  GoFarAway();
  const FramePose last = run.poses.at(static_cast<int64_t>(places.size()) - 1);
  ASSERT_EQ(last.state, TrackingState::kTracking);
  EXPECT_EQ(last.map, MapId(1));
  EXPECT_EQ(run.replica.Maps(), (std::vector<MapId>{MapId(0), MapId(1)}));
  for (int seq = kWalk; seq < kWalk + 30; ++seq) {
    EXPECT_EQ(run.first_poses.at(seq).state, TrackingState::kLost) << seq;
    EXPECT_EQ(run.first_poses.at(seq).map, MapId(0)) << seq;
  }
  run.Finish();
  // What was filmed shortly before the new map stood is placed in it.
  for (int seq = kWalk + 20; seq < kWalk + 30; ++seq) {
    EXPECT_EQ(run.poses.at(seq).state, TrackingState::kTracking) << seq;
    EXPECT_EQ(run.poses.at(seq).map, MapId(1)) << seq;
    EXPECT_FALSE(run.poses.at(seq).live);
  }
  EXPECT_EQ(run.poses.at(kWalk + 1).state, TrackingState::kLost);
}

TEST_F(CarriedAway, BackInTheOldMapItIsFoundThereAtOnce) {
  GoFarAway();
  Visit(-20);  // map 1 may still be on probation, which ends here
  const FramePose pose = Visit(-21);
  EXPECT_EQ(pose.state, TrackingState::kTracking);
  EXPECT_EQ(pose.map, MapId(0)) << "the jump loses map 1, and map 0 has the place";
  EXPECT_EQ(run.replica.num_merged(), 0) << "nothing shows both";
}

TEST_F(CarriedAway, FoundInAnotherMapItIsMeasuredAgainstThatMapsAxes) {
  GoFarAway();
  constexpr int64_t kSeq = kWalk - 5;
  constexpr int kPlace = -21;
  SE3 in_map_0;
  ASSERT_EQ(run.poses.at(kSeq).map, MapId(0));
  ASSERT_TRUE(run.PoseOf(kSeq, &in_map_0));
  const Eigen::Quaterniond axes =
      in_map_0.rotation.conjugate() * OnTheWay(places[static_cast<size_t>(kSeq)]).rotation;
  LineSet lines;
  lines.manhattan = ManhattanState::kThree;
  lines.cam_from_manhattan = OnTheWay(kPlace).rotation;
  lines.covariance_rad2 = 1e-6 * Eigen::Matrix3d::Identity();
  lines.vanishing_points.assign(3, {.support = 20});
  /// Of a tracker that is lost in map 1, when it is back in map 0.
  const auto rotation_with = [&](MapId map, double axes_off_rad) {
    MapDelta frame;
    frame.base_version = run.replica.version();
    frame.version = frame.base_version + 1;
    frame.manhattan_frames = {{ManhattanId(0), map, axes * ExpSo3({0, axes_off_rad, 0})}};
    Tracker again(Room().camera, TrackerOptions(), 2);
    for (const MapDelta& delta : run.mapper.Snapshot()) EXPECT_TRUE(again.Apply(delta));
    EXPECT_TRUE(again.Apply(frame));
    ImageFrame image;
    image.pixels = ImageOf(kPlace);
    FrameFeatures features = again.Extract(image);
    features.lines = std::make_shared<const LineSet>(lines);
    const FramePose pose = again.Track(std::move(features)).poses.front();
    EXPECT_EQ(pose.state, TrackingState::kTracking);
    EXPECT_EQ(pose.map, MapId(0));
    return pose.cam_from_world.rotation.coeffs();
  };
  const double off_rad = 0.05;  // of the 8 degrees that are let in, 3
  EXPECT_EQ(rotation_with(MapId(1), 0), rotation_with(MapId(1), off_rad))
      << "what map 1 says of its axes has no meaning in map 0";
  EXPECT_NE(rotation_with(MapId(0), 0), rotation_with(MapId(0), off_rad));
}

TEST_F(CarriedAway, MapsThatMeetAreMerged) {
  GoFarAway();
  int merged_at = -1000;
  for (int place = kMet - 1; place > -20; --place) {
    const FramePose pose = Visit(place);
    ASSERT_EQ(pose.state, TrackingState::kTracking) << place;
    if (merged_at == -1000 && run.replica.num_merged() > 0) merged_at = place;
    if (place < merged_at) {
      EXPECT_EQ(pose.map, MapId(0)) << place;
    }
  }
  // At 26 half of the wall in view is what was seen from -10: 3 m to the side, of 36 degrees.
  EXPECT_GT(merged_at, 26);
  EXPECT_EQ(run.replica.Maps(), std::vector<MapId>{MapId(0)});
  run.Finish();
  int count = 0;
  EXPECT_LT(RmseOfAll(&count), 0.05) << "over eleven";
  EXPECT_GE(count, static_cast<int>(places.size()) - kCovered - 20);
}

/// Walks on behind `covered` blank images, never recognises a place, and starts a new map at once.
class WalksOnBehindALoss : public ::testing::Test {
 protected:
  static TrackerOptions Blindfolded() {
    TrackerOptions options;
    options.relocalizer.max_candidates = 0;
    options.relocalizer.frames_to_new_map = 0;
    return options;
  }
  void Walk(int covered) {
    run.Walk(0, 40);
    for (int i = 0; i < covered; ++i) run.Track(Room().Blank());
    run.Walk(40, 80);
    // Frame by frame, what is owed still.
    run.Walk(80, 100);
  }
  Lockstep run{Blindfolded()};
};

TEST_F(WalksOnBehindALoss, TheNewMapIsTiedToTheOldOne) {
  Walk(2);
  EXPECT_EQ(run.replica.Maps(), std::vector<MapId>{MapId(0)});
  EXPECT_EQ(run.replica.num_merged(), 1);
  const auto tie = std::find_if(run.keyframes.begin(), run.keyframes.end(),
                                [](const auto& k) { return k.seam.map.IsValid(); });
  ASSERT_NE(tie, run.keyframes.end());
  EXPECT_EQ(tie->map, MapId(1));
  EXPECT_LT(tie->frame_seq, 40) << "from before the loss";
  EXPECT_TRUE(run.poses.at(tie->frame_seq).live) << "it had its pose";
  run.Finish();
  int count = 0;
  EXPECT_LT(
      Rmse(
          run, [](int64_t seq) { return static_cast<int>(seq < 40 ? seq : seq - 2); }, &count),
      0.02);
  EXPECT_EQ(count, 100);
}

TEST_F(WalksOnBehindALoss, NotWhereTheWayBackIsBroken) {
  Walk(4);
  EXPECT_EQ(run.replica.Maps(), (std::vector<MapId>{MapId(0), MapId(1)}));
  for (const KeyframeProposal& k : run.keyframes) EXPECT_FALSE(k.seam.map.IsValid());
}

TEST(Tracker, StartedAgainItTakesTheMapOver) {
  Lockstep run;
  run.Walk(0, 40);
  // Another process, in which nothing is left but what the backend tells.
  Tracker again(Room().camera, TrackerOptions(), 2);
  for (const MapDelta& delta : run.mapper.Snapshot()) EXPECT_TRUE(again.Apply(delta));
  int proposed = 0;
  for (int i = 30; i < 60; ++i) {
    ImageFrame image;
    image.frame_seq = i + 50;
    image.pixels = ImageOf(i);
    const TrackerOutput output = again.Track(again.Extract(image));
    EXPECT_EQ(output.poses.front().state, TrackingState::kTracking) << i;
    EXPECT_EQ(output.poses.front().map, MapId(0)) << i;
    for (const KeyframeProposal& proposal : output.keyframes) {
      EXPECT_EQ(proposal.id, KeyframeId(1, proposed++)) << "a session of its own";
      for (const MapDelta& delta : run.mapper.Process(proposal)) EXPECT_TRUE(again.Apply(delta));
    }
  }
  EXPECT_GE(proposed, 1);
}

TEST(Tracker, AMapThatIsLostWhileYoungIsGivenUp) {
  Lockstep run;
  int i = 0;
  while (run.keyframes.empty() && i < 30) run.Track(ImageOf(i++));
  ASSERT_EQ(run.keyframes.size(), 2u);
  EXPECT_EQ(run.Track(Room().Blank()).state, TrackingState::kInitialising);
  EXPECT_EQ(run.replica.NumKeyframes(MapId(0)), 2) << "until there is another";
  const int blank = i;
  for (; i < 45; ++i) run.Track(ImageOf(i));
  ASSERT_GT(run.keyframes.size(), 4u);
  EXPECT_EQ(run.keyframes[2].role, KeyframeRole::kMapFirst);
  EXPECT_EQ(run.keyframes[2].discarded_map, MapId(0));
  EXPECT_EQ(run.keyframes[2].map, MapId(1));
  EXPECT_EQ(run.replica.NumKeyframes(MapId(0)), 0);
  EXPECT_EQ(run.replica.NumPoints(MapId(0)), 0);
  run.Finish();
  for (const auto& [seq, pose] : run.poses) {
    if (pose.state == TrackingState::kTracking && seq > blank) {
      EXPECT_EQ(pose.map, MapId(1));
    }
  }
  EXPECT_NE(run.poses.at(blank).state, TrackingState::kTracking);
  // Those after the blank image at least; those before it hang on the map that is gone, unless they
  // were placed in the new one.
  const auto index = [&](int64_t seq) { return static_cast<int>(seq < blank ? seq : seq - 1); };
  int count = 0;
  EXPECT_LT(Rmse(run, index, &count), 0.01);
  EXPECT_GE(count, 45 - blank);
}

TEST(Tracker, GivesUpMapAfterMap) {
  TrackerOptions options;
  options.local_map.min_inliers = 100000;  // no frame passes
  Lockstep run(options);
  run.Walk(0, 25);
  ASSERT_GE(run.keyframes.size(), 4u);
  for (size_t k = 0; k < run.keyframes.size(); k += 2) {
    const int map = static_cast<int>(k / 2);
    EXPECT_EQ(run.keyframes[k].map, MapId(map));
    EXPECT_EQ(run.keyframes[k].discarded_map, MapId(map - 1));
    EXPECT_EQ(run.keyframes[k + 1].role, KeyframeRole::kMapSecond);
    EXPECT_EQ(run.replica.NumKeyframes(MapId(map)), k + 2 == run.keyframes.size() ? 2 : 0);
  }
  for (const auto& [seq, pose] : run.poses) {
    // Nothing of the attempt to track it in the old map is left.
    EXPECT_TRUE(pose.covariance.isZero()) << seq;
  }
}

TEST(Tracker, FollowsAMapThatChangesUnderIt) {
  Lockstep run;
  run.Walk(0, 30);
  ASSERT_GE(run.replica.NumKeyframes(MapId(0)), 6);
  SE3 before;
  ASSERT_TRUE(run.PoseOf(29, &before));
  // From here on the replica plays the owner, as long as the tracker proposes nothing.
  OwnedMap owner(run.replica, 1);
  const KeyframeId reference = owner.LivingAncestor(run.poses.at(29).reference);
  const SE3 shift(ExpSo3({0.3, 0.2, -0.1}), {2, -1, 0.5});
  for (int i = 0; i < KeyframeEnd(owner); ++i) {
    const Keyframe* keyframe = owner.Find(KeyframeId(i));
    if (keyframe) owner.SetPose(keyframe->id, keyframe->cam_from_world * shift.Inverse());
  }
  std::vector<PointId> points;
  for (int i = 0; i < EndOf(owner.points()); ++i) {
    const MapPoint* point = owner.Find(PointId(i));
    if (!point) continue;
    points.push_back(point->id);
    const Eigen::Vector3d normal = shift.rotation * point->normal;
    owner.SetPosition(point->id, shift * point->position);
    owner.SetView(point->id, normal, point->max_distance);
  }
  // One in ten goes, and one in ten is replaced by a copy.
  for (size_t i = 0; i < points.size(); i += 10) owner.Erase(points[i]);
  for (size_t i = 5; i < points.size(); i += 10) {
    const MapPoint point = *owner.Find(points[i]);
    const PointId copy = owner.CreatePoint(MapId(0), point.reference, point.position);
    owner.SetView(copy, point.normal, point.max_distance);
    owner.SetDescriptor(copy, point.descriptor);
    owner.Fuse(point.id, copy);
  }
  if (owner.Find(reference)->parent.IsValid()) owner.Cull(reference);
  const std::vector<MapDelta> deltas = owner.TakeDeltas(KeyframeId(), {});
  // What does not continue the version at hand is refused.
  MapDelta later = deltas.front();
  later.base_version += 5;
  EXPECT_FALSE(run.tracker.Apply(later));
  EXPECT_EQ(run.tracker.map_version(), run.replica.version());
  run.Apply(deltas);
  SE3 after;
  ASSERT_TRUE(run.PoseOf(29, &after)) << "through the parent of what was culled";
  EXPECT_LT(LocalCoordinates(before * shift.Inverse(), after).norm(), 1e-6);

  ImageFrame frame;
  frame.frame_seq = 30;
  frame.pixels = ImageOf(30);
  const TrackerOutput output = run.tracker.Track(run.tracker.Extract(frame));
  const FramePose* pose = nullptr;
  for (const FramePose& p : output.poses) {
    if (p.frame_seq == 30) pose = &p;
  }
  ASSERT_TRUE(pose);
  ASSERT_EQ(pose->state, TrackingState::kTracking);
  const double step = (OnTheWay(30).Center() - OnTheWay(29).Center()).norm();
  const double unit = (OnTheWay(29).Center() - OnTheWay(20).Center()).norm();
  SE3 earlier;
  ASSERT_TRUE(run.PoseOf(20, &earlier));
  const double map_unit = (after.Center() - earlier.Center()).norm();
  EXPECT_NEAR((pose->cam_from_world.Center() - after.Center()).norm() / map_unit, step / unit,
              0.03);
  for (const KeyframeProposal& proposal : output.keyframes) {
    EXPECT_NE(proposal.reference, reference) << "culled";
    for (const PointId id : proposal.points) {
      EXPECT_TRUE(!id.IsValid() || run.replica.Find(id)) << "erased or fused";
    }
  }
}

TEST(Tracker, ASnapshotReplacesTheReplica) {
  Lockstep run;
  run.Walk(0, 25);
  ASSERT_FALSE(run.keyframes.empty());
  for (const MapDelta& delta : run.mapper.Snapshot()) EXPECT_TRUE(run.tracker.Apply(delta));
  EXPECT_EQ(run.tracker.map_version(), run.mapper.version());
  EXPECT_EQ(run.Track(ImageOf(25)).state, TrackingState::kTracking);
}

TEST(Tracker, SameInputSameBytes) {
  const auto run = [] {
    Lockstep lockstep;
    lockstep.Walk(0, 22);
    lockstep.Track(Room().Blank());
    lockstep.Walk(22, 26);
    lockstep.Finish();
    return lockstep.bytes;
  };
  const std::string once = run();
  EXPECT_GT(once.size(), 100000u);
  EXPECT_EQ(once, run());
}

}  // namespace
}  // namespace vpslam
