#include "frontend/line_tracking.h"

#include <algorithm>
#include <set>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/unit/synthetic_lines.h"

namespace vpslam {
namespace {

const double kWindow_px = LineTrackingOptions().window_px;

/// Three keyframes that know all lines that two of them show, and frames that look at them.
class LineTracking : public testing::Test {
 protected:
  explicit LineTracking(const SyntheticLineOptions& options = {.num_free = 80})
      : m_(1, options, PosesSideBySide(3, 0.2)) {
    for (const int l : m_.SeenBy(2)) {
      const LineId id = m_.AddLine(l, m_.AllKeyframes());
      ids_.push_back(id);
      id_of_[l] = id;
    }
  }
  TrackingContext context() const {
    return {m_.scene.camera, m_.scene.bounds, m_.scene.scales, m_.map.map};
  }
  /// With its true pose and no match.
  Frame Look(const SE3& pose) {
    seen_ = m_.lines.Look(m_.scene.camera, pose);
    return Seeing(seen_.set, pose);
  }
  Frame Seeing(const LineSet& lines, const SE3& pose) const {
    Frame frame;
    frame.seen = FrameObservation::Make(0, 0, Features(), m_.scene.bounds,
                                        std::make_shared<const LineSet>(lines));
    frame.PlaceIn(MapId(0), pose);
    return frame;
  }
  /// Matches with the lines that the segments show.
  void MatchAll(Frame* frame) const {
    for (size_t i = 0; i < seen_.line.size(); ++i) {
      const auto at = id_of_.find(seen_.line[i]);
      if (at != id_of_.end()) Match(i, at->second, frame);
    }
  }
  void Match(size_t segment, LineId id, Frame* frame) const {
    frame->placement.Match(static_cast<int>(segment), *m_.map.map.Find(id));
  }
  int NumMatched(const Frame& frame) const {
    const std::vector<LineId>& lines = frame.placement.lines();
    return static_cast<int>(
        std::count_if(lines.begin(), lines.end(), [](LineId id) { return id.IsValid(); }));
  }
  int NumWrong(const Frame& frame) const {
    int wrong = 0;
    const std::vector<LineId>& lines = frame.placement.lines();
    for (size_t i = 0; i < lines.size(); ++i) {
      wrong += lines[i].IsValid() && m_.TruthOf(lines[i]) != seen_.line[i];
    }
    return wrong;
  }

