// What a careless or hostile sender may put into a datagram: it has to be refused, without a crash
// and without allocating what it merely promises.
#include <cstring>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "core/messages/array_lengths.h"
#include "core/messages/command.h"
#include "core/messages/lines_request.h"
#include "core/messages/map_request.h"
#include "core/messages/outcome.h"
#include "core/messages/process_status.h"
#include "core/messages/run_description.h"
#include "core/messages/truth.h"
#include "core/messages/validate.h"
#include "core/transport/codec.h"
#include "random_messages.h"
#include "spoiler.h"

namespace vpslam::test {
namespace {

constexpr std::size_t kLengthsOffset = 8 + 33;  // fingerprint, header

template <class T>
bool Accepts(const std::vector<uint8_t>& bytes) {
  std::string why;
  const bool accepted = Decode<T>(bytes, &why).has_value();
  EXPECT_EQ(accepted, why.empty());
  return accepted;
}

void PutInt32(std::vector<uint8_t>* bytes, std::size_t offset, int32_t value) {
  const auto v = static_cast<uint32_t>(value);
  for (int i = 0; i < 4; ++i) (*bytes)[offset + i] = static_cast<uint8_t>(v >> (24 - 8 * i));
}

template <class T>
void ExpectRefusesDamage(RandomMessages& random) {
  const std::vector<uint8_t> good = Encode(random.Make<Header>(), random.Make<T>());
  ASSERT_TRUE(Accepts<T>(good));
  for (std::size_t size = 0; size < good.size(); ++size) {
    ASSERT_FALSE(Accepts<T>({good.begin(), good.begin() + size})) << "cut to " << size;
  }
  std::vector<uint8_t> longer = good;
  longer.push_back(0);
  EXPECT_FALSE(Accepts<T>(longer));
  std::vector<uint8_t> alien = good;
  alien[3] ^= 1;
  EXPECT_FALSE(Accepts<T>(alien)) << "another fingerprint";
  const std::size_t num_lengths = CollectArrayLengths(T()).lengths().size();
  for (std::size_t i = 0; i < num_lengths; ++i) {
    for (const int32_t length : {-1, INT32_MIN, INT32_MAX, 1 << 28, 1 << 20}) {
      std::vector<uint8_t> bytes = good;
      PutInt32(&bytes, kLengthsOffset + 4 * i, length);
      EXPECT_FALSE(Accepts<T>(bytes)) << "length " << i << " = " << length;
    }
  }
  // Any accident: decoding either refuses or gives something that may be sent on.
  for (int i = 0; i < 300; ++i) {
    std::vector<uint8_t> bytes = good;
    for (int n = random.Int(1, 8); n > 0; --n) {
      bytes[random.Int(8, static_cast<int>(bytes.size()) - 1)] = random.Int(0, 255);
    }
    std::string why;
    if (const auto decoded = Decode<T>(bytes, &why)) {
      EXPECT_NO_THROW(Encode(decoded->header, decoded->value));
    }
  }
  // Noise behind the right fingerprint.
  for (int i = 0; i < 100; ++i) {
    std::vector<uint8_t> bytes = good;
    for (std::size_t j = 8; j < bytes.size(); ++j) bytes[j] = random.Int(0, 255);
    std::string why;
    Decode<T>(bytes, &why);
  }
}

class Malformed : public ::testing::Test {
 protected:
  // Whoever allocates gigabytes fails here.
  void SetUp() override {
    getrlimit(RLIMIT_AS, &before_);
    rlimit limit = before_;
    limit.rlim_cur = rlim_t{1} << 30;
#if !defined(__SANITIZE_ADDRESS__)
    setrlimit(RLIMIT_AS, &limit);
#endif
  }
  void TearDown() override { setrlimit(RLIMIT_AS, &before_); }

  RandomMessages random_{11};

