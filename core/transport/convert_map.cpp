// Messages about the map: keyframe, map delta, map request.
#include <span>

#include "core/transport/convert_parts.h"

namespace vpslam {
namespace {

template <class Id>
int32_t AppendObservations(const std::vector<FeatureObservation<Id>>& from,
                           std::vector<observation_t>* to) {
  for (const FeatureObservation<Id>& o : from) {
    observation_t wire;
    wire.feature = o.feature;
    wire.landmark = o.landmark.value;
    to->push_back(wire);
  }
  return static_cast<int32_t>(from.size());
}

/// Takes the first `count` off `from`; false if there are not so many.
template <class Id>
bool TakeObservations(int32_t count, std::span<const observation_t>* from,
                      std::vector<FeatureObservation<Id>>* to) {
  if (count < 0 || static_cast<size_t>(count) > from->size()) return false;
  to->reserve(count);
  for (const observation_t& o : from->first(count)) to->push_back({o.feature, Id(o.landmark)});
  *from = from->subspan(count);
  return true;
}

template <class Id>
tombstone_t ToWireTombstone(const Tombstone<Id>& from) {
  tombstone_t wire;
  wire.id = from.id.value;
  wire.replacement = from.replacement.value;
  return wire;
}

}  // namespace

keyframe_t ToWire(const KeyframeProposal& keyframe) {
  keyframe_t wire{};
  wire.id = keyframe.id.value;
  wire.role = static_cast<int32_t>(keyframe.role);
  wire.map_id = keyframe.map.value;
  wire.discarded_map = keyframe.discarded_map.value;
  wire.frame_seq = keyframe.frame_seq;
  wire.stamp_us = keyframe.stamp_us;
  wire.cam_from_world = ToWirePose(keyframe.cam_from_world);
  wire.reference = keyframe.reference.value;
  CopyFeatures(keyframe.features, &wire.keypoints, &wire.descriptors);
  wire.num_features = keyframe.features.size();
  for (const PointId id : keyframe.points) wire.points.push_back(id.value);
  for (const PointSighting& from : keyframe.sightings) {
    sighting_t to;
    to.point = from.point.value;
    to.visible = from.visible;
    to.found = from.found;
    wire.sightings.push_back(to);
  }
  wire.num_sightings = static_cast<int32_t>(wire.sightings.size());
  for (const InitialPoint& from : keyframe.initial_points) {
    initial_point_t to;
    to.feature_in_first = from.feature_in_first;
    to.feature_in_second = from.feature_in_second;
    for (int i = 0; i < 3; ++i) to.position[i] = from.position_in_world[i];
    wire.initial_points.push_back(to);
  }
  wire.num_initial_points = static_cast<int32_t>(wire.initial_points.size());
  wire.line_set = CopyLineSet(keyframe.lines, &wire.lines, &wire.vanishing_points);
  wire.num_lines = static_cast<int32_t>(wire.lines.size());
  for (const LineId id : keyframe.map_lines) wire.map_lines.push_back(id.value);
  wire.num_vanishing_points = static_cast<int32_t>(wire.vanishing_points.size());
  wire.seam_map = keyframe.seam.map.value;
  wire.seam_cam_from_world = ToWirePose(keyframe.seam.cam_from_world);
  wire.num_seam_points = AppendObservations(keyframe.seam.points, &wire.seam_points);
  return wire;
}

std::optional<KeyframeProposal> FromWire(const keyframe_t& wire, std::string* why) {
  KeyframeProposal keyframe;
  keyframe.id = KeyframeId(wire.id);
  keyframe.role = static_cast<KeyframeRole>(wire.role);
  keyframe.map = MapId(wire.map_id);
  keyframe.discarded_map = MapId(wire.discarded_map);
  keyframe.frame_seq = wire.frame_seq;
  keyframe.stamp_us = wire.stamp_us;
  keyframe.cam_from_world = FromWirePose(wire.cam_from_world);
  keyframe.reference = KeyframeId(wire.reference);
  keyframe.features = ReadFeatures(wire.keypoints, wire.descriptors);
  keyframe.points.reserve(wire.points.size());
  for (const int32_t id : wire.points) keyframe.points.push_back(PointId(id));
  keyframe.sightings.reserve(wire.sightings.size());
  for (const sighting_t& from : wire.sightings) {
    keyframe.sightings.push_back({PointId(from.point), from.visible, from.found});
  }
  keyframe.initial_points.reserve(wire.initial_points.size());
  for (const initial_point_t& from : wire.initial_points) {
    keyframe.initial_points.push_back({from.feature_in_first,
                                       from.feature_in_second,
                                       {from.position[0], from.position[1], from.position[2]}});
  }
  keyframe.lines = ReadLineSet(wire.line_set, wire.lines, wire.vanishing_points);
  keyframe.map_lines.reserve(wire.map_lines.size());
  for (const int32_t id : wire.map_lines) keyframe.map_lines.push_back(LineId(id));
  keyframe.seam.map = MapId(wire.seam_map);
  keyframe.seam.cam_from_world = FromWirePose(wire.seam_cam_from_world);
  std::span<const observation_t> seam_points = wire.seam_points;
  if (!TakeObservations(wire.num_seam_points, &seam_points, &keyframe.seam.points)) {
    *why = "fewer seam points than promised";
    return std::nullopt;
  }
  return Checked(std::move(keyframe), why);
}

map_delta_t ToWire(const MapDelta& delta) {
  map_delta_t wire{};
  wire.base_version = delta.base_version;
  wire.version = delta.version;
  wire.snapshot = delta.snapshot;
  wire.answers = delta.answers.value;
  wire.times.insertion_ms = delta.times.insertion_ms;
  wire.times.feature_culling_ms = delta.times.feature_culling_ms;
  wire.times.feature_creation_ms = delta.times.feature_creation_ms;
  wire.times.keyframe_culling_ms = delta.times.keyframe_culling_ms;
  wire.times.local_ba_ms = delta.times.local_ba_ms;
  wire.times.total_ms = delta.times.total_ms;
  for (const MapId id : delta.erased_maps) wire.erased_maps.push_back(id.value);
  wire.num_erased_maps = static_cast<int32_t>(wire.erased_maps.size());
  for (const MapMerger& from : delta.merged_maps) {
    map_merger_t to;
    to.from = from.from.value;
    to.into = from.into.value;
    wire.merged_maps.push_back(to);
  }
  wire.num_merged_maps = static_cast<int32_t>(wire.merged_maps.size());
  for (const KeyframeState& from : delta.keyframes) {
    keyframe_state_t to;
    to.id = from.id.value;
    to.map_id = from.map.value;
    to.frame_seq = from.frame_seq;
    to.stamp_us = from.stamp_us;
    to.culled = from.culled;
    to.cam_from_world = ToWirePose(from.cam_from_world);
    to.parent = from.parent.value;
    to.cam_from_parent = ToWirePose(from.cam_from_parent);
    to.unit = from.unit;
    to.observations = AppendObservations(from.points, &wire.observations);
    to.line_observations = AppendObservations(from.lines, &wire.line_observations);
    wire.keyframes.push_back(to);
  }
  wire.num_keyframes = static_cast<int32_t>(wire.keyframes.size());
  wire.num_observations = static_cast<int32_t>(wire.observations.size());
  wire.appearances.reserve(delta.appearances.size());
  for (const PointAppearance& from : delta.appearances) {
    point_appearance_t to;
    to.id = from.id.value;
    to.map_id = from.map.value;
    to.reference = from.reference.value;
    to.descriptor = ToWireDescriptor(from.descriptor);
    wire.appearances.push_back(to);
  }
  wire.num_appearances = static_cast<int32_t>(wire.appearances.size());
  wire.geometries.reserve(delta.geometries.size());
  for (const PointGeometry& from : delta.geometries) {
    point_geometry_t to;
    to.id = from.id.value;
    for (int i = 0; i < 3; ++i) to.position[i] = from.position[i];
    for (int i = 0; i < 3; ++i) to.normal[i] = from.normal[i];
    to.max_distance = from.max_distance;
    wire.geometries.push_back(to);
  }
  wire.num_geometries = static_cast<int32_t>(wire.geometries.size());
  for (const auto& from : delta.tombstones) wire.tombstones.push_back(ToWireTombstone(from));
  wire.num_line_observations = static_cast<int32_t>(wire.line_observations.size());
  for (const LineState& from : delta.lines) {
    map_line_t to;
    to.id = from.id.value;
    to.map_id = from.map.value;
    to.reference = from.reference.value;
    for (int i = 0; i < 3; ++i) to.start[i] = from.start[i];
    for (int i = 0; i < 3; ++i) to.end[i] = from.end[i];
    to.descriptor = ToWireDescriptor(from.descriptor);
    to.axis = from.axis;
    wire.lines.push_back(to);
  }
  wire.num_lines = static_cast<int32_t>(wire.lines.size());
  for (const auto& from : delta.line_tombstones) {
    wire.line_tombstones.push_back(ToWireTombstone(from));
  }
  wire.num_line_tombstones = static_cast<int32_t>(wire.line_tombstones.size());
  for (const MapManhattan& from : delta.manhattan_frames) {
    manhattan_frame_t to;
    to.map_id = from.map.value;
    to.exists = from.world_from_manhattan.has_value();
    CopyQuaternion(from.world_from_manhattan.value_or(Eigen::Quaterniond::Identity()),
                   to.world_from_manhattan);
    wire.manhattan_frames.push_back(to);
  }
  wire.num_manhattan_frames = static_cast<int32_t>(wire.manhattan_frames.size());
  wire.num_tombstones = static_cast<int32_t>(wire.tombstones.size());
  return wire;
}

std::optional<MapDelta> FromWire(const map_delta_t& wire, std::string* why) {
  MapDelta delta;
  delta.base_version = wire.base_version;
  delta.version = wire.version;
  delta.snapshot = wire.snapshot != 0;
  delta.answers = KeyframeId(wire.answers);
  delta.times.insertion_ms = wire.times.insertion_ms;
  delta.times.feature_culling_ms = wire.times.feature_culling_ms;
  delta.times.feature_creation_ms = wire.times.feature_creation_ms;
  delta.times.keyframe_culling_ms = wire.times.keyframe_culling_ms;
  delta.times.local_ba_ms = wire.times.local_ba_ms;
  delta.times.total_ms = wire.times.total_ms;
  for (const int32_t id : wire.erased_maps) delta.erased_maps.push_back(MapId(id));
  for (const map_merger_t& from : wire.merged_maps) {
    delta.merged_maps.push_back({MapId(from.from), MapId(from.into)});
  }
  std::span<const observation_t> observations = wire.observations;
  std::span<const observation_t> line_observations = wire.line_observations;
  delta.keyframes.reserve(wire.keyframes.size());
  for (const keyframe_state_t& from : wire.keyframes) {
    KeyframeState to;
    to.id = KeyframeId(from.id);
    to.map = MapId(from.map_id);
    to.frame_seq = from.frame_seq;
    to.stamp_us = from.stamp_us;
    to.culled = from.culled != 0;
    to.cam_from_world = FromWirePose(from.cam_from_world);
    to.parent = KeyframeId(from.parent);
    to.cam_from_parent = FromWirePose(from.cam_from_parent);
    to.unit = from.unit;
    if (!TakeObservations(from.observations, &observations, &to.points) ||
        !TakeObservations(from.line_observations, &line_observations, &to.lines)) {
      *why = "more observations promised than sent";
      return std::nullopt;
    }
    delta.keyframes.push_back(std::move(to));
  }
  if (!observations.empty() || !line_observations.empty()) {
    *why = "observations of no keyframe";
    return std::nullopt;
  }
  delta.appearances.reserve(wire.appearances.size());
  for (const point_appearance_t& from : wire.appearances) {
    delta.appearances.push_back({PointId(from.id), MapId(from.map_id), KeyframeId(from.reference),
                                 FromWireDescriptor(from.descriptor)});
  }
  delta.geometries.reserve(wire.geometries.size());
  for (const point_geometry_t& from : wire.geometries) {
    delta.geometries.push_back({PointId(from.id),
                                {from.position[0], from.position[1], from.position[2]},
                                {from.normal[0], from.normal[1], from.normal[2]},
                                from.max_distance});
  }
  delta.tombstones.reserve(wire.tombstones.size());
  for (const tombstone_t& from : wire.tombstones) {
    delta.tombstones.push_back({PointId(from.id), PointId(from.replacement)});
  }
  delta.lines.reserve(wire.lines.size());
  for (const map_line_t& from : wire.lines) {
    delta.lines.push_back({LineId(from.id),
                           MapId(from.map_id),
                           KeyframeId(from.reference),
                           {from.start[0], from.start[1], from.start[2]},
                           {from.end[0], from.end[1], from.end[2]},
                           FromWireDescriptor(from.descriptor),
                           from.axis});
  }
  delta.line_tombstones.reserve(wire.line_tombstones.size());
  for (const tombstone_t& from : wire.line_tombstones) {
    delta.line_tombstones.push_back({LineId(from.id), LineId(from.replacement)});
  }
  for (const manhattan_frame_t& from : wire.manhattan_frames) {
    MapManhattan to{MapId(from.map_id), std::nullopt};
    if (from.exists) to.world_from_manhattan = ReadQuaternion(from.world_from_manhattan);
    delta.manhattan_frames.push_back(to);
  }
  return Checked(std::move(delta), why);
}

map_request_t ToWire(const MapRequest& request) {
  map_request_t wire{};
  wire.process = request.process;
  wire.map_version = request.map_version;
  return wire;
}

std::optional<MapRequest> FromWire(const map_request_t& wire, std::string* why) {
  return Checked(MapRequest{wire.process, wire.map_version}, why);
}

}  // namespace vpslam
