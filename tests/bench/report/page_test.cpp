// Tests of the reports that make_reports has written: the page, the document and the CSVs have
// equal values, and a report that was ended half-way contains all rows measured until then.

#include "bench/report/trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

namespace {

using Json = nlohmann::ordered_json;
using winnow::bench::Trace;

const std::filesystem::path kReports = WINNOW_REPORTS;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

Json document_of(const std::string& report) {
  return Json::parse(text_of(kReports / report / "results.json"));
}

std::size_t rows_in(const Json& document) {
  std::size_t rows = 0;
  for (const Json& table : document["tables"]) rows += table["rows"].size();
  return rows;
}

/// Without Chart.js `winnow report` writes no page.
bool has_page(const std::string& report) {
  return std::filesystem::exists(kReports / report / "index.html");
}

class Reports : public testing::TestWithParam<const char*> {};

TEST_P(Reports, numbers_on_the_page_match_their_rows) {
  if (!has_page(GetParam())) GTEST_SKIP() << "no page without Chart.js";
  const std::string page = text_of(kReports / GetParam() / "index.html");
  const Trace trace = winnow::bench::trace_page(page, document_of(GetParam()));
  EXPECT_GT(trace.cells, 0U);
  EXPECT_GT(trace.points, 0U);
  for (std::size_t i = 0; i < std::min<std::size_t>(trace.wrong.size(), 10); ++i) {
    ADD_FAILURE() << trace.wrong[i];
  }
}

TEST_P(Reports, page_loads_nothing_from_the_network) {
  if (!has_page(GetParam())) GTEST_SKIP() << "no page without Chart.js";
  const std::string page = text_of(kReports / GetParam() / "index.html");
  for (const char* from : {"src=\"", "<link", "@import", "url(http", "fetch(\""}) {
    EXPECT_EQ(page.find(from), std::string::npos) << from;
  }
}

TEST_P(Reports, csvs_have_all_rows) {
  std::size_t rows = 0;
  const Json document = document_of(GetParam());
  for (const Json& table : document["tables"]) {
    if (table["rows"].empty()) continue;
    const std::string csv =
        text_of(kReports / GetParam() / (table["name"].get<std::string>() + ".csv"));
    rows += static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')) - 1;
  }
  EXPECT_EQ(rows, rows_in(document));
}

INSTANTIATE_TEST_SUITE_P(, Reports, testing::Values("whole", "killed", "interrupted"),
                         [](const auto& test) { return std::string(test.param); });

TEST(AReport, whole_report_has_all_steps_done) {
  const Json document = document_of("whole");
  EXPECT_TRUE(document["complete"].get<bool>());
  EXPECT_EQ(document["problems"], Json::array());
  for (const Json& section : document["sections"]) EXPECT_EQ(section["done"], section["steps"]);
}

/// Returns the HTML of each section of a page by its id.
std::map<std::string, std::string> sections_of(const std::string& page) {
  std::map<std::string, std::string> sections;
  for (std::size_t at = 0; at != std::string::npos;) {
    const auto html = winnow::bench::between(page, "<section id=\"", "</section>", at);
    if (at == std::string::npos) break;
    const std::size_t quote = html.find('"');
    sections[std::string(html.substr(0, quote))] = html.substr(quote);
  }
  return sections;
}

TEST(AReport, each_section_has_plot_table_and_command) {
  if (!has_page("whole")) GTEST_SKIP() << "no page without Chart.js";
  const auto sections = sections_of(text_of(kReports / "whole" / "index.html"));
  for (const Json& section : document_of("whole")["sections"]) {
    if (section["steps"] == 0) continue;
    const auto id = section["id"].get<std::string>();
    ASSERT_TRUE(sections.contains(id)) << id;
    for (const char* part : {"<canvas", "data-row=", "<pre>bench/run "}) {
      EXPECT_NE(sections.at(id).find(part), std::string::npos) << id << " has no " << part;
    }
  }
}

TEST(AReport, missing_libraries_are_named) {
  const Json document = document_of("whole");
  ASSERT_FALSE(document["missing"].empty());
  const auto what = document["missing"][0].get<std::string>();
  EXPECT_NE(what.find("ther libraries"), std::string::npos);
  if (!has_page("whole")) GTEST_SKIP() << "no page without Chart.js";
  EXPECT_NE(text_of(kReports / "whole" / "index.html").find(what), std::string::npos);
}

TEST(AReport, each_measured_row_has_a_command) {
  for (const Json& table : document_of("whole")["tables"]) {
    for (const Json& row : table["rows"]) {
      if (row.contains("from")) continue;
      EXPECT_TRUE(row.value("command", "").starts_with("bench/run ")) << row["id"];
    }
  }
}

/// Splits a CSV into its fields (RFC 4180).
std::vector<std::vector<std::string>> fields_of(const std::string& csv) {
  std::vector<std::vector<std::string>> lines{{""}};
  bool quoted = false;
  for (std::size_t i = 0; i < csv.size(); ++i) {
    const char sign = csv[i];
    if (sign == '"') {
      if (quoted && i + 1 < csv.size() && csv[i + 1] == '"')
        lines.back().back() += csv[++i];
      else
        quoted = !quoted;
    } else if (sign == ',' && !quoted) {
      lines.back().emplace_back();
    } else if (sign == '\n' && !quoted) {
      lines.push_back({""});
    } else {
      lines.back().back() += sign;
    }
  }
  lines.pop_back();
  return lines;
}

/// Returns the value of a CSV column in a row of the document, or null.
Json value_at(const Json& row, const std::string& head) {
  if (row.contains(head)) return row[head].is_object() ? Json() : row[head];
  for (const std::string part : {"min", "median", "max"}) {
    if (!head.ends_with("_" + part)) continue;
    const std::string name = head.substr(0, head.size() - part.size() - 1);
    if (row.contains(name) && row[name].is_object()) return row[name][part];
  }
  return nullptr;
}

TEST(AReport, csvs_have_the_values_of_the_document) {
  std::size_t values = 0;
  const Json document = document_of("whole");
  for (const Json& table : document["tables"]) {
    if (table["rows"].empty()) continue;
    const auto name = table["name"].get<std::string>();
    const auto lines = fields_of(text_of(kReports / "whole" / (name + ".csv")));
    ASSERT_EQ(lines.size(), table["rows"].size() + 1) << name;
    for (std::size_t r = 0; r < table["rows"].size(); ++r) {
      ASSERT_EQ(lines[r + 1].size(), lines[0].size()) << name;
      for (std::size_t c = 0; c < lines[0].size(); ++c) {
        const Json value = value_at(table["rows"][r], lines[0][c]);
        const std::string& text = lines[r + 1][c];
        ++values;
        if (value.is_null())
          EXPECT_EQ(text, "") << name << " " << lines[0][c];
        else if (value.is_string())
          EXPECT_EQ(text, value.get<std::string>());
        else
          EXPECT_EQ(std::strtod(text.c_str(), nullptr), value.get<double>()) << name;
      }
    }
  }
  EXPECT_GT(values, 100U);
}

class HalfReports : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(HalfReports, report_ended_half_way_keeps_its_rows) {
  const auto& [report, status] = GetParam();
  EXPECT_EQ(text_of(kReports / (std::string(report) + ".status")), status);
  const Json document = document_of(report);
  EXPECT_FALSE(document["complete"].get<bool>());
  EXPECT_GT(rows_in(document), 0U);
  EXPECT_LT(rows_in(document), rows_in(document_of("whole")));
}

TEST_P(HalfReports, page_of_half_a_report_shows_its_progress) {
  const std::string report = GetParam().first;
  if (!has_page(report)) GTEST_SKIP() << "no page without Chart.js";
  EXPECT_NE(text_of(kReports / report / "index.html").find("This report is not complete: "),
            std::string::npos);
}

TEST_P(HalfReports, page_made_again_is_identical) {
  const std::string report = GetParam().first;
  if (!has_page(report)) GTEST_SKIP() << "no page without Chart.js";
  EXPECT_TRUE(text_of(kReports / report / "index.html") ==
              text_of(kReports / "again" / report / "index.html"));
}

INSTANTIATE_TEST_SUITE_P(, HalfReports,
                         testing::Values(std::pair("killed", "137\n"),
                                         std::pair("interrupted", "130\n")),
                         [](const auto& test) { return std::string(test.param.first); });

/// Traces a page with one table and one plot and returns its faults.
std::vector<std::string> wrong_with(const std::string& cells, const std::string& point) {
  const Json document = Json::parse(R"({"tables": [{"name": "t", "keys": ["n"],
    "values": [{"name": "ms", "format": "number"}, {"name": "share", "format": "percent"}],
    "rows": [{"id": "t/1", "n": 1, "ms": {"min": 1.0, "median": 2.345, "max": 4.0, "samples": 5}},
             {"id": "t/2", "n": 2, "ms": 4.69, "share": 0.3333333333333333,
              "from": {"value": "share", "rule": "share", "field": "ms",
                       "rows": ["t/1", "t/2"]}}]}]})");
  const std::string page =
      "<table><tr>" + cells + "</tr></table><script type=\"application/json\" id=\"plots\">" +
      R"({"plots": [{"id": "p", "categories": [], "series": [{"x_value": "n", "y_value": "ms",
          "points": [)" +
      point + "]}]}]}</script>";
  return winnow::bench::trace_page(page, document).wrong;
}

