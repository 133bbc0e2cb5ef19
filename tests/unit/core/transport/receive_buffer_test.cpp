#include "core/transport/receive_buffer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vpslam::test {
namespace {

using ::testing::HasSubstr;

TEST(ReceiveBuffer, IsWhatTheUrlAsksFor) {
  EXPECT_EQ(AskedReceiveBuffer("udpm://239.255.76.67:7667?ttl=0&recv_buf_size=212992"), 212992);
  EXPECT_EQ(AskedReceiveBuffer("memq://"), std::nullopt);
}

TEST(ReceiveBuffer, AModestOneIsGrantedAndAnImmodestOneCapped) {
  EXPECT_EQ(GrantedReceiveBuffer(65536), 65536);
  EXPECT_LT(GrantedReceiveBuffer(1 << 30), 1 << 30);
}

TEST(ReceiveBuffer, ImagesThatFitAreNoMatter) {
  EXPECT_EQ(WhyInlineImagesGetLost(4 << 20, 4 << 20, 640 * 480, 4), std::nullopt);
  EXPECT_EQ(WhyInlineImagesGetLost(1 << 19, 1 << 19, 640 * 480, 1), std::nullopt);
}

TEST(ReceiveBuffer, TheWarningNamesTheRemedy) {
  const auto capped = WhyInlineImagesGetLost(4 << 20, 212992, 640 * 480, 1);
  ASSERT_TRUE(capped);
  EXPECT_THAT(*capped, HasSubstr("images of 307 kB"));
  EXPECT_THAT(*capped, HasSubstr("'sysctl -w net.core.rmem_max=4194304'"));
  const auto modest = WhyInlineImagesGetLost(212992, 212992, 640 * 480, 1);
  ASSERT_TRUE(modest);
  EXPECT_THAT(*modest, HasSubstr("recv_buf_size=4194304"));
  const auto large = WhyInlineImagesGetLost(4 << 20, 4 << 20, 2'000'000, 4);
  ASSERT_TRUE(large);
  EXPECT_THAT(*large, HasSubstr("recv_buf_size=8064000"));
}

}  // namespace
}  // namespace vpslam::test
