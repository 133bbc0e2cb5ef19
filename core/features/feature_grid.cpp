#include "core/features/feature_grid.h"

#include <algorithm>
#include <cmath>

namespace vpslam {
namespace {

/// Cell of a coordinate; -1 or `count` outside. Clamped as a double, since any float may come.
int Cell(double coordinate, double min, double per_px, int count) {
  return static_cast<int>(
      std::clamp(std::floor((coordinate - min) * per_px), -1.0, static_cast<double>(count)));
}

}  // namespace

FeatureGrid::FeatureGrid(const std::vector<Keypoint>& keypoints, const Camera::Bounds& bounds,
                         double cell_px)
    : min_x_(bounds.min_x), min_y_(bounds.min_y) {
  const double width = bounds.max_x - bounds.min_x, height = bounds.max_y - bounds.min_y;
  columns_ = std::max(1, static_cast<int>(std::lround(width / cell_px)));
  rows_ = std::max(1, static_cast<int>(std::lround(height / cell_px)));
  columns_per_px_ = columns_ / width;
  rows_per_px_ = rows_ / height;

  const auto cell_of = [&](const Keypoint& k) {
    const int column = std::clamp(Cell(k.x_px, min_x_, columns_per_px_, columns_), 0, columns_ - 1);
    const int row = std::clamp(Cell(k.y_px, min_y_, rows_per_px_, rows_), 0, rows_ - 1);
    return row * columns_ + column;
  };
  // Counting sort by cell.
  cell_begin_.assign(static_cast<size_t>(columns_) * rows_ + 1, 0);
  for (const Keypoint& k : keypoints) ++cell_begin_[cell_of(k) + 1];
  for (size_t i = 1; i < cell_begin_.size(); ++i) cell_begin_[i] += cell_begin_[i - 1];
  entries_.resize(keypoints.size());
  std::vector<int32_t> next(cell_begin_.begin(), cell_begin_.end() - 1);
  for (size_t i = 0; i < keypoints.size(); ++i) {
    const Keypoint& k = keypoints[i];
    entries_[next[cell_of(k)]++] = {k.x_px, k.y_px, k.octave, static_cast<int32_t>(i)};
  }
}

FeatureGrid::CellRange FeatureGrid::CellsAround(float x_px, float y_px, float radius_px) const {
  CellRange range;
  if (entries_.empty() || !std::isfinite(x_px) || !std::isfinite(y_px) || !(radius_px > 0)) {
    return range;
  }
  // Border cells also hold what lies outside, so a circle outside looks at the nearest ones.
  const auto limit = [](int cell, int count) { return std::clamp(cell, 0, count - 1); };
  const double r = radius_px;
  range.column_begin = limit(Cell(x_px - r, min_x_, columns_per_px_, columns_), columns_);
  range.column_end = limit(Cell(x_px + r, min_x_, columns_per_px_, columns_), columns_) + 1;
  range.row_begin = limit(Cell(y_px - r, min_y_, rows_per_px_, rows_), rows_);
  range.row_end = limit(Cell(y_px + r, min_y_, rows_per_px_, rows_), rows_) + 1;
  return range;
}

std::vector<int> FeatureGrid::FindInRadius(float x_px, float y_px, float radius_px,
                                           OctaveRange octaves) const {
  std::vector<int> found;
  ForEachInRadius(x_px, y_px, radius_px, octaves, [&](int i) { found.push_back(i); });
  return found;
}

}  // namespace vpslam
