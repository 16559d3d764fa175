#pragma once

#include "bench/common/json.h"

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// The topics of goals, in the order of their listing.
inline constexpr std::array<std::string_view, 10> kTopics{"engine", "scenes", "peers",  "queries",
                                                          "narrow", "motion", "meshes", "pipeline",
                                                          "choice", "report"};

/// The text of goals/goals.json.
extern const char* const kGoalsJson;

/// Parses a text of this form into single entries:
///
///   {"lists": {"name": [{...}, ...]}, "goals": [{...}, ...]}
///
/// An entry with "each": [SOURCE, ...] is expanded to one entry for each combination of its
/// sources' objects; a source is a list, or the name of one in "lists". "only": {"member":
/// [values]} keeps the combinations whose member has one of the values. "{member}" in the entry's
/// texts is replaced by that member of the combined object; a text that consists of "{member}" only
/// takes its value, of any type. goals/evaluate.h describes the other members of an entry. Throws
/// std::runtime_error if the text is malformed.
[[nodiscard]] std::vector<Json> parse_goals(std::string_view text);

}  // namespace winnow::bench
