// Tables and plots that a layout makes of rows. The report's own layout names only existing
// columns.

#include "bench/report/layout.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace winnow::bench;

/// Rows of two engines on two scenes; Tree has no row on "wall".
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

/// Returns the rows of a table: cells are joined by "|", the best cell has a star.
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

TEST(ALayout, pivot_marks_the_best_of_each_column) {
  const auto parts = shown_of(R"({"pivot": "speed engine scene ms"})");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(text_of(parts[0].table), "frame, ms: engine pile wall\nGrid|2.00|3.00\nTree|1.00*|-");
  EXPECT_EQ(parts[0].table.rows[0][1].row, "speed/pile/2000/Grid/1");
}

TEST(ALayout, each_repeats_a_block_for_every_key) {
  const auto parts = shown_of(R"({"each": {"scene": "speed", "objects": "speed max"},
      "rows": "speed", "columns": ["engine", "threads", "ms"], "caption": "{scene}, {objects}"})");
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(text_of(parts[0].table),
            "pile, 2,000: engine threads frame, ms\nGrid|1|2.00\nTree|1|1.00");
  EXPECT_EQ(text_of(parts[1].table), "wall, 2,000: engine threads frame, ms\nGrid|1|3.00");
}

TEST(ALayout, columns_join_other_tables_and_several_rows) {
  const auto parts = shown_of(R"({"rows": "speed", "once": ["scene"], "columns": ["scene",
      {"all": "engine", "label": "by"}, {"of": "size", "value": "bytes"}]})");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(text_of(parts[0].table),
            ": scene by memory, bytes\npile|Grid, Tree|12.5\nwall|Grid|12.5");
}

TEST(ALayout, plot_has_one_series_for_each_engine) {
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

TEST(ALayout, heading_of_an_empty_block_is_left_out) {
  EXPECT_TRUE(shown_of(R"({"heading": "h", "text": "t", "pivot": "none a b c"})").empty());
  EXPECT_TRUE(shown_of(R"({"heading": "h", "show": [{"text": "t"}, {"rows": "none"}]})").empty());
  const auto parts = shown_of(R"({"heading": "h", "rows": "size", "command": "speed",
      "to": "results"})");
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].targets, kInResults);
  EXPECT_EQ(parts[2].text, "bench/run speed");
}

/// Collects the names that a block of the report's layout uses and the rows do not have.
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

TEST(ALayout, report_layout_names_only_existing_columns) {
  const Results whole =
      read_results((std::filesystem::path(WINNOW_REPORTS) / "whole/results.json").string());
  Unknown unknown(whole.document());
  for (const Json& section : layout()["sections"]) unknown.in(section);
  EXPECT_EQ(unknown.in(layout()["readme"]), std::vector<std::string>());
}

}  // namespace
