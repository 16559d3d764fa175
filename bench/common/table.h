#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

namespace winnow::bench {

/// Text in columns: the first is aligned left, the others right.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}

  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  /// Aligns a further column left.
  void flush_left(std::size_t column) { left_.push_back(column); }

  friend std::ostream& operator<<(std::ostream& out, const Table& table);

 private:
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> left_{0};
};

/// Returns the names as "a, b, c".
[[nodiscard]] std::string listed(const std::vector<std::string>& names);
/// Returns "1 thread", "2 threads".
[[nodiscard]] std::string threads_text(int threads);

/// A number to three significant digits, without an exponent: 0.0571, 1.26, 48.3, 712.
[[nodiscard]] std::string short_number(double value);
/// A share to three significant digits: 12.5 %; "-" for NaN.
[[nodiscard]] std::string percent(double share);
/// An integer in groups of three digits: 100,000.
[[nodiscard]] std::string grouped(std::size_t value);

}  // namespace winnow::bench
