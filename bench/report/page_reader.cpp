#include "bench/report/page_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace winnow::bench {
namespace {

std::string unescaped(std::string_view html) {
  std::string text(html);
  const std::pair<const char*, const char*> names[] = {
      {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}};
  for (const auto& [name, sign] : names) {
    for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos; ++at) {
      text.replace(at, std::string_view(name).size(), sign);
    }
  }
  return text;
}

std::string attribute_of(std::string_view tag, const std::string& name) {
  std::size_t at = 0;
  return unescaped(between(tag, " " + name + "=\"", "\"", at));
}

TracedRow cells_of(std::string_view html) {
  TracedRow cells;
  for (std::size_t at = 0; at != std::string_view::npos;) {
    const std::string_view cell = between(html, "<td", "</td>", at);
    if (at == std::string_view::npos) break;
    const std::size_t end = cell.find('>');
    const std::string_view tag = cell.substr(0, end);
    cells.push_back({attribute_of(tag, "data-row"), attribute_of(tag, "data-value"),
                     unescaped(cell.substr(end + 1))});
  }
  return cells;
}

}  // namespace

std::string_view between(std::string_view text, std::string_view open, std::string_view close,
                         std::size_t& at) {
  const std::size_t from = text.find(open, at);
  const std::size_t to =
      from == std::string_view::npos ? from : text.find(close, from + open.size());
  at = to == std::string_view::npos ? to : to + close.size();
  return at == std::string_view::npos ? std::string_view()
                                      : text.substr(from + open.size(), to - from - open.size());
}

std::vector<TracedRow> table_rows(std::string_view html) {
  std::vector<TracedRow> rows;
  for (std::size_t at = 0; at != std::string_view::npos;) {
    const std::string_view table = between(html, "<table", "</table>", at);
    if (at == std::string_view::npos) break;
    if (table.substr(0, table.find('>')).find("facts") != std::string_view::npos) continue;
    for (std::size_t in = 0; in != std::string_view::npos;) {
      const std::string_view row = between(table, "<tr>", "</tr>", in);
      if (in != std::string_view::npos) rows.push_back(cells_of(row));
    }
  }
  return rows;
}

nlohmann::json plots_of(std::string_view html) {
  std::size_t at = 0;
  const auto text =
      between(html, "<script type=\"application/json\" id=\"plots\">", "</script", at);
  const nlohmann::json data = nlohmann::json::parse(text, nullptr, false);
  return data.is_object() ? data.value("plots", nlohmann::json::array()) : nlohmann::json::array();
}

bool read_figure(std::string text, ShownFigure& figure) {
  std::erase(text, ',');
  char* end = nullptr;
  figure.value = std::strtod(text.c_str(), &end);
  const auto length = static_cast<std::size_t>(end - text.c_str());
  if (length == 0) return false;
  figure.unit = text.substr(length);
  const std::string number = text.substr(0, length);
  const std::size_t exponent_at = number.find_first_of("eE");
  const std::string mantissa = number.substr(0, exponent_at);
  const std::size_t dot = mantissa.find('.');
  int power = dot == std::string::npos ? 0 : -static_cast<int>(mantissa.size() - dot - 1);
  if (exponent_at != std::string::npos) power += std::atoi(number.c_str() + exponent_at + 1);
  figure.half_digit = 0.5 * std::pow(10.0, power);
  return true;
}

}  // namespace winnow::bench
