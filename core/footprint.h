#pragma once

#include <winnow/core/export.h>

#include <cstddef>
#include <initializer_list>

namespace winnow {

/// Bytes of one purpose: `used` is live content, `reserved` is allocated from the memory resource.
struct Bytes {
  std::size_t used = 0;      ///< bytes with content
  std::size_t reserved = 0;  ///< bytes allocated, with content or not

  /// Adds both members.
  Bytes& operator+=(const Bytes& other) noexcept {
    used += other.used;
    reserved += other.reserved;
    return *this;
  }
  /// True if both members are equal.
  friend bool operator==(const Bytes&, const Bytes&) noexcept = default;
};

/// Bytes by purpose. The sum of `reserved` equals, to the byte, the memory outstanding at the
/// memory resource; the object itself (its sizeof) is not included.
struct Footprint {
  Bytes bounds;       ///< bounding-volume columns
  Bytes keys;         ///< slots, generations and row maps
  Bytes client_data;  ///< client data of all objects
  Bytes structure;    ///< cells, nodes and sort orders of the partition
  Bytes scratch;      ///< buffers kept from frame to frame
  Bytes results;      ///< pairs, hits, contacts and other results

  /// Returns the sum over all purposes.
  [[nodiscard]] Bytes total() const noexcept {
    Bytes sum;
    for (const Bytes* part : {&bounds, &keys, &client_data, &structure, &scratch, &results}) {
      sum += *part;
    }
    return sum;
  }
};

}  // namespace winnow
