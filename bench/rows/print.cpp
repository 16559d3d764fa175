#include "bench/rows/print.h"

#include "bench/common/table.h"

#include <algorithm>
#include <ostream>

namespace winnow::bench {
namespace {

std::string key_shown(const Json& key) {
  return key.is_number_unsigned() ? grouped(key.get<std::size_t>()) : key_text(key);
}

std::string value_shown(const Json& row, const Json& column) {
  return shown(row, column) + spread_text(row, column["name"], column["format"]);
}

std::vector<const Json*> columns_to_print(const Json& table, const std::vector<std::string>& values,
                                          const std::vector<const Json*>& rows) {
  std::vector<const Json*> columns;
  for (const Json& column : table["values"]) {
    const std::string name = column["name"];
    const bool is_selected =
        values.empty() || std::find(values.begin(), values.end(), name) != values.end();
    const bool known =
        std::any_of(rows.begin(), rows.end(), [&](const Json* row) { return row->contains(name); });
    if (is_selected && known) columns.push_back(&column);
  }
  return columns;
}

}  // namespace

void print_rows(std::ostream& out, const Results& results, const std::string& name,
                const std::vector<std::string>& values) {
  const Json* table = results.table(name);
  const auto rows = results.rows(name);
  if (table == nullptr || rows.empty()) return;
  std::string shared;
  std::vector<std::string> keys;
  std::vector<std::string> header;
  for (const std::string key : (*table)["keys"]) {
    if (rows.size() > 1 && distinct(rows, key).size() == 1) {
      shared += ", " + key + " " + key_shown((*rows.front())[key]);
      continue;
    }
    keys.push_back(key);
    header.push_back(key);
  }
  const auto columns = columns_to_print(*table, values, rows);
  for (const Json* column : columns) header.push_back(heading_of(*column));
  Table text(header);
  for (std::size_t k = 1; k < keys.size(); ++k) {
    if ((*rows.front())[keys[k]].is_string()) text.flush_left(k);
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if ((*columns[c])["format"] == "text") text.flush_left(keys.size() + c);
  }
  for (const Json* row : rows) {
    std::vector<std::string> cells;
    for (const std::string& key : keys) cells.push_back(key_shown((*row)[key]));
    for (const Json* column : columns) cells.push_back(value_shown(*row, *column));
    text.add(std::move(cells));
  }
  out << '\n' << (*table)["title"].get<std::string>() << shared << '\n' << text << std::flush;
}

Json all_rows_of(const Results& results) {
  Json rows = Json::array();
  for (const Json& table : results.document()["tables"]) {
    for (const Json& row : table["rows"]) rows.push_back(row);
  }
  return rows;
}

}  // namespace winnow::bench
