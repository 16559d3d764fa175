#pragma once

#include "bench/rows/results.h"

#include <string>

namespace winnow::bench {

/// hard_cases, and hard_cases_all, which sums them up.
void declare_hard_cases(Results& results);

/// Adds how winnow's tiers, each held to what it promises, and other libraries, held to 1e-4 of the
/// size, did on the cases of a family. Those are asked without roundings, rays and bad input,
/// and libccd, which starts from it, only about shapes that contain their origin; what an engine
/// throws is wrong. Throws ArgumentError if one of these is no hard case.
void add_hard_cases(Results& results, const std::string& family, const Json& questions, bool peers);

/// Sums of the rows that are there.
void add_hard_case_totals(Results& results);

}  // namespace winnow::bench
