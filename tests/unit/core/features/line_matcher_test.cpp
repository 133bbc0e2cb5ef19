#include "core/features/line_matcher.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

ImageSegment Segment(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y1}}; }

ImageSegment Reversed(const ImageSegment& s) { return {s.end_px, s.start_px}; }

/// `bits` of the descriptor are set.
LineSegment Line(const ImageSegment& s, int bits = 0) {
  LineSegment line;
  line.start_px = s.start_px.cast<float>();
  line.end_px = s.end_px.cast<float>();
  for (int i = 0; i < bits; ++i) line.descriptor[i / 64] |= uint64_t{1} << (i % 64);
  line.has_descriptor = true;
  return line;
}

/// Index of the match; -1 for none. The descriptor looked for has no bit set.
int Best(const ImageSegment& predicted, const std::vector<LineSegment>& lines,
         const LineWindow& window = {}, const std::vector<uint8_t>& taken = {}) {
  const auto match = BestLineInWindow(predicted, Descriptor{}, window, lines, taken);
  if (!match) return -1;
  EXPECT_EQ(match->distance, Distance(Descriptor{}, lines[match->index].descriptor));
  return match->index;
}

TEST(Relate, MeasuresAngleOverlapAndOffset) {
  const ImageSegment a = Segment(100, 100, 200, 100);
  SegmentRelation r = Relate(a, Segment(150, 103, 250, 103));
  EXPECT_NEAR(r.cosine, 1, 1e-12);
  EXPECT_NEAR(r.overlap_px, 50, 1e-9);
  EXPECT_NEAR(r.offset_px, 3, 1e-9);
  r = Relate(a, Segment(220, 100, 260, 100));
  EXPECT_NEAR(r.overlap_px, -20, 1e-9) << "a gap";
  r = Relate(a, Segment(120, 100, 150, 70));
  EXPECT_NEAR(r.cosine, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(r.overlap_px, 30, 1e-9);
  EXPECT_NEAR(r.offset_px, 30, 1e-9);
  r = Relate(a, Segment(150, 60, 150, 140));
  EXPECT_NEAR(r.cosine, 0, 1e-12);
  EXPECT_NEAR(r.overlap_px, 0, 1e-9);
}

TEST(Relate, OffsetIsThatWhereTheyOverlap) {
  // From 0 to 20 px off, but only the first half lies beside the other.
  const SegmentRelation r = Relate(Segment(100, 100, 200, 100), Segment(100, 100, 300, 120));
  EXPECT_NEAR(r.overlap_px, 100, 1e-9);
  EXPECT_NEAR(r.offset_px, 10, 1e-9);
}

TEST(Relate, DirectionOfTheSecondShowsInTheCosineAlone) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(0, 400);
  for (int i = 0; i < 100; ++i) {
    const ImageSegment a = Segment(uniform(rng), uniform(rng), uniform(rng), uniform(rng));
    const ImageSegment b = Segment(uniform(rng), uniform(rng), uniform(rng), uniform(rng));
    const SegmentRelation r = Relate(a, b), opposite = Relate(a, Reversed(b));
    EXPECT_NEAR(r.cosine, -opposite.cosine, 1e-12);
    EXPECT_NEAR(r.overlap_px, opposite.overlap_px, 1e-9);
    EXPECT_NEAR(r.offset_px, opposite.offset_px, 1e-9);
    const SegmentRelation turned = Relate(Reversed(a), b);
    EXPECT_NEAR(r.cosine, -turned.cosine, 1e-12);
    EXPECT_NEAR(r.overlap_px, turned.overlap_px, 1e-9);
    EXPECT_NEAR(r.offset_px, turned.offset_px, 1e-9);
  }
}

TEST(Relate, APointIsNoSegment) {
  const ImageSegment a = Segment(100, 100, 200, 100), point = Segment(150, 100, 150, 100);
  for (const SegmentRelation& r : {Relate(a, point), Relate(point, a)}) {
    EXPECT_EQ(r.cosine, 0);
    EXPECT_EQ(r.overlap_px, 0);
  }
  EXPECT_EQ(Best(a, {Line(point)}), -1);
}

const ImageSegment kPredicted = Segment(100, 100, 200, 110);

ImageSegment Shifted(const ImageSegment& s, double across_px, double along_px = 0) {
  const Eigen::Vector2d u = (s.end_px - s.start_px).normalized();
  const Eigen::Vector2d d = along_px * u + across_px * Eigen::Vector2d(-u.y(), u.x());
  return {s.start_px + d, s.end_px + d};
}

ImageSegment Turned(const ImageSegment& s, double rad) {
  const Eigen::Vector2d middle = 0.5 * (s.start_px + s.end_px);
  const double c = std::cos(rad), sn = std::sin(rad);
  const auto turn = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    const Eigen::Vector2d d = x - middle;
    return middle + Eigen::Vector2d(c * d.x() - sn * d.y(), sn * d.x() + c * d.y());
  };
  return {turn(s.start_px), turn(s.end_px)};
}

