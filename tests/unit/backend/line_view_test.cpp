#include "backend/line_view.h"

#include <gtest/gtest.h>

#include "core/geometry/sphere.h"
#include "tests/unit/synthetic_lines.h"

namespace vpslam {
namespace {

TEST(ViewSegment, RaysMeetTheLineThatIsSeen) {
  SyntheticLineMap m(1, {.noise_sigmas = 0}, PosesSideBySide(2));
  const KeyframeId k(1);
  const SE3& pose = m.map.map.Find(k)->cam_from_world;
  ASSERT_GT(m.segments.at(k).line.size(), 10u);
  for (size_t i = 0; i < m.segments.at(k).line.size(); ++i) {
    const LineView view = ViewSegment(m.Segment(k, static_cast<int>(i)), pose, m.scene.camera);
    const SyntheticLine& truth = m.lines.lines[m.segments.at(k).line[i]];
    EXPECT_NEAR((view.center - pose.Center()).norm(), 0, 1e-12);
    EXPECT_NEAR(view.start_ray.norm(), 1, 1e-12);
    // Single precision of pixels; a segment is a tenth long at least.
    EXPECT_NEAR(view.Normal().dot((truth.start - view.center).normalized()), 0, 1e-4);
    EXPECT_NEAR(view.Normal().dot((truth.end - view.center).normalized()), 0, 1e-4);
    EXPECT_GT(view.start_ray.dot(truth.start - view.center), 0);
  }
}

TEST(IsTooNear, AskedOfTheFarEndAndOfLinesWithoutAnAxis) {
  MapLine line;
  line.start = {0.1, 0, -2};
  line.end = {0.1, 0, 0.5};
  const SE3 cam_from_world = PoseAt({0, 0, -0.5});
  EXPECT_FALSE(IsTooNear(line, cam_from_world, 0.9)) << "one end may lie behind the camera";
  EXPECT_TRUE(IsTooNear(line, cam_from_world, 1.1));
  std::swap(line.start, line.end);
  EXPECT_TRUE(IsTooNear(line, cam_from_world, 1.1));
  line.axis = 2;
  EXPECT_FALSE(IsTooNear(line, cam_from_world, 1.1));
}

TEST(AxisOf, IsTheAxisOfTheMapWhateverTheDetectorCallsIt) {
  SyntheticLineMap m(2, {.num_free = 10, .num_per_axis = 15}, PosesSideBySide(2));
  const KeyframeId k(1);
  const Keyframe& keyframe = *m.map.map.Find(k);
  LineSet set = m.segments.at(k).set;
  const auto expect_axes = [&](const std::array<int, 3>& name) {
    for (size_t i = 0; i < set.lines.size(); ++i) {
      const int axis = m.lines.lines[m.segments.at(k).line[i]].axis;
      EXPECT_EQ(AxisOf(set.lines[i], set, keyframe, m.map.map), axis < 0 ? -1 : name[axis]);
    }
  };
  expect_axes({-1, -1, -1});  // the map has no frame
  m.SetAxes();
  expect_axes({0, 1, 2});
  // The image names its axes differently, and some point the other way.
  std::swap(set.vanishing_points[0], set.vanishing_points[2]);
  for (LineSegment& s : set.lines) {
    if (s.label >= 0) s.label = 2 - s.label;
  }
  set.vanishing_points[1].direction_in_cam *= -1;
  set.vanishing_points[2].direction_in_cam *= -1;
  expect_axes({0, 1, 2});
  // The map's frame has other names: its y is what was x.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  m.SetAxes(m.lines.world_from_manhattan * turn);
  expect_axes({1, 0, 2});
}

TEST(AxisOf, ADirectionOfItsOwnIsNoAxis) {
  SyntheticLineMap m(3, {.num_free = 0, .num_per_axis = 10}, PosesSideBySide(2));
  const KeyframeId k(0);
  LineSet set = m.segments.at(k).set;
  const auto axis_when_turned = [&](double deg) {
    m.SetAxes(ExpSo3({0, 0, deg * M_PI / 180}) * m.lines.world_from_manhattan);
    LineSegment s;
    s.label = 0;
    return AxisOf(s, set, *m.map.map.Find(k), m.map.map);
  };
  EXPECT_EQ(axis_when_turned(3), 0);
  EXPECT_EQ(axis_when_turned(8), -1);
  EXPECT_EQ(axis_when_turned(-8), -1);
}

TEST(AxisDirection, IsTheColumnOfTheFrame) {
  SyntheticLineMap m(4, {.num_per_axis = 2}, PosesSideBySide(2));
  m.SetAxes();
  for (const SyntheticLine& line : m.lines.lines) {
    if (line.axis < 0) continue;
    EXPECT_NEAR(AxisAngle_rad(AxisDirection(line.axis, m.SetAxes(), m.map.map),
                              (line.end - line.start).normalized()),
                0, 1e-9);
  }
}

/// How far from the true line's start, along it.
double Along(const Eigen::Vector3d& x, const SyntheticLine& truth) {
  return (x - truth.start).dot((truth.end - truth.start).normalized());
}

TEST(UpdateEnds, AreTrimmedToWhatIsSeen) {
  SyntheticLineMap m(5, {.noise_sigmas = 0, .cut_share = 0.2}, PosesSideBySide(3));
  int done = 0;
  for (const int l : m.SeenBy(3)) {
    const SyntheticLine& truth = m.lines.lines[l];
    const Eigen::Vector3d along = truth.end - truth.start;
    // Ends far too wide, and far too narrow.
    for (const double grow : {2.0, -0.45}) {
      const LineId id =
          m.AddLine(l, truth.start - grow * along, truth.end + grow * along, m.AllKeyframes());
      UpdateEnds(id, m.scene.camera, &m.map.map);
      double from = 1e9, to = -1e9;
      for (const Observation& o : m.map.map.Find(id)->observations) {
        const LineView view =
            ViewSegment(m.Segment(o.keyframe, o.feature),
                        m.map.map.Find(o.keyframe)->cam_from_world, m.scene.camera);
        for (const auto& ray : {view.start_ray, view.end_ray}) {
          const auto s = NearestOnLine(truth.start, along.normalized(), view.center, ray);
          if (!s) continue;
          from = std::min(from, *s);
          to = std::max(to, *s);
        }
      }
      const MapLine& line = *m.map.map.Find(id);
      EXPECT_LT(LineError(line, truth), 1e-9) << "moved along itself alone";
      // Of three views that which shows most at either end.
      EXPECT_NEAR(Along(line.start, truth), from, 1e-6);
      EXPECT_NEAR(Along(line.end, truth), to, 1e-6);
      EXPECT_GE(from, -0.02);
      EXPECT_LE(to, along.norm() + 0.02);
      m.map.map.Erase(id);
      ++done;
    }
  }
  EXPECT_GT(done, 20);
}

TEST(UpdateEnds, OneViewOfManyDoesNotMakeALineLong) {
  // In one of eight views the edge was joined with the next one.
  SyntheticLineMap m(6, {.noise_sigmas = 0, .cut_share = 0.05}, PosesSideBySide(8, 0.15));
  int done = 0;
  for (const int l : m.SeenBy(8)) {
    const LineId id = m.AddLine(l, m.AllKeyframes());
    LineSegment& s = m.Segment(KeyframeId(3), m.segments.at(KeyframeId(3)).SegmentOf(l));
    s.end_px += 1.0f * (s.end_px - s.start_px);
    UpdateEnds(id, m.scene.camera, &m.map.map);
    const SyntheticLine& truth = m.lines.lines[l];
    const double length = (truth.end - truth.start).norm();
    EXPECT_LT(Along(m.map.map.Find(id)->end, truth), 1.02 * length);
    EXPECT_GT(Along(m.map.map.Find(id)->end, truth), 0.9 * length);
    ++done;
  }
  EXPECT_GT(done, 5);
}

TEST(UpdateDescriptor, IsTheMostCentral) {
  SyntheticLineMap m(7, {}, PosesSideBySide(5, 0.2));
  const int l = m.SeenBy(5).at(0);
  const LineId id = m.AddLine(l, m.AllKeyframes());
  // One is far off, and one the same as the true one.
  LineSegment& off = m.Segment(KeyframeId(1), m.segments.at(KeyframeId(1)).SegmentOf(l));
  for (uint64_t& word : off.descriptor) word = ~word;
  LineSegment& exact = m.Segment(KeyframeId(3), m.segments.at(KeyframeId(3)).SegmentOf(l));
  exact.descriptor = m.lines.lines[l].descriptor;
  m.map.map.SetDescriptor(id, Descriptor{});
  UpdateDescriptor(id, &m.map.map);
  EXPECT_EQ(m.map.map.Find(id)->descriptor, m.lines.lines[l].descriptor);
}

TEST(Fits, NineteenOfTwentyWithinTheNoiseAndNothingElse) {
  int fit = 0, total = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    SyntheticLineMap m(100 + seed, {.num_free = 200}, PosesSideBySide(2), {.num_points = 5});
    for (const int l : m.SeenBy(2)) {
      MapLine line;
      line.start = m.lines.lines[l].start;
      line.end = m.lines.lines[l].end;
      for (const KeyframeId k : m.AllKeyframes()) {
        const SE3& pose = m.map.map.Find(k)->cam_from_world;
        LineSegment segment = m.Segment(k, m.segments.at(k).SegmentOf(l));
        fit += Fits(line, pose, segment, m.scene.camera);
        ++total;
        const Eigen::Vector2f u = (segment.end_px - segment.start_px).normalized();
        segment.start_px += 6 * Eigen::Vector2f(-u.y(), u.x());
        EXPECT_FALSE(Fits(line, pose, segment, m.scene.camera));
      }
    }
  }
  ASSERT_GT(total, 500);
  EXPECT_NEAR(static_cast<double>(fit) / total, 0.95, 4 * std::sqrt(0.95 * 0.05 / total));
}

TEST(Fits, NotBehindTheCamera) {
  const Camera camera = SyntheticScene(1).camera;
  MapLine line;
  line.start = {-1, 0.5, 4};
  line.end = {1, 0.5, 4};
  LineSegment segment;
  segment.start_px = camera.Project(line.start).cast<float>();
  segment.end_px = camera.Project(line.end).cast<float>();
  EXPECT_TRUE(Fits(line, SE3(), segment, camera));
  line.start *= -1;
  line.end *= -1;
  EXPECT_FALSE(Fits(line, SE3(), segment, camera));
}

}  // namespace
}  // namespace vpslam
