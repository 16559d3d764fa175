#pragma once

#include <winnow/simd/isa.h>
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
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
  std::string what;      ///< shown as progress: "mixed, 10,000 objects"
  double seconds = 1.0;  ///< estimate, for the time left
  std::function<void(Results&)> run;
};
using ReportSteps = std::vector<ReportStep>;

/// A section of the report: declares its tables and plans its measurements. layout.json describes
/// how its results are shown.
struct ReportSection {
  std::string_view id;
  void (*declare)(Results&);
  ReportSteps (*plan)(const ReportOptions&);
};

/// Returns all sections in the order of the page.
[[nodiscard]] std::span<const ReportSection> report_sections() noexcept;

// Sections about partitions.
[[nodiscard]] ReportSteps plan_throughput(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_memory(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_advice(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_ranks(const ReportOptions& options);
// Section about tests that try to break the library.
[[nodiscard]] ReportSteps plan_trust(const ReportOptions& options);
// Sections about the pipeline.
[[nodiscard]] ReportSteps plan_stability(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_motion(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_pipeline(const ReportOptions& options);

}  // namespace winnow::bench
