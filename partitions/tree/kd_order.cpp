#include "partitions/tree/kd_order.h"

#include "core/sort/split_jobs.h"
#include "core/sort/stretches.h"
#include "partitions/tree/kd_order.kernel.h"

#include <array>

namespace winnow {

WINNOW_DEFINE_KERNELS(KdOrderKernels, kd_order_kernels)

namespace {

constexpr std::size_t kKdWorthSharing = 2048;
constexpr std::size_t kPointsPerTask = 16384;

}  // namespace

bool sort_by_kd_cuts(const BoundsPool& pool, std::span<std::uint32_t> rows, std::uint32_t* room,
                     Column<float>& scratch, const Execution& execution) {
  const std::size_t count = rows.size();
  if (!scratch.resize(kd_scratch(count))) return false;
  if (count <= kBlockRows) return true;
  KdSet all;
  all.row = rows.data();
  all.row_room = room;
  all.count = count;
  const std::array<const float*, 6> boxes = box_columns(pool);
  for (std::size_t a = 0; a < 3; ++a) {
    all.at[a] = scratch.data() + a * count;
    all.at_room[a] = scratch.data() + (3 + a) * count;
  }
  const KdOrderKernels& kernels = kd_order_kernels();
  for_stretches(execution, count, kPointsPerTask, [&](std::size_t begin, std::size_t end) {
    kernels.centres(boxes.data(), rows.data(), begin, end, all.at);
  });
  run_split_jobs(all, kKdWorthSharing, execution, kernels.split, kernels.finish);
  return true;
}

}  // namespace winnow
