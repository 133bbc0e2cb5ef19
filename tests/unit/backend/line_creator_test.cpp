#include "backend/line_creator.h"

#include <Eigen/Eigenvalues>
#include <ceres/line_manifold.h>
#include <gtest/gtest.h>

#include "core/estimation/line_cost.h"
#include "core/estimation/se3_manifold.h"
#include "core/geometry/sphere.h"
#include "tests/unit/synthetic_lines.h"

namespace vpslam {
namespace {

std::vector<LineId> Create(SyntheticLineMap& m, const LineMappingOptions& options = {}) {
  return CreateLines(m.map.Context(), m.last(), options);
}

/// What the two views that a line was made from know of it: squared error over covariance,
/// chi-square with four degrees of freedom. These are the views that it fits without error.
double Chi2(const SyntheticLineMap& m, const MapLine& line) {
  const ceres::LineManifold<3> manifold;
  const SyntheticLine& truth = m.lines.lines[m.TruthOf(line.id)];
  const LineParameters at_truth = ToLineParameters(truth.start, truth.end);
  // Compared where the truth has its middle.
  const Eigen::Vector3d d = line.Direction();
  const Eigen::Vector3d shift =
      d.dot(0.5 * (truth.start + truth.end) - 0.5 * (line.start + line.end)) * d;
  const LineParameters found = ToLineParameters(line.start + shift, line.end + shift);
  Eigen::Matrix<double, 6, 4, Eigen::RowMajor> plus_jacobian;
  manifold.PlusJacobian(at_truth.data(), plus_jacobian.data());
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  for (const Observation& o : line.observations) {
    const LineSegment& s = m.map.map.Find(o.keyframe)->seen->segments()[o.feature];
    const PoseParameters pose = ToParameters(m.map.map.Find(o.keyframe)->cam_from_world);
    const LineCost cost(m.scene.camera, s.start_px.cast<double>(), s.end_px.cast<double>(),
                        1 / LineSigma_px(s.sigma_px));
    Eigen::Vector2d r;
    const double* found_parameters[] = {pose.data(), found.data()};
    cost.Evaluate(found_parameters, r.data(), nullptr);
    if (r.norm() > 1e-3) continue;
    Eigen::Matrix<double, 2, 6, Eigen::RowMajor> by_line;
    double* jacobians[] = {nullptr, by_line.data()};
    const double* parameters[] = {pose.data(), at_truth.data()};
    cost.Evaluate(parameters, r.data(), jacobians);
    const Eigen::Matrix<double, 2, 4> j = by_line * plus_jacobian;
    information += j.transpose() * j;
  }
  Eigen::Vector4d error;
  manifold.Minus(found.data(), at_truth.data(), error.data());
  return error.dot(information * error);
}

TEST(LineCreator, ErrorsAgreeWithTheNoise) {
  int total = 0, wrong = 0, gross = 0, common = 0;
  double sum = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    SyntheticLineMap m(seed, {}, PosesSideBySide(3));
    common += static_cast<int>(m.SeenBy(3).size());
    for (const LineId id : Create(m)) {
      const MapLine& line = *m.map.map.Find(id);
      EXPECT_GE(line.observations.size(), 3u);
      EXPECT_EQ(line.axis, -1);
      EXPECT_EQ(line.reference, m.last());
      ++total;
      if (m.TruthOf(id) < 0) {
        ++wrong;
        continue;
      }
      const SyntheticLine& truth = m.lines.lines[m.TruthOf(id)];
      EXPECT_GT(line.Direction().dot(truth.end - truth.start), 0);
      EXPECT_LT(Distance(line.descriptor, truth.descriptor), 9);
      const double chi2 = Chi2(m, line);
      gross += chi2 > 18.5;  // one in a thousand
      sum += std::min(chi2, 18.5);
    }
  }
  EXPECT_GT(common, 100);
  EXPECT_GT(total, 0.6 * common);
  EXPECT_EQ(wrong, 0);
  EXPECT_LE(gross, 0.02 * total);
  // Mean 4 with a standard deviation of sqrt(8 / n); the gates take away the tails.
  EXPECT_NEAR(sum / total, 3.8, 0.9);
}

TEST(LineCreator, TwoKeyframesAreNotEnough) {
  for (uint64_t seed = 0; seed < 5; ++seed) {
    SyntheticLineMap m(seed, {}, PosesSideBySide(2));
    ASSERT_GT(m.SeenBy(2).size(), 8u);
    EXPECT_TRUE(Create(m).empty());
    // With a third one that shows them they are.
    SyntheticLineMap three(seed, {}, PosesSideBySide(3));
    EXPECT_GT(Create(three).size(), 3u);
  }
}

TEST(LineCreator, ACommonAxisIsEvidenceToo) {
  int created = 0, common = 0;
  double sum = 0;
  for (uint64_t seed = 0; seed < 5; ++seed) {
    SyntheticLineMap m(seed, {.num_free = 30, .num_per_axis = 12}, PosesSideBySide(2));
    m.SetAxes();
    for (const int l : m.SeenBy(2)) common += m.lines.lines[l].axis >= 0;
    for (const LineId id : Create(m)) {
      const MapLine& line = *m.map.map.Find(id);
      ASSERT_GE(m.TruthOf(id), 0);
      EXPECT_EQ(line.axis, m.lines.lines[m.TruthOf(id)].axis);
      ASSERT_GE(line.axis, 0);
      const Eigen::Matrix3d axes = m.lines.world_from_manhattan.toRotationMatrix();
      EXPECT_LT(AxisAngle_rad(line.Direction(), axes.col(line.axis)), 1e-6);
      // Planes are 1.5 degrees apart at least, of which 0.14 are noise: a tenth of the depth.
      const double error = LineError(line, m.lines.lines[m.TruthOf(id)]);
      EXPECT_LT(error, 4 * 0.1 * 9);
      sum += error;
      ++created;
    }
  }
  EXPECT_GT(created, 20);
  EXPECT_LT(sum / created, 0.5);
  // Those along the baseline are degenerate, and those along the optical axis nearly so.
  EXPECT_GT(created, 0.3 * common);
}

TEST(LineCreator, AKnownDirectionMakesLinesBetter) {
  double free = 0, directed = 0;
  int n = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const auto errors = [&](bool with_frame) {
      SyntheticLineMap m(seed, {.num_free = 0, .num_per_axis = 12}, PosesSideBySide(3));
      if (with_frame) m.SetAxes();
      std::map<int, double> error;
      for (const LineId id : Create(m)) {
        const int l = m.TruthOf(id);
        if (l >= 0) error[l] = LineError(*m.map.map.Find(id), m.lines.lines[l]);
      }
      return error;
    };
    const auto a = errors(false), b = errors(true);
    for (const auto& [l, error] : a) {
      if (!b.contains(l)) continue;
      free += error;
      directed += b.at(l);
      ++n;
    }
  }
  ASSERT_GT(n, 50);
  EXPECT_LT(directed, 0.85 * free);
}

