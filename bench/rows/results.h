#pragma once

#include "bench/common/json.h"

#include <deque>
#include <iosfwd>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Rows that were measured, by family ("throughput", "cold"). A row is an object of keys, which
/// families.json lists for each family, and values: numbers, texts, or spreads (see `to_value`).
///
/// `document` returns them in the form of Google Benchmark:
///
///   { "context": {"date", "machine", "isa", ...},
///     "benchmarks": [{"name", "run_type", "iterations", "real_time", "cpu_time", "time_unit",
///                     values...}] }
///
/// A name is the family and the keys, joined by "/": a text is a word, a number is "key:value", for
/// example throughput/uniform/objects:10000/threads:1/linear_bvh/isa:avx2. The family's time is
/// `real_time`, 0 if it has none; `iterations` counts its samples. The ends of a spread are
/// `real_time_min` and `real_time_max`, or `x_min` and `x_max` of a value `x`. The value `command`
/// measures the row again.
class Results {
 public:
  /// Adds a row, or replaces the row with the same name, and returns its name. Values that are not
  /// finite are left out. Throws std::logic_error if the family is unknown.
  std::string add(const std::string& family, Json row);
  /// Adds rows that another process returned as "benchmarks".
  void adopt(const Json& benchmarks);

  /// Returns the rows of a family that have these members. The pointers stay valid.
  [[nodiscard]] std::vector<const Json*> rows(const std::string& family,
                                              const Json& where = Json::object()) const;
  /// Returns the first such row, or null.
  [[nodiscard]] const Json* row(const std::string& family, const Json& where) const;

  [[nodiscard]] Json& context() noexcept { return context_; }
  [[nodiscard]] Json document() const;

 private:
  Json context_ = Json::object();
  std::vector<std::string> order_;  ///< families in the order of their first rows
  std::map<std::string, std::deque<Json>> families_;
  Json adopted_ = Json::array();
};

/// Formats a document with one row per line, so that versions can be compared with diff.
[[nodiscard]] std::string document_text(const Json& document);

/// Prints the rows of a family: the keys that all rows share in one line, then a column for each
/// other key and for each of these values (none: all) that any row has. Spreads are shown as median
/// (least to greatest). Prints nothing if there are no rows.
void print_rows(std::ostream& out, const Results& results, const std::string& family,
                const std::vector<std::string>& values = {});

/// Returns the keys of a family in the order of its names. Throws std::logic_error if it is
/// unknown.
[[nodiscard]] std::vector<std::string> keys_of(const std::string& family);

/// Returns a text as a word of a name: "LinearBvh" is linear_bvh, "FCL tree" is fcl_tree.
[[nodiscard]] std::string word_of(std::string_view text);

/// Converts samples to the value of a row: {"min", "median", "max", "samples"}.
[[nodiscard]] Json to_value(std::span<const double> samples);

/// Returns a row's value, the median of a spread; NaN if there is none.
[[nodiscard]] double value_of(const Json& row, const std::string& name);

/// Returns the distinct values of a key of these rows, in their order.
[[nodiscard]] std::vector<Json> distinct(const std::vector<const Json*>& rows,
                                         const std::string& key);

/// Formats a key; numbers are as short as possible.
[[nodiscard]] std::string key_text(const Json& key);

}  // namespace winnow::bench
