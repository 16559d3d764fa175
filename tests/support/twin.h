#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/filter.h>
#include <winnow/core/pair_buffer.h>

#include <ostream>
#include <span>
#include <vector>

namespace winnow {

/// For messages; in Pair's own namespace, where GoogleTest looks.
inline std::ostream& operator<<(std::ostream& out, const Pair& pair) {
  return out << "(" << pair.first << ", " << pair.second << ")";
}

}  // namespace winnow

namespace winnow::test {

/// A live object as the tests know it.
struct Object {
  ObjectId id = kNoObject;
  Aabb box;
  ObjectFilter filter{};
};

/// The slow obvious twin: every pair tested and let pass by the objects' filters, sorted.
[[nodiscard]] std::vector<Pair> brute_force_pairs(std::span<const Object> objects);

/// The same set by sorting on x first, for scenes too large for the slow twin; sorted.
[[nodiscard]] std::vector<Pair> swept_pairs(std::span<const Object> objects);

/// Whichever of the two suits the size.
[[nodiscard]] std::vector<Pair> true_pairs(std::span<const Object> objects);

/// Objects 0, 1, 2, ... with these boxes.
[[nodiscard]] std::vector<Object> numbered(std::span<const Aabb> boxes);

/// Every (object of a, object of b) that overlap, sorted.
[[nodiscard]] std::vector<Pair> cross_pairs(std::span<const Object> a, std::span<const Object> b);

}  // namespace winnow::test
