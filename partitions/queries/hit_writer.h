#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/results.h>
#include "core/memory/key_table.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Access of queries to the private data of a HitBuffer. Cast kernels write two pairs per hit,
/// (query, object) and (bits of t, 0). Groups of queries come in order, hits within a group do
/// not. `finish` sorts them.
class HitWriter {
 public:
  /// Queries per group.
  static constexpr std::size_t kGroup = 1024;

  /// Empties the buffer for that many queries. False if memory is refused.
  [[nodiscard]] static bool start(HitBuffer& out, std::size_t queries) noexcept;
  /// Hits that `finish` has not processed yet.
  [[nodiscard]] static PairBuffer& found(HitBuffer& out) noexcept { return out.found_; }
  /// Converts the hits of queries [first, last), sorted by query, t and id; `first` is the
  /// first of a group. False if memory is refused.
  [[nodiscard]] static bool finish(HitBuffer& out, std::size_t first, std::size_t last,
                                   const KeyTable& keys, const Execution& execution) noexcept;

  /// Scratch of a nearest query.
  [[nodiscard]] static Column<std::uint64_t>& heap(HitBuffer& out) noexcept { return out.keys_; }
  /// Converts this scratch to the hits of one query. False if memory is refused.
  [[nodiscard]] static bool write_heap(HitBuffer& out, const KeyTable& keys) noexcept;

 private:
  static void finish_group(HitBuffer& out, std::size_t first, std::size_t last,
                           std::size_t hits_before, const KeyTable& keys) noexcept;
  static void write(HitBuffer& out, std::size_t begin, std::size_t end, std::size_t hits_before,
                    const KeyTable& keys) noexcept;
};

}  // namespace winnow
