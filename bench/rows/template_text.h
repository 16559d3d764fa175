#pragma once

#include "bench/common/json.h"

#include <string>

namespace winnow::bench {

/// Formats a key of a row: counts in groups of three digits, "threads" as "2 threads".
[[nodiscard]] std::string member_text(const std::string& name, const Json& value);

/// Replaces each "{member}" in a text by the formatted member, if the object has it.
[[nodiscard]] std::string filled(const std::string& text, const Json& object);

/// Replaces "{member}" in all texts of an entry. A text that is only "{member}" becomes its value.
[[nodiscard]] Json filled_in(const Json& entry, const Json& object);

}  // namespace winnow::bench
