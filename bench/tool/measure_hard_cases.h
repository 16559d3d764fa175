#pragma once

#include "query/hard_cases.h"

#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace winnow::bench {

/// How one engine did on some hard cases.
struct HardCaseTally {
  std::string engine;
  bool is_peer = false;
  std::size_t right = 0;
  std::size_t wrong = 0;
  std::size_t wrong_verdicts = 0;  ///< of them
  std::size_t not_taken = 0;       ///< it has no such shapes, or no rays
  /// Of distances: relative to sizes and distance, and over what is allowed. NaN: there is none.
  double worst_error = std::numeric_limits<double>::quiet_NaN();
  double worst_over_allowed = std::numeric_limits<double>::quiet_NaN();
  std::map<std::string, std::size_t> faults{};  ///< how often what was wrong

  void add(const CaseVerdict& verdict);
  /// "contact lost 3, distance 2".
  [[nodiscard]] std::string faults_text() const;
};

/// Asks winnow's tiers, each held to what it promises, and other libraries, held to what `fast`
/// promises. Those are asked without roundings, rays and bad input, and libccd, which starts from
/// it, only about shapes that contain their origin; what an engine throws is wrong. Throws
/// ArgumentError if one of these is no hard case.
[[nodiscard]] std::vector<HardCaseTally> judge_hard_cases(const Json& questions, bool peers);

}  // namespace winnow::bench
