// Chooses the pairs of pixels for the descriptor and writes orb_pattern.cpp.
//
// After [Rublee11 sec. 4.3]: go through many pairs from good to bad and take those that correlate
// little with the ones taken before. There a pair is good if its comparison comes out either way
// about equally often. Here it shall also come out the same when the corner is seen again, with
// other noise, from another side, found a little off: what counts is the probability to differ
// between two views of one corner, over that between two corners. The images are "dead leaves"
// [Lee01, "Occlusion models for natural images", IJCV 41]: shapes of all sizes (density ~ size^-3)
// in front of each other, which have much of the statistics of photographs and need no data.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/features/corner_detector.h"
#include "core/features/features.h"
#include "core/features/image_pyramid.h"
#include "core/features/keypoint_distribution.h"
#include "core/features/orb_descriptor.h"
#include "core/features/orientation.h"
#include "core/features/smoothing.h"

namespace vpslam {
namespace {

constexpr int kNumImages = 24;
constexpr int kNumCandidates = 40000;
constexpr int kNumBits = 256;
constexpr int kWidth = 640, kHeight = 480;
constexpr double kJitter_px = 0.7;  // of a corner between two views, in px of its level
constexpr double kKeptShare = 0.9;  // of the candidates, the most stable ones
constexpr unsigned kSeed = 2024;

double Uniform(double a, double b, std::mt19937* rng) {
  return a + (b - a) * ((*rng)() / 4294967296.0);  // the same with every standard library
}

cv::Mat DeadLeaves(int width, int height, std::mt19937* rng) {
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  constexpr double kSmallest_px = 2, kLargest_px = 150;
  for (int i = 0; i < 20000; ++i) {
    // Inverse of the distribution with density ~ r^-3.
    const double u = Uniform(0, 1, rng);
    const double r =
        1 / std::sqrt(u / (kLargest_px * kLargest_px) + (1 - u) / (kSmallest_px * kSmallest_px));
    const cv::Point2f centre(static_cast<float>(Uniform(0, width, rng)),
                             static_cast<float>(Uniform(0, height, rng)));
    const cv::RotatedRect box(
        centre,
        cv::Size2f(static_cast<float>(2 * r), static_cast<float>(2 * r * Uniform(0.3, 1, rng))),
        static_cast<float>(Uniform(0, 360, rng)));
    const cv::Scalar grey(std::floor(Uniform(10, 246, rng)));
    if (i % 2) {
      cv::ellipse(image, box, grey, cv::FILLED, cv::LINE_AA);
    } else {
      cv::Point2f vertices[4];
      box.points(vertices);
      std::array<cv::Point, 4> points;
      for (int k = 0; k < 4; ++k) points[k] = vertices[k];
      cv::fillConvexPoly(image, points.data(), 4, grey, cv::LINE_AA);
    }
  }
  cv::GaussianBlur(image, image, {}, Uniform(0.6, 1.4, rng));
  return image;
}

cv::Mat WithNoise(cv::Mat image, std::mt19937* rng) {
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      // The sum of four uniform variables is near enough to a normal one: sigma about 2.3.
      double noise = 0;
      for (int k = 0; k < 4; ++k) noise += Uniform(-2, 2, rng);
      image.at<uchar>(y, x) = cv::saturate_cast<uchar>(image.at<uchar>(y, x) + noise);
    }
  }
  return image;
}

struct Position {
  int x, y;
};

std::vector<Position> DiscPositions() {
  std::vector<Position> positions;
  for (int y = -kPatternRadius_px; y <= kPatternRadius_px; ++y) {
    for (int x = -kPatternRadius_px; x <= kPatternRadius_px; ++x) {
      if (x * x + y * y <= kPatternRadius_px * kPatternRadius_px) positions.push_back({x, y});
    }
  }
  return positions;
}

/// Smoothed grey values at all positions of the disc turned by the corner's orientation; one row
/// per corner, for the image in which it was found and for another view of the same place.
struct Patches {
  std::vector<std::vector<uint8_t>> first, second;
};

