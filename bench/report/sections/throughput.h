#pragma once

#include "report/page.h"
#include "report/results.h"

namespace winnow::bench {

/// After so many frames the fingerprint of a row is taken: engines that run fewer frames than
/// others still show that they found the same.
inline constexpr std::size_t kFingerprintFrames = 3;

/// Adds what follows from the rows of one scene and size: how much faster wider instruction sets
/// and more threads are, and how the time grows from size to size.
void derive_throughput(Results& results, const std::string& scene, std::size_t objects);

void show_throughput(const Results& results, ReportPage& page);

}  // namespace winnow::bench
