// Compares the results of query engines with each other and with a test of every box in double.
// bench/micro/partitions.cpp calls it; reference_queries.cpp decides doubtful cases.

#include "bench/measure/reference_queries.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

namespace winnow::bench {
namespace {

constexpr double kDoubleRounding = 1e-13;
constexpr double kFloatRounding = 1e-6;
/// Relative tolerance of t: three roundings to nearest of an engine in float, one rounding down of
/// a partition, and some slack.
constexpr double kSameT = 3.0 * 0x1p-23;

bool same_t(double a, double b) noexcept {
  return std::abs(a - b) <= kSameT * std::max(std::abs(a), std::abs(b)) + 1e-30;
}

bool by_row(const Found& a, const Found& b) noexcept {
  return a.row < b.row;
}

bool in_order(std::span<const Found> found) noexcept {
  return std::is_sorted(found.begin(), found.end(),
                        [](const Found& a, const Found& b) { return a.t < b.t; });
}

std::vector<Found> sorted_by_row(std::span<const Found> found) {
  std::vector<Found> sorted(found.begin(), found.end());
  std::sort(sorted.begin(), sorted.end(), by_row);
  return sorted;
}

std::string named(std::uint32_t row) {
  return "object " + std::to_string(row);
}

/// Result for one query; `wrong` is empty if the answers agree.
struct Finding {
  std::string wrong;
  bool undecided = false;
};

/// Compares all queries and counts the findings.
template <typename CompareOne>
Comparison compare_each(std::size_t questions, CompareOne&& compare_one) {
  Comparison result;
  for (std::size_t i = 0; i < questions; ++i) {
    const Finding finding = compare_one(i);
    if (!finding.wrong.empty()) {
      if (result.wrong++ == 0) result.first = "query " + std::to_string(i) + ": " + finding.wrong;
    } else if (finding.undecided) {
      ++result.undecided;
    }
  }
  return result;
}

Finding compare_one_exactly(const ReferenceQueries& judge, const QuerySet& set, std::size_t i,
                            std::span<const Found> expected, std::span<const Found> got) {
  if (set.query_type == QueryType::any) {
    if (expected.empty() != got.empty()) return {"only one of them found any"};
    if (got.empty() || judge.verdict(set, i, got[0].row, kDoubleRounding).possible) return {};
    return {named(got[0].row) + " is not hit"};
  }
  if (set.query_type == QueryType::overlap) {
    if (sorted_by_row(expected) == sorted_by_row(got)) return {};
    return {std::to_string(got.size()) + " objects, expected " + std::to_string(expected.size()) +
            (expected.size() == got.size() ? " others" : "")};
  }
  const auto [e, g] = std::mismatch(expected.begin(), expected.end(), got.begin(), got.end());
  if (e == expected.end() && g == got.end()) return {};
  const auto text = [](auto at, auto end) {
    return at == end ? "nothing" : named(at->row) + " at " + std::to_string(at->t);
  };
  return {text(g, got.end()) + ", expected " + text(e, expected.end())};
}

/// Checks an object that only one engine found.
Finding check_unmatched(const ReferenceQueries& judge, const QuerySet& set, std::size_t i,
                        const Found& found) {
  const Verdict verdict = judge.verdict(set, i, found.row, kFloatRounding);
  if (verdict.possible && !verdict.certain) return {{}, true};
  return {named(found.row) + (verdict.certain ? " is missing" : " should not be there")};
}

Finding compare_closest(const ReferenceQueries& judge, const QuerySet& set, std::size_t i,
                        std::span<const Found> expected, std::span<const Found> got) {
  if (expected.empty() && got.empty()) return {};
  const bool both = !expected.empty() && !got.empty();
  if (both && same_t(static_cast<double>(expected[0].t), static_cast<double>(got[0].t))) return {};
  // The smaller t belongs to an object that the other engine did not find.
  const bool got_first = expected.empty() || (both && got[0].t < expected[0].t);
  return check_unmatched(judge, set, i, got_first ? got[0] : expected[0]);
}

Finding compare_sets(const ReferenceQueries& judge, const QuerySet& set, std::size_t i,
                     std::span<const Found> expected, std::span<const Found> got) {
  if (!in_order(got) || !in_order(expected)) return {"the hits are not in order"};
  const std::vector<Found> a = sorted_by_row(expected);
  const std::vector<Found> b = sorted_by_row(got);
  std::vector<Found> lone;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(lone),
                                by_row);
  Finding finding;
  for (const Found& found : lone) {
    const Finding one = check_unmatched(judge, set, i, found);
    if (!one.wrong.empty()) return one;
    finding.undecided = true;
  }
  std::vector<Found> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common), by_row);
  for (const Found& found : common) {
    const auto other = std::lower_bound(b.begin(), b.end(), found, by_row);
    if (!same_t(static_cast<double>(found.t), static_cast<double>(other->t))) {
      return {named(found.row) + " at another t"};
    }
  }
  return finding;
}