std::vector<uint8_t> CutOut(const cv::Mat& level, const cv::Mat& smoothed, int x, int y,
                            const std::vector<Position>& positions) {
  const double angle_rad = Orientation_rad(level, x, y);
  std::vector<uint8_t> patch;
  patch.reserve(positions.size());
  for (const Position& p : positions) {
    const auto [dx, dy] = TurnedPixel(p.x, p.y, angle_rad);
    patch.push_back(smoothed.at<uchar>(y + dy, x + dx));
  }
  return patch;
}

/// Turned by up to 40 degrees, up to 15 % larger or smaller, up to 10 % compressed in one
/// direction.
cv::Matx23d RandomView(std::mt19937* rng) {
  const double turn = Uniform(-0.7, 0.7, rng), axis = Uniform(0, 3.14, rng);
  const double scale = Uniform(0.85, 1.15, rng), squeeze = Uniform(0.9, 1, rng);
  const auto rotation = [](double a) {
    return cv::Matx22d(std::cos(a), -std::sin(a), std::sin(a), std::cos(a));
  };
  const cv::Matx22d m =
      rotation(turn + axis) * cv::Matx22d(scale, 0, 0, scale * squeeze) * rotation(-axis);
  const cv::Vec2d centre(kWidth / 2, kHeight / 2);
  const cv::Vec2d t = centre - m * centre;
  return {m(0, 0), m(0, 1), t[0], m(1, 0), m(1, 1), t[1]};
}

Patches CollectPatches(const std::vector<Position>& positions, std::mt19937* rng) {
  constexpr int kMargin_px = kOrientationRadius_px + 1;
  constexpr int kPerLevel = 150;
  const ScalePyramid scales(8, 1.2);
  ImagePyramid first(kWidth, kHeight, scales, 2 * kMargin_px + 1), second = first;
  CornerDetector detector({.margin_px = kMargin_px});
  KeypointDistribution distribution;
  Smoother smoother;
  Patches patches;
  std::vector<Corner> corners;
  for (int i = 0; i < kNumImages; ++i) {
    const cv::Mat image = DeadLeaves(kWidth, kHeight, rng);
    const cv::Matx23d view = RandomView(rng);
    cv::Mat seen;
    cv::warpAffine(image, seen, view, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
    first = ImagePyramid(kWidth, kHeight, scales, 2 * kMargin_px + 1);
    second = ImagePyramid(kWidth, kHeight, scales, 2 * kMargin_px + 1);
    first.Build(WithNoise(image, rng));
    second.Build(WithNoise(seen, rng));
    for (int octave = 0; octave < first.num_levels(); ++octave) {
      const cv::Mat &a = first.level(octave), &b = second.level(octave);
      detector.Detect(a, &corners);
      distribution.Select(a.size(), kPerLevel, &corners);
      cv::Mat smoothed_a(a.size(), CV_8UC1), smoothed_b(b.size(), CV_8UC1);
      smoother.Smooth(a, &smoothed_a);
      smoother.Smooth(b, &smoothed_b);
      for (const Corner& c : corners) {
        const cv::Vec2d in_second =
            view * cv::Vec3d(first.ToLevelZeroX(octave, c.x), first.ToLevelZeroY(octave, c.y), 1);
        // A detector would find it within a pixel or so.
        const double scale = scales.scale(octave);
        const int x = static_cast<int>(std::lround((in_second[0] + 0.5) / scale - 0.5 +
                                                   Uniform(-kJitter_px, kJitter_px, rng)));
        const int y = static_cast<int>(std::lround((in_second[1] + 0.5) / scale - 0.5 +
                                                   Uniform(-kJitter_px, kJitter_px, rng)));
        if (x < kMargin_px || y < kMargin_px || x >= b.cols - kMargin_px ||
            y >= b.rows - kMargin_px) {
          continue;
        }
        patches.first.push_back(CutOut(a, smoothed_a, c.x, c.y, positions));
        patches.second.push_back(CutOut(b, smoothed_b, x, y, positions));
      }
    }
  }
  return patches;
}

/// A pair and the outcomes of its comparison, one bit per patch.
struct Candidate {
  PatternPair pair;
  std::vector<uint64_t> outcomes;
  double mean = 0;
  double instability = 0;  ///< probability to differ between two views / between two corners
};

double Correlation(const Candidate& a, const Candidate& b, double n) {
  int both = 0;
  for (size_t i = 0; i < a.outcomes.size(); ++i) {
    both += std::popcount(a.outcomes[i] & b.outcomes[i]);
  }
  return (both / n - a.mean * b.mean) /
         std::sqrt(a.mean * (1 - a.mean) * b.mean * (1 - b.mean) + 1e-12);
}

/// The most stable candidates first; the rest is dropped.
std::vector<Candidate> MakeCandidates(const std::vector<Position>& positions,
                                      const Patches& patches, std::mt19937* rng) {
  std::vector<Candidate> candidates;
  const size_t n = patches.first.size();
  while (static_cast<int>(candidates.size()) < kNumCandidates) {
    const size_t p = (*rng)() % positions.size(), q = (*rng)() % positions.size();
    if (p == q) continue;
    Candidate c;
    c.pair = {static_cast<int8_t>(positions[p].x), static_cast<int8_t>(positions[p].y),
              static_cast<int8_t>(positions[q].x), static_cast<int8_t>(positions[q].y)};
    c.outcomes.assign((n + 63) / 64, 0);
    int ones = 0, flips = 0;
    for (size_t i = 0; i < n; ++i) {
      const bool less = patches.first[i][p] < patches.first[i][q];
      ones += less;
      flips += less != (patches.second[i][p] < patches.second[i][q]);
      c.outcomes[i / 64] |= static_cast<uint64_t>(less) << (i % 64);
    }
    c.mean = static_cast<double>(ones) / static_cast<double>(n);
    c.instability =
        static_cast<double>(flips) / static_cast<double>(n) / (2 * c.mean * (1 - c.mean) + 1e-9);
    candidates.push_back(std::move(c));
  }
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.instability < b.instability; });
  candidates.resize(static_cast<size_t>(kKeptShare * kNumCandidates));
  std::fprintf(stderr, "instability %.3f to %.3f\n", candidates.front().instability,
               candidates.back().instability);
  return candidates;
}

