// How many frames a video file should have, as its container says, and what FFmpeg complains about
// while it is read. OpenCV knows neither: it counts what an edit list cuts away, and multiplies a
// length by a rate where times are uneven.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace vpslam {

struct VideoContents {
  /// Frames that are to be shown, where the container counts them; nullopt where it does not
  /// (Matroska, transport streams, ...).
  std::optional<int64_t> frames;
  /// How long the pictures last by the container's header; 0 where it does not say.
  double duration_s = 0;
};

/// Nothing is known of a file that FFmpeg cannot open.
VideoContents ReadVideoContents(const std::string& path);

/// What FFmpeg complains about while this lives: it writes that nowhere then. One at a time.
class FfmpegComplaints {
 public:
  FfmpegComplaints();
  ~FfmpegComplaints();
  FfmpegComplaints(const FfmpegComplaints&) = delete;
  FfmpegComplaints& operator=(const FfmpegComplaints&) = delete;

  /// Again: OpenCV takes over when it opens its first video.
  static void Listen();

  int64_t count() const;
  std::string first() const;  ///< a line
};

}  // namespace vpslam
