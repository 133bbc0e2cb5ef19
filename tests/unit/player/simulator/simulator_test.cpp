#include "player/simulator/simulator.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/geometry/so3.h"

namespace vpslam::simulator {
namespace {

bool SameBytes(const cv::Mat1b& a, const cv::Mat1b& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

/// The places are built once: that takes a second or two each.
class SimulatorTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    cv::setNumThreads(1);
    room_ = std::make_unique<Simulator>(ParseSpec("sim:room?seed=4&frames=600"));
    corridor_ = std::make_unique<Simulator>(ParseSpec("sim:corridor?noise=0&distortion=1"));
  }
  static void TearDownTestSuite() {
    room_.reset();
    corridor_.reset();
  }
  static std::unique_ptr<Simulator> room_, corridor_;
};
std::unique_ptr<Simulator> SimulatorTest::room_, SimulatorTest::corridor_;

TEST_F(SimulatorTest, SameSpecGivesTheSameBytesInAnyOrder) {
  const cv::Mat1b last = room_->Render(30), first = room_->Render(3);
  Simulator again = Simulator::Create("sim:room?seed=4&frames=31");
  EXPECT_TRUE(SameBytes(again.Render(3), first));
  EXPECT_TRUE(SameBytes(again.Render(30), last));
  EXPECT_FALSE(SameBytes(first, last));
}

TEST_F(SimulatorTest, AnotherSeedGivesAnotherPlace) {
  Simulator other = Simulator::Create("sim:room?seed=5");
  EXPECT_FALSE(SameBytes(other.Render(3), room_->Render(3)));
  EXPECT_GT((other.world_from_cam(3).translation - room_->world_from_cam(3).translation).norm(),
            0.01);
}

TEST_F(SimulatorTest, StampsAreThoseOf30Hz) {
  EXPECT_EQ(room_->stamp_us(0), 1'000'000);
  EXPECT_EQ(room_->stamp_us(1), 1'033'333);
  EXPECT_EQ(room_->stamp_us(300), 11'000'000);
  EXPECT_EQ(room_->frames(), 600);
}

TEST_F(SimulatorTest, TheCameraMovesFreelyAndComesBack) {
  for (Simulator* place : {room_.get(), corridor_.get()}) {
    double path = 0;
    for (int i = 1; i < 600; ++i) {
      const SE3 a = place->world_from_cam(i - 1), b = place->world_from_cam(i);
      const double step = (b.translation - a.translation).norm();
      path += step;
      EXPECT_LT(step, 0.06) << i;
      EXPECT_LT(LogSo3(b.rotation * a.rotation.conjugate()).norm(), 0.06) << i;
    }
    EXPECT_GT(path, 5);
    for (int i = 0; i < 1800; i += 60) {
      const cv::Mat1f depth = place->Depth(i);
      double nearest = 0, farthest = 0;
      cv::minMaxLoc(depth, &nearest, &farthest);
      EXPECT_GT(nearest, 0.15) << "frame " << i;  // 0 would be a view out of the scene
      EXPECT_LT(farthest, 20) << "frame " << i;
    }
  }
  // Once round the table and on: some later frame sees what the first one saw.
  const SE3 start = room_->world_from_cam(0);
  bool back = false;
  for (int i = 300; i < 600; ++i) {
    const SE3 now = room_->world_from_cam(i);
    back = back || ((now.translation - start.translation).norm() < 0.4 &&
                    LogSo3(now.rotation * start.rotation.conjugate()).norm() < 0.5);
  }
  EXPECT_TRUE(back);
}

TEST_F(SimulatorTest, ManhattanDirectionsAreOrthonormalAndCarryMostLines) {
  for (const Simulator* place : {room_.get(), corridor_.get()}) {
    const Eigen::Matrix3d axes = place->manhattan();
    EXPECT_TRUE((axes.transpose() * axes).isIdentity(1e-12));
    double along[3] = {}, total = 0;
    for (const Line3d& line : place->lines3d()) {
      const Eigen::Vector3d d = line.b - line.a;
      total += d.norm();
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(axes.col(axis).dot(d)) > 0.9999 * d.norm()) along[axis] += d.norm();
      }
    }
    EXPECT_GT(along[0] + along[1] + along[2], 0.6 * total);
    EXPECT_LT(along[0] + along[1] + along[2], total);  // some things are turned
    for (const double length : along) EXPECT_GT(length, 0.1 * total);
  }
}

struct LineEvidence {
  double share_on_edge = 0;  // of visible samples with a clear edge within 1.5 px
  double share_beside = 0;   // the same for a place 9 px aside
  // From the projection to the ridge of the edge, where it is clear. Other edges nearby spread it,
  // but they stand on both sides alike.
  double median_offset_px = 0;
  Eigen::Vector2d mean_offset_px = Eigen::Vector2d::Zero();  // over those shorter than 0.85 px
};

