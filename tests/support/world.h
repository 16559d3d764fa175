#pragma once

#include <gtest/gtest.h>
#include <winnow/partitions/partition.h>

#include <cstddef>
#include <map>
#include <memory>
#include <memory_resource>
#include <span>
#include <vector>

#include "tests/support/config.h"
#include "tests/support/reference.h"

namespace winnow::test {

/// Returns true if `got` is a right result of `self_pairs` for the true pairs `truth` (sorted):
/// each pair once, first < second; exactly the true ones, or with additional ones if the partition
/// is not exact.
[[nodiscard]] testing::AssertionResult right_pairs(std::span<const Pair> got,
                                                   std::span<const Pair> truth, bool exact);

/// As above, for pairs between two partitions, where first < second need not hold.
[[nodiscard]] testing::AssertionResult right_cross_pairs(std::span<const Pair> got,
                                                         std::span<const Pair> truth, bool exact);

/// A partition and a plain model with the same content. Calls run on the config's threads.
class World {
 public:
  struct Entry {
    Key key;
    Aabb box;
    ClientData data = 0;
    ObjectFilter filter{};
  };

  explicit World(const Config& config,
                 std::pmr::memory_resource* memory = std::pmr::get_default_resource());

  [[nodiscard]] Partition& partition() { return partition_; }
  [[nodiscard]] const Partition& partition() const { return partition_; }
  [[nodiscard]] Threads& threads() { return threads_; }

  // Each call must succeed and is repeated on the model.
  std::vector<Key> insert(std::span<const Aabb> boxes, std::span<const ClientData> data = {});
  Key insert(const Aabb& box, ClientData data = 0);
  void update(std::span<const Key> keys, std::span<const Aabb> boxes);
  void update(Key key, const Aabb& box);
  void remove(std::span<const Key> keys);
  void remove(Key key);
  void set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters);
  void set_filter(Key key, const ObjectFilter& filter);
  void clear();

  /// Runs a query on the config's threads.
  Status self_pairs(PairBuffer& buffer, const PairOptions& options = {});
  Status pairs_with(const Partition& other, PairBuffer& buffer, const PairOptions& options = {});

  /// Returns true if a pair query into `buffer` succeeds and is right.
  [[nodiscard]] testing::AssertionResult agrees(PairBuffer& buffer,
                                                const PairOptions& options = {});
  /// As above, with a fresh buffer.
  [[nodiscard]] testing::AssertionResult agrees();
  /// Returns true if size, keys, boxes (bit by bit), client data and filters equal the model.
  [[nodiscard]] testing::AssertionResult holds_its_objects() const;

  /// Live objects by id.
  [[nodiscard]] const std::map<ObjectId, Entry>& entries() const { return entries_; }
  [[nodiscard]] std::vector<Object> objects() const;
  /// Returns true if the pairs are right.
  [[nodiscard]] testing::AssertionResult has_pairs(const PairBuffer& buffer) const;
  /// Returns true if the filters of all pairs' objects accept each other.
  [[nodiscard]] testing::AssertionResult may_all_pair(std::span<const Pair> pairs) const;

 private:
  std::map<ObjectId, Entry> entries_;
  Partition partition_;
  Threads threads_;
};

}  // namespace winnow::test
