// Evaluates the blocks of layout.json over the results: selects rows, groups them and returns
// tables and plots as parts. page.cpp and markdown.cpp format the parts; layout.h states the
// language.

#include "bench/report/layout.h"

#include "bench/common/sample.h"
#include "bench/common/table.h"
#include "bench/peers/yardstick.h"
#include "bench/rows/machine.h"
#include "bench/rows/template_text.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <utility>

namespace winnow::bench {
namespace {

using RowList = std::vector<const Json*>;
using Parts = std::vector<Part>;

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

unsigned targets_of(const Json& block) {
  unsigned targets = 0;
  for (const std::string& word : words_of(block.value("to", "page"))) {
    targets |= word == "page" ? kOnPage : word == "results" ? kInResults : kOnTerminal;
  }
  return targets;
}

bool is_figure(const Part& part) {
  return part.kind == Part::Kind::table || part.kind == Part::Kind::plot;
}

/// Marks the best cell of each column that has at least two numbers.
void mark_best(CellTable& table, bool less) {
  for (std::size_t c = 1; c < table.header.size(); ++c) {
    Cell* best = nullptr;
    std::size_t known = 0;
    for (auto& row : table.rows) {
      if (!std::isfinite(row[c].number)) continue;
      ++known;
      const bool better =
          best != nullptr && (less ? row[c].number < best->number : row[c].number > best->number);
      if (best == nullptr || better) best = &row[c];
    }
    if (known > 1) best->best = true;
  }
}

/// Largest number of series that a reader can tell apart in one plot.
constexpr std::size_t kMaxSeries = 12;

double median_height(const PlotSeries& series) {
  std::vector<double> heights;
  for (const PlotPoint& point : series.points) heights.push_back(point.y);
  return median_of(heights);
}

/// If there are more than kMaxSeries series, keeps the best in their order and notes it in the
/// title.
void thin_out(Plot& plot, bool more_is_better) {
  const std::size_t all = plot.series.size();
  if (all <= kMaxSeries) return;
  std::vector<double> medians;
  for (const PlotSeries& one : plot.series) {
    medians.push_back(more_is_better ? -median_height(one) : median_height(one));
  }
  std::vector<double> ranked = medians;
  std::sort(ranked.begin(), ranked.end());
  const double last = ranked[kMaxSeries - 1];
  std::size_t at = 0;
  std::size_t kept = 0;
  std::erase_if(plot.series, [&](const PlotSeries&) {
    const bool keep = medians[at++] <= last && kept < kMaxSeries;
    kept += keep ? 1 : 0;
    return !keep;
  });
  plot.title += ": the best " + grouped(kMaxSeries) + " of " + grouped(all);
}

/// Returns the Pareto front: the points that no other point beats in both x and y.
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

class Evaluation {
 public:
  Evaluation(const Results& results, std::string id) : results_(results), id_(std::move(id)) {}

  void add(const Json& block, const Json& scope, Parts& to) {
    for (const Json& bound : bindings(block, scope)) {
      Json own = block;
      own.erase("show");
      add_one(filled_in(own, bound), block.value("show", Json::array()), bound, to);
    }
  }

 private:
  const Results& results_;
  std::string id_;
  std::size_t plots_ = 0;

  void add_one(const Json& block, const Json& children, const Json& scope, Parts& to) {
    Parts parts;
    for (const Json& child : children) add(child, scope, parts);
    if (block.contains("pivot")) add_pivots(block, scope, parts);
    if (block.contains("rows")) add_table(row_table(block, scope), block, parts);
    if (block.contains("least")) add_table(least_table(block, scope), block, parts);
    if (block.contains("plot") || block.contains("bars")) add_plot(block, scope, parts);
    unsigned targets = 0;
    for (const Part& part : parts) targets |= is_figure(part) ? part.targets : 0U;
    constexpr const char* kContents[] = {"pivot", "rows", "least", "plot", "bars"};
    const bool has_contents =
        !children.empty() || std::any_of(std::begin(kContents), std::end(kContents),
                                         [&](const char* name) { return block.contains(name); });
    if (has_contents && targets == 0) return;
    if (!has_contents) targets = targets_of(block);
    for (const auto& [name, kind] :
         {std::pair{"heading", Part::Kind::heading}, std::pair{"text", Part::Kind::paragraph}}) {
      if (block.contains(name)) to.push_back({kind, targets, block[name]});
    }
    to.insert(to.end(), parts.begin(), parts.end());
    if (!block.contains("command")) return;
    const RowList rows = rows_of(block["command"], scope, block);
    if (rows.empty() || !rows.front()->contains("command")) return;
    to.push_back({Part::Kind::command, kOnPage, (*rows.front())["command"]});
  }

