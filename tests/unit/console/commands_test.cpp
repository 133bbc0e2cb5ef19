#include "console/commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vpslam {
namespace {

using ::testing::HasSubstr;

TEST(Commands, AreAddressedToWhoObeysThem) {
  std::string why;
  for (const std::string& name : CommandNames()) {
    const auto command = ParseCommand(name == "rate" ? "rate 2" : name, &why);
    ASSERT_TRUE(command) << name << ": " << why;
    EXPECT_FALSE(command->target.empty());
  }
  EXPECT_EQ(ParseCommand("step", &why)->value, 1);
  EXPECT_EQ(ParseCommand(" step  5 ", &why)->value, 5);
  EXPECT_EQ(ParseCommand("rate 0.5", &why)->value, 0.5);
  EXPECT_EQ(ParseCommand("show", &why)->target, "frontend");
  EXPECT_EQ(ParseCommand("save", &why)->action, CommandAction::kSaveNow);
}

TEST(Commands, OthersAreRefusedWithAReason) {
  std::string why;
  EXPECT_FALSE(ParseCommand("", &why));
  EXPECT_FALSE(ParseCommand("dance", &why));
  EXPECT_THAT(why, HasSubstr("'dance' is no command; there are pause resume"));
  EXPECT_FALSE(ParseCommand("rate", &why));
  EXPECT_THAT(why, HasSubstr("needs a number"));
  for (const char* text : {"rate fast", "rate -1", "pause 3", "step 2 3", "rate 1e99"}) {
    EXPECT_FALSE(ParseCommand(text, &why)) << text;
  }
}

}  // namespace
}  // namespace vpslam
