// All that the tracker takes from one image: point features, and lines where there are detectors.
//
// Live tracking and the replay of a log consume this one struct, which holds numbers exactly as
// messages do; so both compute the same, to the bit.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/base/description.h"
#include "core/features/features.h"
#include "core/features/line_set.h"
#include "core/messages/stages.h"

namespace vpslam {

struct FrameFeatures {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  int64_t published_us = 0;  ///< as ImageFrame::published_us
  double decode_ms = kNotRun;
  double features_ms = kNotRun;  ///< spent on finding them
  Features features;
  std::shared_ptr<const LineSet> lines;  ///< nullptr: tracked without lines

  static constexpr const char* kWireName = "features_t";
  static void Describe(auto& v, auto& m) {
    auto& [frame_seq, stamp_us, published_us, decode_ms, features_ms, features, lines] = m;
    v("frame_seq", frame_seq, kNotNegative);
    v("stamp_us", stamp_us);
    v("published_us", published_us);
    v("decode_ms", decode_ms, Duration());
    v("features_ms", features_ms, Duration());
    v.Array("num_features", "keypoints", features.keypoints);
    v.Array("num_features", "descriptors", features.descriptors);
    v.Optional("has_lines", lines, LineSet(), [](auto& visitor, auto& set) {
      visitor.Nested("line_set", set, LineSetSummary());
      visitor.Array("num_lines", "lines", set.lines);
      visitor.Array("num_vanishing_points", "vanishing_points", set.vanishing_points);
    });
  }
  std::optional<std::string> Validate() const { return lines ? lines->Validate() : std::nullopt; }
};

}  // namespace vpslam
