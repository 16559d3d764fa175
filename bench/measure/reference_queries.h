#pragma once

#include "bench/scenes/query_set.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace winnow::bench {

/// Result of one query on one box, computed in double.
struct Verdict {
  bool possible = false;  ///< the box is found, or missed by less than the tolerance
  bool certain = false;   ///< the box is found by more than the tolerance
  double t = 0.0;         ///< where a ray enters the box, or the distance of the box
};

/// Evaluates queries independently of partitions and other libraries.
class ReferenceQueries {
 public:
  explicit ReferenceQueries(std::span<const Aabb> boxes) noexcept : boxes_(boxes) {}

  /// Evaluates one query on one object. `tolerance` is relative to the coordinates, like the
  /// rounding of the engine under test: 1e-13 for double, 1e-6 for float.
  [[nodiscard]] Verdict verdict(const QuerySet& set, std::size_t question, std::uint32_t row,
                                double tolerance) const;

 private:
  std::span<const Aabb> boxes_;
};

/// Result of comparing two engines' answers to a set.
struct Comparison {
  std::size_t wrong = 0;      ///< queries whose answers cannot both be right
  std::size_t undecided = 0;  ///< queries whose answers differ within the rounding of float
  std::string first;          ///< the first error, as text

  [[nodiscard]] bool agree() const noexcept { return wrong == 0; }
};

/// Compares two partitions: the objects must agree, and for ordered results also the order and t.
/// For QueryType::any, both must find an object or none, and the object must be a hit.
[[nodiscard]] Comparison compare_exactly(const ReferenceQueries& judge, const QuerySet& set,
                                         const QueryResults& expected, const QueryResults& got);

/// Compares a partition with an engine that computes in float: t must agree to a relative 3 *
/// 2^-23, with objects in order of t. An object that only one of the two found must be undecidable
/// within the rounding of float.
[[nodiscard]] Comparison compare_in_float(const ReferenceQueries& judge, const QuerySet& set,
                                          const QueryResults& expected, const QueryResults& got);

/// Compares a partition with a test of every box in double, for at most `most` queries.
[[nodiscard]] Comparison compare_by_force(const ReferenceQueries& judge, const QuerySet& set,
                                          std::size_t objects, const QueryResults& got,
                                          std::size_t most);

}  // namespace winnow::bench
