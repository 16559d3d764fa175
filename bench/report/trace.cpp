#include "bench/report/trace.h"

#include "bench/report/page_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <sstream>
#include <string_view>

namespace winnow::bench {
namespace {

using TraceJson = nlohmann::json;

/// Whether a text shows a value, in a hundredth of which it is told if it is a share.
bool shows(const std::string& text, double value, const std::string& format) {
  ShownFigure figure;
  if (!read_figure(text, figure)) return false;
  if (format == "percent") {
    if (figure.unit != " %") return false;
    value *= 100.0;
  } else if (!figure.unit.empty()) {
    return false;
  }
  return std::abs(figure.value - value) <= figure.half_digit * (1.0 + 1e-9) + 1e-12 * value;
}

double figure_of(const TraceJson& row, const std::string& name) {
  const auto at = row.find(name);
  if (at == row.end()) return std::nan("");
  if (at->is_number()) return at->get<double>();
  if (at->is_object() && at->contains("median")) return at->at("median").get<double>();
  return std::nan("");
}

bool alike(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

bool is_text_of(const std::string& text, const TraceJson& key) {
  if (key.is_string()) return key.get<std::string>() == text;
  ShownFigure figure;
  return key.is_number() && read_figure(text, figure) && figure.unit.empty() &&
         std::abs(figure.value - key.get<double>()) <= 1e-5 * std::abs(figure.value);
}

/// By the rule; NaN if there is none of that name.
double derived_again(const std::string& rule, const std::vector<const TraceJson*>& rows,
                     const std::string& field) {
  std::vector<double> values;
  for (const TraceJson* row : rows) values.push_back(figure_of(*row, field));
  double sum = 0.0;
  for (const double value : values) sum += value;
  if (rule == "sum") return sum;
  if (rule == "share" && !values.empty()) return values.front() / sum;
  if (rule == "ratio" && values.size() == 2) return values[0] / values[1];
  if (rule != "exponent" || values.size() < 2) return std::nan("");
  double x_mean = 0.0;
  double y_mean = 0.0;
  const auto count = static_cast<double>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    x_mean += std::log(figure_of(*rows[i], "objects")) / count;
    y_mean += std::log(values[i]) / count;
  }
  double over = 0.0;
  double under = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = std::log(figure_of(*rows[i], "objects")) - x_mean;
    over += x * (std::log(values[i]) - y_mean);
    under += x * x;
  }
  return over / under;
}

class Tracing {
 public:
  Tracing(const TraceJson& document, std::size_t picked, std::uint64_t seed)
      : picked_(picked), random_(seed) {
    for (const TraceJson& table : document.at("tables")) {
      for (const TraceJson& row : table.at("rows")) {
        rows_[row.at("id").get<std::string>()] = {&row, &table};
      }
    }
  }

  Trace all(const std::string& html) {
    const auto script = html.find("<script");
    check_cells(table_rows(std::string_view(html).substr(0, script)));
    check_points(plots_of(html));
    check_derived();
    return std::move(trace_);
  }

 private:
  struct Known {
    const TraceJson* row = nullptr;
    const TraceJson* table = nullptr;
  };

  std::map<std::string, Known> rows_;
  std::size_t picked_;
  std::mt19937_64 random_;
  Trace trace_;

  void complain(const std::string& what) { trace_.wrong.push_back(what); }

  template <typename T>
  void pick(std::vector<T>& all) {
    if (picked_ == 0 || all.size() <= picked_) return;
    for (std::size_t i = 0; i < picked_; ++i) {
      std::swap(all[i], all[i + random_() % (all.size() - i)]);
    }
    all.resize(picked_);
  }

  [[nodiscard]] const TraceJson* column(const Known& known, const std::string& value) const {
    for (const TraceJson& one : known.table->at("values")) {
      if (one.at("name") == value) return &one;
    }
    return nullptr;
  }

  void check_cells(const std::vector<TracedRow>& shown_rows) {
    std::vector<TracedCell> cells;
    for (const TracedRow& shown_row : shown_rows) {
      for (const TracedCell& cell : shown_row) {
        if (!cell.row.empty()) {
          cells.push_back(cell);
        } else if (cell.text.find_first_of("0123456789") != std::string::npos) {
          check_key(shown_row, cell.text);
        }
      }
    }
    pick(cells);
    for (const TracedCell& cell : cells) check_cell(cell);
  }

  [[nodiscard]] static bool is_key_of(const std::string& text, const Known& known) {
    const TraceJson& keys = known.table->at("keys");
    return std::any_of(keys.begin(), keys.end(), [&](const TraceJson& key) {
      return is_text_of(text, known.row->value(key.get<std::string>(), TraceJson()));
    });
  }

  /// A text with digits that says of no row where it is from must be a key of its neighbours, or,
  /// where all cells are such texts, of any row.
  void check_key(const TracedRow& shown_row, const std::string& text) {
    bool has_neighbours = false;
    for (const TracedCell& cell : shown_row) {
      const auto at = rows_.find(cell.row);
      if (at == rows_.end()) continue;
      has_neighbours = true;
      if (is_key_of(text, at->second)) return;
    }
    if (!has_neighbours && std::any_of(rows_.begin(), rows_.end(), [&](const auto& one) {
          return is_key_of(text, one.second);
        })) {
      return;
    }
    complain("a table shows \"" + text + "\", which is of no row");
  }

