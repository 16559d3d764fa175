#include "report/section.h"

#include <array>

namespace winnow::bench {

std::span<const ReportSection> report_sections() noexcept {
  static const std::array<ReportSection, 8> all{
      kThroughputSection, kMemorySection,  kVolumesSection,  kNarrowSection,
      kStabilitySection,  kQueriesSection, kPipelineSection, kAdviceSection};
  return all;
}

}  // namespace winnow::bench
