#include <winnow/partitions/hits.wide.h>
#include <winnow/partitions/queries/cast.kernel.h>
#include <winnow/partitions/queries/row_block.wide.h>
#include <winnow/partitions/queries/sweep.wide.h>
#include <winnow/partitions/queries/walks.wide.h>

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Calls found(t bits << 32 | id) for every row from `first_row` on that the sweep touches by
/// `limit`; it returns false to end the walk.
template <typename Found>
bool test_rows(const QueryView& view, const Sweep& sweep, const SweepTest& probe,
               const Wanted& wanted, std::uint32_t first_row, const float& limit, Found&& found) {
  const RowBlock block(view, first_row);
  Float16 enter;
  Mask16 mask = probe.test(block.columns(), block.at(), limit, enter);
  mask = wanted.rows(first_row, mask);
  for (; mask != 0; mask &= mask - 1) {
    const unsigned lane = first(mask);
    const double t = touch_row(sweep, block.columns(), block.at() + lane);
    if (t < 0.0) continue;
    const std::uint32_t id = view.id[first_row + lane];
    if (!found(std::uint64_t{order_of_rounded_down(t)} << 32U | id)) return false;
  }
  return true;
}

bool closest(const QueryView& view, const Sweep& sweep, const QueryFilter& filter,
             std::uint64_t& best) {
  const SweepTest probe(sweep);
  const Wanted wanted(view, filter);
  float limit = scaled_limit(sweep, sweep.max_t);
  bool any = false;
  walk_in_order(view, probe, wanted, limit, [&](std::uint32_t first_row) {
    return test_rows(view, sweep, probe, wanted, first_row, limit, [&](std::uint64_t hit) {
      const auto id = static_cast<std::uint32_t>(hit);
      if ((any && hit >= best) || !wanted.accepts(id)) return true;
      any = true;
      best = hit;
      // Up to the next float: what shows the same t may have the smaller id.
      const float t = value_of(static_cast<std::uint32_t>(hit >> 32U) + 1);
      const float next = scaled_limit(sweep, static_cast<double>(t));
      limit = next < limit ? next : limit;
      return true;
    });
  });
  return any;
}

bool any(const QueryView& view, const Sweep& sweep, const QueryFilter& filter,
         std::uint64_t& found) {
  const SweepTest probe(sweep);
  const Wanted wanted(view, filter);
  const float limit = scaled_limit(sweep, sweep.max_t);
  return !walk_in_order(view, probe, wanted, limit, [&](std::uint32_t first_row) {
    return test_rows(view, sweep, probe, wanted, first_row, limit, [&](std::uint64_t hit) {
      if (!wanted.accepts(static_cast<std::uint32_t>(hit))) return true;
      found = hit;
      return false;
    });
  });
}

bool all(const QueryView& view, const Sweep& sweep, const QueryFilter& filter, PairSink& sink,
         std::size_t& count) {
  const SweepTest probe(sweep);
  const Wanted wanted(view, filter);
  const float limit = scaled_limit(sweep, sweep.max_t);
  count = 0;
  return walk(view, probe, wanted, limit, [&](std::uint32_t first_row) {
    if (!has_room(sink)) return false;
    return test_rows(view, sweep, probe, wanted, first_row, limit, [&](std::uint64_t hit) {
      const auto id = static_cast<std::uint32_t>(hit);
      if (!wanted.accepts(id)) return true;
      sink.cursor[0] = id;
      sink.cursor[1] = static_cast<std::uint32_t>(hit >> 32U);
      sink.cursor += 2;
      ++count;
      return true;
    });
  });
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const CastKernels WINNOW_KERNEL_TABLE(cast_kernels) = {
    WINNOW_ISA_NAME::closest, WINNOW_ISA_NAME::any, WINNOW_ISA_NAME::all};

}  // namespace winnow
