#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/hits.h>
#include <winnow/core/key_table.h>

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

/// A query's access to the inside of a HitBuffer: first come pairs (id, t's bits) question by
/// question with their counts, then they are sorted and written as hits.
class HitWriter {
 public:
  /// What has been found so far.
  [[nodiscard]] static PairBuffer& found(HitBuffer& out) noexcept { return out.found_; }

  /// Empties the buffer for `questions` questions. False if memory is refused.
  [[nodiscard]] static bool start(HitBuffer& out, std::size_t questions) noexcept {
    out.clear();
    out.found_.clear();
    if (!out.start_.resize(questions + 1)) return false;
    out.start_[0] = 0;
    return true;
  }
  static void set_count(HitBuffer& out, std::size_t question, std::size_t hits) noexcept {
    out.start_[question + 1] = hits;
  }

  /// Scratch for a nearest query.
  [[nodiscard]] static Column<std::uint64_t>& heap(HitBuffer& out) noexcept { return out.heap_; }
  /// Writes these as the hits of the only question. False if memory is refused.
  [[nodiscard]] static bool write(HitBuffer& out, const KeyTable& keys,
                                  const Column<std::uint64_t>& found) noexcept;

  /// Sorts by (t, id) and writes every question's hits. False if memory is refused.
  [[nodiscard]] static bool finish(HitBuffer& out, const KeyTable& keys,
                                   const Execution& execution) noexcept;
};

}  // namespace winnow
