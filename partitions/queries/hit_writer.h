#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/hits.h>
#include "core/memory/key_table.h"

#include <bit>
#include <cstddef>
#include <cstdint>

namespace winnow {

/// The hit that (t's bits << 32 | id) stands for.
[[nodiscard]] inline Hit to_hit(const KeyTable& keys, std::uint64_t found) noexcept {
  const auto id = static_cast<ObjectId>(found);
  return {keys.key_of(id), keys.client_data(id),
          std::bit_cast<float>(static_cast<std::uint32_t>(found >> 32U))};
}

/// A query's access to the inside of a HitBuffer. Casts first write two pairs a hit, (question,
/// object) and (bits of t, 0), those of one group of questions after those of another, but in no
/// order within a group; then `finish` puts them in order.
class HitWriter {
 public:
  /// Questions in a group.
  static constexpr std::size_t kGroup = 1024;

  /// Empties the buffer for `questions` questions. False if memory is refused.
  [[nodiscard]] static bool start(HitBuffer& out, std::size_t questions) noexcept;
  /// Found and not yet finished.
  [[nodiscard]] static PairBuffer& found(HitBuffer& out) noexcept { return out.found_; }
  /// Makes hits of what was found for questions [first, last), where `first` begins a group, sorted
  /// by question, t and id. False if memory is refused.
  [[nodiscard]] static bool finish(HitBuffer& out, std::size_t first, std::size_t last,
                                   const KeyTable& keys, const Execution& execution) noexcept;

  /// Scratch for a nearest query.
  [[nodiscard]] static Column<std::uint64_t>& heap(HitBuffer& out) noexcept { return out.keys_; }
  /// Makes hits of what is in that scratch, of one question. False if memory is refused.
  [[nodiscard]] static bool write_heap(HitBuffer& out, const KeyTable& keys) noexcept;

 private:
  static void finish_group(HitBuffer& out, std::size_t first, std::size_t last,
                           std::size_t hits_before, const KeyTable& keys) noexcept;
  static void write(HitBuffer& out, std::size_t begin, std::size_t end, std::size_t hits_before,
                    const KeyTable& keys) noexcept;
};

}  // namespace winnow
