#pragma once

#include "bench/common/json.h"
#include "bench/common/sample.h"

#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// How a value is shown: to three digits (`tiny`: to two, with an exponent), as a whole number, as
/// a share of a hundred, or as it stands.
enum class Format { number, tiny, count, percent, text };

/// Which way is better, when two runs are compared.
enum class Better { neither, less, more };

/// A value that each row of a table may have: a number, the spread of several measurements, or a
/// text.
struct ValueColumn {
  std::string name;   ///< of the member
  std::string label;  ///< as it is headed, without the unit
  std::string unit;   ///< "ms", "ns/pair", "bytes/object"; empty: none
  Better better = Better::neither;
  Format format = Format::number;
};

/// Rows of one kind, each named by its keys.
struct TableSpec {
  std::string name;     ///< unique, in small letters
  std::string section;  ///< where it is shown
  std::string title;    ///< what a row tells
  std::vector<std::string> keys;
  std::vector<ValueColumn> values;
};

/// Everything that a report has measured. It is one JSON document, from which alone the page, the
/// CSVs, comparisons and the tables of the readme are made:
///
///   { "format", "complete", "machine": {...}, "settings": {...}, "missing": [...],
///     "warnings": [...], "problems": [...], "sections": [{"id", "title", "steps", "done",
///     "seconds"}], "tables": [{"name", "section", "title", "keys": [...],
///                 "values": [{"name", "label", "unit", "better", "format"}],
///                 "rows": [{"id", keys..., values..., "command", "from"}]}] }
///
/// A row's id is the table's name and its keys, joined by "/". A value is a number, a text, or
/// {"min", "median", "max", "samples"}; one that could not be measured is absent. `command`
/// measures the row again. A row that was computed from others says so in `from`, see `derived`.
class Results {
 public:
  /// Empty but for the instruction sets of the machine.
  Results();
  /// Throws ArgumentError if it is no such document.
  explicit Results(Json document);

  /// Does nothing if the table is there.
  void declare(const TableSpec& spec);

  /// Adds a row of keys and values, or replaces that of the same keys; its id. Values that are not
  /// finite are left out. Throws std::logic_error if the table does not have such members.
  std::string add(const std::string& table, Json row);

  /// Rows of a table that have these members; none if there is no such table. They stay valid until
  /// the next `add` or `declare`.
  [[nodiscard]] std::vector<const Json*> rows(const std::string& table,
                                              const Json& where = Json::object()) const;
  /// The first of them, or null.
  [[nodiscard]] const Json* row(const std::string& table, const Json& where) const;
  /// Null if there is none.
  [[nodiscard]] const Json* table(const std::string& name) const;
  /// The column's facts as in the document, null if there is none.
  [[nodiscard]] const Json* column(const std::string& table, const std::string& value) const;

  [[nodiscard]] Json& document() noexcept { return document_; }
  [[nodiscard]] const Json& document() const noexcept { return document_; }

 private:
  [[nodiscard]] Json* find_table(const std::string& name);

  Json document_;
};

/// Throws ArgumentError if the file cannot be read or is no such document.
[[nodiscard]] Results read_results(const std::string& path);

/// A spread as a value of a row.
[[nodiscard]] Json to_value(const std::vector<double>& samples);

/// Number or median of a row's value; NaN if there is none.
[[nodiscard]] double value_of(const Json& row, const std::string& name);

/// `from` of a row whose value `name` comes from value `field` of others: "ratio" divides the first
/// by the second; "exponent" fits value = a * key^b to all, by least squares of logarithms, where
/// key is "objects" and b is the value; "sum" adds them; "share" divides the first by the sum of
/// all.
[[nodiscard]] Json derived(const std::string& name, const std::string& rule,
                           const std::string& field, const std::vector<std::string>& rows);

/// Of a column: its label and unit.
[[nodiscard]] std::string heading_of(const Json& column);

/// The value as tables and notes show it; "-" if there is none.
[[nodiscard]] std::string shown(const Json& row, const Json& column);
[[nodiscard]] std::string shown(double value, const std::string& format);
/// The spread of a value in brackets, if it has one.
[[nodiscard]] std::string spread_text(const Json& row, const std::string& name,
                                      const std::string& format);

/// The texts of a key of these rows, each once, in their order.
[[nodiscard]] std::vector<Json> distinct(const std::vector<const Json*>& rows,
                                         const std::string& key);

/// The table's name and the row's keys joined by "/".
[[nodiscard]] std::string row_id(const Json& table, const Json& row);

/// A key as a text, numbers as short as they are.
[[nodiscard]] std::string key_text(const Json& key);

}  // namespace winnow::bench
