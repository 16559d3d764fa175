#include "bench/common/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace winnow::bench {

std::ostream& operator<<(std::ostream& out, const Table& table) {
  std::vector<std::size_t> widths;
  for (const auto& row : table.rows_) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  for (const auto& row : table.rows_) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::size_t space = widths[c] - row[c].size();
      const bool left = std::find(table.left_.begin(), table.left_.end(), c) != table.left_.end();
      if (c != 0) line.append(2, ' ');
      if (!left) line.append(space, ' ');
      line.append(row[c]);
      if (left) line.append(space, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out << line << '\n';
  }
  return out;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string threads_text(int threads) {
  return std::to_string(threads) + (threads == 1 ? " thread" : " threads");
}

std::string short_number(double value) {
  int decimals = 0;
  for (double limit = 100.0; std::abs(value) < limit && decimals < 4; limit /= 10.0) ++decimals;
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", value == 0.0 ? 0 : decimals, value);
  return text;
}

std::string percent(double share) {
  return std::isnan(share) ? "-" : short_number(100.0 * share) + " %";
}

std::string grouped(std::size_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, 1, ',');
  return digits;
}

}  // namespace winnow::bench
