#pragma once

#include "bench/common/json.h"

#include <string>

namespace winnow::bench {

/// Returns why a JSON document is not a report (see Results), in a few words; empty if it is one.
/// In that case all members that every report has are present and of the right type.
[[nodiscard]] std::string fault_of_report(const Json& document);

inline constexpr const char* kReportFormat = "winnow report 1";

}  // namespace winnow::bench
