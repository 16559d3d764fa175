#pragma once

#include <winnow/simd/isa.h>
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace winnow::bench {

/// Scope of a report.
struct ReportOptions {
  std::vector<NamedScene> scenes;
  std::vector<std::size_t> objects;  ///< of built-in scenes, ascending
  std::vector<int> threads;          ///< ascending; the first is 1 by default
  std::vector<Isa> isas;             ///< narrowest first; the last one is the active one
  bool peers = true;                 ///< measure other libraries too, if the tool has them
  bool yardstick = true;             ///< measure the yardstick too, if the tool has it
  /// Few and small measurements: every part of the report in seconds, with unstable times.
  bool quick = false;
  std::uint64_t seed = 1;
};

/// A unit of work that adds rows to the results. If it throws, the report notes the problem and
/// continues.
struct ReportStep {
  std::string section;
  std::string what;  ///< shown as progress: "mixed, 10,000 objects"
  std::function<void(Results&)> run;
};
using ReportSteps = std::vector<ReportStep>;

/// Returns the names of the sections; the last one, "goals", has rows that only goals need.
[[nodiscard]] std::vector<std::string> report_sections();

/// Returns the steps of these sections in their order; without sections, of all but "goals".
[[nodiscard]] ReportSteps report_steps(const ReportOptions& options,
                                       const std::vector<std::string>& sections);

}  // namespace winnow::bench
