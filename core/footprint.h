#pragma once

#include <winnow/core/export.h>

#include <cstddef>
#include <initializer_list>

namespace winnow {

/// Bytes of one purpose: `used` holds live content, `reserved` is what the memory resource gave.
struct Bytes {
  std::size_t used = 0;      ///< bytes with content
  std::size_t reserved = 0;  ///< bytes held, content or not

  /// Adds both.
  Bytes& operator+=(const Bytes& other) noexcept {
    used += other.used;
    reserved += other.reserved;
    return *this;
  }
  /// Both are equal.
  friend bool operator==(const Bytes&, const Bytes&) noexcept = default;
};

/// Bytes by purpose. The sum of `reserved` equals, to the byte, what is outstanding at the memory
/// resource; the object itself (its sizeof) is not in it.
struct Footprint {
  Bytes bounds;       ///< bounding-volume columns
  Bytes keys;         ///< slots, generations, row maps
  Bytes client_data;  ///< the callers' values
  Bytes structure;    ///< cells, nodes, sort orders: what the partition adds
  Bytes scratch;      ///< buffers kept from frame to frame
  Bytes results;      ///< pairs and hits on their way to the caller's buffer

  /// Sum of all purposes.
  [[nodiscard]] Bytes total() const noexcept {
    Bytes sum;
    for (const Bytes* part : {&bounds, &keys, &client_data, &structure, &scratch, &results}) {
      sum += *part;
    }
    return sum;
  }
};

}  // namespace winnow
