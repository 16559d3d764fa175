#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// What a frustum costs beside reading every box.
struct FrustumCosts {
  /// By partition of one frustum, and at last of reading the six columns of all boxes once: one
  /// entry a round.
  std::vector<std::vector<double>> ms;
  double found_a_question = 0;  ///< objects
};

/// Questions of the set (see question_set_names) about the first frame of `uniform`, on one thread.
/// Throws Refusal.
[[nodiscard]] FrustumCosts measure_frustum_costs(const std::vector<std::string>& partitions,
                                                 const std::string& set, std::size_t objects,
                                                 std::size_t rounds = 15);

/// Allocations by a partition and its buffers when a set of questions is asked for the second time.
struct SecondRound {
  std::string set;  ///< and how it was asked
  std::size_t allocations = 0;
};

/// All sets, singly and as a batch, on `uniform`, on one thread. Throws Refusal.
[[nodiscard]] std::vector<SecondRound> measure_second_rounds(std::string_view partition,
                                                             std::size_t objects);

}  // namespace winnow::bench