  /// Returns the scope once for each combination of the values that "each" binds.
  [[nodiscard]] std::vector<Json> bindings(const Json& block, const Json& scope) const {
    std::vector<Json> all{scope};
    const Json each = block.value("each", Json::object());
    if (each.is_array()) {
      all.assign(each.size(), scope);
      for (std::size_t i = 0; i < each.size(); ++i) all[i].update(each[i]);
      return all;
    }
    for (const auto& [key, source] : each.items()) {
      std::vector<Json> longer;
      for (const Json& before : all) {
        for (const Json& value : values_of(key, source, before, block)) {
          longer.push_back(before);
          longer.back()[key] = value;
        }
      }
      all = std::move(longer);
    }
    return all;
  }

  [[nodiscard]] std::vector<Json> values_of(const std::string& key, const Json& source, Json scope,
                                            const Json& block) const {
    if (source.is_array()) return {source.begin(), source.end()};
    scope.erase(key);
    const auto words = words_of(source);
    const auto values = distinct(rows_of(words[0], scope, block), key);
    if (words.size() == 1 || values.empty()) return values;
    if (words[1] == "first") return {values.front()};
    return {words[1] == "max" ? *std::max_element(values.begin(), values.end())
                              : *std::min_element(values.begin(), values.end())};
  }

  [[nodiscard]] RowList rows_of(const std::string& name, const Json& scope,
                                const Json& block) const {
    const Json* table = results_.table(name);
    if (table == nullptr) return {};
    Json where = Json::object();
    for (const std::string key : (*table)["keys"]) {
      if (scope.contains(key)) where[key] = scope[key];
    }
    const Json members = block.value("where", Json::object());
    for (const auto& [key, value] : members.items()) {
      where[key] = value;
      if (value.is_null()) where.erase(key);
    }
    return results_.rows(name, where);
  }

  /// Returns the cell of a row's value or key ("-" if the row is null), formatted by its column. A
  /// spread is shown by its median.
  [[nodiscard]] Cell cell(const std::string& table, const Json* row,
                          const std::string& value) const {
    const Json* column = results_.column(table, value);
    if (row == nullptr || !row->contains(value)) return {"-"};
    if (column == nullptr) return {member_text("", (*row)[value])};
    return {.text = shown(*row, *column),
            .row = (*row)["id"],
            .value = value,
            .number = value_of(*row, value),
            .words = (*row)[value].is_string()};
  }

  [[nodiscard]] CellTable row_table(const Json& block, const Json& scope) const {
    const std::string name = block["rows"];
    const Json* table = results_.table(name);
    CellTable shown_rows{block.value("caption", "")};
    if (table == nullptr) return shown_rows;
    Json columns = block.value("columns", (*table)["keys"]);
    if (!block.contains("columns")) {
      for (const Json& column : (*table)["values"]) columns.push_back(column["name"]);
    }
    for (const Json& column : columns) shown_rows.header.push_back(header_of(name, column));
    const RowList rows = rows_of(name, scope, block);
    const Json once = block.value("once", Json::array());
    std::vector<RowList> groups;
    for (const Json* row : rows) {
      const auto is_same = [&](const RowList& group) {
        return std::all_of(once.begin(), once.end(), [&](const std::string key) {
          return group.front()->value(key, Json()) == row->value(key, Json());
        });
      };
      const auto same =
          once.empty() ? groups.end() : std::find_if(groups.begin(), groups.end(), is_same);
      if (same == groups.end()) {
        groups.push_back({row});
      } else {
        same->push_back(row);
      }
    }
    for (const RowList& group : groups) {
      shown_rows.rows.emplace_back();
      for (const Json& column : columns) {
        shown_rows.rows.back().push_back(cell_in(name, group, column));
      }
    }
    return shown_rows;
  }

  static void add_table(CellTable table, const Json& block, Parts& to) {
    if (table.rows.empty()) return;
    to.push_back({Part::Kind::table, targets_of(block), "", std::move(table)});
  }

  void add_pivots(const Json& block, const Json& scope, Parts& to) const {
    const auto words = words_of(block["pivot"]);
    for (std::size_t i = 3; i < words.size(); ++i) {
      add_table(pivot(block, scope, words, words[i]), block, to);
    }
  }

