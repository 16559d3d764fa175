#pragma once

#include "bench/scenes/question_set.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace winnow::bench {

/// What arithmetic in double, written down plainly, says about one question and one box.
struct Verdict {
  bool possible = false;  ///< the box is found, or misses by less than the tolerance
  bool certain = false;   ///< the box is found by more than the tolerance
  double t = 0.0;         ///< where a ray meets the box, or how far it is
};

/// Judges answers independently of how they were found.
class Judge {
 public:
  explicit Judge(std::span<const Aabb> boxes) noexcept : boxes_(boxes) {}

  /// About a question and an object. `tolerance` is relative to the coordinates that are computed
  /// with, as the rounding of what is judged: 1e-13 for double, 1e-6 for float.
  [[nodiscard]] Verdict verdict(const QuestionSet& set, std::size_t question, std::uint32_t row,
                                double tolerance) const;

 private:
  std::span<const Aabb> boxes_;
};

/// How two engines' answers to a set stand to each other.
struct Comparison {
  std::size_t wrong = 0;      ///< questions whose answers cannot both be right
  std::size_t undecided = 0;  ///< questions whose answers differ where float cannot decide
  std::string first;          ///< what was wrong first

  [[nodiscard]] bool agree() const noexcept { return wrong == 0; }
};

/// Of two partitions: the same objects, in the same order with the same t where there is an order.
/// Of any hit only whether there is one, and that it is one.
[[nodiscard]] Comparison compare_exactly(const Judge& judge, const QuestionSet& set,
                                         const Answers& expected, const Answers& got);

/// Of a partition and an engine that computes in float: t within 2 ulp, objects in order of t. An
/// object that only one of the two found is judged: it must lie within float's rounding.
[[nodiscard]] Comparison compare_in_float(const Judge& judge, const QuestionSet& set,
                                          const Answers& expected, const Answers& got);

/// Of a partition and every box tested in double, for at most `most` questions.
[[nodiscard]] Comparison compare_by_force(const Judge& judge, const QuestionSet& set,
                                          std::size_t objects, const Answers& got,
                                          std::size_t most);

}  // namespace winnow::bench
