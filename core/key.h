#pragma once

#include <winnow/core/export.h>

#include <cstdint>
#include <string_view>  // declares std::hash

namespace winnow {

/// A 64-bit value that a partition stores and gives back and never reads. Two objects may share
/// one.
using ClientData = std::uint64_t;

/// Index of an object in its partition, stable from insert to remove and reused afterwards.
/// Objects inserted into a fresh partition get 0, 1, 2, ... Pairs are given in these.
using ObjectId = std::uint32_t;

/// No object.
inline constexpr ObjectId kNoObject = 0xFFFFFFFFU;

/// Objects that one partition can hold at a time.
inline constexpr std::uint64_t kMaxObjects = 0xFFFFFFFEULL;

/// Opaque handle of an inserted object. The default key is null and is never handed out. A key
/// whose object was removed, or that another partition or scene gave out, is answered with
/// `Status::invalid_key`: the stamp holds 17 bits that tell 131,071 of them apart, as many as may
/// live in one process at a time, and a 15-bit generation. One whose generations are used up, after
/// 16,384 objects in one place, tells its keys by a further number. `std::hash`
/// takes keys.
struct Key {
  ObjectId id = kNoObject;  ///< index of the object in its partition
  /// Tells it from others that had the index, and from those of other partitions.
  std::uint32_t stamp = 0;

  /// The same object of the same partition.
  friend constexpr bool operator==(const Key&, const Key&) noexcept = default;
};

static_assert(sizeof(Key) == 8);

}  // namespace winnow

// Doxygen knows no namespace that it could be part of.
/// @cond
template <>
struct std::hash<winnow::Key> {
  std::size_t operator()(const winnow::Key& key) const noexcept {
    return std::hash<std::uint64_t>{}((static_cast<std::uint64_t>(key.stamp) << 32U) | key.id);
  }
};
/// @endcond