/// Looks for the image edges that true lines should make.
LineEvidence FindEdgesOnLines(Simulator& place, const std::vector<int>& frames) {
  constexpr double kClear = 3;  // grey levels a px
  int samples = 0, on_edge = 0, beside = 0, short_offsets = 0;
  Eigen::Vector2d offset_sum(0, 0);
  std::vector<double> offsets;
  const Camera& camera = place.camera();
  for (const int frame : frames) {
    const cv::Mat1b image = place.Render(frame);
    const cv::Mat1f depth = place.Depth(frame);
    const SE3 cam_from_world = place.world_from_cam(frame).Inverse();
    cv::Mat1f smooth, dx, dy, gradient;
    image.convertTo(smooth, CV_32F);
    cv::GaussianBlur(smooth, smooth, {0, 0}, 1);
    cv::Sobel(smooth, dx, CV_32F, 1, 0, 3, 1 / 8.0);
    cv::Sobel(smooth, dy, CV_32F, 0, 1, 3, 1 / 8.0);
    cv::magnitude(dx, dy, gradient);
    const auto at = [&](const Eigen::Vector2d& x) {
      cv::Mat1f patch;
      cv::getRectSubPix(gradient, {1, 1}, cv::Point2f(x.x(), x.y()), patch);
      return static_cast<double>(patch(0, 0));
    };
    for (const Line3d& line : place.lines3d()) {
      if ((line.b - line.a).norm() < 0.3) continue;
      for (double t = 0.05; t < 1; t += 0.1) {
        const auto project = [&](double s) -> std::optional<Eigen::Vector2d> {
          const Eigen::Vector3d x = cam_from_world * (line.a + s * (line.b - line.a));
          if (x.z() < 0.3) return std::nullopt;
          const Eigen::Vector2d undistorted = camera.Project(x);
          // Far outside, the distortion's polynomial comes back into the image.
          if (!camera.UndistortedBounds().Contains(undistorted)) return std::nullopt;
          return camera.Distort(undistorted);
        };
        const auto x = project(t), ahead = project(t + 0.01);
        if (!x || !ahead || x->x() < 16 || x->y() < 16 || x->x() > camera.width - 17 ||
            x->y() > camera.height - 17) {
          continue;
        }
        const double z = (cam_from_world * (line.a + t * (line.b - line.a))).z();
        // Visible if the surface next to it is as far away.
        const int u = static_cast<int>(std::lround(x->x())),
                  v = static_cast<int>(std::lround(x->y()));
        double nearest = 1e9;
        for (int j = -2; j <= 2; ++j) {
          for (int i = -2; i <= 2; ++i) {
            nearest = std::min<double>(nearest, std::abs(depth(v + j, u + i) - z));
          }
        }
        if (nearest > 0.01 || (*ahead - *x).norm() < 0.2) continue;
        const Eigen::Vector2d along = (*ahead - *x).normalized(), normal(-along.y(), along.x());
        ++samples;
        double best = 0, best_offset = 0;
        for (int k = -15; k <= 15; ++k) {
          const double s = 0.1 * k;
          const double g = at(*x + s * normal);
          if (g > best) {
            best = g;
            best_offset = s;
          }
        }
        on_edge += best > kClear;
        if (best > kClear && std::abs(best_offset) < 1.45) {
          offsets.push_back(std::abs(best_offset));
          if (offsets.back() < 0.85) {
            offset_sum += best_offset * normal;
            ++short_offsets;
          }
        }
        double best_beside = 0;
        for (int k = 75; k <= 105; ++k) {
          best_beside = std::max(best_beside, at(*x + 0.1 * k * normal));
        }
        beside += best_beside > kClear;
      }
    }
  }
  EXPECT_GT(samples, 1000);
  std::nth_element(offsets.begin(), offsets.begin() + offsets.size() / 2, offsets.end());
  LineEvidence evidence;
  evidence.share_on_edge = static_cast<double>(on_edge) / samples;
  evidence.share_beside = static_cast<double>(beside) / samples;
  evidence.median_offset_px = offsets[offsets.size() / 2];
  evidence.mean_offset_px = offset_sum / short_offsets;
  return evidence;
}

TEST_F(SimulatorTest, TrueLinesLieOnVisibleEdges) {
  const LineEvidence corridor = FindEdgesOnLines(*corridor_, {0, 100, 200, 400, 500});
  const LineEvidence room = FindEdgesOnLines(*room_, {0, 150, 300, 450});
  for (const LineEvidence& e : {corridor, room}) {
    EXPECT_GT(e.share_on_edge, 0.8);
    EXPECT_LT(e.share_beside, e.share_on_edge - 0.2);
    EXPECT_LT(e.median_offset_px, 0.45);
    EXPECT_LT(e.mean_offset_px.norm(), 0.05);
  }
}

TEST_F(SimulatorTest, AFrameCostsLittleTime) {
  const std::clock_t start = std::clock();
  constexpr int kFrames = 8;
  for (int i = 0; i < kFrames; ++i) room_->Render(60 * i);
  const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / kFrames;
  RecordProperty("cpu_ms_per_frame", static_cast<int>(ms));
  EXPECT_LT(ms, 200);  // three times what it should be, for slow and busy machines
}

TEST_F(SimulatorTest, NoiseGrowsWithItsFactor) {
  // Two frames' noise differs by the seed alone if the camera sees the same radiance.
  Camera camera = room_->camera();
  SensorOptions options;
  const auto sigma = [&](float radiance) {
    const Sensor sensor(camera, options);
    const cv::Mat1f even(camera.height, camera.width, radiance);
    cv::Mat1f difference;
    cv::subtract(sensor.Expose(even, 1), sensor.Expose(even, 2), difference, cv::noArray(), CV_32F);
    return cv::norm(difference) / std::sqrt(2.0 * difference.total());
  };
  const double once = sigma(0.2f);
  EXPECT_GT(once, 0.7);
  EXPECT_LT(once, 3);
  options.noise = 2;
  EXPECT_NEAR(sigma(0.2f), 2 * once, 0.15 * once);
  options.noise = 0;
  EXPECT_EQ(sigma(0.2f), 0);
}

}  // namespace
}  // namespace vpslam::simulator
