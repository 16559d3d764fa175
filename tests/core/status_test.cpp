#include <winnow/core/key.h>
#include <winnow/core/status.h>

#include <gtest/gtest.h>

#include <set>
#include <span>
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

TEST(Answers, value_has_status_ok) {
  const Answer<Key> answer = Key{3, 4};
  EXPECT_EQ(answer.status, Status::ok);
  EXPECT_EQ(answer.id, 3U);
  const Key key = answer;
  EXPECT_EQ(key, (Key{3, 4}));
  const int numbers[] = {1, 2, 3};
  int sum = 0;
  for (const int number : Answer<std::span<const int>>(numbers)) sum += number;
  EXPECT_EQ(sum, 6);
}

TEST(Answers, error_has_the_default_value) {
  const Answer<Key> answer = Status::invalid_pose;
  EXPECT_EQ(answer.status, Status::invalid_pose);
  EXPECT_FALSE(answer);
  EXPECT_TRUE(Answer<std::span<const int>>(Status::invalid_key).empty());
}

TEST(Answers, get_stores_only_values) {
  Key key{1, 2};
  EXPECT_EQ(Answer<Key>(Status::invalid_pose).get(key), Status::invalid_pose);
  EXPECT_EQ(key, (Key{1, 2}));
  EXPECT_EQ(Answer<Key>(Key{3, 4}).get(key), Status::ok);
  EXPECT_EQ(key, (Key{3, 4}));
}

}  // namespace
}  // namespace winnow::test
