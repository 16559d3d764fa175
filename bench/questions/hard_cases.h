#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include "bench/questions/shape_json.h"

#include <limits>
#include <string>

namespace winnow::bench {

/// Returns the files of tests/hard_cases, each an array, by their names. They are compiled in;
/// there are none if the tool was built without the tests.
[[nodiscard]] const Json& hard_cases();

/// Hard cases are queries in the format of `winnow query` whose results are known independently of
/// the library. Each has one more member, "expect": either a "status" other than ok, or the result.
/// The result is "overlap", "distance" and (if unique) "normal" of a pair; "hit", "t" and "normal"
/// of a ray; and a "tolerance" if the values had to be rounded by more than double precision
/// rounds.

// Values of CaseVerdict::fault.
inline constexpr const char* kContactLost = "contact lost";
inline constexpr const char* kFalseContact = "false contact";

/// Result of comparing an answer with the expectation of a hard case.
struct CaseVerdict {
  /// Name of the first member that is wrong: id, status, overlap, distance, error bound, or a
  /// normal that is not of unit length or is more than 0.01 degrees off. Empty if all are right.
  std::string fault;
  /// Error of the distance, relative to the sizes of both shapes plus the distance. NaN if there is
  /// none.
  double error = std::numeric_limits<double>::quiet_NaN();
  /// Error of the distance divided by the largest allowed error. NaN if there is none.
  double over_allowed = std::numeric_limits<double>::quiet_NaN();
};

/// Compares an answer with the expectation in its question. `promised` is the largest allowed error
/// of a distance, relative to the sizes of both shapes plus the distance.
[[nodiscard]] CaseVerdict check_hard_case(const Json& question, const Json& answer,
                                          double promised);

/// Returns the largest error that a tier guarantees, in the units of `check_hard_case`.
[[nodiscard]] double guaranteed_error(NarrowTier tier);

/// Returns the questions with a and b swapped and expected normals negated; questions that lack
/// either shape are copied unchanged.
[[nodiscard]] Json exchanged(const Json& questions);

}  // namespace winnow::bench
