#pragma once

#include "recordings/recording.h"
#include "report/page.h"
#include "report/results.h"

#include <winnow/simd/isa.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// A built-in scene, or a recording.
struct ReportScene {
  std::string name;
  std::string argument;  ///< how a command names it: the scene, or the file
  std::shared_ptr<const Recording> recording{};
};

/// What a report is about.
struct ReportOptions {
  std::vector<ReportScene> scenes;
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

// One file each, in sections/.
extern const ReportSection kThroughputSection;
extern const ReportSection kMemorySection;
extern const ReportSection kVolumesSection;
extern const ReportSection kNarrowSection;
extern const ReportSection kStabilitySection;
extern const ReportSection kQueriesSection;
extern const ReportSection kPipelineSection;
extern const ReportSection kAdviceSection;

}  // namespace winnow::bench
