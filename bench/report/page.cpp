#include "bench/report/page.h"

#include "bench/common/table.h"
#include "bench/pages/html.h"
#include "bench/report/section.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow::bench {
namespace {

std::string attribute(const std::string& name, const std::string& text) {
  return " " + name + "=\"" + replaced(escaped(text), "\"", "&quot;") + "\"";
}

std::string html_of(const PageCell& cell) {
  std::string html = "<td";
  if (cell.best || cell.words) html += attribute("class", cell.best ? "best" : "words");
  if (!cell.row.empty()) {
    html += attribute("data-row", cell.row) + attribute("data-value", cell.value) +
            attribute("title", cell.row);
  }
  return html + ">" + escaped(cell.text) + "</td>";
}

std::string html_of(const PageTable& table) {
  std::string html = "<div class=\"wide\"><table>\n";
  if (!table.caption.empty()) html += "<caption>" + escaped(table.caption) + "</caption>\n";
  html += "<thead><tr>";
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    const bool words = std::any_of(table.rows.begin(), table.rows.end(),
                                   [&](const auto& row) { return c < row.size() && row[c].words; });
    html += (words ? "<th class=\"words\">" : "<th>") + escaped(table.header[c]) + "</th>";
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (const PageCell& cell : row) html += html_of(cell);
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

void mark_best(PageTable& table, const std::vector<std::vector<double>>& values, bool less) {
  const std::size_t columns = table.header.size() - 1;
  for (std::size_t c = 0; c < columns; ++c) {
    std::size_t best = values.size();
    std::size_t known = 0;
    for (std::size_t r = 0; r < values.size(); ++r) {
      const double value = values[r][c];
      if (!std::isfinite(value)) continue;
      ++known;
      const bool first = best == values.size();
      if (first || (less ? value < values[best][c] : value > values[best][c])) best = r;
    }
    if (known > 1) table.rows[best][c + 1].best = true;
  }
}

bool can_be_drawn(double value, bool log) {
  return std::isfinite(value) && (!log || value > 0.0);
}

std::string note_of(const Json& row, const SeriesOf& from, const Results& results) {
  std::string note = row["id"].get<std::string>();
  for (const std::string& name : {from.x, from.y}) {
    const Json* column = results.column(from.table, name);
    if (column == nullptr) continue;
    const std::string unit = (*column)["unit"];
    note += "; " + shown(row, *column) + (unit.empty() ? "" : " " + unit) +
            spread_text(row, name, (*column)["format"]);
  }
  return note;
}

}  // namespace

void ReportPage::heading(const std::string& text) {
  html_ += "<h3>" + escaped(text) + "</h3>\n";
}

void ReportPage::paragraph(const std::string& text) {
  html_ += "<p>" + escaped(text) + "</p>\n";
}

void ReportPage::command(const std::string& text) {
  html_ += "<pre>" + escaped(text) + "</pre>\n";
}

void ReportPage::command_of(const std::string& table, const Json& where) {
  const Json* row = results_.row(table, where);
  if (row != nullptr && row->contains("command")) command((*row)["command"]);
}

void ReportPage::add(const PageTable& table) {
  if (!table.rows.empty()) html_ += html_of(table);
}

void ReportPage::add(const std::vector<Plot>& plots) {
  std::string places;
  for (Plot plot : plots) {
    std::erase_if(plot.series, [](const PlotSeries& one) { return one.points.empty(); });
    if (plot.series.empty()) continue;
    places += place_of(plot);
    plots_.push_back(std::move(plot));
  }
  if (!places.empty()) html_ += "<div class=\"plots\">\n" + places + "</div>\n";
}

void ReportPage::all_rows(const std::string& name) {
  const Json* table = results_.table(name);
  if (table == nullptr || (*table)["rows"].empty()) return;
  PageTable whole;
  for (const Json& key : (*table)["keys"]) whole.header.push_back(key);
  for (const Json& column : (*table)["values"]) whole.header.push_back(heading_of(column));
  for (const Json& row : (*table)["rows"]) {
    std::vector<PageCell> cells;
    for (const Json& key : (*table)["keys"]) {
      cells.push_back(text_cell(key_text(row[key.get<std::string>()])));
    }
    for (const Json& column : (*table)["values"]) {
      PageCell shown_cell = cell(results_, name, &row, column["name"]);
      shown_cell.text += spread_text(row, column["name"], column["format"]);
      cells.push_back(std::move(shown_cell));
    }
    whole.rows.push_back(std::move(cells));
  }
  const std::string title = (*table)["title"];
  html_ += "<details><summary>All " + grouped(whole.rows.size()) + " rows: " + escaped(title) +
           "</summary>\n" + html_of(whole) + "</details>\n";
}

PageCell text_cell(const std::string& text) {
  return {text};
}

PageCell cell(const Results& results, const std::string& table, const Json* row,
              const std::string& value) {
  const Json* column = results.column(table, value);
  if (row == nullptr || column == nullptr || !row->contains(value)) return {"-"};
  return {.text = shown(*row, *column),
          .row = (*row)["id"],
          .value = value,
          .words = (*row)[value].is_string()};
}

PageTable pivot(const Results& results, const Pivot& pivot) {
  auto rows = results.rows(pivot.table, pivot.where);
  std::erase_if(rows, [&](const Json* row) { return !row->contains(pivot.value); });
  const Json* column = results.column(pivot.table, pivot.value);
  PageTable table;
  if (rows.empty() || column == nullptr) return table;
  table.caption = pivot.caption.empty() ? heading_of(*column) : pivot.caption;
  table.header.push_back(pivot.row_key);
  const auto heads = distinct(rows, pivot.column_key);
  for (const Json& head : heads) {
    table.header.push_back(head.is_number_unsigned() ? grouped(head.get<std::size_t>())
                                                     : key_text(head));
  }
  std::vector<std::vector<double>> values;
  for (const Json& name : distinct(rows, pivot.row_key)) {
    std::vector<PageCell> cells{text_cell(key_text(name))};
    values.emplace_back();
    for (const Json& head : heads) {
      Json where = pivot.where;
      where[pivot.row_key] = name;
      where[pivot.column_key] = head;
      const Json* row = results.row(pivot.table, where);
      cells.push_back(cell(results, pivot.table, row, pivot.value));
      values.back().push_back(row == nullptr ? std::numeric_limits<double>::quiet_NaN()
                                             : value_of(*row, pivot.value));
    }
    table.rows.push_back(std::move(cells));
  }
  const std::string better = (*column)["better"];
  if (pivot.mark_best && better != "neither") mark_best(table, values, better == "less");
  return table;
}

std::vector<PlotSeries> series_of(const Results& results, const SeriesOf& from, bool log_x,
                                  bool log_y) {
  std::vector<PlotSeries> all;
  const auto rows = results.rows(from.table, from.where);
  for (const Json& name : distinct(rows, from.series_key)) {
    PlotSeries series{.name = key_text(name), .line = from.line};
    series.x_value = from.x;
    series.y_value = from.y;
    for (const Json* row : rows) {
      if (!row->contains(from.series_key) || (*row)[from.series_key] != name) continue;
      const double x = value_of(*row, from.x);
      const double y = value_of(*row, from.y);
      if (!can_be_drawn(x, log_x) || !can_be_drawn(y, log_y)) continue;
      PlotPoint point{x, y, note_of(*row, from, results), (*row)["id"]};
      if (const Json& value = (*row)[from.y]; value.is_object()) {
        point.low = value["min"];
        point.high = value["max"];
      }
      series.points.push_back(std::move(point));
    }
    all.push_back(std::move(series));
  }
  return all;
}

void add_bars(Plot& plot, const Results& results, const BarsOf& from) {
  const auto rows = results.rows(from.table, from.where);
  for (const Json* row : rows) plot.categories.push_back(key_text((*row)[from.category_key]));
  for (const std::string& value : from.values) {
    const Json* column = results.column(from.table, value);
    if (column == nullptr) continue;
    PlotSeries series{.name = (*column)["label"]};
    series.y_value = value;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double y = value_of(*rows[i], value);
      if (!std::isfinite(y)) continue;
      const std::string unit = (*column)["unit"];
      series.points.push_back(
          {static_cast<double>(i), y, shown(*rows[i], *column) + " " + unit, (*rows[i])["id"]});
    }
    plot.series.push_back(std::move(series));
  }
}

