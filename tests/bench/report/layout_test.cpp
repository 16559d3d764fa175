// What a layout makes of rows, and that the report's own names only what there is.

#include "bench/report/layout.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace winnow::bench;

/// Two engines on two scenes; Tree has no row on "wall".
Results some_results() {
  Results results;
  results.declare({"speed",
                   "s",
                   "t",
                   {"scene", "objects", "engine", "threads"},
                   {{"ms", "frame", "ms", Better::less}, {"note", "note", "", {}, Format::text}}});
  results.declare({"size", "s", "t", {"engine"}, {{"bytes", "memory", "bytes", Better::less}}});
  const auto add = [&](const char* scene, const char* engine, double ms) {
    results.add("speed", {{"scene", scene},
                          {"objects", 2000U},
                          {"engine", engine},
                          {"threads", 1},
                          {"ms", to_value({ms, ms, 2.0 * ms})},
                          {"note", "as measured"},
                          {"command", "bench/run speed"}});
  };
  add("pile", "Grid", 2.0);
  add("pile", "Tree", 1.0);
  add("wall", "Grid", 3.0);
  results.add("size", {{"engine", "Grid"}, {"bytes", 12.5}});
  return results;
}

std::vector<Part> shown_of(const std::string& block) {
  return parts_of(some_results(), Json::parse(block), "p");
}

/// Rows of a table, cells joined by "|", the best with a star.
std::string text_of(const CellTable& table) {
  std::string text = table.caption + ":";
  for (const std::string& head : table.header) text += " " + head;
  for (const auto& row : table.rows) {
    text += "\n";
    for (const Cell& cell : row)
      text += (&cell == &row.front() ? "" : "|") + cell.text + (cell.best ? "*" : "");
  }
  return text;
}

TEST(ALayout, shows_one_value_by_two_keys_and_marks_the_best_of_each_column) {
  const auto parts = shown_of(R"({"pivot": "speed engine scene ms"})");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(text_of(parts[0].table), "frame, ms: engine pile wall\nGrid|2.00|3.00\nTree|1.00*|-");
  EXPECT_EQ(parts[0].table.rows[0][1].row, "speed/pile/2000/Grid/1");
}

TEST(ALayout, repeats_a_block_for_each_key_and_fills_it_in) {
  const auto parts = shown_of(R"({"each": {"scene": "speed", "objects": "speed max"},
      "rows": "speed", "columns": ["engine", "threads", "ms"], "caption": "{scene}, {objects}"})");
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(text_of(parts[0].table),
            "pile, 2,000: engine threads frame, ms\nGrid|1|2.00\nTree|1|1.00");
  EXPECT_EQ(text_of(parts[1].table), "wall, 2,000: engine threads frame, ms\nGrid|1|3.00");
}

TEST(ALayout, joins_rows_of_other_tables_and_makes_one_row_of_several) {
  const auto parts = shown_of(R"({"rows": "speed", "once": ["scene"], "columns": ["scene",
      {"all": "engine", "label": "by"}, {"of": "size", "value": "bytes"}]})");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(text_of(parts[0].table),
            ": scene by memory, bytes\npile|Grid, Tree|12.5\nwall|Grid|12.5");
}

TEST(ALayout, draws_a_series_for_each_engine_with_its_spread) {
  const auto parts = shown_of(R"({"where": {"scene": "pile"}, "plot": "speed engine objects ms",
      "front": true})");
  ASSERT_EQ(parts.size(), 1U);
  const Plot& plot = parts[0].plot;
  ASSERT_EQ(plot.series.size(), 3U);
  EXPECT_EQ(plot.series[1].name, "Tree");
  EXPECT_EQ(plot.series[1].points[0].x, 2000.0);
  EXPECT_EQ(plot.series[1].points[0].high, 2.0);
  ASSERT_EQ(plot.series[2].points.size(), 1U);  // the front
  EXPECT_EQ(plot.series[2].points[0].row, "speed/pile/2000/Tree/1");
}

TEST(ALayout, leaves_out_headings_of_what_shows_nothing) {
  EXPECT_TRUE(shown_of(R"({"heading": "h", "text": "t", "pivot": "none a b c"})").empty());
  EXPECT_TRUE(shown_of(R"({"heading": "h", "show": [{"text": "t"}, {"rows": "none"}]})").empty());
  const auto parts = shown_of(R"({"heading": "h", "rows": "size", "command": "speed",
      "to": "results"})");
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].targets, kInResults);
  EXPECT_EQ(parts[2].text, "bench/run speed");
}

/// Names that a block of the report's layout asks rows for, and that they do not have.
class Unknown {
 public:
  explicit Unknown(const Json& document) : document_(document) {}

  std::vector<std::string> in(const Json& block) {
    for (const Json& child : block.value("show", Json::array())) in(child);
    for (const Json& line : block.value("least", Json::array())) check_words(line["of"]);
    if (block.contains("rows")) check_columns(block["rows"], block.value("columns", Json::array()));
    if (block.contains("command")) check(block["command"], "id");
    const Json each = block.value("each", Json::array());
    for (const auto& [key, source] : each.items()) {
      if (source.is_string()) check(table_in(source), key);
    }
    for (const char* words : {"pivot", "plot", "bars"}) {
      if (!block.contains(words)) continue;
      const std::string text = block[words];
      const std::size_t value = text.find("{value}");
      if (value == text.npos) check_words(text);
      const Json values = each.is_object() ? each.value("value", Json::array()) : each;
      for (const Json& one : value == text.npos ? Json::array() : values) {
        const std::string name = one.is_object() ? one["value"] : one;
        check_words(text.substr(0, value) + name);
      }
    }
    return found_;
  }

 private:
  const Json& document_;
  std::vector<std::string> found_;

  void check(const std::string& name, const std::string& member) {
    for (const Json& table : document_["tables"]) {
      if (table["name"] != name) continue;
      bool known = member == "id" || member == "-";
      for (const Json& key : table["keys"]) known = known || key == member;
      for (const Json& value : table["values"]) known = known || value["name"] == member;
      if (!known) found_.push_back(name + " " + member);
      return;
    }
    found_.push_back(name);
  }
  static std::string table_in(const std::string& text) { return text.substr(0, text.find(' ')); }
  void check_words(const std::string& text) {
    std::istringstream words(text);
    std::string table;
    words >> table;
    for (std::string word; words >> word;) check(table, word);
  }
  void check_columns(const std::string& table, const Json& columns) {
    for (const Json& column : columns) {
      if (column.is_string()) check(table, column);
      if (column.contains("all")) check(table, column["all"]);
      if (column.contains("of")) check(column["of"], column["value"]);
    }
  }
};

TEST(ALayout, of_the_report_names_only_what_its_tables_have) {
  const Results whole =
      read_results((std::filesystem::path(WINNOW_REPORTS) / "whole/results.json").string());
  Unknown unknown(whole.document());
  for (const Json& section : layout()["sections"]) unknown.in(section);
  EXPECT_EQ(unknown.in(layout()["readme"]), std::vector<std::string>());
}

}  // namespace
