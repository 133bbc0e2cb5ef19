#include "frontend/keyframe_proposer.h"

#include <gtest/gtest.h>

#include "tests/unit/frontend/tracking_scene.h"

namespace vpslam {
namespace {

TEST(KeyframeProposer, TheFrameBecomesTheKeyframeThatIsProposed) {
  TrackingScene s(1, {});
  Frame frame = s.TrackedFrame(PoseAt({0.3, 0, 0}), 7, KeyframeId(1));
  const Map empty;
  KeyframeProposer proposer(empty);
  EXPECT_FALSE(proposer.HasToTakeOver());
  const KeyframeProposal proposal = proposer.Propose(&frame);
  EXPECT_EQ(proposal.id, KeyframeId(0));
  EXPECT_EQ(proposal.map, MapId(0));
  EXPECT_EQ(proposal.frame_seq, 7);
  EXPECT_EQ(proposal.reference, KeyframeId(1)) << "the parent to be";
  EXPECT_EQ(proposal.points, frame.placement.points());
  EXPECT_EQ(frame.placement.reference, proposal.id);
  EXPECT_EQ(frame.placement.cam_from_reference.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(proposer.Propose(&frame).id, KeyframeId(1));
}

TEST(KeyframeProposer, BehindAnotherFrontendItBeginsANewSession) {
  TrackingScene s(1, {}, 3);
  Frame frame = s.TrackedFrame(PoseAt({0.3, 0, 0}), 7);
  KeyframeProposer proposer(s.map.map);
  ASSERT_TRUE(proposer.HasToTakeOver());
  proposer.TakeOver();
  EXPECT_FALSE(proposer.HasToTakeOver());
  const int32_t session = s.map.map.latest_session() + 1;
  EXPECT_EQ(proposer.Propose(&frame).id, KeyframeId(session, 0));
  EXPECT_EQ(proposer.NewMap(), MapId(session, 0));
}

TEST(KeyframeProposer, ADiscardedMapIsToldOnce) {
  const Map empty;
  KeyframeProposer proposer(empty);
  KeyframeProposal first, second;
  proposer.DiscardMap(MapId(4));
  EXPECT_EQ(proposer.discarded_map(), MapId(4));
  proposer.AddDiscardedMap(&first);
  proposer.AddDiscardedMap(&second);
  EXPECT_EQ(first.discarded_map, MapId(4));
  EXPECT_FALSE(second.discarded_map.IsValid());
  EXPECT_FALSE(proposer.discarded_map().IsValid());
}

}  // namespace
}  // namespace vpslam
