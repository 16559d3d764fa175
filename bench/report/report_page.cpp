#include "bench/common/table.h"
#include "bench/pages/html.h"
#include "bench/report/page.h"
#include "bench/report/section.h"

namespace winnow::bench {
namespace {

std::string facts_table(const std::string& head, const Json& facts) {
  std::string html =
      "<table class=\"facts\"><thead><tr><th>" + head + "</th><th></th></tr></thead>\n<tbody>\n";
  for (const auto& [name, fact] : facts.items()) {
    std::string text = key_text(fact);
    if (fact.is_object() || fact.is_array()) {
      text.clear();
      for (const auto& [member, value] : fact.items()) {
        text += (text.empty() ? "" : ", ") +
                (fact.is_object() ? member + " " + key_text(value) : key_text(value));
      }
    }
    html += "<tr><td>" + escaped(replaced(name, "_", " ")) + "</td><td>" + escaped(text) +
            "</td></tr>\n";
  }
  return html + "</tbody></table>\n";
}

std::string note(const std::string& text) {
  return "<p class=\"note\">" + escaped(text) + "</p>\n";
}

std::string notes_of(const Json& document) {
  std::string html;
  if (!document["complete"].get<bool>()) {
    std::size_t steps = 0;
    std::size_t done = 0;
    for (const Json& section : document["sections"]) {
      steps += section["steps"].get<std::size_t>();
      done += section["done"].get<std::size_t>();
    }
    html += note("This report is not complete: " + grouped(done) + " of " + grouped(steps) +
                 " steps were measured when this page was written.");
  }
  for (const Json& missing : document["missing"]) html += note(missing.get<std::string>());
  for (const Json& problem : document["problems"]) {
    html += note("Problem: " + problem.get<std::string>());
  }
  return html;
}

std::string section_html(const ReportSection& section, const Json& document, ReportPage& page) {
  const std::string id(section.id);
  std::string html =
      "<section id=\"" + id + "\">\n<h2>" + escaped(std::string(section.title)) + "</h2>\n";
  for (const Json& state : document["sections"]) {
    if (state["id"] != id || state["done"] == state["steps"]) continue;
    html += note("Measured so far: " + key_text(state["done"]) + " of " + key_text(state["steps"]) +
                 " steps.");
  }
  section.show(page.results(), page);
  return html + page.html() + "</section>\n";
}

}  // namespace

void write_report_page(const std::string& path, const Results& results) {
  const Json& document = results.document();
  std::vector<Plot> plots;
  std::string contents;
  std::string sections;
  for (const ReportSection& section : report_sections()) {
    ReportPage page(results);
    const std::string html = section_html(section, document, page);
    if (page.html().empty()) continue;
    const std::string id(section.id);
    contents += "<a href=\"#" + id + "\">" + escaped(std::string(section.title)) + "</a> ";
    sections += html;
    plots.insert(plots.end(), page.plots().begin(), page.plots().end());
  }
  const std::string body =
      "<h1>winnow: speed against error</h1>\n" + notes_of(document) + "<nav>" + contents +
      "</nav>\n<p>Every number is a row of results.json beside this page: point at it to read "
      "which. Times are medians; brackets and upright whiskers go from the least to the "
      "greatest. What is folded away is in the CSVs, too.</p>\n<p>The reference sweep is a plain "
      "sort and sweep over 10,000 boxes, by which machines are compared; a + behind the commit "
      "says "
      "that the source was changed since. Scenes are described by bench/run scenes; the "
      "tiers of the narrow phase are fast (float lanes), robust (each answer certified in double, "
      "or "
      "solved again, the default) and reference (each pair solved by itself).</p>\n" +
      facts_table("measured on", document["machine"]) +
      facts_table("settings", document["settings"]) + sections;
  write_plot_page(path, "winnow: speed against error", body, plots);
}

}  // namespace winnow::bench
