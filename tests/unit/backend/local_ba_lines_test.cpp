#include <gtest/gtest.h>

#include "backend/ba_window.h"
#include "backend/culling.h"
#include "backend/local_ba.h"
#include "core/geometry/sphere.h"
#include "tests/unit/synthetic_lines.h"

namespace vpslam {
namespace {

const LocalBaOptions kThorough{.max_iterations = 50, .function_tolerance = 1e-10};
const ManhattanFrames kNoAxes{ManhattanOptions()};

std::vector<KeyframeId> Ids(std::initializer_list<int> values) {
  std::vector<KeyframeId> ids;
  for (const int v : values) ids.emplace_back(v);
  return ids;
}

BaSummary Adjust(SyntheticLineMap& m, const LocalBaOptions& options = kThorough) {
  return AdjustLocally(m.map.Context(), m.last(), kNoAxes, options, options.max_iterations);
}

void AddLines(SyntheticLineMap& m, int min_views, double sigma) {
  for (const int l : m.SeenBy(min_views)) {
    const SyntheticLine& truth = m.lines.lines[l];
    m.AddLine(l, truth.start + m.scene.NormalVector(sigma), truth.end + m.scene.NormalVector(sigma),
              m.AllKeyframes());
  }
}

double MeanError(const SyntheticLineMap& m) {
  double sum = 0;
  for (const LineId id : m.Lines()) {
    sum += LineError(*m.map.map.Find(id), m.lines.lines[m.TruthOf(id)]);
  }
  return sum / static_cast<double>(m.Lines().size());
}

double PoseError(const SyntheticLineMap& m, KeyframeId k) {
  return LocalCoordinates(m.map.views.at(k).cam_from_world, m.map.map.Find(k)->cam_from_world)
      .norm();
}

TEST(LocalBaLines, ErrorsBecomeLessAndWhatIsLeftIsTheNoise) {
  SyntheticLineMap m(1, {}, PosesSideBySide(6));
  AddLines(m, 3, 0.12);
  const auto lines = static_cast<int>(m.Lines().size());
  ASSERT_GT(lines, 15);
  int line_observations = 0;
  for (const LineId id : m.Lines()) {
    line_observations += static_cast<int>(m.map.map.Find(id)->observations.size());
  }
  const double before = MeanError(m);
  const BaSummary summary = Adjust(m);
  // Measurements less what they determine; one gauge remains, the scale.
  const double freedom = 2.0 * summary.observations + 2.0 * line_observations - 6 * 5 -
                         3.0 * summary.points - 4.0 * lines + 1;
  EXPECT_NEAR(2 * summary.final_cost, freedom, 4 * std::sqrt(2 * freedom));
  EXPECT_LT(MeanError(m), 0.7 * before);
}

TEST(LocalBaLines, LinesMakeAPoseBetterWherePointsAreFew) {
  double with = 0, without = 0;
  for (uint64_t seed = 0; seed < 6; ++seed) {
    for (const bool use_lines : {false, true}) {
      SyntheticLineMap m(seed, {.num_free = 100}, PosesSideBySide(4), {.num_points = 30});
      if (use_lines) AddLines(m, 3, 0);
      const KeyframeId k = m.last();
      m.map.map.SetPose(k, m.scene.Disturbed(m.map.map.Find(k)->cam_from_world, 0.02, 0.005));
      LocalBaOptions options = kThorough;
      options.max_keyframes = 1;
      Adjust(m, options);
      (use_lines ? with : without) += PoseError(m, k);
    }
  }
  EXPECT_LT(with, 0.8 * without);
}

TEST(LocalBaLines, WrongObservationsAreThrownOut) {
  SyntheticLineMap m(2, {.num_free = 120}, PosesSideBySide(6, 0.2));
  AddLines(m, 5, 0.02);
  std::set<std::pair<KeyframeId, LineId>> wrong;
  int total = 0;
  for (const LineId id : m.Lines()) {
    const auto& observations = m.map.map.Find(id)->observations;
    total += static_cast<int>(observations.size());
    if (id.value % 3) continue;
    const Observation& o = observations[1];
    LineSegment& s = m.Segment(o.keyframe, o.feature);
    const Eigen::Vector2f u = (s.end_px - s.start_px).normalized();
    s.start_px += 12 * Eigen::Vector2f(-u.y(), u.x());
    wrong.insert({o.keyframe, id});
  }
  ASSERT_GT(wrong.size(), 4u);
  const BaSummary summary = Adjust(m);
  EXPECT_GE(summary.outliers, static_cast<int>(wrong.size()));
  int left = 0;
  for (const LineId id : m.Lines()) {
    for (const Observation& o : m.map.map.Find(id)->observations) {
      ++left;
      EXPECT_FALSE(wrong.contains({o.keyframe, id}));
      EXPECT_EQ(m.map.map.Find(o.keyframe)->lines.at(o.feature), id);
    }
  }
  EXPECT_GT(left, 0.85 * (total - static_cast<int>(wrong.size())));
}

TEST(LocalBaLines, WhatCameTooNearIsLetGo) {
  // The points are 3 m away and more.
  for (const int axis : {-1, 1}) {
    for (const double depth : {0.4, 1.0}) {
      SyntheticLineMap m(4, {.num_free = 0}, {});
      for (int i = 0; i < 8; ++i) {
        const int l =
            m.lines.Add({depth * (-0.25 + 0.05 * i), 0, depth}, Eigen::Vector3d::UnitY(), axis);
        m.lines.lines[l].start.y() = -0.2 * depth;
        m.lines.lines[l].end.y() = 0.2 * depth;
      }
      for (const double x : {0.0, 0.15, 0.3}) m.AddKeyframe(PoseAt({depth * x, 0, 0}));
      m.map.AddPoints(0, 200);
      for (const int l : m.SeenBy(3)) m.AddLine(l, m.AllKeyframes());
      ASSERT_GT(m.Lines().size(), 4u);
      m.SetAxes(Eigen::Quaterniond::Identity());
      Adjust(m);
      EXPECT_EQ(m.Lines().empty(), depth < 0.5 && axis < 0) << depth << " " << axis;
    }
  }
}

TEST(LocalBaLines, TwoViewsWithoutDirectionMoveNothing) {
  SyntheticLineMap m(3, {.noise_sigmas = 0}, PosesSideBySide(3));
  for (const int l : m.SeenBy(3)) {
    const SyntheticLine& truth = m.lines.lines[l];
    const Eigen::Vector3d off(0, 0.002, 0.002);  // within what observations allow
    m.AddLine(l, truth.start + off, truth.end + off, Ids({1, 2}));
  }
  ASSERT_GT(m.Lines().size(), 5u);
  const Map before = m.map.map;
  Adjust(m);
  EXPECT_GT(m.Lines().size(), 3u);
  for (const LineId id : m.Lines()) {
    const MapLine& was = *before.Find(id);
    const MapLine& is = *m.map.map.Find(id);
    EXPECT_LT(was.Direction().cross(is.start - was.start).norm(), 1e-9);
    EXPECT_LT(was.Direction().cross(is.end - was.start).norm(), 1e-9);
  }
}

TEST(LocalBaLines, AnAxisHoldsALinesDirection) {
  double before = 0, after = 0;
  int n = 0;
  SyntheticLineMap m(4, {.num_free = 0, .num_per_axis = 15}, PosesSideBySide(3));
  m.SetAxes();
  for (const int l : m.SeenBy(2)) {
    const SyntheticLine& truth = m.lines.lines[l];
    m.AddLine(l, truth.start + m.scene.NormalVector(0.03), truth.end + m.scene.NormalVector(0.03),
              Ids({1, 2}));
  }
  const auto angle = [&](LineId id) {
    const SyntheticLine& truth = m.lines.lines[m.TruthOf(id)];
    return AxisAngle_rad(m.map.map.Find(id)->Direction(), (truth.end - truth.start).normalized());
  };
  std::map<LineId, double> start;
  for (const LineId id : m.Lines()) start[id] = angle(id);
  ASSERT_GT(start.size(), 8u);
  LocalBaOptions options = kThorough;
  options.direction_sigma_deg = 0.05;
  Adjust(m, options);
  for (const LineId id : m.Lines()) {
    before += start.at(id);
    after += angle(id);
    ++n;
  }
  ASSERT_GT(n, 5);
  EXPECT_LT(after, 0.1 * before);
}

TEST(LocalBaLines, EndsAreTrimmedToWhatIsSeen) {
  SyntheticLineMap m(5, {.noise_sigmas = 0.2, .cut_share = 0}, PosesSideBySide(4, 0.2));
  for (const int l : m.SeenBy(4)) {
    const SyntheticLine& truth = m.lines.lines[l];
    const Eigen::Vector3d along = truth.end - truth.start;
    m.AddLine(l, truth.start - along, truth.end + along, m.AllKeyframes());
  }
  ASSERT_GT(m.Lines().size(), 5u);
  Adjust(m);
  for (const LineId id : m.Lines()) {
    const MapLine& line = *m.map.map.Find(id);
    const SyntheticLine& truth = m.lines.lines[m.TruthOf(id)];
    EXPECT_NEAR((line.end - line.start).norm() / (truth.end - truth.start).norm(), 1, 0.15);
  }
}

TEST(BaWindow, LinesBindKeyframesAsPointsDo) {
  SyntheticLineMap m(6, {}, PosesSideBySide(5, 0.2), {.num_points = 0});
  const std::vector<int> seen = m.SeenBy(5);
  ASSERT_GT(seen.size(), 8u);
  for (size_t i = 0; i < seen.size(); ++i) {
    m.AddLine(seen[i], i < 6 ? Ids({3, 4}) : i < 8 ? Ids({2, 4}) : Ids({0, 1}));
  }
  const BaWindow window =
      ChooseBaWindow(KeyframeId(4), {.min_fixed_keyframes = 1, .min_shared_points = 5}, m.map.map);
  EXPECT_EQ(window.moved, (std::set<KeyframeId>{KeyframeId(3), KeyframeId(4)}));
  EXPECT_EQ(window.fixed, (std::set<KeyframeId>{KeyframeId(2)}));
  EXPECT_EQ(window.lines.size(), 8u) << "not what others see alone";
  EXPECT_TRUE(window.points.empty());
}

TEST(LineProbation, TwoObservationsDoNotLast) {
  SyntheticLineMap m(7, {}, PosesSideBySide(4, 0.2));
  const std::vector<int> seen = m.SeenBy(4);
  const LineId two = m.AddLine(seen[0], Ids({0, 1})), three = m.AddLine(seen[1], Ids({0, 1, 2}));
  const LineId unknown = m.AddLine(seen[2], Ids({0, 1})), gone = m.AddLine(seen[3], Ids({0, 1}));
  LineProbation probation({});
  for (const LineId id : {two, three, gone}) probation.Add(id, 10);
  m.map.map.Erase(gone);
  probation.Cull(11, &m.map.map);
  EXPECT_NE(m.map.map.Find(two), nullptr) << "it has time yet";
  probation.Cull(12, &m.map.map);
  EXPECT_EQ(m.map.map.Find(two), nullptr);
  EXPECT_NE(m.map.map.Find(three), nullptr);
  EXPECT_NE(m.map.map.Find(unknown), nullptr) << "never on probation";
  // Who passed is left alone.
  m.map.map.Unobserve(KeyframeId(2), three);
  probation.Cull(13, &m.map.map);
  EXPECT_NE(m.map.map.Find(three), nullptr);
}

TEST(CullKeyframes, ACulledKeyframeUnobservesItsLines) {
  SyntheticLineMap m(8, {}, PosesSideBySide(4, 0.2));
  const std::vector<int> seen = m.SeenBy(4);
  const LineId two = m.AddLine(seen[0], Ids({1, 2})), three = m.AddLine(seen[1], Ids({1, 2, 3}));
  m.map.map.Cull(KeyframeId(2));
  EXPECT_EQ(m.map.map.Find(two), nullptr) << "one view is none";
  ASSERT_NE(m.map.map.Find(three), nullptr);
  EXPECT_EQ(m.map.map.Find(three)->observations.size(), 2u);
  for (const Observation& o : m.map.map.Find(three)->observations) {
    EXPECT_NE(o.keyframe, KeyframeId(2));
  }
  EXPECT_TRUE(m.map.map.Find(KeyframeId(2)) == nullptr);
}

}  // namespace
}  // namespace vpslam
