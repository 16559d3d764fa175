#pragma once

#include "bench/common/json.h"

#include <string>

namespace winnow::bench {

/// What keeps a JSON document from being a report (see Results), in a few words; empty if nothing
/// does. After that whoever reads it may rely on all members that every report has, and on their
/// types.
[[nodiscard]] std::string fault_of_report(const Json& document);

inline constexpr const char* kReportFormat = "winnow report 1";

}  // namespace winnow::bench
