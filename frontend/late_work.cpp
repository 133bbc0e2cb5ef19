#include "frontend/late_work.h"

#include <optional>
#include <utility>
#include <vector>

#include "frontend/keyframe_policy.h"
#include "frontend/pose_report.h"

namespace vpslam {
namespace {

/// By an image and the late work after it.
constexpr size_t kMaxProposedPerImage = 2;

}  // namespace

void LateWork::PlaceAroundStart(const PendingFrames& pending, const Frame& first,
                                int64_t second_seq) {
  std::vector<Frame> frames(pending.before_loss.begin(), pending.before_loss.end());
  for (Frame& frame : frames) frame.placement = Placement();
  frames.insert(frames.end(), pending.frames.begin(), pending.frames.end());
  pre_loss_.Add(pending.before_loss);
  walks_.Start(std::move(frames), first, second_seq);
}

void LateWork::PlaceBackFrom(const Frame& found, const PendingFrames& pending) {
  walks_.Return({pending.frames.begin(), pending.frames.end()}, found);
}

void LateWork::Step(size_t num_proposed, TrackerOutput* output) {
  for (int i = 0; i < options_.late_frames_per_frame; ++i) {
    if (!walks_.Busy()) return pre_loss_.Clear();
    if (walks_.Waits(context_.map)) return;
    std::optional<Frame> frame = walks_.Step(context_);
    if (!frame) continue;
    const bool has_pose = pre_loss_.Has(*frame);
    const auto seam = pre_loss_.SeamAt(context_.map, *frame);
    if (has_pose && !seam) {
      // From here on the walk would place again what has a place, for nothing.
      walks_.EndWalk();
      continue;
    }
    const bool has_room = num_proposed + output->keyframes.size() < kMaxProposedPerImage;
    const bool is_keyframe = has_room && IsKeyframe(*frame, seam.has_value());
    if (is_keyframe) {
      output->keyframes.push_back(proposer_.Propose(&*frame));
      if (seam) output->keyframes.back().seam = *seam;
      walks_.GoOnFrom(*frame);
    }
    if (has_pose) continue;
    output->poses.push_back(ReportPlacedLate(*frame));
    if (is_keyframe) output->poses.back().keyframe = frame->placement.reference;
  }
}

bool LateWork::IsKeyframe(const Frame& frame, bool has_seam) const {
  return proposer_.earlier().unanswered == 0 &&
         walks_.frames_since_keyframe() >= options_.late_frames_per_keyframe &&
         (has_seam ||
          IsWeaklyTracked(frame, frame.placement.reference, context_.map, options_.keyframes));
}

void LateWork::Finish(TrackerOutput* output) {
  while (walks_.Busy()) {
    const std::optional<Frame> frame = walks_.Step(context_);
    if (!frame) continue;
    if (pre_loss_.Has(*frame)) {
      walks_.EndWalk();
    } else {
      output->poses.push_back(ReportPlacedLate(*frame));
    }
  }
}

}  // namespace vpslam