std::vector<const Candidate*> Choose(const std::vector<Candidate>& candidates, double n) {
  for (double threshold = 0.2;; threshold += 0.02) {
    std::vector<const Candidate*> chosen;
    for (const Candidate& c : candidates) {
      const bool independent = std::all_of(chosen.begin(), chosen.end(), [&](const Candidate* o) {
        return std::abs(Correlation(c, *o, n)) < threshold;
      });
      if (independent) chosen.push_back(&c);
      if (chosen.size() == kNumBits) {
        std::fprintf(stderr, "largest correlation %.2f, largest |mean - 0.5| %.3f\n", threshold,
                     std::abs(c.mean - 0.5));
        return chosen;
      }
    }
  }
}

}  // namespace
}  // namespace vpslam

int main() {
  using namespace vpslam;
  std::mt19937 rng(kSeed);
  const std::vector<Position> positions = DiscPositions();
  const Patches patches = CollectPatches(positions, &rng);
  std::fprintf(stderr, "%zu patches\n", patches.first.size());
  const std::vector<Candidate> candidates = MakeCandidates(positions, patches, &rng);
  std::printf(
      "// Written by learn_orb_pattern; do not edit.\n"
      "#include \"core/features/orb_pattern.h\"\n\n"
      "namespace vpslam {\n\n"
      "// clang-format off\n"
      "const std::array<PatternPair, %d> kOrbPattern = {{\n",
      kNumBits);
  int column = 0;
  for (const Candidate* c : Choose(candidates, static_cast<double>(patches.first.size()))) {
    std::printf("%s{%d, %d, %d, %d},%s", column == 0 ? "    " : " ", c->pair.x1, c->pair.y1,
                c->pair.x2, c->pair.y2, column == 4 ? "\n" : "");
    column = (column + 1) % 5;
  }
  std::printf("%s}};\n// clang-format on\n\n}  // namespace vpslam\n", column ? "\n" : "");
  return 0;
}
