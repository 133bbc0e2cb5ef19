// Which detector is asked for the lines of which image. Images go to whoever has least to do, so a
// detector that is slow, has stopped or has died gets no more, and one that starts later takes its
// share at once. Knows neither LCM nor clocks.
//
// A detector is known by the session of its messages. It has at most `max_in_hand` images in hand:
// what waits beyond that, waits here, where it can still go to another. What a detector does not
// answer in time is asked of another, and that detector is suspect: it gets no image as long as
// there is one who is not, until it answers anything or says that it has nothing in hand. Where
// there is no other it is asked again, since the request may have been lost. Detectors forget what
// they were asked twice while they work on it, and who needs the lines drops repeated ones.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/messages/lines_request.h"

namespace vpslam {

struct LineDispatchOptions {
  /// 2: one to work on, and one that is there when that is done.
  int max_in_hand = 2;
  /// Lockstep and lossless: every image is asked for. Otherwise, of the images that wait for a
  /// detector, only the newest stays.
  bool keep_all = true;
  /// After that long without an answer another detector is asked; doubled with every further
  /// attempt, up to 8 times ...
  std::chrono::milliseconds patience{250};
  /// ... and never less than so many times what an answer took lately.
  double patience_factor = 6;
  /// A detector that says nothing for so long is gone.
  std::chrono::milliseconds forget_after{5000};

  std::optional<std::string> Validate() const;
};

class LineDispatch {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Throws std::invalid_argument if the options do not validate.
  explicit LineDispatch(const LineDispatchOptions& options);

  /// An image came; one of a new session means that all before are obsolete. Repeated images and
  /// those that were passed make no difference.
  void AddImage(int64_t session, int64_t frame_seq);
  /// A detector said of itself that it can work, and how much it has in hand.
  void AddDetector(int64_t detector, int64_t in_hand, Time now);
  /// A detector said that it has ended.
  void RemoveDetector(int64_t detector);
  /// Lines came from a detector.
  void AddAnswer(int64_t detector, int64_t frame_seq, Time now);
  /// The lines that came were not those of this image.
  void AskAgain(int64_t frame_seq);
  /// Lines of this image and those before are needed no more.
  void Pass(int64_t frame_seq);

  /// What is to be asked now. To be called after each of the above, and from time to time.
  std::vector<LinesRequest> Requests(Time now);

  int detectors() const { return static_cast<int>(detectors_.size()); }

 private:
  struct Image {
    bool asked = false;
    int attempts = 0;
  };
  struct Detector {
    Time heard, last_asked;
    bool suspect = false;
    struct Question {
      Time asked;
      std::chrono::duration<double> patience;
    };
    std::map<int64_t, Question> in_hand;  ///< by frame_seq
  };

  void GiveUp(Time now);
  Detector* Idlest(int64_t* session);
  std::chrono::duration<double> Patience(int attempts) const;

  const LineDispatchOptions options_;
  int64_t image_session_ = 0;
  int64_t passed_ = -1;              ///< frame_seq
  std::map<int64_t, Image> images_;  ///< by frame_seq; those that no lines came for
  std::set<int64_t> answered_;       ///< frame_seq, of images that were not passed
  std::map<int64_t, Detector> detectors_;
  double usual_s_ = 0;  ///< from request to answer
};

}  // namespace vpslam
