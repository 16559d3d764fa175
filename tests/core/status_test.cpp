#include <winnow/core/status.h>

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace winnow::test {
namespace {

// What lies behind the last one has the name of none.
TEST(Statuses, have_names_of_their_own) {
  const std::string none = to_string(static_cast<Status>(255));
  std::set<std::string> names{none};
  for (int i = 0; i <= static_cast<int>(Status::communication_failed); ++i) {
    EXPECT_TRUE(names.insert(to_string(static_cast<Status>(i))).second) << i;
  }
  EXPECT_EQ(to_string(static_cast<Status>(static_cast<int>(Status::communication_failed) + 1)),
            none);
  EXPECT_STREQ(to_string(Status::ok), "ok");
}

}  // namespace
}  // namespace winnow::test
