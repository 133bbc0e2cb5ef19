#include "recorder/tables.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/messages/state_names.h"
#include "recorder/stages.h"
#include "recorder/trajectory.h"

namespace vpslam {
namespace {

template <class Times, size_t n>
std::string Header(const char* first, const std::array<Stage<Times>, n>& stages) {
  std::string text = first;
  for (const Stage<Times>& stage : stages) text += fmt::format(",{}_ms", stage.name);
  return text + '\n';
}

template <class Times, size_t n>
std::string Cells(const Times& times, const std::array<Stage<Times>, n>& stages) {
  std::string text;
  for (const Stage<Times>& stage : stages) {
    const double ms = times.*stage.ms;
    text += std::isfinite(ms) ? fmt::format(",{:.3f}", ms) : ",";
  }
  return text + '\n';
}

}  // namespace

std::string FramesTable(const RunRecord& run) {
  std::string text = Header("frame,timestamp,state,inliers", kTrackingStages);
  for (const auto& [seq, frame] : run.frames()) {
    const FramePose& pose = frame.last;
    text += fmt::format("{},{},{},{}", seq, FormatStamp(pose.stamp_us), StateName(pose.state),
                        pose.inliers);
    text += Cells((frame.live ? *frame.live : pose).times, kTrackingStages);
  }
  return text;
}

std::string KeyframesTable(const RunRecord& run) {
  std::string text = Header("keyframe,frame,timestamp", kMappingStages);
  for (const auto& [id, keyframe] : run.keyframes()) {
    text += fmt::format("{},{},{}", id.value, keyframe.frame_seq, FormatStamp(keyframe.stamp_us));
    text += Cells(keyframe.times, kMappingStages);
  }
  return text;
}

}  // namespace vpslam
