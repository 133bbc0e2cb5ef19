#include "frontend/line_joiner.h"

#include <stdexcept>
#include <utility>

namespace vpslam {

std::optional<std::string> LineJoinerOptions::Validate() const {
  if (!(deadline_ms >= 0)) return "the deadline for lines must be >= 0 ms";
  if (max_kept < 1) return "the lines of one image at least must be kept";
  return std::nullopt;
}

LineJoiner::LineJoiner(const LineJoinerOptions& options) : options_(options) {
  if (const auto why = options.Validate()) throw std::invalid_argument(*why);
}

bool LineJoiner::Add(LineSet lines) {
  const int64_t seq = lines.frame_seq;
  if (seq <= passed_) return false;
  const bool is_new = kept_.try_emplace(seq, std::move(lines)).second;
  if (kept_.size() > options_.max_kept) kept_.erase(kept_.begin());
  return is_new;
}

LineJoiner::Verdict LineJoiner::Look(int64_t frame_seq, int64_t stamp_us, int64_t published_us,
                                     int64_t now_us) const {
  const auto found = kept_.find(frame_seq);
  if (found != kept_.end() && found->second.stamp_us == stamp_us) return Verdict::kHere;
  if (options_.wait_for_all) return Verdict::kWait;
  const double waited_ms = static_cast<double>(now_us - published_us) * 1e-3;
  return waited_ms < options_.deadline_ms ? Verdict::kWait : Verdict::kGoOn;
}

bool LineJoiner::DropAlien(int64_t frame_seq, int64_t stamp_us) {
  const auto found = kept_.find(frame_seq);
  if (found == kept_.end() || found->second.stamp_us == stamp_us) return false;
  kept_.erase(found);
  return true;
}

std::optional<LineSet> LineJoiner::Take(int64_t frame_seq, int64_t stamp_us) {
  std::optional<LineSet> lines;
  const auto found = kept_.find(frame_seq);
  if (found != kept_.end() && found->second.stamp_us == stamp_us) lines = std::move(found->second);
  passed_ = frame_seq;
  kept_.erase(kept_.begin(), kept_.upper_bound(frame_seq));
  return lines;
}

void LineJoiner::Restart() {
  kept_.clear();
  passed_ = -1;
}

}  // namespace vpslam
