#include "core/transport/codec.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "equality.h"
#include "random_messages.h"

namespace vpslam::test {
namespace {

constexpr int kTrials = 200;

template <class T>
void ExpectRoundTrip(RandomMessages& random, const T& value) {
  const Header header = random.SomeHeader();
  std::string why;
  const auto decoded = Decode<T>(Encode(header, value), &why);
  ASSERT_TRUE(decoded) << why;
  EXPECT_TRUE(Same(decoded->header, header));
  EXPECT_TRUE(Same(decoded->value, value));
}

TEST(Codec, EveryMessageComesBackBitByBit) {
  RandomMessages random(1);
  for (int i = 0; i < kTrials; ++i) {
    ExpectRoundTrip(random, random.SomeCamera());
    ExpectRoundTrip(random, random.Image(true));
    ExpectRoundTrip(random, random.Image(false));
    ExpectRoundTrip(random, random.SomeFrameFeatures());
    ExpectRoundTrip(random, random.Lines());
    ExpectRoundTrip(random, random.SomeFramePose());
    ExpectRoundTrip(random, random.SomeTruth());
    ExpectRoundTrip(random, random.Keyframe(random.Int(0, 30)));
    ExpectRoundTrip(random, random.Delta(random.Int(0, 30)));
    ExpectRoundTrip(random, random.SomeMapRequest());
    ExpectRoundTrip(random, random.SomeLinesRequest());
    ExpectRoundTrip(random, random.SomeAck());
    ExpectRoundTrip(random, random.SomeCommand());
    ExpectRoundTrip(random, random.SomeRunDescription());
    ExpectRoundTrip(random, random.Status());
    ExpectRoundTrip(random, random.SomePreview());
    if (HasFatalFailure()) return;
  }
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
  const FramePose pose = random.SomeFramePose();
  Header header = random.SomeHeader();
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
  const Header header = random.SomeHeader();

  FramePose pose = random.SomeFramePose();
  pose.cam_from_world.translation.x() = nan;
  EXPECT_THROW(Encode(header, pose), std::invalid_argument);
  pose = random.SomeFramePose();
  pose.cam_from_reference.rotation.coeffs() *= 1.1;
  EXPECT_THROW(Encode(header, pose), std::invalid_argument);
  pose = random.SomeFramePose();
  pose.state = TrackingState::kTracking;
  pose.reference = KeyframeId();
  EXPECT_THROW(Encode(header, pose), std::invalid_argument);

  KeyframeProposal keyframe = random.Keyframe(10);
  keyframe.points.pop_back();
  EXPECT_THROW(Encode(header, keyframe), std::invalid_argument);
  keyframe = random.Keyframe(10);
  keyframe.features.descriptors.pop_back();
  EXPECT_THROW(Encode(header, keyframe), std::invalid_argument);
  for (const int16_t roundness : {-1, 10001}) {
    keyframe = random.Keyframe(10);
    keyframe.features.keypoints[4].roundness_per_10000 = roundness;
    EXPECT_THROW(Encode(header, keyframe), std::invalid_argument) << roundness;
  }
  keyframe = random.Keyframe(10);
  keyframe.initial_points.back().feature_in_second = 10;
  EXPECT_THROW(Encode(header, keyframe), std::invalid_argument);

  MapDelta delta = random.Delta(10);
  delta.geometries[7].position.z() = std::numeric_limits<float>::infinity();
  EXPECT_THROW(Encode(header, delta), std::invalid_argument);
  delta = random.Delta(10);
  delta.appearances[3].id = PointId();
  EXPECT_THROW(Encode(header, delta), std::invalid_argument);

  LineSet lines = random.Lines();
  lines.vanishing_points[0].direction_in_cam *= 2;
  EXPECT_THROW(Encode(header, lines), std::invalid_argument);
  lines = random.Lines();
  lines.vanishing_points.clear();
  lines.lines.clear();
  EXPECT_THROW(Encode(header, lines), std::invalid_argument) << "Manhattan axes without any VP";

  ImageMessage image = random.Image(true);
  image.bytes.pop_back();
  EXPECT_THROW(Encode(header, image), std::invalid_argument);
  image = random.Image(false);
  image.segment = "/etc/passwd";
  EXPECT_THROW(Encode(header, image), std::invalid_argument);
  image = random.Image(false);
  image.width = 16385;
  EXPECT_THROW(Encode(header, image), std::invalid_argument);

  ProcessStatus status = random.Status();
  status.message = std::string("a\0b", 3);
  EXPECT_THROW(Encode(header, status), std::invalid_argument);
  Ack ack = random.SomeAck();
  ack.done = ack.received + 1;
  EXPECT_THROW(Encode(header, ack), std::invalid_argument);
}

TEST(Codec, TheReasonNamesTheElement) {
  RandomMessages random(4);
  MapDelta delta = random.Delta(10);
  delta.geometries[7].position.x() = std::numeric_limits<float>::quiet_NaN();
  try {
    Encode(random.SomeHeader(), delta);
    FAIL() << "was sent";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("geometry 7"), std::string::npos) << e.what();
  }
}

TEST(Codec, PartsOfTheMapFitADatagram) {
  // What a keyframe of 1000 features costs, and a part of the map that replication calls full.
  RandomMessages random(5);
  KeyframeProposal keyframe = random.Keyframe(1000);
  keyframe.role = KeyframeRole::kRegular;
  keyframe.initial_points.clear();
  EXPECT_LT(Encode(random.SomeHeader(), keyframe).size(), 65000u);
  MapDelta delta = random.Delta(600);
  EXPECT_LT(Encode(random.SomeHeader(), delta).size(), 60000u);
}

}  // namespace
}  // namespace vpslam::test
