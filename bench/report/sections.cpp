#include "bench/report/section.h"

#include <array>

namespace winnow::bench {

std::size_t objects_up_to(const ReportOptions& options, std::size_t most) noexcept {
  std::size_t chosen = options.objects.front();
  for (const std::size_t objects : options.objects) {
    if (objects <= most) chosen = objects;
  }
  return chosen;
}

std::span<const ReportSection> report_sections() noexcept {
  static const std::array<ReportSection, 8> all{
      kThroughputSection, kMemorySection,  kVolumesSection,  kNarrowSection,
      kStabilitySection,  kQueriesSection, kPipelineSection, kAdviceSection};
  return all;
}

}  // namespace winnow::bench