TEST(LineCreator, LinesAlongTheBaselineAreRefused) {
  for (const bool along : {true, false}) {
    std::vector<SE3> poses;
    for (int i = 0; i < 3; ++i) poses.push_back(PoseAt({0.4 * i, 0, 0}));
    SyntheticLineMap m(7, {.num_free = 0}, {});
    for (int i = 0; i < 20; ++i) {
      m.lines.Add({-1 + 0.15 * i, -1.2 + 0.13 * i, 5},
                  along ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY(), -1);
    }
    for (const SE3& pose : poses) m.AddKeyframe(pose);
    m.map.AddPoints(0, 200);
    ASSERT_GT(m.SeenBy(3).size(), 10u);
    if (along) {
      EXPECT_TRUE(Create(m).empty());
    } else {
      EXPECT_GT(Create(m).size(), 0.5 * static_cast<double>(m.SeenBy(3).size()));
    }
  }
}

TEST(LineCreator, PureRotationCreatesNothing) {
  for (const double seeming_baseline : {0.0, 1e-4, 0.02}) {
    SyntheticLineMap m(8, {.num_free = 40, .num_per_axis = 10},
                       {PoseAt({0, 0, 0}), PoseAt({0, 0, 0}, {0, 0.05, 0.02}),
                        PoseAt({0, 0, 0}, {0.03, -0.03, 0})});
    m.SetAxes();
    for (int i = 1; i < 3; ++i) {
      SE3 pose = m.map.map.Find(KeyframeId(i))->cam_from_world;
      pose.translation.x() += i * seeming_baseline;
      m.map.map.SetPose(KeyframeId(i), pose);
    }
    ASSERT_GT(m.SeenBy(3).size(), 10u);
    EXPECT_TRUE(Create(m).empty()) << seeming_baseline;
  }
}

TEST(LineCreator, WhatIsFarBehindThePointsIsRefused) {
  for (const double depth : {7.0, 30.0}) {
    SyntheticLineMap m(9, {.num_free = 0}, {});
    for (int i = 0; i < 12; ++i) {
      const double at = -0.25 * depth + 0.04 * depth * i;
      const int l = m.lines.Add({at, 0.02 * at, depth}, Eigen::Vector3d::UnitY(), -1);
      m.lines.lines[l].start.y() = -0.2 * depth;
      m.lines.lines[l].end.y() = 0.2 * depth;
    }
    for (const double x : {0.0, 1.0, 2.0}) m.AddKeyframe(PoseAt({x, 0.1 * x, 0}));
    m.map.AddPoints(0, 200);
    ASSERT_GT(m.SeenBy(3).size(), 6u);
    EXPECT_EQ(Create(m).empty(), depth > 20) << depth;
  }
}

