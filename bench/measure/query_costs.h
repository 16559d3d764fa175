#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Cost of frustum queries compared with reading every box.
struct FrustumCosts {
  /// ms[i][round]: milliseconds of one frustum query of partition i. The last i is not a partition,
  /// but one pass over the six columns of all boxes.
  std::vector<std::vector<double>> ms;
  double found_a_question = 0;  ///< mean number of objects
};

/// Runs the queries of a set (see query_set_names) on the first frame of `uniform`, on one
/// thread. Throws QueryError.
[[nodiscard]] FrustumCosts measure_frustum_costs(const std::vector<std::string>& partitions,
                                                 const std::string& set, std::size_t objects,
                                                 std::size_t rounds = 15);

/// Allocations by a partition and its buffers when a set of queries is run a second time.
struct SecondRound {
  std::string set;  ///< name of the set, and how it was run
  std::size_t allocations = 0;
};

/// Runs all sets, singly and as a batch, on `uniform`, on one thread. Throws QueryError.
[[nodiscard]] std::vector<SecondRound> measure_second_rounds(std::string_view partition,
                                                             std::size_t objects);

}  // namespace winnow::bench
