#include "core/transport/codec.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/messages/command.h"
#include "core/messages/lines_request.h"
#include "core/messages/map_request.h"
#include "core/messages/outcome.h"
#include "core/messages/process_status.h"
#include "core/messages/run_description.h"
#include "core/messages/truth.h"
#include "core/transport/fingerprint.h"
#include "equality.h"
#include "lcm_types.h"
#include "random_messages.h"

namespace vpslam::test {
namespace {

using ::testing::ElementsAre;

constexpr int kTrials = 200;
const std::map<std::string, int, std::less<>> kTen = {{"num_features", 10},
                                                      {"num_initial_points", 3},
                                                      {"num_geometries", 10},
                                                      {"num_appearances", 10}};

template <class T>
void ExpectRoundTrips() {
  RandomMessages random(1);
  for (int i = 0; i < kTrials; ++i) {
    const auto header = random.Make<Header>();
    const T value = random.Make<T>();
    std::string why;
    const auto decoded = Decode<T>(Encode(header, value), &why);
    ASSERT_TRUE(decoded) << why;
    ASSERT_TRUE(Same(decoded->header, header));
    ASSERT_TRUE(Same(decoded->value, value));
  }
}

template <class Wire>
Wire ByLcm(const std::vector<uint8_t>& bytes) {
  Wire wire{};
  const int size = static_cast<int>(bytes.size());
  EXPECT_EQ(wire.decode(bytes.data(), 0, size), size);
  return wire;
}

// What lcm-gen makes of lcmtypes/ is the measure. Its fingerprint covers names, types, dimensions
// and order of all members.
template <class T, class Wire>
void ExpectAgreesWithLcm() {
  RandomMessages random(6);
  EXPECT_EQ((FingerprintHash::Of<Header, T>()), Wire::getHash());
  EXPECT_STREQ(Description<T>::kWireName, Wire::getTypeName());
  for (int i = 0; i < kTrials; ++i) {
    const std::vector<uint8_t> ours = Encode(random.Make<Header>(), random.Make<T>());
    const auto wire = ByLcm<Wire>(ours);
    std::vector<uint8_t> theirs(wire.getEncodedSize());
    wire.encode(theirs.data(), 0, wire.getEncodedSize());
    ASSERT_EQ(ours, theirs);
  }
}

#define VPSLAM_TEST(T, type)                    \
  TEST(RoundTrip, T) { ExpectRoundTrips<T>(); } \
  TEST(AgreementWithLcm, T) { ExpectAgreesWithLcm<T, type>(); }
VPSLAM_MESSAGES(VPSLAM_TEST)
#undef VPSLAM_TEST

// The same bytes after lcm-gen's decoding and encoding say nothing of values: these do.
TEST(AgreementWithLcm, MembersHoldTheirValues) {
  RandomMessages random(7);
  const auto header = random.Make<Header>();
  FramePose pose = random.Make<FramePose>();
  pose.live = false;
  const auto wire = ByLcm<pose_t>(Encode(header, pose));
  EXPECT_EQ(wire.header.session, header.session);
  EXPECT_EQ(wire.header.last, 0);
  EXPECT_EQ(wire.stamp_us, pose.stamp_us);
  EXPECT_EQ(wire.state, static_cast<int32_t>(pose.state));
  EXPECT_EQ(wire.live, 0);
  EXPECT_EQ(wire.map_id, pose.map.value);
  const Eigen::Quaterniond& q = pose.cam_from_world.rotation;
  EXPECT_THAT(wire.cam_from_world.rotation, ElementsAre(q.w(), q.x(), q.y(), q.z()));
  EXPECT_EQ(wire.cam_from_world.translation[2], pose.cam_from_world.translation.z());
  EXPECT_EQ(wire.covariance[6 * 2 + 5], pose.covariance(2, 5));

  const auto keyframe = random.Make<KeyframeProposal>(kTen);
  const auto wire_keyframe = ByLcm<keyframe_t>(Encode(header, keyframe));
  EXPECT_EQ(wire_keyframe.keypoints[9].x_px, keyframe.features.keypoints[9].x_px);
  EXPECT_EQ(wire_keyframe.keypoints[9].edge_mrad, keyframe.features.keypoints[9].edge_mrad);
  EXPECT_EQ(static_cast<uint64_t>(wire_keyframe.descriptors[9].words[3]),
            keyframe.features.descriptors[9][3]);
  const auto command = random.Make<Command>();
  EXPECT_EQ(ByLcm<command_t>(Encode(header, command)).target, command.target);
}

template <class T, class Wire>
void ExpectSizeOfElement() {
  EXPECT_EQ(WireBytes<T>(), static_cast<std::size_t>(Wire()._getEncodedSizeNoHash()))
      << Wire::getTypeName();
  EXPECT_STREQ(Description<T>::kWireName, Wire::getTypeName());
}

TEST(AgreementWithLcm, ElementsOfArraysTakeWhatTheGuardReckonsWith) {
  ExpectSizeOfElement<Keypoint, keypoint_t>();
  ExpectSizeOfElement<Descriptor, descriptor_t>();
  ExpectSizeOfElement<LineSegment, line_segment_t>();
  ExpectSizeOfElement<VanishingPoint, vanishing_point_t>();
  ExpectSizeOfElement<PointSighting, sighting_t>();
  ExpectSizeOfElement<InitialPoint, initial_point_t>();
  ExpectSizeOfElement<FeatureObservation<PointId>, observation_t>();
  ExpectSizeOfElement<KeyframeState, keyframe_state_t>();
  ExpectSizeOfElement<PointAppearance, point_appearance_t>();
  ExpectSizeOfElement<PointGeometry, point_geometry_t>();
  ExpectSizeOfElement<LineState, map_line_t>();
  ExpectSizeOfElement<Tombstone<LineId>, tombstone_t>();
  ExpectSizeOfElement<MapManhattan, manhattan_frame_t>();
  ExpectSizeOfElement<MapMerger, map_merger_t>();
}

TEST(Codec, EndOfStreamNeedsNoPayload) {
  Header header;
  header.session = 5;
  header.seq = 7;
  header.last = true;
  std::string why;
  const auto decoded = Decode<KeyframeProposal>(Encode(header, KeyframeProposal()), &why);
  ASSERT_TRUE(decoded) << why;
  EXPECT_TRUE(decoded->header.last);
  EXPECT_EQ(decoded->header.seq, 7);
}

TEST(Codec, OldestSeqIsRewrittenInPlace) {
  RandomMessages random(2);
  const FramePose pose = random.Make<FramePose>();
  Header header = random.Make<Header>();
  std::vector<uint8_t> bytes = Encode(header, pose);
  header.oldest_seq = header.seq - 3;
  SetOldestSeq(&bytes, header.oldest_seq);
  std::string why;
  const auto decoded = Decode<FramePose>(bytes, &why);
  ASSERT_TRUE(decoded) << why;
  EXPECT_TRUE(Same(decoded->header, header));
  EXPECT_TRUE(Same(decoded->value, pose));
}

TEST(Codec, RefusesToSendWhatNobodyWouldAccept) {
  RandomMessages random(3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Header header = random.Make<Header>();

  FramePose pose = random.Make<FramePose>();
  pose.cam_from_world.translation.x() = nan;
  EXPECT_THROW(Encode(header, pose), std::invalid_argument);
  pose = random.Make<FramePose>();
  pose.cam_from_reference.rotation.coeffs() *= 1.1;
  EXPECT_THROW(Encode(header, pose), std::invalid_argument);
  pose = random.Make<FramePose>();
  pose.state = TrackingState::kTracking;
  pose.reference = KeyframeId();
  EXPECT_THROW(Encode(header, pose), std::invalid_argument);

  KeyframeProposal keyframe = random.Make<KeyframeProposal>(kTen);
  keyframe.points.pop_back();
  EXPECT_THROW(Encode(header, keyframe), std::invalid_argument);
  keyframe = random.Make<KeyframeProposal>(kTen);
  keyframe.features.descriptors.pop_back();
  EXPECT_THROW(Encode(header, keyframe), std::invalid_argument);
  for (const int16_t roundness : {-1, 10001}) {
    keyframe = random.Make<KeyframeProposal>(kTen);
    keyframe.features.keypoints[4].roundness_per_10000 = roundness;
    EXPECT_THROW(Encode(header, keyframe), std::invalid_argument) << roundness;
  }
  keyframe = random.Make<KeyframeProposal>(kTen);
  keyframe.initial_points.back().feature_in_second = 10;
  EXPECT_THROW(Encode(header, keyframe), std::invalid_argument);

  MapDelta delta = random.Make<MapDelta>(kTen);
  delta.geometries[7].position.z() = std::numeric_limits<float>::infinity();
  EXPECT_THROW(Encode(header, delta), std::invalid_argument);
  delta = random.Make<MapDelta>(kTen);
  delta.appearances[3].id = PointId();
  EXPECT_THROW(Encode(header, delta), std::invalid_argument);

  LineSet lines = random.Make<LineSet>({{"num_vanishing_points", 3}});
  lines.manhattan = ManhattanState::kThree;
  const LineSet good_lines = lines;
  lines.vanishing_points[0].direction_in_cam *= 2;
  EXPECT_THROW(Encode(header, lines), std::invalid_argument);
  lines = good_lines;
  lines.vanishing_points.clear();
  lines.lines.clear();
  EXPECT_THROW(Encode(header, lines), std::invalid_argument) << "Manhattan axes without any VP";

  ImageMessage image = InlineImage({.pixels = cv::Mat::zeros(3, 4, CV_8UC1)});
  EXPECT_NO_THROW(Encode(header, image));
  image.bytes.pop_back();
  EXPECT_THROW(Encode(header, image), std::invalid_argument);
  ImageMessage shared;
  shared.width = shared.height = 9;
  shared.segment = "/vpslam-1";
  shared.generation = 2;
  EXPECT_NO_THROW(Encode(header, shared));
  image = shared;
  image.segment = "/etc/passwd";
  EXPECT_THROW(Encode(header, image), std::invalid_argument);
  image = shared;
  image.width = 16385;
  EXPECT_THROW(Encode(header, image), std::invalid_argument);

  ProcessStatus status = random.Make<ProcessStatus>();
  status.message = std::string("a\0b", 3);
  EXPECT_THROW(Encode(header, status), std::invalid_argument);
  Ack ack = random.Make<Ack>();
  ack.done = ack.received + 1;
  EXPECT_THROW(Encode(header, ack), std::invalid_argument);
}

TEST(Codec, TheReasonNamesTheElement) {
  RandomMessages random(4);
  MapDelta delta = random.Make<MapDelta>(kTen);
  delta.geometries[7].position.x() = std::numeric_limits<float>::quiet_NaN();
  try {
    Encode(random.Make<Header>(), delta);
    FAIL() << "was sent";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("geometries[7].position"), std::string::npos) << e.what();
  }
}

TEST(Codec, PartsOfTheMapFitADatagram) {
  // A part of the map that replication calls full. A keyframe of 1000 features takes a little more
  // than a datagram: LCM cuts it in two.
  RandomMessages random(5);
  auto keyframe = random.Make<KeyframeProposal>({{"num_features", 1000}});
  keyframe.role = KeyframeRole::kRegular;
  keyframe.initial_points.clear();
  EXPECT_LT(Encode(random.Make<Header>(), keyframe).size(), 70000u);
  const auto delta = random.Make<MapDelta>({{"num_appearances", 400}, {"num_geometries", 400}});
  EXPECT_LT(Encode(random.Make<Header>(), delta).size(), 60000u);
}

}  // namespace
}  // namespace vpslam::test
