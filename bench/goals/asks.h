#pragma once

#include "bench/common/json.h"

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// What is asked of winnow, by topic.
inline constexpr std::array<std::string_view, 10> kTopics{"engine", "scenes", "peers",  "queries",
                                                          "narrow", "motion", "meshes", "pipeline",
                                                          "choice", "report"};

/// The text of goals/goals.json.
extern const char* const kGoalsJson;

/// The asks of a text
///
///   {"lists": {"name": [{...}, ...]}, "asks": [{...}, ...]}
///
/// one by one. An entry with "each": [SOURCE, ...] stands for one entry for each combination of its
/// sources' objects; a source is the name of a list, or a list. "only": {"member": [values]} keeps
/// some of them. "{member}" in its texts becomes that member of the objects; a text that is nothing
/// else takes its value. What an entry says is described in goals/evaluate.h. Throws
/// std::runtime_error if the text is not what it should be.
[[nodiscard]] std::vector<Json> parse_asks(std::string_view text);

}  // namespace winnow::bench