TEST(BestLineInWindow, AnOppositeSegmentIsNeverMatched) {
  LineWindow window;
  EXPECT_EQ(Best(kPredicted, {Line(kPredicted)}, window), 0);
  EXPECT_EQ(Best(kPredicted, {Line(Reversed(kPredicted))}, window), -1);
  // The other side of a dark bar is no match, however well it lies.
  EXPECT_EQ(Best(kPredicted, {Line(Reversed(kPredicted)), Line(Shifted(kPredicted, 3))}, window),
            1);
}

TEST(BestLineInWindow, EachGateDecides) {
  const LineWindow window;  // 10 px, 11.5 degrees, 0.3, 80 bits
  EXPECT_EQ(Best(kPredicted, {Line(Shifted(kPredicted, 9.9))}), 0);
  EXPECT_EQ(Best(kPredicted, {Line(Shifted(kPredicted, -9.9))}), 0);
  EXPECT_EQ(Best(kPredicted, {Line(Shifted(kPredicted, 10.1))}), -1);
  const LineWindow wide{.max_offset_px = 50};
  EXPECT_EQ(Best(kPredicted, {Line(Turned(kPredicted, 0.19))}, wide), 0);
  EXPECT_EQ(Best(kPredicted, {Line(Turned(kPredicted, -0.21))}, wide), -1);
  const double length = kPredicted.Length();
  EXPECT_EQ(Best(kPredicted, {Line(Shifted(kPredicted, 0, 0.69 * length))}), 0);
  EXPECT_EQ(Best(kPredicted, {Line(Shifted(kPredicted, 0, 0.71 * length))}), -1);
  EXPECT_EQ(Best(kPredicted, {Line(Shifted(kPredicted, 0, -0.71 * length))}), -1);
  EXPECT_EQ(Best(kPredicted, {Line(kPredicted, 80)}), 0);
  EXPECT_EQ(Best(kPredicted, {Line(kPredicted, 81)}), -1);
}

TEST(BestLineInWindow, OverlapIsMeasuredByTheShorter) {
  const Eigen::Vector2d u = (kPredicted.end_px - kPredicted.start_px).normalized();
  const ImageSegment part{kPredicted.start_px + 20 * u, kPredicted.start_px + 32 * u};
  EXPECT_EQ(Best(kPredicted, {Line(part)}), 0);
  EXPECT_EQ(Best(part, {Line(kPredicted)}), 0);
}

TEST(BestLineInWindow, NearParallelLinesAreAmbiguous) {
  const LineSegment a = Line(Shifted(kPredicted, 4), 20);
  EXPECT_EQ(Best(kPredicted, {a, Line(Shifted(kPredicted, -4), 20)}), -1);
  EXPECT_EQ(Best(kPredicted, {a, Line(Shifted(kPredicted, -4), 24)}), -1) << "0.65 to 0.7";
  // Its descriptor, or its place, tells them apart; in any order.
  const LineSegment other = Line(Shifted(kPredicted, -4), 60);
  EXPECT_EQ(Best(kPredicted, {a, other}), 0);
  EXPECT_EQ(Best(kPredicted, {other, a}), 1);
  EXPECT_EQ(Best(kPredicted, {Line(Shifted(kPredicted, -9), 20), a}), 1);
  // A third that is worse still does not hide the rival.
  const LineSegment rival = Line(Shifted(kPredicted, -4), 21);
  EXPECT_EQ(Best(kPredicted, {other, a, rival}), -1);
  EXPECT_EQ(Best(kPredicted, {rival, other, a}), -1);
  EXPECT_EQ(Best(kPredicted, {a, rival, other}), -1);
}

TEST(BestLineInWindow, ABrokenEdgeIsNoRival) {
  const Eigen::Vector2d along = kPredicted.end_px - kPredicted.start_px;
  const ImageSegment first{kPredicted.start_px, kPredicted.start_px + 0.5 * along};
  const ImageSegment second{kPredicted.start_px + 0.55 * along, kPredicted.end_px};
  EXPECT_NE(Best(kPredicted, {Line(Shifted(first, 1), 20), Line(Shifted(second, 1), 21)}), -1);
  EXPECT_EQ(Best(kPredicted, {Line(Shifted(first, 4), 20), Line(Shifted(second, -1), 40)}), -1)
      << "this is another edge";
}

TEST(BestLineInWindow, LinesTakenOrWithoutDescriptorAreNotAsked) {
  LineSegment bare = Line(kPredicted);
  bare.has_descriptor = false;
  const LineSegment other = Line(Shifted(kPredicted, 3), 30);
  EXPECT_EQ(Best(kPredicted, {bare, other}), 1);
  EXPECT_EQ(Best(kPredicted, {Line(kPredicted), other}), 0);
  EXPECT_EQ(Best(kPredicted, {Line(kPredicted), other}, {}, {1, 0}), 1);
  EXPECT_EQ(Best(kPredicted, {Line(kPredicted), other}, {}, {1, 1}), -1);
  EXPECT_EQ(Best(kPredicted, {}), -1);
}

}  // namespace
}  // namespace vpslam
