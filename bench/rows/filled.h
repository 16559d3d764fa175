#pragma once

#include "bench/common/json.h"

#include <string>

namespace winnow::bench {

/// A key of a row as texts show it: counts in groups of three digits, "threads" as "2 threads".
[[nodiscard]] std::string member_text(const std::string& name, const Json& value);

/// A text with "{member}" replaced by its text where the object has it.
[[nodiscard]] std::string filled(const std::string& text, const Json& object);

/// All texts of an entry filled; one that is "{member}" and nothing else takes its value.
[[nodiscard]] Json filled_in(const Json& entry, const Json& object);

}  // namespace winnow::bench
