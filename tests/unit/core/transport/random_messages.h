// Messages with every field set at random (but sound), for round trips.
#pragma once

#include <limits>
#include <random>
#include <string>

#include "core/transport/validate.h"

namespace vpslam::test {

class RandomMessages {
 public:
  explicit RandomMessages(uint64_t seed) : random_(seed) {}

  int Int(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  int64_t Long() { return std::uniform_int_distribution<int64_t>(0, int64_t{1} << 60)(random_); }
  double Real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  bool Bool() { return Int(0, 1) == 1; }

  SE3 Pose() {
    return SE3(Eigen::Quaterniond(Real(-1, 1), Real(-1, 1), Real(-1, 1), Real(0.1, 1)),
               {Real(-9, 9), Real(-9, 9), Real(-9, 9)});
  }
  Descriptor Bits() { return {random_(), random_(), random_(), random_()}; }
  Features SomeFeatures(int n) {
    Features f;
    for (int i = 0; i < n; ++i) {
      f.keypoints.push_back({static_cast<float>(Real(-50, 700)), static_cast<float>(Real(-50, 500)),
                             static_cast<float>(Real(0, 6.28)), static_cast<float>(Real(0, 255)),
                             Int(0, 7), static_cast<int16_t>(Int(0, 10000)),
                             static_cast<int16_t>(Int(0, 3141))});
      f.descriptors.push_back(Bits());
    }
    return f;
  }
  double Time() { return Bool() ? kNotRun : Real(0, 100); }

  Header SomeHeader() {
    Header h;
    h.session = Long();
    h.seq = Long();
    h.oldest_seq = h.seq / 2;
    h.stamp_us = Long();
    return h;
  }

  Camera SomeCamera() {
    Camera c;
    c.width = Int(16, 2000);
    c.height = Int(16, 2000);
    c.fps = Real(1, 100);
    c.fx = Real(100, 1000);
    c.fy = Real(100, 1000);
    c.cx = Real(1, 15);
    c.cy = Real(1, 15);
    c.k1 = Real(-0.1, 0.1);
    c.k2 = Real(-0.1, 0.1);
    c.p1 = Real(-0.01, 0.01);
    c.p2 = Real(-0.01, 0.01);
    c.k3 = Real(-0.01, 0.01);
    return c;
  }

  ImageMessage Image(bool is_inline) {
    ImageMessage m;
    m.frame_seq = Long();
    m.stamp_us = Long();
    m.published_us = Long();
    m.decode_ms = Time();
    m.width = Int(1, 40);
    m.height = Int(1, 40);
    if (is_inline) {
      for (int i = 0; i < m.width * m.height; ++i) m.bytes.push_back(Int(0, 255));
    } else {
      m.segment = "/vpslam-test_1";
      m.slot = Int(0, 9);
      m.generation = 2 * Int(1, 1000);
    }
    return m;
  }

  FrameFeatures SomeFrameFeatures() {
    FrameFeatures f{Long(), Long(), Long(), Time(), Time(), SomeFeatures(Int(0, 30)), nullptr};
    if (Bool()) f.lines = std::make_shared<const LineSet>(Lines());
    return f;
  }

  LineSet Lines() {
    LineSet s;
    s.frame_seq = Long();
    s.stamp_us = Long();
    s.manhattan = Bool() ? ManhattanState::kThree : ManhattanState::kTwo;
    s.cam_from_manhattan = Pose().rotation;
    for (int i = 0; i < 9; ++i) s.covariance_rad2(i) = Real(-1, 1);
    s.lines_ms = Real(0, 9);
    s.descriptors_ms = Real(0, 9);
    s.vps_ms = Real(0, 9);
    const int num_vps = Int(3, 5);
    for (int i = 0; i < num_vps; ++i) {
      VanishingPoint vp;
      vp.direction_in_cam = Eigen::Vector3d(Real(-1, 1), Real(-1, 1), Real(0.1, 1)).normalized();
      for (int j = 0; j < 4; ++j) vp.covariance_rad2(j) = Real(-1, 1);
      vp.support = Int(0, 50);
      s.vanishing_points.push_back(vp);
    }
    for (int i = Int(0, 20); i > 0; --i) {
      LineSegment line;
      line.start_px = {static_cast<float>(Real(0, 640)), static_cast<float>(Real(0, 480))};
      line.end_px = {static_cast<float>(Real(0, 640)), static_cast<float>(Real(0, 480))};
      line.sigma_px = static_cast<float>(Real(0, 2));
      line.descriptor = Bits();
      line.has_descriptor = Bool();
      line.label = Int(-1, num_vps - 1);
      s.lines.push_back(line);
    }
    return s;
  }

  TrackingTimes Times() {
    return {Time(), Time(), Time(), Time(), Time(), Time(), Time(), Time(), Time(), Time(), Time()};
  }

  FramePose SomeFramePose() {
    FramePose p;
    p.frame_seq = Long();
    p.stamp_us = Long();
    p.image_published_us = Long();
    p.state = static_cast<TrackingState>(Int(0, 2));
    p.live = Bool();
    p.map = MapId(Int(0, 9));
    p.cam_from_world = Pose();
    p.reference = KeyframeId(Int(0, 999));
    p.cam_from_reference = Pose();
    for (int i = 0; i < 36; ++i) p.covariance(i) = Real(-1, 1);
    p.inliers = Int(0, 999);
    p.matches = Int(0, 999);
    p.keyframe = KeyframeId(Int(-1, 999));
    p.times = Times();
    return p;
  }

  Truth SomeTruth() { return {Long(), Long(), Pose()}; }

  KeyframeProposal Keyframe(int num_features) {
    KeyframeProposal k;
    k.id = KeyframeId(Int(0, 999));
    k.role = KeyframeRole::kMapSecond;
    k.map = MapId(Int(0, 9));
    k.discarded_map = MapId(Int(-1, 9));
    k.frame_seq = Long();
    k.stamp_us = Long();
    k.cam_from_world = Pose();
    k.reference = KeyframeId(Int(-1, 999));
    k.features = SomeFeatures(num_features);
    for (int i = 0; i < num_features; ++i) k.points.push_back(PointId(Int(-1, 9999)));
    for (int i = Int(0, 20); i > 0; --i) {
      k.sightings.push_back({PointId(Int(0, 9999)), Int(0, 9), Int(0, 9)});
    }
    for (int i = 0; i < num_features; i += 2) {
      k.initial_points.push_back({Int(0, 1999), i, {Real(-9, 9), Real(-9, 9), Real(-9, 9)}});
    }
    k.lines = Lines();
    for (size_t i = 0; i < k.lines.lines.size(); ++i) k.map_lines.push_back(LineId(Int(-1, 9999)));
    k.seam.map = MapId(Int(-1, 9));
    k.seam.cam_from_world = Pose();
    for (int i = 0; i < num_features; i += 3) k.seam.points.push_back({i, PointId(Int(0, 9999))});
    return k;
  }

  MapDelta Delta(int num_points) {
    MapDelta d;
    d.base_version = Int(0, 99);
    d.version = d.base_version + 1;
    d.snapshot = Bool();
    d.answers = KeyframeId(Int(-1, 99));
    d.times = {Time(), Time(), Time(), Time(), Time(), Time()};
    for (int i = Int(0, 3); i > 0; --i) d.erased_maps.push_back(MapId(Int(0, 9)));
    for (int i = Int(0, 3); i > 0; --i) d.merged_maps.push_back({MapId(i), MapId(Int(10, 19))});
    for (int i = Int(0, 5); i > 0; --i) {
      KeyframeState k;
      k.id = KeyframeId(Int(0, 99));
      k.map = MapId(Int(0, 9));
      k.frame_seq = Long();
      k.stamp_us = Long();
      k.culled = Bool();
      k.cam_from_world = Pose();
      k.parent = KeyframeId(Int(-1, 99));
      k.cam_from_parent = Pose();
      k.unit = Real(0.1, 9);
      for (int j = Int(0, 30); j > 0; --j) {
        k.points.push_back({Int(0, 999), PointId(Int(0, 9999))});
      }
      for (int j = Int(0, 9); j > 0; --j) {
        k.lines.push_back({Int(0, 99), LineId(Int(0, 9999))});
      }
      d.keyframes.push_back(k);
    }
    for (int i = 0; i < num_points; ++i) {
      d.appearances.push_back(
          {PointId(Int(0, 9999)), MapId(Int(0, 9)), KeyframeId(Int(-1, 99)), Bits()});
      PointGeometry g;
      g.id = PointId(Int(0, 9999));
      g.position = Eigen::Vector3d(Real(-9, 9), Real(-9, 9), Real(-9, 9)).cast<float>();
      g.normal = Eigen::Vector3d(Real(-1, 1), Real(-1, 1), Real(0.1, 1)).normalized().cast<float>();
      g.max_distance = static_cast<float>(Real(0, 99));
      d.geometries.push_back(g);
    }
    for (int i = Int(0, 9); i > 0; --i) {
      d.tombstones.push_back({PointId(Int(0, 9999)), PointId(Int(10000, 20000))});
    }
    for (int i = Int(0, 9); i > 0; --i) {
      const auto end = [&]() -> Eigen::Vector3f {
        return Eigen::Vector3d(Real(-9, 9), Real(-9, 9), Real(-9, 9)).cast<float>();
      };
      d.lines.push_back({LineId(Int(0, 9999)), MapId(Int(0, 9)), KeyframeId(Int(-1, 99)), end(),
                         end(), Bits(), Int(-1, 2)});
      d.line_tombstones.push_back({LineId(Int(0, 9999)), LineId(Int(10000, 20000))});
    }
    d.manhattan_frames.push_back({MapId(3), std::nullopt});
    d.manhattan_frames.push_back({MapId(4), Pose().rotation});
    return d;
  }

  MapRequest SomeMapRequest() { return {"frontend", Long()}; }
  LinesRequest SomeLinesRequest() { return {Long(), Long(), Long()}; }
  Ack SomeAck() {
    Ack a{"IMAGE", Long(), "backend", Long(), 0};
    a.done = a.received - Int(0, 5);
    return a;
  }
  Command SomeCommand() { return {"player", static_cast<CommandAction>(Int(3, 9)), Real(0, 99)}; }
  RunDescription SomeRunDescription() {
    return {static_cast<uint64_t>(Long()), "abc1234", "{\"preset\": \"points\"}"};
  }
  ProcessStatus Status() {
    ProcessStatus s;
    s.process = "vpdetector-2";
    s.pid = Int(1, 99999);
    s.protocol_version = Int(1, 9);
    s.state = static_cast<ProcessState>(Int(0, 4));
    s.rate_hz = Real(0, 99);
    s.processed = Long();
    s.queued = Long();
    s.dropped = Long();
    s.gaps = Long();
    s.rejected = Long();
    s.resent = Long();
    s.cpu_s = Real(0, 99);
    s.rss_peak_mb = Real(0, 99);
    s.message = "it is what it is";
    return s;
  }
  Preview SomePreview() {
    Preview p{Long(), Long(), {}};
    for (int i = Int(1, 99); i > 0; --i) p.jpeg.push_back(Int(0, 255));
    return p;
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace vpslam::test
