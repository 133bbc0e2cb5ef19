#include "recorder/trajectory.h"

#include <algorithm>
#include <iterator>
#include <map>

#include <fmt/format.h>

namespace vpslam {
namespace {

/// `value` with nine decimals; never "-0.000000000".
void AppendNumber(double value, std::string* text) {
  const size_t begin = text->size();
  fmt::format_to(std::back_inserter(*text), "{:.9f}", value);
  if ((*text)[begin] == '-' && text->find_first_not_of("-0.", begin) == std::string::npos) {
    text->erase(begin, 1);
  }
}

}  // namespace

bool HasFinalPose(const RunRecord& run, const FramePose& pose) {
  SE3 cam_from_world;
  return IsMeasured(pose) &&
         run.map().Place(pose.reference, pose.cam_from_reference, &cam_from_world);
}

std::vector<MapTrajectory> FinalTrajectories(const RunRecord& run) {
  std::map<MapId, MapTrajectory> by_map;
  for (const auto& [seq, frame] : run.frames()) {
    const FramePose& pose = frame.last;
    SE3 cam_from_world;
    if (!IsMeasured(pose) ||
        !run.map().Place(pose.reference, pose.cam_from_reference, &cam_from_world)) {
      continue;
    }
    MapTrajectory& trajectory = by_map[run.map().FindEvenCulled(pose.reference)->map];
    trajectory.poses.push_back({pose.stamp_us, cam_from_world.Inverse()});
  }
  std::vector<MapTrajectory> result;
  for (auto& [id, trajectory] : by_map) {
    trajectory.map = id;
    result.push_back(std::move(trajectory));
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const MapTrajectory& a, const MapTrajectory& b) {
                     return a.poses.size() > b.poses.size();
                   });
  return result;
}

std::vector<StampedPose> LiveTrajectory(const RunRecord& run) {
  std::vector<StampedPose> poses;
  for (const auto& [seq, frame] : run.frames()) {
    if (frame.live && IsMeasured(*frame.live)) {
      poses.push_back({frame.live->stamp_us, frame.live->cam_from_world.Inverse()});
    }
  }
  return poses;
}

MapId MainMap(const RunRecord& run) {
  const std::vector<MapTrajectory> trajectories = FinalTrajectories(run);
  if (!trajectories.empty()) return trajectories.front().map;
  const std::vector<MapId> maps = run.map().Maps();
  const auto most = std::max_element(maps.begin(), maps.end(), [&run](MapId a, MapId b) {
    return run.map().NumKeyframes(a) < run.map().NumKeyframes(b);
  });
  return most == maps.end() ? MapId() : *most;
}

std::vector<StampedPose> KeyframeTrajectory(const Map& map, MapId map_id) {
  std::vector<StampedPose> poses;
  for (const Keyframe& keyframe : map.keyframes()) {
    if (keyframe.map != map_id) continue;
    poses.push_back({keyframe.stamp_us, keyframe.cam_from_world.Inverse()});
  }
  // Late ones come after those of later times, and a frame that ties two maps may be one of both.
  std::stable_sort(poses.begin(), poses.end(), [](const StampedPose& a, const StampedPose& b) {
    return a.stamp_us < b.stamp_us;
  });
  const auto same = [](const StampedPose& a, const StampedPose& b) {
    return a.stamp_us == b.stamp_us;
  };
  poses.erase(std::unique(poses.begin(), poses.end(), same), poses.end());
  return poses;
}

std::string FormatStamp(int64_t stamp_us) {
  const uint64_t magnitude =
      stamp_us < 0 ? 0 - static_cast<uint64_t>(stamp_us) : static_cast<uint64_t>(stamp_us);
  return fmt::format("{}{}.{:06}", stamp_us < 0 ? "-" : "", magnitude / 1'000'000,
                     magnitude % 1'000'000);
}

std::string FormatTum(const std::vector<StampedPose>& poses) {
  std::string text;
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d& t = pose.world_from_cam.translation;
    const Eigen::Quaterniond& q = pose.world_from_cam.rotation;
    const double sign = q.w() < 0 ? -1 : 1;
    text += FormatStamp(pose.stamp_us);
    for (const double v :
         {t.x(), t.y(), t.z(), sign * q.x(), sign * q.y(), sign * q.z(), sign * q.w()}) {
      text += ' ';
      AppendNumber(v, &text);
    }
    text += '\n';
  }
  return text;
}

}  // namespace vpslam