Finding compare_nearest(std::span<const Found> expected, std::span<const Found> got) {
  const bool same = std::equal(expected.begin(), expected.end(), got.begin(), got.end(),
                               [](const Found& a, const Found& b) {
                                 return same_t(static_cast<double>(a.t), static_cast<double>(b.t));
                               });
  return same ? Finding{} : Finding{"other distances"};
}

/// The reference for one query: every box tested in double.
struct ExhaustiveResult {
  std::vector<std::uint32_t> certain;
  double least_t = std::numeric_limits<double>::infinity();  ///< of the certain rows
  std::vector<double> distances;                             ///< for QueryType::nearest, sorted

  ExhaustiveResult(const ReferenceQueries& judge, const QuerySet& set, std::size_t i,
                   std::size_t objects) {
    for (std::uint32_t row = 0; row < objects; ++row) {
      const Verdict verdict = judge.verdict(set, i, row, kDoubleRounding);
      if (set.query_type == QueryType::nearest) distances.push_back(verdict.t);
      if (!verdict.certain) continue;
      certain.push_back(row);
      least_t = std::min(least_t, verdict.t);
    }
    std::sort(distances.begin(), distances.end());
  }
};

Finding check_found(const ReferenceQueries& judge, const QuerySet& set, std::size_t i,
                    std::span<const Found> got) {
  for (const Found& found : got) {
    const Verdict verdict = judge.verdict(set, i, found.row, kDoubleRounding);
    if (!verdict.possible) return {named(found.row) + " should not be there"};
    if (set.query_type == QueryType::any) continue;
    if (!same_t(static_cast<double>(found.t), verdict.t))
      return {named(found.row) + " at another t"};
  }
  return {};
}

Finding compare_one_by_force(const ReferenceQueries& judge, const QuerySet& set, std::size_t i,
                             std::size_t objects, std::span<const Found> got) {
  if (Finding finding = check_found(judge, set, i, got); !finding.wrong.empty()) return finding;
  const ExhaustiveResult force(judge, set, i, objects);
  if (set.query_type == QueryType::nearest) {
    if (got.size() != std::min(set.count, objects)) return {"another number of objects"};
    for (std::size_t k = 0; k < got.size(); ++k) {
      if (!same_t(static_cast<double>(got[k].t), force.distances[k])) return {"other distances"};
    }
    return {};
  }
  if (set.query_type == QueryType::all || set.query_type == QueryType::overlap) {
    if (!in_order(got)) return {"the hits are not in order"};
    const std::vector<Found> sorted = sorted_by_row(got);
    for (const std::uint32_t row : force.certain) {
      if (!std::binary_search(sorted.begin(), sorted.end(), Found{row, 0.0F}, by_row)) {
        return {named(row) + " is missing"};
      }
    }
    return {};
  }
  if (got.empty() && !force.certain.empty()) return {"nothing found"};
  const bool late = set.query_type == QueryType::closest && !got.empty() &&
                    static_cast<double>(got[0].t) > force.least_t;
  if (late && !same_t(static_cast<double>(got[0].t), force.least_t)) return {"not the closest"};
  return {};
}

}  // namespace

Comparison compare_exactly(const ReferenceQueries& judge, const QuerySet& set,
                           const QueryResults& expected, const QueryResults& got) {
  return compare_each(std::min(expected.questions(), got.questions()), [&](std::size_t i) {
    return compare_one_exactly(judge, set, i, expected.of(i), got.of(i));
  });
}

Comparison compare_in_float(const ReferenceQueries& judge, const QuerySet& set,
                            const QueryResults& expected, const QueryResults& got) {
  return compare_each(std::min(expected.questions(), got.questions()), [&](std::size_t i) {
    switch (set.query_type) {
      case QueryType::closest:
        return compare_closest(judge, set, i, expected.of(i), got.of(i));
      case QueryType::any:
        if (expected.of(i).empty() == got.of(i).empty()) return Finding{};
        return check_unmatched(judge, set, i, got.of(i).empty() ? expected.of(i)[0] : got.of(i)[0]);
      case QueryType::nearest:
        return compare_nearest(expected.of(i), got.of(i));
      default:
        return compare_sets(judge, set, i, expected.of(i), got.of(i));
    }
  });
}

Comparison compare_by_force(const ReferenceQueries& judge, const QuerySet& set, std::size_t objects,
                            const QueryResults& got, std::size_t most) {
  return compare_each(std::min(most, got.questions()), [&](std::size_t i) {
    return compare_one_by_force(judge, set, i, objects, got.of(i));
  });
}

}  // namespace winnow::bench