TEST(ATrace, trace_of_a_correct_page_has_no_faults) {
  EXPECT_EQ(wrong_with("<td>1</td><td data-row=\"t/1\" data-value=\"ms\">2.35 (1.00 to 4.00)</td>",
                       R"({"x": 1, "y": 2.345, "row": "t/1", "low": 1.0, "high": 4.0})"),
            std::vector<std::string>());
  EXPECT_EQ(wrong_with("<td data-row=\"t/2\" data-value=\"share\">33.3 %</td>",
                       R"({"x": 2, "y": 4.69, "row": "t/2"})"),
            std::vector<std::string>());
}

TEST(ATrace, trace_finds_each_wrong_figure) {
  const std::string good = R"({"x": 1, "y": 2.345, "row": "t/1"})";
  for (const char* cells :
       {"<td data-row=\"t/1\" data-value=\"ms\">2.37</td>",
        "<td data-row=\"t/1\" data-value=\"ms\">2.35 (1.00 to 4.10)</td>",
        "<td data-row=\"t/3\" data-value=\"ms\">2.35</td>",
        "<td data-row=\"t/1\" data-value=\"share\">33.3 %</td>",
        "<td data-row=\"t/2\" data-value=\"share\">0.333</td>", "<td>17</td>"}) {
    EXPECT_EQ(wrong_with(cells, good).size(), 1U) << cells;
  }
  for (const char* point : {R"({"x": 2, "y": 2.345, "row": "t/1"})",
                            R"({"x": 1, "y": 2.3, "row": "t/1"})", R"({"x": 1, "y": 2.345})",
                            R"({"x": 1, "y": 2.345, "row": "t/1", "low": 1.5, "high": 4.0})"}) {
    EXPECT_EQ(wrong_with("", point).size(), 1U) << point;
  }
}

}  // namespace