  void check_cell(const TracedCell& cell) {
    ++trace_.cells;
    const auto at = rows_.find(cell.row);
    const TraceJson* facts = at == rows_.end() ? nullptr : column(at->second, cell.value);
    if (facts == nullptr || !at->second.row->contains(cell.value)) {
      complain("a table shows " + cell.value + " of " + cell.row + ", which is not there");
      return;
    }
    const TraceJson& value = at->second.row->at(cell.value);
    if (!is_shown(cell.text, value, facts->at("format").get<std::string>())) {
      complain(cell.row + ", " + cell.value + ": a table shows \"" + cell.text + "\" of " +
               value.dump());
    }
  }

  /// A text, a number, or a median, with the spread in brackets or without.
  [[nodiscard]] static bool is_shown(const std::string& text, const TraceJson& value,
                                     const std::string& format) {
    if (value.is_string()) return value.get<std::string>() == text;
    if (value.is_number()) return shows(text, value.get<double>(), format);
    if (!value.is_object()) return false;
    const std::size_t bracket = text.find(" (");
    if (!shows(text.substr(0, bracket), value.at("median").get<double>(), format)) return false;
    if (bracket == std::string::npos) return true;
    const std::size_t to = text.find(" to ", bracket);
    if (to == std::string::npos || text.back() != ')') return false;
    return shows(text.substr(bracket + 2, to - bracket - 2), value.at("min").get<double>(),
                 format) &&
           shows(text.substr(to + 4, text.size() - to - 5), value.at("max").get<double>(), format);
  }

  struct PlacedPoint {
    const TraceJson* plot;
    const TraceJson* series;
    const TraceJson* point;
  };

  void check_points(const TraceJson& plots) {
    std::vector<PlacedPoint> points;
    for (const TraceJson& plot : plots) {
      for (const TraceJson& series : plot.at("series")) {
        for (const TraceJson& point : series.at("points")) {
          points.push_back({&plot, &series, &point});
        }
      }
    }
    pick(points);
    for (const PlacedPoint& placed : points) check_point(placed);
  }

  void check_point(const PlacedPoint& placed) {
    ++trace_.points;
    const TraceJson& point = *placed.point;
    const std::string plot = placed.plot->at("id").get<std::string>();
    const auto at = rows_.find(point.value("row", ""));
    if (at == rows_.end()) {
      complain("plot " + plot + " has a point of no row");
      return;
    }
    const TraceJson& row = *at->second.row;
    const std::string y = placed.series->at("y_value").get<std::string>();
    if (!alike(figure_of(row, y), point.at("y").get<double>())) {
      complain("plot " + plot + ": y is not " + y + " of " + at->first);
    }
    if (point.contains("low") && (!row.contains(y) || row[y].value("min", 0.0) != point["low"] ||
                                  row[y].value("max", 0.0) != point["high"])) {
      complain("plot " + plot + ": a whisker is not the spread of " + at->first);
    }
    if (!is_x(placed, at->second)) complain("plot " + plot + ": x is not that of " + at->first);
  }

  /// A value or key of the row, or the number of the bar that is called by one of its keys.
  [[nodiscard]] static bool is_x(const PlacedPoint& placed, const Known& known) {
    const double x = placed.point->at("x").get<double>();
    const TraceJson& categories = placed.plot->at("categories");
    if (categories.empty()) {
      return alike(figure_of(*known.row, placed.series->at("x_value").get<std::string>()), x);
    }
    const auto number = static_cast<std::size_t>(x);
    if (number >= categories.size()) return false;
    return is_key_of(categories[number].get<std::string>(), known);
  }

  void check_derived() {
    for (const auto& [id, known] : rows_) {
      const auto from = known.row->find("from");
      if (from == known.row->end()) continue;
      // One value's, or a list of such.
      if (from->is_object()) check_rule(id, *known.row, *from);
      if (!from->is_array()) continue;
      for (const TraceJson& one : *from) check_rule(id, *known.row, one);
    }
  }

  void check_rule(const std::string& id, const TraceJson& row, const TraceJson& from) {
    ++trace_.derived;
    std::vector<const TraceJson*> rows;
    for (const TraceJson& other : from.at("rows")) {
      const auto at = rows_.find(other.get<std::string>());
      if (at == rows_.end()) {
        complain(id + " comes from " + other.get<std::string>() + ", which is not there");
        return;
      }
      rows.push_back(at->second.row);
    }
    const std::string name = from.at("value").get<std::string>();
    const std::string rule = from.at("rule").get<std::string>();
    const double again = derived_again(rule, rows, from.at("field").get<std::string>());
    if (!(std::abs(figure_of(row, name) - again) <= 1e-6 * std::abs(again) + 1e-12)) {
      std::ostringstream text;
      text << id << ": " << name << " is " << figure_of(row, name) << ", by the rule \"" << rule
           << "\" " << again;
      complain(text.str());
    }
  }
};

}  // namespace

Trace trace_page(const std::string& html, const nlohmann::json& document, std::size_t picked,
                 std::uint64_t seed) {
  return Tracing(document, picked, seed).all(html);
}

}  // namespace winnow::bench
