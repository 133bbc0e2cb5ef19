#include "frontend/line_dispatch.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>

namespace vpslam {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr double kSmoothing = 0.1;  // of the usual time of an answer
constexpr int kMaxDoublings = 3;

}  // namespace

std::optional<std::string> LineDispatchOptions::Validate() const {
  if (max_in_hand < 1) return "a detector must be given one image at least";
  if (patience.count() <= 0 || !(patience_factor >= 1))
    return "patience must be > 0, its factor >= 1";
  if (forget_after <= patience) return "a detector must not be forgotten before patience is lost";
  return std::nullopt;
}

LineDispatch::LineDispatch(const LineDispatchOptions& options) : options_(options) {
  if (const auto why = options.Validate()) throw std::invalid_argument(*why);
}

void LineDispatch::AddImage(int64_t session, int64_t frame_seq) {
  if (session != image_session_) {
    image_session_ = session;
    passed_ = -1;
    images_.clear();
    answered_.clear();
    for (auto& [id, detector] : detectors_) detector.in_hand.clear();
  }
  if (frame_seq <= passed_ || answered_.contains(frame_seq)) return;
  if (!images_.try_emplace(frame_seq).second || options_.keep_all) return;
  std::erase_if(images_, [frame_seq](const auto& entry) {
    return entry.first < frame_seq && !entry.second.asked;
  });
}

void LineDispatch::AddDetector(int64_t id, int64_t in_hand, Time now) {
  Detector& detector = detectors_[id];
  detector.heard = now;
  if (in_hand == 0) detector.suspect = false;
}

void LineDispatch::RemoveDetector(int64_t id) {
  const auto found = detectors_.find(id);
  if (found == detectors_.end()) return;
  for (const auto& [seq, question] : found->second.in_hand) {
    if (const auto image = images_.find(seq); image != images_.end()) image->second.asked = false;
  }
  detectors_.erase(found);
}

void LineDispatch::AddAnswer(int64_t id, int64_t frame_seq, Time now) {
  Detector& detector = detectors_[id];
  detector.heard = now;
  detector.suspect = false;
  if (const auto question = detector.in_hand.find(frame_seq); question != detector.in_hand.end()) {
    const double took_s = Seconds(now - question->second.asked).count();
    usual_s_ = usual_s_ == 0 ? took_s : usual_s_ + kSmoothing * (took_s - usual_s_);
    detector.in_hand.erase(question);
  }
  if (frame_seq <= passed_) return;
  images_.erase(frame_seq);
  answered_.insert(frame_seq);
}

void LineDispatch::AskAgain(int64_t frame_seq) {
  if (answered_.erase(frame_seq) > 0) images_.try_emplace(frame_seq);
}

void LineDispatch::Pass(int64_t frame_seq) {
  passed_ = std::max(passed_, frame_seq);
  images_.erase(images_.begin(), images_.upper_bound(passed_));
  answered_.erase(answered_.begin(), answered_.upper_bound(passed_));
}

std::vector<LinesRequest> LineDispatch::Requests(Time now) {
  GiveUp(now);
  std::vector<LinesRequest> requests;
  for (auto& [seq, image] : images_) {
    if (image.asked) continue;
    int64_t session = 0;
    Detector* detector = Idlest(&session);
    if (!detector) break;
    detector->in_hand[seq] = {now, Patience(image.attempts)};
    detector->last_asked = now;
    image.asked = true;
    ++image.attempts;
    requests.push_back({seq, image_session_, session});
  }
  return requests;
}

void LineDispatch::GiveUp(Time now) {
  for (auto it = detectors_.begin(); it != detectors_.end();) {
    Detector& detector = it->second;
    const bool gone = now - detector.heard > options_.forget_after;
    std::erase_if(detector.in_hand, [&](const auto& entry) {
      if (!gone && now - entry.second.asked <= entry.second.patience) return false;
      if (const auto image = images_.find(entry.first); image != images_.end()) {
        image->second.asked = false;
      }
      detector.suspect = true;
      return true;
    });
    it = gone ? detectors_.erase(it) : std::next(it);
  }
}

// Of those who have room: first who answers, then who has least in hand, then who was asked longest
// ago. Suspects come into question only where there is nobody else, busy or not.
LineDispatch::Detector* LineDispatch::Idlest(int64_t* session) {
  const auto rank = [](const Detector& d) {
    return std::tuple(d.suspect, d.in_hand.size(), d.last_asked);
  };
  const bool all_suspect = std::all_of(detectors_.begin(), detectors_.end(),
                                       [](const auto& entry) { return entry.second.suspect; });
  Detector* best = nullptr;
  for (auto& [id, detector] : detectors_) {
    if (static_cast<int>(detector.in_hand.size()) >= options_.max_in_hand) continue;
    if (detector.suspect && !all_suspect) continue;
    if (best && !(rank(detector) < rank(*best))) continue;
    best = &detector;
    *session = id;
  }
  return best;
}

Seconds LineDispatch::Patience(int attempts) const {
  const double least_s =
      std::max(Seconds(options_.patience).count(), options_.patience_factor * usual_s_);
  return Seconds(least_s * (1 << std::min(attempts, kMaxDoublings)));
}

}  // namespace vpslam
