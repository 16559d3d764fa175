#pragma once

#include <winnow/core/results.h>

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Returns the pair as a number, which is not 0 if the ids differ in the order first < second.
[[nodiscard]] constexpr std::uint64_t as_number(const Pair& pair) noexcept {
  return static_cast<std::uint64_t>(pair.first) << 32U | pair.second;
}

/// Access of a partition to the private data of a PairBuffer.
class PairTracker {
 public:
  [[nodiscard]] static PairBuffer::Provenance provenance(const PairBuffer& out) noexcept {
    return out.provenance_;
  }
  static void set_provenance(PairBuffer& out, PairBuffer::Provenance provenance) noexcept {
    out.provenance_ = provenance;
  }

  /// Removes every pair with an object in the bitmap, in stable order. O(pairs).
  static void drop(PairBuffer& out, const std::uint64_t* moved) noexcept;

  /// As above; appends removed pairs to `dropped`, which must be empty. If memory is refused,
  /// returns false and keeps all pairs, in another order.
  [[nodiscard]] static bool drop(PairBuffer& out, const std::uint64_t* moved,
                                 Column<Pair>& dropped) noexcept;

  /// Sorts by (first, second); ids are below `slots`. O(pairs). False if memory is refused.
  [[nodiscard]] static bool sort(PairBuffer& out, std::size_t slots) noexcept {
    return sort(out, slots, 0, out.size());
  }
  /// Sorts pairs [begin, end) only.
  [[nodiscard]] static bool sort(PairBuffer& out, std::size_t slots, std::size_t begin,
                                 std::size_t end) noexcept;

  /// Sets the number of pairs in the array; the memory must be reserved.
  static void set_size(PairBuffer& out, std::size_t size) noexcept { out.rows_.set_size(size); }

  /// Returns the pairs for editing; provenance stays.
  [[nodiscard]] static Pair* data(PairBuffer& out) noexcept { return out.rows_.data(); }
};

}  // namespace winnow
