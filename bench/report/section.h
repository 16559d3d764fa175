#pragma once

#include <winnow/simd/isa.h>
#include "bench/report/page.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstdint>
#include <functional>
#include <memory>
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
  /// Few and small measurements: every part of the report in some seconds, none of it steady.
  bool quick = false;
  std::uint64_t seed = 1;
};

/// The greatest number of objects asked for that is not above `most`, or the least there is.
[[nodiscard]] std::size_t objects_up_to(const ReportOptions& options, std::size_t most) noexcept;

/// A piece of the work: it adds rows to the results. One that throws is noted as a problem, and the
/// report goes on.
struct ReportStep {
  std::string what;      ///< for the progress: "mixed, 10,000 objects"
  double seconds = 1.0;  ///< about how long it takes, for the time left
  std::function<void(Results&)> run;
};

/// A part of the report. What it shows depends on the results alone, and it can show any part of
/// them: the rows of a run that was interrupted, or none.
struct ReportSection {
  std::string_view id;
  std::string_view title;
  void (*declare)(Results&);
  std::vector<ReportStep> (*plan)(const ReportOptions&);
  void (*show)(const Results&, ReportPage&);
};

/// All of them, in the order of the page.
[[nodiscard]] std::span<const ReportSection> report_sections() noexcept;

/// What the section about the pipeline shows of granular flows: also the page of a single one.
void show_flows(const Results& results, ReportPage& page);

// One file each.
extern const ReportSection kThroughputSection;
extern const ReportSection kMemorySection;
extern const ReportSection kVolumesSection;
extern const ReportSection kNarrowSection;
extern const ReportSection kStabilitySection;
extern const ReportSection kQueriesSection;
extern const ReportSection kPipelineSection;
extern const ReportSection kAdviceSection;

}  // namespace winnow::bench
