#pragma once

#include "bench/common/json.h"
#include "bench/common/sample.h"

#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Format of a value: three digits (`tiny`: two, with an exponent), a whole number, a percentage,
/// or the text itself.
enum class Format { number, tiny, count, percent, text };

/// Whether less or more of a value is better when two runs are compared.
enum class Better { neither, less, more };

/// A value that rows of a table may have: a number, the spread of several measurements, or a text.
struct ValueColumn {
  std::string name;   ///< the member's name
  std::string label;  ///< heading, without the unit
  std::string unit;   ///< "ms", "ns/pair", "bytes/object"; empty if there is none
  Better better = Better::neither;
  Format format = Format::number;
};

/// A table of rows of one kind, each identified by its keys.
struct TableSpec {
  std::string name;     ///< unique, in small letters
  std::string section;  ///< the section that shows it
  std::string title;    ///< what a row describes
  std::vector<std::string> keys;
  std::vector<ValueColumn> values;
};

/// Everything that a report has measured. It is one JSON document, the only source of the page, the
/// CSVs, comparisons and the tables of the readme:
///
///   { "format", "complete", "machine": {...}, "settings": {...}, "missing": [...],
///     "warnings": [...], "problems": [...], "sections": [{"id", "title", "steps", "done",
///     "seconds"}], "tables": [{"name", "section", "title", "keys": [...],
///                 "values": [{"name", "label", "unit", "better", "format"}],
///                 "rows": [{"id", keys..., values..., "command", "from"}]}] }
///
/// A row's id is the table's name and its keys, joined by "/". A value is a number, a text, or
/// {"min", "median", "max", "samples"}; a value that could not be measured is absent. `command`
/// measures the row again. A row that was computed from others lists them in `from`, see `derived`.
class Results {
 public:
  /// Creates a document with only the machine's instruction sets.
  Results();
  /// Takes a document. Throws ArgumentError if it is not a report.
  explicit Results(Json document);

  /// Adds a table; does nothing if it exists.
  void declare(const TableSpec& spec);

  /// Adds a row of keys and values, or replaces the row with the same keys, and returns its id.
  /// Values that are not finite are left out. Throws std::logic_error if the table does not have
  /// such members.
  std::string add(const std::string& table, Json row);

  /// Returns the rows of a table that have these members; none if there is no such table. The
  /// pointers stay valid until the next `add` or `declare`.
  [[nodiscard]] std::vector<const Json*> rows(const std::string& table,
                                              const Json& where = Json::object()) const;
  /// Returns the first such row, or null.
  [[nodiscard]] const Json* row(const std::string& table, const Json& where) const;
  /// Returns null if there is no such table.
  [[nodiscard]] const Json* table(const std::string& name) const;
  /// Returns the column's description in the document, or null.
  [[nodiscard]] const Json* column(const std::string& table, const std::string& value) const;

  [[nodiscard]] Json& document() noexcept { return document_; }
  [[nodiscard]] const Json& document() const noexcept { return document_; }

 private:
  [[nodiscard]] Json* find_table(const std::string& name);

  Json document_;
};

/// Reads a document. Throws ArgumentError if the file cannot be read or is not a report.
[[nodiscard]] Results read_results(const std::string& path);

/// Converts samples to the value of a row.
[[nodiscard]] Json to_value(const std::vector<double>& samples);

/// Returns a row's value, the median of a spread; NaN if there is none.
[[nodiscard]] double value_of(const Json& row, const std::string& name);

/// Returns the member `from` of a row: it states that the value `name` of the row was computed by
/// `rule` from the value `field` of the rows with the ids `rows`. Rules: "ratio" divides the first
/// value by the second; "exponent" fits value = a * objects^b to all by least squares of logarithms
/// and returns b; "sum" adds all; "share" divides the first by the sum of all.
[[nodiscard]] Json derived(const std::string& name, const std::string& rule,
                           const std::string& field, const std::vector<std::string>& rows);

/// Returns a column's label and unit.
[[nodiscard]] std::string heading_of(const Json& column);

/// Formats a value as tables and notes show it; "-" if there is none.
[[nodiscard]] std::string shown(const Json& row, const Json& column);
[[nodiscard]] std::string shown(double value, const std::string& format);
/// Formats the spread of a value in brackets; empty if it has none.
[[nodiscard]] std::string spread_text(const Json& row, const std::string& name,
                                      const std::string& format);

/// Returns the distinct values of a key of these rows, in their order.
[[nodiscard]] std::vector<Json> distinct(const std::vector<const Json*>& rows,
                                         const std::string& key);

/// Returns the table's name and the row's keys joined by "/".
[[nodiscard]] std::string row_id(const Json& table, const Json& row);

/// Formats a key; numbers are as short as possible.
[[nodiscard]] std::string key_text(const Json& key);

}  // namespace winnow::bench
