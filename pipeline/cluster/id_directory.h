#pragma once

#include <winnow/pipeline/cluster_transport.h>
#include "pipeline/cluster/name_table.h"

#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

namespace winnow {

/// One rank's part of a distributed directory of all names, which ensures that no name is used
/// twice in a cluster. The hash of a name selects the rank that stores it (its keeper). Adding
/// names takes three exchanges: ranks send names to the keepers, keepers return refusals, and a
/// rank with any refusal withdraws all of its names.
class IdDirectory {
 public:
  IdDirectory(std::uint32_t rank, std::uint32_t ranks, std::pmr::memory_resource* memory)
      : rank_(rank), ranks_(ranks), names_(memory) {}

  /// Frees a name; sent with the next call of `request`.
  void release(std::uint64_t name) { released_.push_back(name); }

  /// Step 1: requests names from their keepers.
  void request(std::span<const std::uint64_t> names, std::vector<RankMessage>& messages);
  /// Step 2, as keeper: refuses ranks that request a stored name, or a name that another rank
  /// requests too.
  void answer(std::span<const RankMessage> requests, std::vector<RankMessage>& messages);
  /// Step 3: returns true if nothing was refused; else sends withdrawals to the keepers of the
  /// requested names.
  [[nodiscard]] bool conclude(std::span<const RankMessage> refusals,
                              std::vector<RankMessage>& messages);
  /// Last, as keeper: stores the requested names of the ranks that did not withdraw.
  void keep(std::span<const RankMessage> withdrawn);

  [[nodiscard]] std::size_t bytes() const noexcept { return names_.bytes(); }

 private:
  struct NameRequest {
    std::uint64_t name;
    std::uint32_t from;
    friend constexpr auto operator<=>(const NameRequest&, const NameRequest&) noexcept = default;
  };

  [[nodiscard]] std::uint32_t keeper_of(std::uint64_t name) const noexcept {
    // Uses other bits of the hash than NameTable.
    return static_cast<std::uint32_t>((scattered(name) >> 32U) % ranks_);
  }
  void sort_by_keeper(std::vector<std::uint64_t>& names) const;

  std::uint32_t rank_;
  std::uint32_t ranks_;
  NameTable names_;
  std::vector<std::uint64_t> released_;
  // Data of the sent messages; must stay in place until the next exchange.
  std::vector<std::uint64_t> sent_;
  std::vector<std::uint64_t> sent_released_;
  std::vector<std::uint32_t> requested_keepers_;  // ranks that names were requested from
  std::vector<NameRequest> requests_;
};

}  // namespace winnow