  [[nodiscard]] CellTable pivot(const Json& block, const Json& scope,
                                const std::vector<std::string>& words,
                                const std::string& value) const {
    RowList rows = rows_of(words[0], scope, block);
    std::erase_if(rows, [&](const Json* row) { return !row->contains(value); });
    const Json* column = results_.column(words[0], value);
    if (rows.empty() || column == nullptr) return {};
    const std::string label = heading_of(*column);
    CellTable table{filled(block.value("caption", "{label}"), {{"label", label}}), {words[1]}};
    const auto heads = distinct(rows, words[2]);
    for (const Json& head : heads) table.header.push_back(member_text("", head));
    for (const Json& name : distinct(rows, words[1])) {
      std::vector<Cell> cells{{member_text("", name)}};
      RowList of_name = rows;
      std::erase_if(of_name, [&](const Json* row) { return (*row)[words[1]] != name; });
      for (const Json& head : heads) {
        const auto at = std::find_if(of_name.begin(), of_name.end(),
                                     [&](const Json* row) { return (*row)[words[2]] == head; });
        cells.push_back(cell(words[0], at == of_name.end() ? nullptr : *at, value));
      }
      if (block.contains("most")) cells.push_back(most_of(words[0], of_name, block["most"]));
      table.rows.push_back(std::move(cells));
    }
    if (block.contains("most")) {
      const Json* most = results_.column(words[0], block["most"]);
      table.header.push_back("most " + (most == nullptr ? "" : heading_of(*most)));
    }
    const std::string better = (*column)["better"];
    if (block.value("best", true) && better != "neither") mark_best(table, better == "less");
    return table;
  }

  [[nodiscard]] Cell most_of(const std::string& table, const RowList& rows,
                             const std::string& value) const {
    const Json* most = nullptr;
    for (const Json* row : rows) {
      if (!row->contains(value)) continue;
      if (most == nullptr || value_of(*row, value) > value_of(*most, value)) most = row;
    }
    return cell(table, most, value);
  }

  [[nodiscard]] std::string header_of(const std::string& table, const Json& column) const {
    if (column.is_object() && column.contains("label")) return column["label"];
    const std::string name = column.is_object() ? column["value"] : column;
    const Json* facts =
        results_.column(column.is_object() ? column["of"].get<std::string>() : table, name);
    return facts == nullptr ? name : heading_of(*facts);
  }

  [[nodiscard]] Cell cell_in(const std::string& table, const RowList& group,
                             const Json& column) const {
    const Json& row = *group.front();
    if (column.is_string()) return cell(table, &row, column);
    if (column.contains("all")) {
      std::vector<std::string> names;
      for (const Json& name : distinct(group, column["all"])) names.push_back(key_text(name));
      return {.text = listed(names), .words = true};
    }
    const std::string other = column["of"];
    return cell(other, joined(other, row, filled_in(column.value("where", Json::object()), row)),
                column["value"]);
  }

  /// Returns the row of another table that has the same keys.
  [[nodiscard]] const Json* joined(const std::string& other, const Json& row, Json where) const {
    const Json* table = results_.table(other);
    if (table == nullptr) return nullptr;
    for (const std::string key : (*table)["keys"]) {
      if (row.contains(key) && !where.contains(key)) where[key] = row[key];
    }
    return results_.row(other, where);
  }

  [[nodiscard]] CellTable least_table(const Json& block, const Json& scope) const {
    CellTable table{"", {"what", "unit", "winnow", "best other library", "times"}};
    for (const Json& entry : block["least"]) {
      for (const Json& bound : bindings(entry, scope)) {
        const auto words = words_of(entry["of"]);
        const Json* own = nullptr;
        const Json* peer = nullptr;
        for (const Json* row : rows_of(words[0], bound, entry)) {
          const std::string name = (*row)[words[1]];
          if (name == kYardstickName) continue;  // the yardstick is not a library
          const Json*& least = is_peer(name) ? peer : own;
          if (row->value("right", "yes") != "yes" || !row->contains(words[2])) continue;
          if (!is_peer(name) && entry.value("own", name) != name) continue;
          if (!least || value_of(*row, words[2]) < value_of(*least, words[2])) least = row;
        }
        if (own == nullptr) continue;
        const auto figure = [&](const Json* row) {
          if (row == nullptr) return std::string("-");
          return shown(value_of(*row, words[2]), "number") + " (" + key_text((*row)[words[1]]) +
                 ")";
        };
        const double times =
            peer == nullptr ? std::nan("") : value_of(*peer, words[2]) / value_of(*own, words[2]);
        table.rows.push_back({{filled(entry["what"], bound)},
                              {entry["unit"]},
                              {figure(own)},
                              {figure(peer)},
                              {shown(times, "number")}});
      }
    }
    return table;
  }