void add_bar_groups(Plot& plot, const Results& results, const BarGroupsOf& from) {
  const auto rows = results.rows(from.table, from.where);
  const auto categories = distinct(rows, from.category_key);
  plot.stacked = false;
  for (const Json& category : categories) plot.categories.push_back(key_text(category));
  for (const Json& name : distinct(rows, from.series_key)) {
    PlotSeries series{.name = key_text(name)};
    series.y_value = from.value;
    for (const Json* row : rows) {
      const double y = value_of(*row, from.value);
      if ((*row)[from.series_key] != name || !std::isfinite(y)) continue;
      const auto at = std::find(categories.begin(), categories.end(), (*row)[from.category_key]);
      series.points.push_back({static_cast<double>(at - categories.begin()), y,
                               note_of(*row, {from.table, {}, {}, {}, from.value}, results),
                               (*row)["id"]});
    }
    plot.series.push_back(std::move(series));
  }
}

PlotSeries pareto_front(const std::vector<PlotSeries>& series) {
  std::vector<PlotPoint> points;
  for (const PlotSeries& one : series) {
    points.insert(points.end(), one.points.begin(), one.points.end());
  }
  std::sort(points.begin(), points.end(), [](const PlotPoint& a, const PlotPoint& b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  });
  PlotSeries front{.name = "Pareto front", .front = true};
  if (!series.empty()) {
    front.x_value = series.front().x_value;
    front.y_value = series.front().y_value;
  }
  for (PlotPoint& point : points) {
    if (!front.points.empty() && point.y >= front.points.back().y) continue;
    front.points.push_back(std::move(point));
  }
  return front;
}

}  // namespace winnow::bench
