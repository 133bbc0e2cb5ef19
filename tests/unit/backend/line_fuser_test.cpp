#include "backend/line_fuser.h"

#include <gtest/gtest.h>

#include "tests/unit/synthetic_lines.h"

namespace vpslam {
namespace {

void Fuse(SyntheticLineMap& m) { FuseLines(m.map.Context(), m.last(), {}); }

std::vector<KeyframeId> Ids(std::initializer_list<int> values) {
  std::vector<KeyframeId> ids;
  for (const int v : values) ids.emplace_back(v);
  return ids;
}

size_t NumObservations(const SyntheticLineMap& m, LineId id) {
  return m.map.map.Find(id)->observations.size();
}

TEST(LineFuser, DuplicatesAreJoinedAndTheBetterKnownStays) {
  SyntheticLineMap m(1, {.noise_sigmas = 0.3}, PosesSideBySide(5, 0.2));
  std::vector<std::pair<LineId, LineId>> pairs;
  for (const int l : m.SeenBy(5)) {
    const LineId two = m.AddLine(l, Ids({0, 1})), three = m.AddLine(l, Ids({2, 3, 4}));
    pairs.emplace_back(two, three);
  }
  ASSERT_GT(pairs.size(), 5u);
  Fuse(m);
  for (const auto& [two, three] : pairs) {
    EXPECT_EQ(m.map.map.Find(two), nullptr);
    EXPECT_EQ(m.map.map.Resolve(two), three);
    ASSERT_NE(m.map.map.Find(three), nullptr);
    EXPECT_EQ(NumObservations(m, three), 5u);
    EXPECT_GE(m.TruthOf(three), 0);
  }
}

TEST(LineFuser, NeighboursThatShowALineObserveIt) {
  SyntheticLineMap m(2, {.noise_sigmas = 0.3}, PosesSideBySide(4, 0.2));
  std::vector<LineId> of_new, of_others;
  for (const int l : m.SeenBy(4)) {
    (l % 2 ? of_new : of_others).push_back(m.AddLine(l, l % 2 ? Ids({2, 3}) : Ids({0, 1})));
  }
  ASSERT_GT(of_new.size(), 2u);
  ASSERT_GT(of_others.size(), 2u);
  Fuse(m);
  for (const LineId id : of_new) EXPECT_EQ(NumObservations(m, id), 4u);
  // What others know is looked for in the new keyframe, not in one another.
  for (const LineId id : of_others) EXPECT_EQ(NumObservations(m, id), 3u);
  for (const LineId id : m.Lines()) {
    EXPECT_GE(m.TruthOf(id), 0);
    const MapLine& line = *m.map.map.Find(id);
    EXPECT_LT(LineError(line, m.lines.lines[m.TruthOf(id)]), 1e-9) << "ends move along it alone";
  }
}

TEST(LineFuser, EndsGrowToWhatIsSeen) {
  SyntheticLineMap m(3, {.noise_sigmas = 0, .cut_share = 0}, PosesSideBySide(4, 0.2));
  std::vector<LineId> ids;
  for (const int l : m.SeenBy(4)) {
    const SyntheticLine& truth = m.lines.lines[l];
    const Eigen::Vector3d along = truth.end - truth.start;
    ids.push_back(m.AddLine(l, truth.start + 0.3 * along, truth.end, Ids({0, 1})));
  }
  Fuse(m);
  for (const LineId id : ids) {
    const SyntheticLine& truth = m.lines.lines[m.TruthOf(id)];
    EXPECT_NEAR((m.map.map.Find(id)->start - truth.start).norm(), 0, 0.02);
  }
}

TEST(LineFuser, WhatDoesNotFitIsNotJoined) {
  for (const double off_px : {0.0, 3.0}) {
    SyntheticLineMap m(4, {.noise_sigmas = 0}, PosesSideBySide(3, 0.2));
    std::vector<LineId> ids;
    for (const int l : m.SeenBy(3)) ids.push_back(m.AddLine(l, Ids({0, 1})));
    ASSERT_GT(ids.size(), 5u);
    // Within the window of the search, but beyond the gate.
    for (LineSegment& s : m.map.LinesOf(m.last()).lines) {
      const Eigen::Vector2f u = (s.end_px - s.start_px).normalized();
      const Eigen::Vector2f shift = static_cast<float>(off_px) * Eigen::Vector2f(-u.y(), u.x());
      s.start_px += shift;
      s.end_px += shift;
    }
    Fuse(m);
    for (const LineId id : ids) EXPECT_EQ(NumObservations(m, id), off_px > 0 ? 2u : 3u);
  }
}

TEST(LineFuser, DifferentLinesStayDifferent) {
  SyntheticLineMap m(5, {.num_free = 150}, PosesSideBySide(4, 0.2));
  for (const int l : m.SeenBy(4)) m.AddLine(l, Ids({0, 1, 2, 3}));
  const size_t before = m.Lines().size();
  ASSERT_GT(before, 20u);
  Fuse(m);
  EXPECT_EQ(m.Lines().size(), before);
}

TEST(LineFuser, NothingToFuse) {
  SyntheticLineMap none(6, {.num_free = 0}, PosesSideBySide(2));
  Fuse(none);
  SyntheticLineMap alone(6, {}, PosesSideBySide(1));
  Fuse(alone);
  EXPECT_TRUE(none.Lines().empty());
  EXPECT_TRUE(alone.Lines().empty());
}

}  // namespace
}  // namespace vpslam
