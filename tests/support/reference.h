#pragma once

#include <winnow/core/filter.h>
#include <winnow/core/results.h>
#include <winnow/core/volumes.h>

#include <ostream>
#include <span>
#include <vector>

namespace winnow {

/// For messages; in the namespace of Pair, where GoogleTest looks it up.
inline std::ostream& operator<<(std::ostream& out, const Pair& pair) {
  return out << "(" << pair.first << ", " << pair.second << ")";
}

}  // namespace winnow

namespace winnow::test {

/// A live object as the tests store it.
struct Object {
  ObjectId id = kNoObject;
  Aabb box;
  ObjectFilter filter{};
};

/// Brute force: tests every pair and the filters of its objects; sorted.
[[nodiscard]] std::vector<Pair> brute_force_pairs(std::span<const Object> objects);

/// Returns the same pairs by a sweep along x, for scenes too large for brute force; sorted.
[[nodiscard]] std::vector<Pair> swept_pairs(std::span<const Object> objects);

/// Calls one of the two, depending on the size.
[[nodiscard]] std::vector<Pair> true_pairs(std::span<const Object> objects);

/// Objects 0, 1, 2, ... with these boxes.
[[nodiscard]] std::vector<Object> numbered(std::span<const Aabb> boxes);

/// Returns every overlapping (object of a, object of b), sorted.
[[nodiscard]] std::vector<Pair> cross_pairs(std::span<const Object> a, std::span<const Object> b);

}  // namespace winnow::test
