// Key points of one image sorted into square cells, to find those near a position without looking
// at all of them.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/features/features.h"
#include "core/geometry/camera.h"

namespace vpslam {

/// Octaves from `min` to `max`, both included.
struct OctaveRange {
  int min = 0;
  int max = std::numeric_limits<int>::max();
};

class FeatureGrid {
 public:
  /// An empty grid: finds nothing.
  FeatureGrid() = default;
  /// Copies the positions; `keypoints` need not live on. Key points outside `bounds` belong to the
  /// nearest cell. Cells are about `cell_px` wide.
  FeatureGrid(const std::vector<Keypoint>& keypoints, const Camera::Bounds& bounds,
              double cell_px = 10.0);

  /// Calls f(index) for each key point closer than `radius_px` to (x_px, y_px); ordered by cell,
  /// row by row, and by index within a cell.
  template <class F>
  void ForEachInRadius(float x_px, float y_px, float radius_px, OctaveRange octaves, F&& f) const {
    const CellRange range = CellsAround(x_px, y_px, radius_px);
    const float radius2 = radius_px * radius_px;
    for (int row = range.row_begin; row < range.row_end; ++row) {
      // The cells of one row lie one after the other, so their entries do, too.
      const int begin = cell_begin_[row * columns_ + range.column_begin];
      const int end = cell_begin_[row * columns_ + range.column_end];
      for (int i = begin; i < end; ++i) {
        const Entry& e = entries_[i];
        const float dx = e.x_px - x_px, dy = e.y_px - y_px;
        if (dx * dx + dy * dy < radius2 && e.octave >= octaves.min && e.octave <= octaves.max) {
          f(e.index);
        }
      }
    }
  }

  /// The same as a list.
  std::vector<int> FindInRadius(float x_px, float y_px, float radius_px,
                                OctaveRange octaves = {}) const;

 private:
  struct Entry {
    float x_px, y_px;
    int32_t octave;
    int32_t index;
  };
  /// Half-open.
  struct CellRange {
    int column_begin = 0, column_end = 0, row_begin = 0, row_end = 0;
  };
  CellRange CellsAround(float x_px, float y_px, float radius_px) const;

  double min_x_ = 0, min_y_ = 0;
  double columns_per_px_ = 0, rows_per_px_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<int32_t> cell_begin_;  ///< rows x columns + 1 offsets into entries_
  std::vector<Entry> entries_;
};

}  // namespace vpslam
