// An image as it travels: its pixels inline, or where in shared memory they lie.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/description.h"
#include "core/messages/image_frame.h"
#include "core/messages/names.h"

namespace vpslam {

enum class ImageEncoding : int32_t { kGray8 = 1 };  ///< one byte per pixel

struct ImageMessage {
  static constexpr int32_t kMaxSide = 16384;  ///< px

  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  int64_t published_us = 0;
  double decode_ms = kNotRun;
  int32_t width = 0;   ///< px
  int32_t height = 0;  ///< px; rows follow each other without padding
  ImageEncoding encoding = ImageEncoding::kGray8;
  std::string segment;  ///< name of the POSIX shared memory; empty: inline
  int32_t slot = 0;
  int64_t generation = 0;      ///< of the slot when it was written
  std::vector<uint8_t> bytes;  ///< inline: width x height

  static constexpr const char* kWireName = "image_t";
  static void Describe(auto& v, auto& m) {
    auto& [frame_seq, stamp_us, published_us, decode_ms, width, height, encoding, segment, slot,
           generation, bytes] = m;
    v("frame_seq", frame_seq, kNotNegative);
    v("stamp_us", stamp_us);
    v("published_us", published_us);
    v("decode_ms", decode_ms, Duration());
    v("width", width, Between{1, kMaxSide});
    v("height", height, Between{1, kMaxSide});
    v("encoding", encoding, OneOf<ImageEncoding::kGray8>());
    v("segment", segment, Text{kMaxNameLength});
    v("slot", slot);
    v("generation", generation);
    v.Array("num_bytes", "bytes", bytes);
  }
  std::optional<std::string> Validate() const;
};

/// With the pixels inside: for other hosts and for logs.
ImageMessage InlineImage(const ImageFrame& frame);

}  // namespace vpslam
