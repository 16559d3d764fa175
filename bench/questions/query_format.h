#pragma once

#include "bench/common/json.h"

#include <optional>
#include <string>
#include <vector>

namespace winnow::bench {

/// The first member of a query that prevents an answer.
struct QueryFault {
  std::string member;  ///< path from the query, for example "a.pose.position[2]"; empty: the query
  std::string expected;  ///< for example "a finite number >= 0"
  std::string given;     ///< the value as JSON, shortened, or "nothing"
};

/// Returns the first member that is missing, has the wrong type or is outside its range. Returns
/// nothing if there is none: the input may still be refused, for example if a result overflows.
[[nodiscard]] std::optional<QueryFault> fault_of(const Json& query);

/// A part of a query; for `pair` and `motion`, the query without its shapes.
enum class QueryPart { convex_shape, any_shape, ray, pair, motion };

/// Returns whether a part has all members, each of the right type. Numbers may be out of range.
[[nodiscard]] bool is_readable(const Json& value, QueryPart part);

/// The text of example.json, a file of queries that has each member at least once.
extern const char* const kQueryExample;

/// Returns the names of all members and types of shapes.
[[nodiscard]] std::vector<std::string> query_words();

/// Returns a description of the format: the example, and each member with its unit.
[[nodiscard]] std::string query_format();

}  // namespace winnow::bench