TEST(LineCreator, WhatIsBeforeThePointsNeedsManyViewsAndWhatIsFarBeforeIsRefused) {
  // The points are 3 m away and more.
  struct Case {
    double depth;
    int views;
    bool is_created;
  };
  for (const auto& [depth, views, is_created] :
       {Case{0.6, 5, false}, {1.5, 4, false}, {1.5, 5, true}, {4.5, 3, true}}) {
    SyntheticLineMap m(16, {.num_free = 0}, {});
    for (int i = 0; i < 12; ++i) {
      const int l =
          m.lines.Add({depth * (-0.25 + 0.04 * i), 0, depth}, Eigen::Vector3d::UnitY(), -1);
      m.lines.lines[l].start.y() = -0.2 * depth;
      m.lines.lines[l].end.y() = 0.2 * depth;
    }
    for (int i = 0; i < views; ++i) {
      const double x = 0.3 * i / (views - 1);
      m.AddKeyframe(PoseAt({depth * x, 0.1 * x, 0}));
    }
    m.map.AddPoints(0, 200);
    ASSERT_GT(m.SeenBy(views).size(), 6u);
    EXPECT_EQ(Create(m).empty(), !is_created) << depth << ", " << views << " views";
  }
}

TEST(LineCreator, AnOppositeSegmentIsAnotherEdge) {
  SyntheticLineMap m(10, {}, PosesSideBySide(3));
  SyntheticLineMap same = m;
  ASSERT_GT(CreateLines(same.map.Context(), same.last(), {}).size(), 5u);
  for (LineSegment& s : m.map.LinesOf(KeyframeId(1)).lines) {
    std::swap(s.start_px, s.end_px);
  }
  EXPECT_TRUE(Create(m).empty()) << "two keyframes remain";
}

TEST(LineCreator, LinesThatLookAlikeSideBySideAreLeftAlone) {
  SyntheticLineMap m(11, {.num_free = 0, .descriptor_bits = 20}, {});
  for (int i = 0; i < 10; ++i) {
    const int l = m.lines.Add({-1 + 0.2 * i, 0, 5}, Eigen::Vector3d::UnitY(), -1);
    if (l > 0) m.lines.lines[l].descriptor = m.lines.lines[0].descriptor;
  }
  for (const SE3& pose : PosesSideBySide(3)) m.AddKeyframe(pose);
  m.map.AddPoints(0, 200);
  ASSERT_GT(m.SeenBy(3).size(), 5u);
  SyntheticLineMap bold = m;
  const size_t cautious = Create(m).size();
  EXPECT_LT(cautious, 0.5 * static_cast<double>(Create(bold, {.ratio = 100}).size()));
}

TEST(LineCreator, OfARowOfBarsTheNextOneDoesNotWin) {
  // Too far away for its depth to be told, but the next bar in the other image makes up for that.
  SyntheticLineMap m(15, {.num_free = 0, .noise_sigmas = 0.2}, {});
  for (int i = 0; i < 12; ++i) {
    const int l = m.lines.Add({-0.7 + 0.12 * i, 0, 5}, Eigen::Vector3d::UnitY(), -1);
    if (l > 0) m.lines.lines[l].descriptor = m.lines.lines[0].descriptor;
  }
  for (const double x : {0.0, 0.06, 0.05}) m.AddKeyframe(PoseAt({x, 0, 0}));
  m.map.AddPoints(0, 200);
  ASSERT_GT(m.SeenBy(3).size(), 8u);
  EXPECT_TRUE(Create(m).empty());
}

TEST(LineCreator, SegmentsThatHaveLinesAreLeftAlone) {
  SyntheticLineMap m(12, {}, PosesSideBySide(4));
  const std::vector<LineId> created = Create(m);
  ASSERT_GT(created.size(), 5u);
  const auto before = m.map.map.Find(m.last())->lines;
  // What is ambiguous no longer may become a line now.
  Create(m);
  for (size_t i = 0; i < before.size(); ++i) {
    if (before[i].IsValid()) {
      EXPECT_EQ(m.map.map.Find(m.last())->lines[i], before[i]);
    }
  }
  for (const LineId id : created) {
    for (const Observation& o : m.map.map.Find(id)->observations) {
      EXPECT_EQ(m.map.map.Find(o.keyframe)->lines.at(o.feature), id);
    }
  }
}

TEST(LineCreator, ShortLinesWithoutDescriptorAreNotUsed) {
  SyntheticLineMap m(13, {}, PosesSideBySide(3));
  for (LineSegment& s : m.map.LinesOf(m.last()).lines) s.has_descriptor = false;
  EXPECT_TRUE(Create(m).empty());
}

TEST(LineCreator, NoSegmentsNoLines) {
  SyntheticLineMap m(14, {.num_free = 0}, PosesSideBySide(3));
  EXPECT_TRUE(Create(m).empty());
}

TEST(LineCreator, SameInputSameBytes) {
  const auto run = [] {
    SyntheticLineMap m(15, {.num_per_axis = 8}, PosesSideBySide(4));
    m.SetAxes();
    m.map.map.TakeDeltas(KeyframeId(), {});
    EXPECT_FALSE(Create(m).empty());
    return BytesOf(m.map.map.TakeDeltas(m.last(), {}));
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace vpslam
