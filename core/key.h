#pragma once

#include <winnow/core/export.h>

#include <cstdint>
#include <string_view>  // declares std::hash

namespace winnow {

/// A 64-bit value that a partition stores with an object and returns, but never interprets. Objects
/// may share a value.
using ClientData = std::uint64_t;

/// Index of an object in its partition: stable from insert to remove, and reused afterwards.
/// Objects inserted into a new partition get 0, 1, 2, ... Pairs consist of these ids.
using ObjectId = std::uint32_t;

/// The id of no object.
inline constexpr ObjectId kNoObject = 0xFFFFFFFFU;

/// Maximum number of objects in a partition.
inline constexpr std::uint64_t kMaxObjects = 0xFFFFFFFEULL;

/// Opaque handle of an inserted object. The default key is null and belongs to no object. A key of
/// a removed object, or of another partition or scene, is rejected with `Status::invalid_key`: its
/// stamp consists of a 17-bit tag and a 15-bit generation. Up to 131,071 partitions and scenes of a
/// process have different tags at any one time. After 16,384 objects under one id its tag has no
/// generation left, and the id continues with another tag. `std::hash` accepts keys.
struct Key {
  ObjectId id = kNoObject;  ///< index of the object in its partition
  /// Distinguishes the object from earlier objects with this index and from objects of other
  /// partitions.
  std::uint32_t stamp = 0;

  /// True unless the key is null.
  [[nodiscard]] explicit constexpr operator bool() const noexcept { return id != kNoObject; }
  /// True if both belong to the same object of the same partition.
  friend constexpr bool operator==(const Key&, const Key&) noexcept = default;
};

static_assert(sizeof(Key) == 8);

}  // namespace winnow

// Hidden from Doxygen, which cannot assign it to a namespace.
/// @cond
template <>
struct std::hash<winnow::Key> {
  std::size_t operator()(const winnow::Key& key) const noexcept {
    return std::hash<std::uint64_t>{}((static_cast<std::uint64_t>(key.stamp) << 32U) | key.id);
  }
};
/// @endcond
