#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/world.h"

namespace winnow::test {

/// The state of a partition that callers can read. Taken before a call that must be refused, and
/// compared afterwards.
class Snapshot {
 public:
  explicit Snapshot(World& world) : world_(world), pairs_(canonical_pairs()) {}

  /// Returns true if the call returned `expected` and no readable state has changed.
  [[nodiscard]] testing::AssertionResult refused(Status status, Status expected) {
    if (status != expected) {
      return testing::AssertionFailure() << "returned " << winnow::to_string(status)
                                         << " instead of " << winnow::to_string(expected);
    }
    return unchanged();
  }

  [[nodiscard]] testing::AssertionResult unchanged() {
    if (testing::AssertionResult held = world_.holds_its_objects(); !held) return held;
    if (canonical_pairs() != pairs_) return testing::AssertionFailure() << "other pairs";
    return testing::AssertionSuccess();
  }

 private:
  std::vector<Pair> canonical_pairs() {
    PairBuffer buffer;
    EXPECT_EQ(world_.self_pairs(buffer, {.order = Order::canonical}), Status::ok);
    return {buffer.begin(), buffer.end()};
  }

  World& world_;
  std::vector<Pair> pairs_;
};

}  // namespace winnow::test
