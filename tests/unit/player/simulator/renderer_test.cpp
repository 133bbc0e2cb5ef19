#include "player/simulator/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "player/simulator/random.h"

namespace vpslam::simulator {
namespace {

Camera TestCamera(bool distortion) {
  Camera camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = 262.3;
  camera.fy = 259.1;
  camera.cx = 158.4;
  camera.cy = 121.7;
  if (distortion) {
    camera.k1 = -0.26;
    camera.k2 = 0.06;
    camera.p1 = 0.0006;
    camera.p2 = -0.0004;
  }
  return camera;
}

Quad Shining(const Eigen::Vector3d& origin, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
             double radiance) {
  Quad quad;
  quad.origin = origin;
  quad.u = u;
  quad.v = v;
  quad.emission = radiance;
  return quad;
}

Scene WhiteTexture() {
  Scene scene;
  scene.textures.push_back(MakeTexture(cv::Mat1f::ones(4, 4), false));
  return scene;
}

Renderer::Exposure Still(const SE3& pose) {
  Renderer::Exposure exposure;
  exposure.fill(pose);
  return exposure;
}

double Bilinear(const cv::Mat1f& image, const Eigen::Vector2d& x) {
  const int i = static_cast<int>(std::floor(x.x())), j = static_cast<int>(std::floor(x.y()));
  const double f = x.x() - i, g = x.y() - j;
  return (1 - g) * ((1 - f) * image(j, i) + f * image(j, i + 1)) +
         g * ((1 - f) * image(j + 1, i) + f * image(j + 1, i + 1));
}

/// Signed distance along `normal` from `expected` to a step from `low` to `high`: where the step of
/// the same area would stand.
double EdgeOffset(const cv::Mat1f& image, const Eigen::Vector2d& expected,
                  const Eigen::Vector2d& normal, double low, double high) {
  constexpr double kReach = 3, kStep = 0.1;
  double bright = 0;
  int steps = 0;
  for (double s = -kReach; s < kReach; s += kStep, ++steps) {
    bright += (Bilinear(image, expected + (s + kStep / 2) * normal) - low) / (high - low);
  }
  return kReach - bright * kStep;
}

bool Inside(const Camera& camera, const Eigen::Vector2d& x) {
  return x.x() > 6 && x.y() > 6 && x.x() < camera.width - 7 && x.y() < camera.height - 7;
}

/// Edges of a bright parallelogram on nothing, at random poses, against the projection of its
/// corners by core/geometry/camera.h.
void ExpectEdgesWhereTheCameraPutsThem(const Camera& camera) {
  constexpr double kLow = 0.02;  // what is seen where nothing is
  Random random(17);
  std::vector<double> offsets;
  for (int trial = 0; trial < 12; ++trial) {
    Scene scene = WhiteTexture();
    const Eigen::Vector3d u(random.Uniform(0.8, 1.4), random.Uniform(-0.3, 0.3),
                            random.Uniform(-0.3, 0.3));
    const Eigen::Vector3d v(random.Uniform(-0.3, 0.3), random.Uniform(0.7, 1.2),
                            random.Uniform(-0.3, 0.3));
    const Eigen::Vector3d origin(-0.6 + random.Uniform(-0.2, 0.2), -0.5, 2.2);
    // The quad is given in world coordinates, the camera stands somewhere else.
    const SE3 world_from_cam(Eigen::Quaterniond(random.Gaussian(), random.Gaussian(),
                                                random.Gaussian(), random.Gaussian())
                                 .normalized(),
                             {random.Gaussian(), random.Gaussian(), random.Gaussian()});
    scene.quads.push_back(Shining(world_from_cam * origin, world_from_cam.rotation * u,
                                  world_from_cam.rotation * v, 1));
    Renderer renderer(scene, camera);
    const cv::Mat1f image = renderer.Radiance(Still(world_from_cam));

    const std::array<Eigen::Vector3d, 4> corners = {origin, origin + u, origin + u + v, origin + v};
    for (int side = 0; side < 4; ++side) {
      const Eigen::Vector3d a = corners[side], b = corners[(side + 1) % 4];
      const auto pixel = [&](double t) { return camera.Distort(camera.Project(a + t * (b - a))); };
      for (double t = 0.15; t < 0.86; t += 0.01) {
        const Eigen::Vector2d along = (pixel(t + 1e-4) - pixel(t - 1e-4)).normalized();
        // Corners go round clockwise in the image, so this points inwards, to the bright side.
        const Eigen::Vector2d inwards(-along.y(), along.x());
        if (!Inside(camera, pixel(t))) continue;
        offsets.push_back(EdgeOffset(image, pixel(t), inwards, kLow, 1));
      }
    }
  }
  ASSERT_GT(offsets.size(), 1000u);
  double mean = 0, square = 0, worst = 0;
  for (const double d : offsets) {
    mean += d / offsets.size();
    square += d * d / offsets.size();
    worst = std::max(worst, std::abs(d));
  }
  EXPECT_LT(std::abs(mean), 0.01);
  // Four samples a pixel place an edge along its rows or columns in steps of a quarter pixel: an
  // error of 0.25 / sqrt(12) = 0.07 RMS.
  EXPECT_LT(std::sqrt(square), 0.08);
  EXPECT_LT(worst, 0.3);
}

TEST(Renderer, EdgesAreWhereThePinholeCameraPutsThem) {
  ExpectEdgesWhereTheCameraPutsThem(TestCamera(false));
}

TEST(Renderer, EdgesAreWhereTheDistortedCameraPutsThem) {
  ExpectEdgesWhereTheCameraPutsThem(TestCamera(true));
}

TEST(Renderer, TexelsAreWhereTheCameraPutsThem) {
  // A texture with a step between texel columns 12 and 13 of 40: at 0.325 of the quad's width.
  Scene scene;
  cv::Mat1f image(30, 40, 0.2f);
  image.colRange(13, 40) = 1.0f;
  scene.textures.push_back(MakeTexture(image, false));
  const Camera camera = TestCamera(false);
  const Eigen::Vector3d origin(-0.9, -0.6, 1.5), u(1.8, 0, 0.4), v(0, 1.2, 0.1);
  scene.quads.push_back(Shining(origin, u, v, 1));
  scene.quads.back().texel_scale = {40, 30};
  Renderer renderer(scene, camera);
  const cv::Mat1f seen = renderer.Radiance(Still(SE3()));
  for (double b = 0.2; b < 0.8; b += 0.05) {
    const Eigen::Vector2d x = camera.Project(origin + 0.325 * u + b * v);
    // The step is a ramp one texel wide, some 7 px here; perspective skews it hardly.
    double left = x.x() - 8;
    while (Bilinear(seen, {left, x.y()}) < 0.6) left += 0.01;
    EXPECT_NEAR(left, x.x(), 0.15);
  }
}

TEST(Renderer, DepthIsExactAlsoForPlanesThatReachBehindTheCamera) {
  const Camera camera = TestCamera(true);
  Scene scene = WhiteTexture();
  // A floor 1.2 m below the camera from far behind to far ahead, and a wall at 7 m.
  scene.quads.push_back(Shining({-9, 1.2, 30}, {18, 0, 0}, {0, 0, -60}, 1));
  scene.quads.push_back(Shining({-9, -9, 7}, {18, 0, 0}, {0, 18, 0}, 0.5));
  Renderer renderer(scene, camera);
  const cv::Mat1f depth = renderer.Depth(SE3());
  for (int y = 0; y < camera.height; y += 7) {
    for (int x = 0; x < camera.width; x += 7) {
      const auto pixel = camera.Undistort({x, y});
      ASSERT_TRUE(pixel);
      const double slope = camera.Unproject(*pixel).y();
      const double expected = slope > 0 ? std::min(7.0, 1.2 / slope) : 7.0;
      EXPECT_NEAR(depth(y, x), expected, 1e-4 * expected) << x << " " << y;
    }
  }
}

TEST(Renderer, NearThingsHideFarOnesInAnyOrder) {
  const Camera camera = TestCamera(false);
  const Quad far = Shining({-3, -3, 4}, {6, 0, 0}, {0, 6, 0}, 0.3);
  const Quad near = Shining({-0.3, -0.3, 2}, {0.6, 0, 0}, {0, 0.6, 0}, 0.9);
  for (const bool near_first : {false, true}) {
    Scene scene = WhiteTexture();
    scene.quads = near_first ? std::vector{near, far} : std::vector{far, near};
    Renderer renderer(scene, camera);
    const cv::Mat1f image = renderer.Radiance(Still(SE3()));
    const cv::Mat1f depth = renderer.Depth(SE3());
    EXPECT_FLOAT_EQ(image(121, 158), 0.9f);
    EXPECT_FLOAT_EQ(depth(121, 158), 2);
    EXPECT_FLOAT_EQ(image(121, 158 + 60), 0.3f);
    EXPECT_FLOAT_EQ(depth(121, 158 + 60), 4);
  }
}

TEST(Renderer, SeesTheBackOfTwoSidedFacesOnly) {
  const Camera camera = TestCamera(false);
  Scene scene = WhiteTexture();
  scene.quads.push_back(
      Shining({1, -1, 2}, {-2, 0, 0}, {0, 2, 0}, 0.9));  // u points left: the back
  EXPECT_EQ(Renderer(scene, camera).Depth(SE3())(120, 160), 0);
  scene.quads[0].two_sided = true;
  EXPECT_FLOAT_EQ(Renderer(scene, camera).Depth(SE3())(120, 160), 2);
}

TEST(Renderer, NeighbouringFacesLeaveNoCrack) {
  const Camera camera = TestCamera(true);
  Random random(3);
  Scene scene = WhiteTexture();
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, -0.3, -1).normalized();
  const Eigen::Vector3d u = normal.unitOrthogonal() * 0.071;
  const Eigen::Vector3d v = normal.cross(u);
  for (int i = -60; i < 60; ++i) {
    for (int j = -60; j < 60; ++j) {
      scene.quads.push_back(Shining(Eigen::Vector3d(0, 0, 2) + i * u + j * v, u, v, 1));
      scene.quads.back().two_sided = true;
    }
  }
  Renderer renderer(scene, camera);
  double low = 0, high = 0;
  cv::minMaxLoc(renderer.Radiance(Still(SE3())), &low, &high);
  EXPECT_FLOAT_EQ(static_cast<float>(low), 1);
  EXPECT_FLOAT_EQ(static_cast<float>(high), 1);
}

TEST(Renderer, BlurIsCentredOnTheMiddleOfTheExposure) {
  const Camera camera = TestCamera(false);
  Scene scene = WhiteTexture();
  scene.quads.push_back(Shining({-2, -2, 2}, {2, 0, 0}, {0, 4, 0}, 1));  // its right edge at x = 0
  Renderer renderer(scene, camera);
  // The camera passes 2 px to the right during the exposure, so the edge moves 2 px to the left.
  Renderer::Exposure exposure;
  for (int i = 0; i < Renderer::kSubFrames; ++i) {
    exposure[i].translation.x() = Renderer::SubFrameTime(i) * 2 * 2 / camera.fx;
  }
  const cv::Mat1f blurred = renderer.Radiance(exposure);
  const cv::Mat1f sharp = renderer.Radiance(Still(SE3()));
  int soft_blurred = 0, soft_sharp = 0;
  for (int x = 150; x < 167; ++x) {
    soft_blurred += blurred(120, x) > 0.05f && blurred(120, x) < 0.95f;
    soft_sharp += sharp(120, x) > 0.05f && sharp(120, x) < 0.95f;
  }
  EXPECT_GT(soft_blurred, soft_sharp);
  EXPECT_NEAR(EdgeOffset(blurred, {camera.cx, 120}, {-1, 0}, 0.02, 1), 0, 0.15);
}

}  // namespace
}  // namespace vpslam::simulator