  void add_plot(const Json& block, const Json& scope, Parts& to) {
    const bool bars = block.contains("bars");
    const auto words = words_of(block[bars ? "bars" : "plot"]);
    const RowList rows = rows_of(words[0], scope, block);
    const Json* column = results_.column(words[0], words[3]);
    if (column == nullptr) return;
    const std::string log = block.value("log", "");
    const Json labels{{"label", (*column)["label"]}};
    Plot plot{.id = id_ + "_" + std::to_string(plots_),
              .title = filled(block.value("title", ""), labels),
              .x = {block.value("x", header_of(words[0], words[2])), log.find('x') != log.npos},
              .y = {block.value("y", heading_of(*column)), log.find('y') != log.npos}};
    if (bars) {
      for (const Json& head : distinct(rows, words[2])) plot.categories.push_back(key_text(head));
      plot.stacked = block.value("stacked", words[1] == "-");
    }
    const bool line = !block.value("dots", false);
    if (words[1] == "-") {
      for (std::size_t i = 3; i < words.size(); ++i) {
        const Json* one = results_.column(words[0], words[i]);
        if (one == nullptr) continue;
        plot.series.push_back({.name = (*one)["label"], .line = line});
        add_points(plot, words[0], rows, words[2], words[i]);
      }
    } else {
      for (const Json& name : distinct(rows, words[1])) {
        RowList of_name = rows;
        std::erase_if(of_name,
                      [&](const Json* row) { return row->value(words[1], Json()) != name; });
        plot.series.push_back({.name = key_text(name), .line = line});
        add_points(plot, words[0], of_name, words[2], words[3]);
      }
    }
    std::erase_if(plot.series, [](const PlotSeries& one) { return one.points.empty(); });
    if (plot.series.empty()) return;
    if (plot.categories.empty()) thin_out(plot, (*column)["better"] == "more");
    if (block.value("front", false)) plot.series.push_back(pareto_front(plot.series));
    ++plots_;
    to.push_back({Part::Kind::plot, targets_of(block), "", {}, std::move(plot)});
  }

  /// Adds points to the last series. Skips rows without x or y, and values not above 0 on a
  /// logarithmic axis.
  void add_points(Plot& plot, const std::string& table, const RowList& rows, const std::string& x,
                  const std::string& y) const {
    PlotSeries& series = plot.series.back();
    series.x_value = x;
    series.y_value = y;
    for (const Json* row : rows) {
      double at = value_of(*row, x);
      if (!plot.categories.empty() && row->contains(x)) {
        at = static_cast<double>(
            std::find(plot.categories.begin(), plot.categories.end(), key_text((*row)[x])) -
            plot.categories.begin());
      }
      const double height = value_of(*row, y);
      if (!std::isfinite(at) || (plot.x.log && at <= 0.0)) continue;
      if (!std::isfinite(height) || (plot.y.log && height <= 0.0)) continue;
      PlotPoint point{at, height, note_of(table, *row, {x, y}), (*row)["id"]};
      if (const Json& value = (*row)[y]; value.is_object() && plot.categories.empty()) {
        point.low = value["min"];
        point.high = value["max"];
      }
      series.points.push_back(std::move(point));
    }
    std::stable_sort(series.points.begin(), series.points.end(),
                     [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  }

  [[nodiscard]] std::string note_of(const std::string& table, const Json& row,
                                    const std::vector<std::string>& values) const {
    std::string note = row["id"].get<std::string>();
    for (const std::string& name : values) {
      const Json* column = results_.column(table, name);
      if (column == nullptr) continue;
      const std::string unit = (*column)["unit"];
      note += "; " + shown(row, *column) + (unit.empty() ? "" : " " + unit) +
              spread_text(row, name, (*column)["format"]);
    }
    return note;
  }
};

}  // namespace

const Json& layout() {
  static const Json parsed = Json::parse(kLayoutJson);
  return parsed;
}

std::vector<Part> parts_of(const Results& results, const Json& block, const std::string& id) {
  Parts parts;
  Evaluation(results, id).add(block, {{"isa", results.document()["machine"]["isa"]}}, parts);
  return parts;
}

}  // namespace winnow::bench
