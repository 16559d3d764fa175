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

/// What a report is about.
struct ReportOptions {
  std::vector<NamedScene> scenes;
  std::vector<std::size_t> objects;  ///< of built-in scenes, ascending
  std::vector<int> threads;          ///< ascending; the first is 1 unless asked otherwise
  std::vector<Isa> isas;             ///< narrowest first; the last one is the active one
  bool peers = true;                 ///< other libraries too, where the tool has them
  bool yardstick = true;             ///< the yardstick too, where the tool has it
  /// Few and small measurements: every part of the report in some seconds, none of it steady.
  bool quick = false;
  std::uint64_t seed = 1;
};

/// A piece of the work: it adds rows to the results. One that throws is noted as a problem, and the
/// report goes on.
struct ReportStep {
  std::string what;      ///< for the progress: "mixed, 10,000 objects"
  double seconds = 1.0;  ///< about how long it takes, for the time left
  std::function<void(Results&)> run;
};
using ReportSteps = std::vector<ReportStep>;

/// A part of the report: what is measured. What is shown of it stands in layout.json.
struct ReportSection {
  std::string_view id;
  void (*declare)(Results&);
  ReportSteps (*plan)(const ReportOptions&);
};

/// All of them, in the order of the page.
[[nodiscard]] std::span<const ReportSection> report_sections() noexcept;

// Of partitions.
[[nodiscard]] ReportSteps plan_throughput(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_memory(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_volumes(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_queries(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_advice(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_ranks(const ReportOptions& options);
// Of what tries to break it.
[[nodiscard]] ReportSteps plan_trust(const ReportOptions& options);
// Of the pipeline.
[[nodiscard]] ReportSteps plan_narrow(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_stability(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_motion(const ReportOptions& options);
[[nodiscard]] ReportSteps plan_pipeline(const ReportOptions& options);

}  // namespace winnow::bench
