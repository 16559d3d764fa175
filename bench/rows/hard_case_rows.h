#pragma once

#include "bench/rows/results.h"

#include <string>

namespace winnow::bench {

/// Adds the results of winnow's tiers, each with its guaranteed error, and of other libraries, with
/// an allowed error of 1e-4 of the size, for the cases of a family. Other libraries get no
/// roundings, rays or bad input. libccd starts from the shapes' origins and therefore gets only
/// shapes that contain their origin. An exception counts as a wrong answer. Throws ArgumentError if
/// a question is not a hard case.
void add_hard_cases(Results& results, const std::string& family, const Json& questions, bool peers);

/// Adds the sums of the rows added so far.
void add_hard_case_totals(Results& results);

}  // namespace winnow::bench
