// Checks that every figure of a report's page follows from results.json: parses the table cells and
// the plot data, and recomputes derived values. bench/goals calls trace_page().

#include "bench/report/trace.h"

#include "bench/pages/html.h"
#include "bench/rows/results.h"
#include "bench/rows/template_text.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace winnow::bench {
namespace {

bool alike(double a, double b, double tolerance) {
  return std::abs(a - b) <= tolerance * std::max(std::abs(a), std::abs(b));
}

/// Returns the exponent of the power law through the points, by least squares of logarithms.
double exponent_of(const std::vector<double>& xs, const std::vector<double>& ys) {
  const auto mean_log = [](const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += std::log(value);
    return sum / static_cast<double>(values.size());
  };
  const double x_mean = mean_log(xs);
  const double y_mean = mean_log(ys);
  double over = 0.0;
  double under = 0.0;
  for (std::size_t i = 0; i < xs.size(); ++i) {
    over += (std::log(xs[i]) - x_mean) * (std::log(ys[i]) - y_mean);
    under += (std::log(xs[i]) - x_mean) * (std::log(xs[i]) - x_mean);
  }
  return over / under;
}

/// Recomputes a derived value by its rule (see `derived`); NaN if there is no such rule.
double derived_again(const std::string& rule, const std::vector<const Json*>& rows,
                     const std::string& field) {
  std::vector<double> values;
  std::vector<double> objects;
  for (const Json* row : rows) values.push_back(value_of(*row, field));
  for (const Json* row : rows) objects.push_back(value_of(*row, "objects"));
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  if (rule == "sum") return sum;
  if (rule == "share" && !values.empty()) return values.front() / sum;
  if (rule == "ratio" && values.size() == 2) return values[0] / values[1];
  return rule == "exponent" ? exponent_of(objects, values) : std::nan("");
}

std::string in_attribute(const std::string& text) {
  return replaced(escaped(text), "\"", "&quot;");
}

std::string attribute_of(std::string_view tag, const std::string& name) {
  std::size_t at = 0;
  return std::string(between(tag, " " + name + "=\"", "\"", at));
}

class Tracing {
 public:
  explicit Tracing(const Json& document) {
    for (const Json& table : document["tables"]) {
      for (const Json& row : table["rows"]) {
        rows_[in_attribute(row["id"])] = {&row, &table};
        for (const std::string key : table["keys"]) {
          keys_.insert(escaped(member_text("", row.value(key, Json()))));
        }
      }
    }
  }

  Trace all(std::string_view html) {
    for (std::size_t at = 0; at != html.npos;) {
      const std::string_view table = between(html, "<table", "</table>", at);
      if (table.starts_with(" class=\"facts\"")) continue;
      for (std::size_t in = 0; in != table.npos;) {
        const std::string_view cell = between(table, "<td", "</td>", in);
        const std::size_t end = cell.find('>');
        if (end != cell.npos) check_cell(cell.substr(0, end), std::string(cell.substr(end + 1)));
      }
    }
    std::size_t at = 0;
    const Json data = Json::parse(
        between(html, "<script type=\"application/json\" id=\"plots\">", "</script", at));
    for (const Json& plot : data["plots"]) {
      for (const Json& series : plot["series"]) {
        for (const Json& point : series["points"]) check_point(plot, series, point);
      }
    }
    for (const auto& [id, known] : rows_) {
      const Json from = known.row->value("from", Json::array());  // one value, or a list of values
      for (const Json& one : from.is_array() ? from : Json::array({from})) {
        check_rule(id, *known.row, one);
      }
    }
    return std::move(trace_);
  }

 private:
  struct Known {
    const Json* row = nullptr;
    const Json* table = nullptr;
  };

  std::map<std::string, Known> rows_;
  std::set<std::string> keys_;
  Trace trace_;

  [[nodiscard]] Known known_of(const std::string& id) const {
    const auto at = rows_.find(id);
    return at == rows_.end() ? Known{} : at->second;
  }

  void demand(bool holds, const std::string& what) {
    if (!holds) trace_.wrong.push_back(what);
  }

  void check_cell(std::string_view tag, const std::string& text) {
    const std::string id = attribute_of(tag, "data-row");
    if (id.empty()) {
      const bool has_digits = text.find_first_of("0123456789") != text.npos;
      demand(!has_digits || keys_.contains(text), "a table shows \"" + text + "\", no row's key");
      return;
    }
    ++trace_.cells;
    const std::string name = attribute_of(tag, "data-value");
    const Known known = known_of(id);
    demand(known.row != nullptr && known.row->contains(name) &&
               is_shown(*known.row, (*known.table)["values"], name, text),
           "a table shows \"" + text + "\" as " + name + " of " + id);
  }

  /// Returns whether `text` shows the value, with its spread or without.
  static bool is_shown(const Json& row, const Json& columns, const std::string& name,
                       const std::string& text) {
    const auto column = std::find_if(columns.begin(), columns.end(),
                                     [&](const Json& one) { return one["name"] == name; });
    if (column == columns.end()) return false;
    const std::string median = shown(row, *column);
    return text == escaped(median) ||
           text == escaped(median + spread_text(row, name, (*column)["format"]));
  }

  void check_point(const Json& plot, const Json& series, const Json& point) {
    ++trace_.points;
    const Known known = known_of(in_attribute(point.value("row", "")));
    const std::string where = "plot " + plot["id"].get<std::string>() + ": " + point.dump();
    if (known.row == nullptr) return demand(false, where + " is of no row");
    const Json& row = *known.row;
    const std::string y = series["y_value"];
    demand(alike(value_of(row, y), point["y"], 1e-9), where + ": y is another");
    if (point.contains("low")) {
      demand(row[y]["min"] == point["low"] && row[y]["max"] == point["high"],
             where + ": the whisker is another");
    }
    const std::string x = series["x_value"];
    const auto at = point["x"].get<double>();
    const Json& bars = plot["categories"];
    demand(bars.empty() ? alike(value_of(row, x), at, 1e-9)
                        : at < static_cast<double>(bars.size()) &&
                              bars[static_cast<std::size_t>(at)] == key_text(row.value(x, Json())),
           where + ": x is another");
  }

  void check_rule(const std::string& id, const Json& row, const Json& from) {
    ++trace_.derived;
    std::vector<const Json*> rows;
    for (const std::string other : from["rows"]) {
      rows.push_back(known_of(in_attribute(other)).row);
      if (rows.back() == nullptr) return demand(false, id + " comes from " + other + ": no row");
    }
    const std::string name = from["value"];
    const double again = derived_again(from["rule"], rows, from["field"]);
    demand(alike(value_of(row, name), again, 1e-6),
           id + ": " + name + " does not follow by its rule");
  }
};

}  // namespace

std::string_view between(std::string_view text, std::string_view open, std::string_view close,
                         std::size_t& at) {
  const std::size_t from = text.find(open, at);
  const std::size_t to = from == text.npos ? from : text.find(close, from + open.size());
  at = to == text.npos ? to : to + close.size();
  return at == text.npos ? "" : text.substr(from + open.size(), to - from - open.size());
}

Trace trace_page(const std::string& html, const Json& document) {
  return Tracing(document).all(html);
}

}  // namespace winnow::bench
