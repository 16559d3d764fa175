#include <winnow/core/status.h>

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace winnow::test {
namespace {

// A value after the last status has the name of an unknown status.
TEST(Statuses, every_status_has_its_own_name) {
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
