#include "bench/contenders/partitions.h"

#include "bench/common/table.h"

#include <algorithm>
#include <limits>
#include <new>
#include <stdexcept>

namespace winnow::bench {

std::vector<std::string> all_partitions() {
  std::vector<std::string> names;
  for (const StructureKind kind : all_structures()) names.emplace_back(kind.name());
  return names;
}

std::vector<std::string> testing_partitions() {
  std::vector<std::string> names = all_partitions();
  std::erase(names, "NSquared");
  return names;
}

Partition make_named(std::string_view name, const PartitionOptions& options) {
  const StructureKind kind = structure_named(name);
  if (kind == StructureKind{})
    throw std::runtime_error("there is no partition " + std::string(name));
  Partition partition(kind, options);
  if (partition.status() != Status::ok) throw std::bad_alloc();
  return partition;
}

Execution execution_for(int threads) noexcept {
  return threads == 1 ? Execution::serial() : Execution::parallel();
}

std::size_t largest_for(std::string_view partition) noexcept {
  if (partition == "NSquared") return 2'000;
  if (partition == "BoundsNSquared") return 50'000;
  return std::numeric_limits<std::size_t>::max();
}

std::vector<std::string> unlimited_partitions() {
  std::vector<std::string> names = all_partitions();
  std::erase_if(names, [](const std::string& name) {
    return largest_for(name) != std::numeric_limits<std::size_t>::max();
  });
  return names;
}

Partitions partitions_for(const std::vector<std::string>& names, std::size_t objects) {
  if (std::find(names.begin(), names.end(), "all") == names.end()) return {names, {}};
  Partitions result;
  for (const std::string& name : all_partitions()) {
    const std::size_t largest = largest_for(name);
    if (objects <= largest) {
      result.taken.push_back(name);
    } else {
      result.skipped.push_back(name + " (more than " + grouped(largest) + " objects)");
    }
  }
  return result;
}

}  // namespace winnow::bench
