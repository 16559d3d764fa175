#pragma once

#include <winnow/core/pair_buffer.h>

#include <cstddef>
#include <cstdint>

namespace winnow {

/// A partition's access to the provenance of a PairBuffer.
class PairTracker {
 public:
  [[nodiscard]] static PairBuffer::Provenance provenance(const PairBuffer& out) noexcept {
    return out.provenance_;
  }
  static void set_provenance(PairBuffer& out, PairBuffer::Provenance provenance) noexcept {
    out.provenance_ = provenance;
  }

  /// Drops every pair that has an object in the set, keeping the order. O(pairs).
  static void drop(PairBuffer& out, const std::uint64_t* moved) noexcept;

  /// The same, adding the pairs that it drops to `dropped`, which is empty. False, and unchanged
  /// but for the order, if memory is refused.
  [[nodiscard]] static bool drop(PairBuffer& out, const std::uint64_t* moved,
                                 Column<Pair>& dropped) noexcept;

  /// Sorts by (first, second), all ids below `slots`. O(pairs); false if memory is refused.
  [[nodiscard]] static bool sort(PairBuffer& out, std::size_t slots) noexcept {
    return sort(out, slots, 0, out.size());
  }
  /// The same for pairs [begin, end) alone.
  [[nodiscard]] static bool sort(PairBuffer& out, std::size_t slots, std::size_t begin,
                                 std::size_t end) noexcept;

  /// The first `size` of the pairs that stand in its array.
  static void set_size(PairBuffer& out, std::size_t size) noexcept { out.pairs_.set_size(size); }

  /// The pairs, which keep their provenance.
  [[nodiscard]] static Pair* data(PairBuffer& out) noexcept { return out.pairs_.data(); }
};

}  // namespace winnow