 private:
  rlimit before_{};
};

// Each member that has a rule, of each element of each array.
template <class T>
void ExpectRefusesToSendWhatBreaksARule(RandomMessages& random) {
  const Header header;
  const T good = random.Make<T>();
  ASSERT_NO_THROW(Encode(header, good));
  for (int i = 0;; ++i) {
    T bad = good;
    Spoiler spoiler(i);
    Description<T>::Visit(spoiler, bad);
    if (!spoiler.spoiled()) break;
    EXPECT_THROW(Encode(header, bad), std::invalid_argument) << spoiler.spoiled();
  }
}

#define VPSLAM_TEST(T, type)                        \
  TEST_F(Malformed, T) {                            \
    ExpectRefusesDamage<T>(random_);                \
    ExpectRefusesToSendWhatBreaksARule<T>(random_); \
  }
VPSLAM_MESSAGES(VPSLAM_TEST)
#undef VPSLAM_TEST

TEST_F(Malformed, RandomBytes) {
  for (int i = 0; i < 2000; ++i) {
    std::vector<uint8_t> bytes(random_.Int(0, 400));
    for (uint8_t& b : bytes) b = random_.Int(0, 255);
    EXPECT_FALSE(Accepts<FramePose>(bytes));
    EXPECT_FALSE(Accepts<MapDelta>(bytes));
    EXPECT_FALSE(Accepts<ProcessStatus>(bytes));
  }
}

TEST_F(Malformed, StringsOfImpossibleLength) {
  const Command command = random_.Make<Command>();
  const std::vector<uint8_t> good = Encode(random_.Make<Header>(), command);
  for (const int32_t length : {0, -1, INT32_MIN, INT32_MAX, 1000}) {
    std::vector<uint8_t> bytes = good;
    PutInt32(&bytes, kLengthsOffset, length);
    EXPECT_FALSE(Accepts<Command>(bytes)) << length;
  }
}

TEST_F(Malformed, NotANumber) {
  const std::vector<uint8_t> good = Encode(random_.Make<Header>(), random_.Make<Truth>());
  // frame_seq and stamp_us come first, then rotation and translation.
  for (int i = 0; i < 7; ++i) {
    std::vector<uint8_t> bytes = good;
    const std::size_t offset = kLengthsOffset + 16 + 8 * i;
    bytes[offset] = 0x7f;
    bytes[offset + 1] = 0xf8;
    EXPECT_FALSE(Accepts<Truth>(bytes)) << i;
  }
}

TEST_F(Malformed, NumbersThatNobodyCountsUpTo) {
  Header header = random_.Make<Header>();
  header.seq = INT64_MAX;
  EXPECT_TRUE(Validate(header));
  // Tables hold a few bytes for each thousand indices: these would take gigabytes.
  MapDelta delta;
  delta.version = 1;
  KeyframeState keyframe;
  keyframe.id = KeyframeId(1);
  keyframe.map = MapId(0);
  delta.keyframes = {keyframe};
  EXPECT_FALSE(Validate(delta));
  for (const KeyframeId id : {KeyframeId(INT64_MAX), KeyframeId(0, KeyframeId::kMaxIndex),
                              KeyframeId(KeyframeId::kMaxSession, 0), KeyframeId(int64_t{-2})}) {
    delta.keyframes[0].id = id;
    EXPECT_TRUE(Validate(delta)) << id.value;
  }
}

TEST_F(Malformed, ObservationsThatBelongToNoKeyframe) {
  MapDelta delta;
  delta.keyframes.resize(1);
  delta.keyframes[0].id = KeyframeId(1);
  delta.keyframes[0].map = MapId(0);
  delta.keyframes[0].points = {{1, PointId(2)}, {3, PointId(4)}};
  const std::vector<uint8_t> good = Encode(random_.Make<Header>(), delta);
  ASSERT_TRUE(Accepts<MapDelta>(good));
  // The keyframe's own numbers of observations, of points and of lines, stand right before the
  // observations at the end.
  const std::size_t end = good.size() - 2 * WireBytes<FeatureObservation<PointId>>();
  for (const auto& [offset, right] : {std::pair(end - 8, 2), std::pair(end - 4, 0)}) {
    for (const int32_t count : {-1, 0, 1, 2, 3, INT32_MAX}) {
      std::vector<uint8_t> bytes = good;
      PutInt32(&bytes, offset, count);
      EXPECT_EQ(Accepts<MapDelta>(bytes), count == right) << count;
    }
  }
}

}  // namespace
}  // namespace vpslam::test