  SyntheticLineMap m_;
  std::vector<LineId> ids_;
  std::map<int, LineId> id_of_;
  SyntheticSegments seen_;
  const SE3 pose_ = PoseAt({0.25, 0.1, 0.05}, {0.01, -0.02, 0});
};

TEST_F(LineTracking, FindsTheLinesAgainEachOnce) {
  Frame frame = Look(pose_);
  Frame all = frame;
  MatchAll(&all);
  ASSERT_GT(NumMatched(all), 10);
  // The pose is known to 2 px.
  frame.placement.cam_from_world =
      Retract(pose_, (Vector6d() << 0, 0, 0, 0.003, -0.003, 0).finished());
  // Asked for more than once, it is found once.
  std::vector<LineId> twice = ids_;
  twice.insert(twice.end(), ids_.begin(), ids_.end());
  const int count = MatchLines(context(), twice, kWindow_px, {}, &frame);
  EXPECT_EQ(count, NumMatched(frame));
  EXPECT_GT(count, 0.85 * NumMatched(all));
  EXPECT_EQ(NumWrong(frame), 0);
  std::set<LineId> different(frame.placement.lines().begin(), frame.placement.lines().end());
  different.erase(LineId());
  EXPECT_EQ(static_cast<int>(different.size()), count);
  EXPECT_EQ(MatchLines(context(), ids_, kWindow_px, {}, &frame), 0) << "all are found already";
}

TEST_F(LineTracking, ALineOfTwoSegmentsIsMatchedOnce) {
  Frame frame = Look(pose_);
  LineSet set = *frame.seen->lines;
  // Every segment is there twice: an edge that was found at two scales.
  const size_t n = set.lines.size();
  for (size_t i = 0; i < n; ++i) {
    set.lines.push_back(set.lines[i]);
    seen_.line.push_back(seen_.line[i]);
  }
  frame = Seeing(set, pose_);
  std::vector<LineId> twice = ids_;
  twice.insert(twice.end(), ids_.begin(), ids_.end());
  const int count = MatchLines(context(), twice, kWindow_px, {}, &frame);
  EXPECT_GT(count, 8);
  std::map<LineId, int> times;
  for (const LineId id : frame.placement.lines()) {
    if (id.IsValid()) ++times[id];
  }
  for (const auto& [id, count_of] : times) EXPECT_EQ(count_of, 1);
}

TEST_F(LineTracking, TheWindowLimits) {
  Frame frame = Look(pose_);
  frame.placement.cam_from_world =
      Retract(pose_, (Vector6d() << 0, 0, 0, 0.02, -0.02, 0).finished());  // 15 px
  Frame wide = frame;
  const int narrow_count = MatchLines(context(), ids_, kWindow_px, {}, &frame);
  const int wide_count = MatchLines(context(), ids_, 4 * kWindow_px, {}, &wide);
  EXPECT_LT(narrow_count, 0.5 * wide_count);
  EXPECT_GT(wide_count, 8);
}

TEST_F(LineTracking, SegmentsAndLinesThatAreMatchedStaySo) {
  Frame frame = Look(pose_);
  MatchAll(&frame);
  const std::vector<LineId> before = frame.placement.lines();
  // The first match is with another line: it keeps its segment, and is not looked for elsewhere.
  std::vector<size_t> matched;
  for (size_t i = 0; i < before.size(); ++i) {
    if (before[i].IsValid()) matched.push_back(i);
  }
  ASSERT_GT(matched.size(), 3u);
  Match(matched[0], before[matched[1]], &frame);
  for (const size_t i : {matched[1], matched[2]}) {
    frame.placement.UnmatchLine(static_cast<int>(i));
  }
  EXPECT_EQ(MatchLines(context(), ids_, kWindow_px, {}, &frame), 1);
  EXPECT_EQ(frame.placement.lines()[matched[0]], before[matched[1]]);
  EXPECT_FALSE(frame.placement.lines()[matched[1]].IsValid());
  EXPECT_EQ(frame.placement.lines()[matched[2]], before[matched[2]]);
}

TEST_F(LineTracking, LinesThatAreGoneAreNotLookedFor) {
  Frame frame = Look(pose_);
  for (const LineId id : ids_) m_.map.map.Erase(id);
  EXPECT_EQ(MatchLines(context(), ids_, kWindow_px, {}, &frame), 0);
  EXPECT_EQ(MatchLines(context(), {LineId(), LineId(9999)}, kWindow_px, {}, &frame), 0);
}

TEST_F(LineTracking, WithoutLinesOrSwitchedOffNothingHappens) {
  Frame frame = Look(pose_);
  EXPECT_EQ(MatchLines(context(), ids_, kWindow_px, {.enabled = false}, &frame), 0);
  EXPECT_EQ(NumMatched(frame), 0);
  frame.seen = FrameObservation::Make(0, 0, Features(), m_.scene.bounds);
  frame.PlaceIn(MapId(0), pose_);
  EXPECT_EQ(MatchLines(context(), ids_, kWindow_px, {}, &frame), 0);
}

TEST_F(LineTracking, LivingLinesAreWhatTheyHaveBecome) {
  m_.map.map.Erase(ids_[0]);
  m_.map.map.Fuse(ids_[1], ids_[2]);
  EXPECT_EQ(LivingLines(m_.map.map, {ids_[3], LineId(), ids_[0], ids_[1], ids_[2], ids_[3]}),
            (std::vector<LineId>{ids_[2], ids_[3]}));
  EXPECT_TRUE(LivingLines(m_.map.map, {}).empty());
}

TEST_F(LineTracking, MeasuresTellWhatTheSegmentsAre) {
  Frame frame = Look(pose_);
  MatchAll(&frame);
  const LineId gone = ids_[0];
  m_.map.map.Erase(gone);
  std::vector<int> features, segments;
  const PoseMeasurements measured = Measure(context(), &frame, &features, &segments);
  EXPECT_TRUE(features.empty());
  ASSERT_EQ(measured.lines.size(), segments.size());
  EXPECT_EQ(static_cast<int>(segments.size()), NumMatched(frame)) << "what is gone is no match";
  ASSERT_GT(segments.size(), 8u);
  for (size_t i = 0; i < segments.size(); ++i) {
    const LineSegment& s = frame.seen->segments()[segments[i]];
    const MapLine& line = *m_.map.map.Find(frame.placement.lines()[segments[i]]);
    EXPECT_NE(line.id, gone);
    EXPECT_EQ(measured.lines[i].start_in_world, line.start);
    EXPECT_EQ(measured.lines[i].end_in_world, line.end);
    EXPECT_EQ(measured.lines[i].start_px, s.start_px.cast<double>());
    EXPECT_EQ(measured.lines[i].end_px, s.end_px.cast<double>());
    EXPECT_NEAR(measured.lines[i].inv_sigma2, std::pow(LineSigma_px(s.sigma_px), -2), 1e-9);
  }
}

TEST_F(LineTracking, PoseFromLinesWithinItsCovarianceAndWrongOnesGone) {
  double sum = 0;
  int n = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Frame frame = Look(pose_);
    MatchAll(&frame);
    std::vector<size_t> matched;
    const std::vector<LineId> lines = frame.placement.lines();
    for (size_t i = 0; i < lines.size(); ++i) {
      if (lines[i].IsValid()) matched.push_back(i);
    }
    ASSERT_GT(matched.size(), 10u);
    Match(matched[0], lines[matched[1]], &frame);
    Match(matched[1], lines[matched[0]], &frame);
    frame.placement.cam_from_world = m_.scene.Disturbed(pose_, 0.01, 0.003);
    OptimizeFrame(context(), {}, &frame);
    EXPECT_EQ(frame.placement.inliers, 0);
    EXPECT_EQ(frame.placement.line_inliers, NumMatched(frame));
    EXPECT_GE(frame.placement.line_inliers, static_cast<int>(0.7 * matched.size()));
    EXPECT_EQ(frame.placement.Support(), frame.placement.line_inliers);
    EXPECT_LE(NumWrong(frame), 1);
    const Vector6d e = LocalCoordinates(frame.placement.cam_from_world, pose_);
    sum += std::min(60.0, e.dot(frame.placement.covariance.ldlt().solve(e)));
    ++n;
  }
  // Chi-square with six degrees of freedom: the mean of 40 has a standard deviation of 0.55; some
  // good ones are gated away with few lines.
  EXPECT_NEAR(sum / n, 6.5, 2.5);
}

}  // namespace
}  // namespace vpslam
