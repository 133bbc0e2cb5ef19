#include "core/features/keypoint_distribution.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vpslam {
namespace {

/// Counting sort, strongest first, stable.
void SortByScore(const std::vector<Corner>& corners, std::vector<Corner>* sorted) {
  constexpr int kNumScores = 256;
  std::array<int, kNumScores + 1> begin{};  // of the score 255 - i
  const auto bucket = [](const Corner& c) { return kNumScores - 1 - c.score; };
  for (const Corner& c : corners) ++begin[bucket(c) + 1];
  for (int i = 0; i < kNumScores; ++i) begin[i + 1] += begin[i];
  sorted->resize(corners.size());
  for (const Corner& c : corners) (*sorted)[begin[bucket(c)]++] = c;
}

}  // namespace

void KeypointDistribution::Cover(cv::Size size, float cell_px, int limit) {
  constexpr int kReach = 2;  // cells to each side; finer ones cost more and choose no better
  const float cells_per_px = 1.0f / cell_px;
  // A frame of kReach cells saves the test for the border.
  const int columns = static_cast<int>(size.width * cells_per_px) + 1 + 2 * kReach;
  const int rows = static_cast<int>(size.height * cells_per_px) + 1 + 2 * kReach;
  covered_.assign(static_cast<size_t>(columns) * rows, 0);
  picked_.clear();
  for (const Corner& c : sorted_) {
    const int column = static_cast<int>(c.x * cells_per_px);
    const int row = static_cast<int>(c.y * cells_per_px);
    if (covered_[(row + kReach) * columns + column + kReach]) continue;
    picked_.push_back(c);
    if (static_cast<int>(picked_.size()) >= limit) return;
    for (int r = row; r <= row + 2 * kReach; ++r) {
      std::fill_n(covered_.begin() + r * columns + column, 2 * kReach + 1, uint8_t{1});
    }
  }
}

void KeypointDistribution::Select(cv::Size size, int wanted, std::vector<Corner>* corners) {
  SortByScore(*corners, &sorted_);
  if (wanted >= static_cast<int>(corners->size())) {
    corners->swap(sorted_);
    return;
  }
  corners->assign(sorted_.begin(), sorted_.begin() + std::max(wanted, 0));
  if (wanted <= 0) return;

  // Bisection between "covers its own pixel only" and the square that fewer than `wanted` would
  // fill; the strongest `wanted` corners, as they stand now, if even the former leaves too few.
  constexpr int kIterations = 8;
  const int limit = wanted + std::max(wanted / 20, 1);
  float low = 0.5f;
  float high = std::sqrt(static_cast<float>(size.area()) / static_cast<float>(wanted));
  for (int i = 0; i < kIterations && high - low > 0.1f; ++i) {
    const float cell_px = 0.5f * (low + high);
    Cover(size, cell_px, limit);
    const int count = static_cast<int>(picked_.size());
    if (count < wanted) {
      high = cell_px;
      continue;
    }
    low = cell_px;
    corners->assign(picked_.begin(), picked_.begin() + wanted);
    if (count < limit) break;
  }
}

std::vector<int> ShareOut(int num_features, double factor, const std::vector<int>& available) {
  const size_t n = available.size();
  std::vector<int> shares(n, 0);
  std::vector<char> full(n, 0);
  int left = num_features;
  // Each round hands out what is left among the levels that have more; ends when all are full or
  // nothing is left. A round fills a level or is the last one.
  for (size_t round = 0; round <= n && left > 0; ++round) {
    double total_weight = 0;
    for (size_t i = 0; i < n; ++i) {
      if (!full[i]) total_weight += std::pow(factor, -static_cast<double>(i));
    }
    // Rounding the running sum makes the shares add up.
    double running = 0;
    int before = 0, given = 0;
    for (size_t i = 0; i < n; ++i) {
      if (full[i]) continue;
      running += left * std::pow(factor, -static_cast<double>(i)) / total_weight;
      const int upto = static_cast<int>(std::lround(running));
      const int share = std::min(upto - before, available[i] - shares[i]);
      before = upto;
      shares[i] += share;
      given += share;
      full[i] = shares[i] >= available[i];
    }
    left -= given;
  }
  return shares;
}

}  // namespace vpslam
