#include "bench/report/markdown.h"

#include "bench/common/errors.h"
#include "bench/common/table.h"
#include "bench/report/layout.h"

#include <iostream>

namespace winnow::bench {
namespace {

const std::string kFiguresBegin = "<!-- figures -->\n";
const std::string kFiguresEnd = "<!-- end -->";

std::string line_of(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& one : cells) line += one.empty() ? " |" : " " + one + " |";
  return line + "\n";
}

/// Formats a table. The best cell of each column is bold; a caption replaces the header of the
/// first column.
std::string markdown_of(const CellTable& table) {
  std::vector<std::string> header = table.header;
  if (!table.caption.empty()) header.front() = table.caption;
  std::string text = line_of(header) + "|";
  for (std::size_t i = 0; i < header.size(); ++i) text += "---|";
  text += "\n";
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    for (const Cell& one : row) cells.push_back(one.best ? "**" + one.text + "**" : one.text);
    text += line_of(cells);
  }
  return text + "\n";
}

std::string markdown_of(const std::vector<Part>& parts) {
  std::string text;
  for (const Part& part : parts) {
    if ((part.targets & kInResults) == 0) continue;
    if (part.kind == Part::Kind::heading) text += "### " + part.text + "\n\n";
    if (part.kind == Part::Kind::paragraph) text += part.text + "\n\n";
    if (part.kind == Part::Kind::table) text += markdown_of(part.table);
  }
  return text;
}

std::string run_text(const Results& results) {
  const Json& machine = results.document()["machine"];
  std::string text;
  for (const std::string fact : {"processor", "cores", "isa", "commit"}) {
    text += (text.empty() ? "" : ", ") + std::string(fact == "commit" ? "commit " : "") +
            key_text(machine.value(fact, Json("unknown"))) + (fact == "cores" ? " cores" : "");
  }
  return "One run of `bench/run --with-peers report` (" + text + ")";
}

}  // namespace

std::string results_markdown(const Results& results) {
  std::string text =
      "# Results\n\n" + run_text(results) +
      ". `bench/run dev results` generates this page from `bench/results/results.json`, which has "
      "a "
      "row for every figure. Other libraries are Debian packages, run at their best settings and "
      "with `-O3 -march=native`. The yardstick is a blocked sweep without state between frames. "
      "Times are medians; the best value of a column is bold.\n\n";
  for (const Json& section : layout()["sections"]) {
    const std::string shown_parts = markdown_of(parts_of(results, section, section["id"]));
    if (shown_parts.empty()) continue;
    text += "## " + section["title"].get<std::string>() + "\n\n" + shown_parts;
  }
  text.pop_back();
  return text;
}

std::string with_figures(const std::string& text, const Results& results) {
  const std::size_t begin = text.find(kFiguresBegin);
  if (begin == std::string::npos) return text;
  const std::size_t from = begin + kFiguresBegin.size();
  const std::size_t end = text.find(kFiguresEnd, from);
  if (end == std::string::npos) throw ArgumentError("figures without an end: " + kFiguresEnd);
  const std::string table = markdown_of(parts_of(results, layout()["readme"], ""));
  if (table.empty()) throw ArgumentError("the results have no frames");
  return text.substr(0, from) + run_text(results) +
         ".\nOther libraries run at their best settings: Embree on all threads, CGAL too if that "
         "is faster, the others on\none. The yardstick is a blocked sweep without state between "
         "frames.\n\n" +
         table + text.substr(end);
}

void print_summary(const Results& results) {
  for (const Json& section : layout()["sections"]) {
    for (const Part& part : parts_of(results, section, "")) {
      if (part.kind != Part::Kind::table || (part.targets & kOnTerminal) == 0) continue;
      Table text(part.table.header);
      for (const auto& row : part.table.rows) {
        std::vector<std::string> cells;
        for (const Cell& one : row) cells.push_back(one.text);
        text.add(std::move(cells));
      }
      if (!part.table.caption.empty()) std::cout << '\n' << part.table.caption;
      std::cout << '\n' << text;
    }
  }
  std::cout << '\n';
  for (const char* kind : {"missing", "warnings"}) {
    for (const Json& one : results.document().value(kind, Json::array())) {
      std::cout << one.get<std::string>() << '\n';
    }
  }
  for (const Json& problem : results.document()["problems"]) {
    std::cout << "problem: " << problem.get<std::string>() << '\n';
  }
}

}  // namespace winnow::bench
