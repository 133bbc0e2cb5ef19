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

/// Marks of a grid with a frame around it, which saves the test for the border.
struct FramedGrid {
  FramedGrid(cv::Size size, float cell_px, std::vector<uint8_t>* marks)
      : cells_per_px(1.0f / cell_px),
        columns(static_cast<int>(static_cast<float>(size.width) * cells_per_px) + 1 + 2 * kFrame),
        marks_(*marks) {
    const int rows = static_cast<int>(static_cast<float>(size.height) * cells_per_px) + 1;
    marks_.assign(static_cast<size_t>(columns) * (rows + 2 * kFrame), 0);
  }
  uint8_t* At(const Corner& c) const {
    const int column = static_cast<int>(static_cast<float>(c.x) * cells_per_px);
    const int row = static_cast<int>(static_cast<float>(c.y) * cells_per_px);
    return &marks_[(row + kFrame) * columns + column + kFrame];
  }
  void MarkAround(uint8_t* cell) const {
    for (int r = -kFrame; r <= kFrame; ++r) {
      std::fill_n(cell + r * columns - kFrame, 2 * kFrame + 1, uint8_t{1});
    }
  }

  static constexpr int kFrame = 2;
  float cells_per_px;
  int columns;

 private:
  std::vector<uint8_t>& marks_;
};

}  // namespace

std::optional<std::string> DistributionOptions::Validate() const {
  if (!(min_spacing >= 0 && min_spacing <= 1)) return "min_spacing must lie in 0 to 1";
  if (!(cell > 0 && cell <= 100)) return "cell must lie in 0 to 100";
  return std::nullopt;
}

void KeypointDistribution::Select(cv::Size size, int wanted, std::vector<Corner>* corners) {
  if (wanted >= static_cast<int>(corners->size())) return;
  SortByScore(*corners, &sorted_);
  corners->clear();
  if (wanted <= 0) return;
  const double spacing_px = std::sqrt(static_cast<double>(size.area()) / wanted);
  // A corner covers its cell and two more to each side; cells below half a pixel change nothing.
  const double cover_px = options_.min_spacing * spacing_px / FramedGrid::kFrame;
  const FramedGrid cover(size, static_cast<float>(std::max(0.5, cover_px)), &cover_mask_);
  const FramedGrid cells(size, static_cast<float>(std::max(1.0, options_.cell * spacing_px)),
                         &cell_taken_);
  uncovered_.clear();
  covered_.clear();
  const size_t limit = static_cast<size_t>(wanted);
  for (const Corner& c : sorted_) {
    uint8_t* mark = cover.At(c);
    if (*mark) {
      covered_.push_back(c);
      continue;
    }
    cover.MarkAround(mark);
    uint8_t* taken = cells.At(c);
    if (*taken) {
      uncovered_.push_back(c);
    } else {
      *taken = 1;
      corners->push_back(c);
      if (corners->size() == limit) return;
    }
  }
  for (const std::vector<Corner>* rest : {&uncovered_, &covered_}) {
    const size_t n = std::min(limit - corners->size(), rest->size());
    corners->insert(corners->end(), rest->begin(), rest->begin() + static_cast<std::ptrdiff_t>(n));
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
