#pragma once

#include <winnow/pipeline/cluster_transport.h>
#include "pipeline/cluster/name_table.h"

#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

namespace winnow {

/// One rank's share of all names that there are, so that none is given twice wherever this is
/// tried: a name is kept on the rank that its hash says. Three exchanges add names: they are asked
/// for, what is refused is told, and who was refused anywhere takes all of its names back.
class NameDirectory {
 public:
  NameDirectory(std::uint32_t rank, std::uint32_t ranks, std::pmr::memory_resource* memory)
      : rank_(rank), ranks_(ranks), names_(memory) {}

  /// To be told with the next names that are asked for.
  void forget(std::uint64_t name) { forgotten_.push_back(name); }

  /// 1: asks the ranks that keep these names for them.
  void ask(std::span<const std::uint64_t> names, std::vector<Parcel>& parcels);
  /// 2: tells who asked for a name that is there, or that another rank asks for.
  void answer(std::span<const Parcel> asked, std::vector<Parcel>& parcels);
  /// 3: true if nothing was refused; else tells those who were asked.
  [[nodiscard]] bool conclude(std::span<const Parcel> refusals, std::vector<Parcel>& parcels);
  /// Keeps the names of those who took nothing back.
  void keep(std::span<const Parcel> taken_back);

  [[nodiscard]] std::size_t bytes() const noexcept { return names_.bytes(); }

 private:
  struct Wanted {
    std::uint64_t name;
    std::uint32_t from;
    friend constexpr auto operator<=>(const Wanted&, const Wanted&) noexcept = default;
  };

  [[nodiscard]] std::uint32_t keeper_of(std::uint64_t name) const noexcept {
    // Other bits than those that say where it lies in a table.
    return static_cast<std::uint32_t>((scattered(name) >> 32U) % ranks_);
  }
  void sort_by_keeper(std::vector<std::uint64_t>& names) const;

  std::uint32_t rank_;
  std::uint32_t ranks_;
  NameTable names_;
  std::vector<std::uint64_t> forgotten_;
  // What is sent lies here until the next exchange.
  std::vector<std::uint64_t> sent_;
  std::vector<std::uint64_t> sent_forgotten_;
  std::vector<std::uint32_t> asked_;  // ranks
  std::vector<Wanted> wanted_;
};

}  // namespace winnow
