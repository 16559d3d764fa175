#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include "bench/questions/shape_json.h"

#include <limits>
#include <string>

namespace winnow::bench {

/// Hard cases are questions whose answers are known by reasoning, as `winnow query` takes them,
/// with one more member: "expect" holds a "status" other than ok, or what the answer is: "overlap",
/// "distance" and "normal" (where it is unique) of a pair, "hit", "t" and "normal" of a ray, with a
/// "tolerance" where these had to be rounded by more than doubles are.

// Faults of a verdict.
inline constexpr const char* kContactLost = "contact lost";
inline constexpr const char* kFalseContact = "false contact";

/// How the answer to a hard case was.
struct CaseVerdict {
  /// What is wrong; empty if nothing is: the id, the status, the verdict, the distance, the error
  /// bound, or a normal that is not unit or more than 0.01 degrees off.
  std::string fault;
  /// Of the distance, relative to sizes and distance; NaN: there is none.
  double error = std::numeric_limits<double>::quiet_NaN();
  /// The same over the most that is allowed.
  double over_allowed = std::numeric_limits<double>::quiet_NaN();
};

/// `promised` is the largest error of a distance that is right, relative to sizes and distance.
[[nodiscard]] CaseVerdict judge_case(const Json& question, const Json& answer, double promised);

/// What a tier promises.
[[nodiscard]] double promised_error(NarrowTier tier);

/// The same with a and b exchanged where there are both, which turns the normals expected.
[[nodiscard]] Json exchanged(const Json& questions);

}  // namespace winnow::bench
