#pragma once

#include <winnow/partitions/partition.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

// Partitions by name. The tool creates partitions only here.

/// Returns all names, in the order in which reports list them.
[[nodiscard]] std::vector<std::string> all_partitions();
/// Returns the partitions that test bounds: all but the baseline that does not.
[[nodiscard]] std::vector<std::string> testing_partitions();

/// Makes the partition of that name; throws std::runtime_error if there is none.
[[nodiscard]] Partition make_named(std::string_view name, const PartitionOptions& options = {});

/// Returns the execution options that a program with `threads` threads uses.
[[nodiscard]] Execution execution_for(int threads) noexcept;

/// Returns the number of objects up to which a partition is run on whole scenes. The limit matters
/// for the baselines: from some dozens to some hundreds of objects on, each partition with a
/// structure is faster than BoundsNSquared.
[[nodiscard]] std::size_t largest_for(std::string_view partition) noexcept;

/// Returns the partitions without such a limit.
[[nodiscard]] std::vector<std::string> unlimited_partitions();

/// The partitions to run, and those left out, as in "NSquared (more than 2,000 objects)".
struct Partitions {
  std::vector<std::string> taken;
  std::vector<std::string> skipped;
};

/// Selects each partition named; "all" selects all whose limit allows `objects`.
[[nodiscard]] Partitions partitions_for(const std::vector<std::string>& names, std::size_t objects);

}  // namespace winnow::bench
