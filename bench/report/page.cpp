// Writes index.html of a report: the recommendation, the circumstances of the run and one folded
// section for each section of layout.json, with the data of the plots.

#include "bench/report/page.h"

#include "bench/common/table.h"
#include "bench/pages/html.h"
#include "bench/report/recommendation.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

namespace winnow::bench {
namespace {

std::string element(const std::string& name, const std::string& text) {
  return "<" + name + ">" + escaped(text) + "</" + name.substr(0, name.find(' ')) + ">\n";
}

std::string attribute(const std::string& name, const std::string& text) {
  return " " + name + "=\"" + replaced(escaped(text), "\"", "&quot;") + "\"";
}

std::string html_of(const Cell& cell) {
  std::string html = "<td";
  if (cell.best || cell.words) html += attribute("class", cell.best ? "best" : "words");
  if (!cell.row.empty()) {
    html += attribute("data-row", cell.row) + attribute("data-value", cell.value) +
            attribute("title", cell.row);
  }
  return html + ">" + escaped(cell.text) + "</td>";
}

std::string html_of(const CellTable& table) {
  std::string html = "<div class=\"wide\"><table>\n";
  if (!table.caption.empty()) html += element("caption", table.caption);
  html += "<thead><tr>";
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    const bool words = std::any_of(table.rows.begin(), table.rows.end(),
                                   [&](const auto& row) { return row[c].words; });
    html += (words ? "<th class=\"words\">" : "<th>") + escaped(table.header[c]) + "</th>";
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (const Cell& cell : row) html += html_of(cell);
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

/// Places consecutive plots side by side if the page is wide enough.
PageParts page_of(std::vector<Part> parts) {
  PageParts page;
  bool in_plots = false;
  for (Part& part : parts) {
    if ((part.targets & kOnPage) == 0) continue;
    const bool is_plot = part.kind == Part::Kind::plot;
    if (is_plot != in_plots) page.html += is_plot ? "<div class=\"plots\">\n" : "</div>\n";
    in_plots = is_plot;
    switch (part.kind) {
      case Part::Kind::heading:
        page.html += element("h3", part.text);
        break;
      case Part::Kind::paragraph:
        page.html += element("p", part.text);
        break;
      case Part::Kind::command:
        page.html += element("pre", part.text);
        break;
      case Part::Kind::table:
        page.html += html_of(part.table);
        break;
      case Part::Kind::plot:
        page.html += place_of(part.plot);
        page.plots.push_back(std::move(part.plot));
    }
  }
  if (in_plots) page.html += "</div>\n";
  return page;
}

std::string note(const std::string& text) {
  return element("p class=\"note\"", text);
}

std::string not_complete(const Json& document) {
  if (document["complete"].get<bool>()) return "";
  std::size_t steps = 0;
  std::size_t done = 0;
  for (const Json& section : document["sections"]) {
    steps += section["steps"].get<std::size_t>();
    done += section["done"].get<std::size_t>();
  }
  return note("This report is not complete: " + grouped(done) + " of " + grouped(steps) +
              " steps were measured when this page was written.");
}

std::string steps_left(const Json& document, const std::string& id) {
  for (const Json& state : document["sections"]) {
    if (state["id"] != id || state["done"] == state["steps"]) continue;
    return note("Measured so far: " + key_text(state["done"]) + " of " + key_text(state["steps"]) +
                " steps.");
  }
  return "";
}

/// Lists the CSV files that have every row of the section's tables.
std::string files_of(const Json& document, const std::string& id) {
  std::string files;
  for (const Json& table : document["tables"]) {
    if (table["section"] != id || table["rows"].empty()) continue;
    const std::string file = table["name"].get<std::string>() + ".csv";
    files += "<li><a" + attribute("href", file) + ">" + escaped(file) +
             "</a>: " + escaped(table["title"].get<std::string>()) + " (" +
             grouped(table["rows"].size()) + (table["rows"].size() == 1 ? " row" : " rows") +
             ")</li>\n";
  }
  if (files.empty()) return "";
  return element("h3", "Every row") + "<ul class=\"files\">\n" + files + "</ul>\n";
}

/// Returns the recommendation, which opens the page.
std::string card_of(const Recommendation& recommendation) {
  const std::pair<const char*, const std::string&> lines[] = {
      {"because", recommendation.because},
      {"it costs", recommendation.price},
      {"next best", recommendation.next},
      {"where scenes change", recommendation.varying},
      {"other libraries", recommendation.others}};
  std::string html = "<div id=\"recommendation\">\n<p class=\"take\">Take <strong>" +
                     escaped(recommendation.take) + "</strong></p>\n<dl>\n";
  for (const auto& [head, text] : lines) {
    if (!text.empty()) html += element("dt", head) + element("dd", text);
  }
  html += "</dl>\n";
  if (!recommendation.code.empty()) html += element("pre", recommendation.code);
  return html + "</div>\n";
}

std::string counted(std::size_t count, const std::string& what) {
  return count == 0 ? "" : "; " + grouped(count) + " " + what + (count == 1 ? "" : "s");
}

constexpr const char* kTitle = "winnow: speed against error";
constexpr const char* kHowToRead =
    "Every number is a row of results.json beside this page: point at it to read which. Times are "
    "medians; brackets and upright whiskers go from the least to the greatest.";
constexpr const char* kWords =
    "The reference sweep is a plain sort and sweep over 10,000 boxes, by which machines are "
    "compared; a + behind the commit marks changes of the source after it. Scenes are described "
    "by bench/run scenes; the tiers of the narrow phase are robust (each answer certified in "
    "double, or solved again, the default) and reference (each pair solved by itself).";

/// Returns one line about the machine, the run and the number of warnings; it unfolds into all
/// details.
std::string circumstances(const Json& document) {
  const Json& machine = document["machine"];
  std::string line;
  for (const char* name : {"processor", "cores", "isa", "compiler", "commit", "date"}) {
    if (!machine.contains(name) || machine[name].is_structured()) continue;
    line += (line.empty() ? "" : ", ") + key_text(machine[name]) +
            (std::string_view(name) == "cores" ? " cores" : "");
  }
  std::string notes;
  for (const Json& problem : document["problems"]) {
    notes += note("Problem: " + problem.get<std::string>());
  }
  const Json warnings = document.value("warnings", Json::array());
  for (const Json& warning : warnings) notes += note(warning.get<std::string>());
  for (const Json& missing : document["missing"]) notes += note(missing.get<std::string>());
  const std::size_t problems = document["problems"].size();
  line += counted(problems, "problem") +
          counted(warnings.size() + document["missing"].size(), "warning");
  return "<details id=\"circumstances\"" + std::string(problems == 0 ? "" : " class=\"note\"") +
         ">" + element("summary", line) + notes + element("p", kHowToRead) + element("p", kWords) +
         facts_table("measured on", machine) + facts_table("settings", document["settings"]) +
         "</details>\n";
}

/// Returns a folded section; the layout's "open" unfolds it.
std::string folded(const Json& section, const std::string& html) {
  return std::string("<details class=\"section\"") + (section.value("open", false) ? " open" : "") +
         "><summary>" + element("h2", section["title"]) + "</summary>\n" + html + "</details>\n";
}

}  // namespace

const Json& section_of(std::string_view id) {
  for (const Json& section : layout()["sections"]) {
    if (section["id"] == id) return section;
  }
  throw std::out_of_range("no section " + std::string(id));
}

PageParts section_parts(const Results& results, const Json& section) {
  return page_of(parts_of(results, section, section["id"]));
}

std::string facts_table(const std::string& head, const Json& facts) {
  std::string html =
      "<table class=\"facts\"><thead><tr><th>" + head + "</th><th></th></tr></thead>\n<tbody>\n";
  for (const auto& [name, fact] : facts.items()) {
    std::string text = fact.is_structured() ? "" : key_text(fact);
    if (fact.is_structured()) {
      for (const auto& [member, value] : fact.items()) {
        text +=
            (text.empty() ? "" : ", ") + (fact.is_object() ? member + " " : "") + key_text(value);
      }
    }
    html += "<tr><td>" + escaped(replaced(name, "_", " ")) + "</td><td>" + escaped(text) +
            "</td></tr>\n";
  }
  return html + "</tbody></table>\n";
}

void write_report_page(const std::string& path, const Results& results) {
  const Json& document = results.document();
  std::vector<Plot> plots;
  std::string contents;
  std::string sections;
  for (const Json& section : layout()["sections"]) {
    PageParts page = section_parts(results, section);
    if (page.html.empty()) continue;
    const std::string id = section["id"];
    const std::string title = section["title"];
    contents += "<a" + attribute("href", "#" + id) + ">" + escaped(title) + "</a> ";
    sections += "<section" + attribute("id", id) + ">\n" +
                folded(section, steps_left(document, id) + page.html + files_of(document, id)) +
                "</section>\n";
    std::move(page.plots.begin(), page.plots.end(), std::back_inserter(plots));
  }
  const std::optional<Recommendation> recommendation = recommend(results);
  const std::string body = element("h1", kTitle) + not_complete(document) +
                           (recommendation ? card_of(*recommendation) : "") +
                           circumstances(document) + "<nav>" + contents +
                           "<a href=\"#all\">open all</a></nav>\n" + sections;
  write_plot_page(path, kTitle, body, plots);
}

}  // namespace winnow::bench
