#include "partitions/tree/environment_order.h"

#include "core/sort/radix_sort.h"
#include "partitions/tree/kd_order.h"

#include <algorithm>

namespace winnow {

bool sort_by_environment(const BoundsPool& pool, const ObjectFilter* filters,
                         std::span<std::uint32_t> rows, Column<std::uint64_t>& scratch,
                         const Execution& execution) {
  const std::size_t count = rows.size();
  if (!scratch.grow(2 * count)) return false;
  std::uint64_t* const items = scratch.data();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t environment = filters[pool.ids()[rows[i]]].environment;
    items[i] = environment << 32U | rows[i];
  }
  const std::uint64_t* const sorted = radix_sort(items, items + count, count, 32, execution);
  for (std::size_t i = 0; i < count; ++i) rows[i] = static_cast<std::uint32_t>(sorted[i]);
  return true;
}

namespace {

/// Calls visit(begin, end) for each range of rows of one environment until visit returns false.
template <typename Visit>
bool for_environments(const BoundsPool& pool, const ObjectFilter* filters,
                      std::span<const std::uint32_t> rows, Visit&& visit) {
  const auto environment_of = [&](std::size_t i) {
    return filters[pool.ids()[rows[i]]].environment;
  };
  std::size_t begin = 0;
  while (begin < rows.size()) {
    const std::uint32_t environment = environment_of(begin);
    std::size_t end = begin + 1;
    while (end < rows.size() && environment_of(end) == environment) ++end;
    if (!visit(begin, end)) return false;
    begin = end;
  }
  return true;
}

}  // namespace

bool sort_by_environment_and_place(const BoundsPool& pool, const ObjectFilter* filters,
                                   std::span<std::uint32_t> rows, Column<std::uint64_t>& scratch,
                                   std::uint32_t* room, Column<float>& points,
                                   const Execution& execution) {
  if (!sort_by_environment(pool, filters, rows, scratch, execution)) return false;
  return for_environments(pool, filters, rows, [&](std::size_t begin, std::size_t end) {
    // Rows that fit in one block need no order.
    return end - begin <= kBlockRows ||
           sort_by_kd_cuts(pool, rows.subspan(begin, end - begin), room, points, execution);
  });
}

bool append_environments(const BoundsPool& pool, const ObjectFilter* filters,
                         std::span<const std::uint32_t> rows,
                         Column<std::uint32_t>& order) noexcept {
  bool was_large = false;
  return for_environments(pool, filters, rows, [&](std::size_t begin, std::size_t end) {
    const bool large = end - begin > kBlockRows;
    const std::size_t at = order.size();
    const std::size_t padding =
        large || was_large ? (kBlockRows - at % kBlockRows) % kBlockRows : 0;
    if (!order.resize(at + padding + end - begin)) return false;
    std::fill_n(order.data() + at, padding, kNoObject);
    std::copy_n(rows.data() + begin, end - begin, order.data() + at + padding);
    was_large = large;
    return true;
  });
}

}  // namespace winnow
