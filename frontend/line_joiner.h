// Brings images and their lines together by sequence number, whatever the order in which lines come
// and however often, and says how long an image waits for them. Knows neither LCM nor clocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/features/line_set.h"

namespace vpslam {

struct LineJoinerOptions {
  /// Lockstep and lossless: an image waits for its lines however long they take. Otherwise it goes
  /// on without them at the deadline.
  bool wait_for_all = true;
  double deadline_ms = 25;  ///< from the publication of the image
  /// Lines that are kept for images to come; beyond that, those of the oldest image go.
  std::size_t max_kept = 64;

  std::optional<std::string> Validate() const;
};

class LineJoiner {
 public:
  /// Throws std::invalid_argument if the options do not validate.
  explicit LineJoiner(const LineJoinerOptions& options);

  /// False for lines that are there already, or of an image that was passed.
  bool Add(LineSet lines);

  enum class Verdict {
    kHere,  ///< Take gives them
    kWait,  ///< ask again later
    kGoOn,  ///< without lines: the deadline has passed
  };
  /// `stamp_us` is the image's: lines with another belong to another sequence and are not its own.
  /// `now_us` and `published_us` are of one clock.
  Verdict Look(int64_t frame_seq, int64_t stamp_us, int64_t published_us, int64_t now_us) const;
  /// Forgets lines of this number that are another sequence's; true if there were any, so that the
  /// image's own have to be asked for again.
  bool DropAlien(int64_t frame_seq, int64_t stamp_us);
  /// The lines of the image, if they are there. This image and all before it are passed then.
  std::optional<LineSet> Take(int64_t frame_seq, int64_t stamp_us);

  /// The images begin anew: their sender was restarted.
  void Restart();

 private:
  const LineJoinerOptions options_;
  std::map<int64_t, LineSet> kept_;  ///< by frame_seq
  int64_t passed_ = -1;              ///< frame_seq
};

}  // namespace vpslam
