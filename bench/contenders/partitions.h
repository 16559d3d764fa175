#pragma once

#include <winnow/partitions/partition.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

// Partitions by name: the one place where the tool makes them.

/// All there are, in the order in which reports list them.
[[nodiscard]] std::vector<std::string> all_partitions();
/// Those that test bounds: all but the baseline that does not.
[[nodiscard]] std::vector<std::string> testing_partitions();

/// Throws std::runtime_error if there is none of this name.
[[nodiscard]] Partition make_named(std::string_view name, const PartitionOptions& options = {});

/// How a program uses a partition on so many threads.
[[nodiscard]] Execution execution_for(int threads) noexcept;

/// From some dozens to some hundreds of objects on, each partition with a structure is faster than
/// BoundsNSquared. The number of objects up to which a partition is run on whole scenes.
[[nodiscard]] std::size_t largest_for(std::string_view partition) noexcept;

/// Those that have no such limit.
[[nodiscard]] std::vector<std::string> unlimited_partitions();

/// Partitions to run, and those left out: "NSquared (more than 2,000 objects)".
struct Partitions {
  std::vector<std::string> taken;
  std::vector<std::string> skipped;
};

/// Each one named is taken; "all" takes those that suit so many objects.
[[nodiscard]] Partitions partitions_for(const std::vector<std::string>& names, std::size_t objects);

}  // namespace winnow::bench
