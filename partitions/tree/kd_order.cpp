#include "partitions/tree/kd_order.h"

#include "core/sort/split_jobs.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <limits>

namespace winnow {
namespace {

constexpr std::uint32_t kMostBins = 256;
constexpr std::size_t kFewToRank = 32;  // to be ranked
constexpr float kLeastReach = 1e-30F;   // what is closer is at one place
constexpr std::size_t kKdWorthSharing = 2048;
constexpr std::size_t kPointsPerTask = 16384;

/// Points to be cut into subtrees, and room for a little more than half of them.
struct KdJob {
  KdPoint* points = nullptr;
  std::size_t count = 0;
  KdPoint* room = nullptr;

  [[nodiscard]] std::size_t size() const { return count; }
  [[nodiscard]] static std::size_t room_for(std::size_t count) { return count / 2 + count / 16; }
};

/// A point as one register; the last float is the row's bits.
using Lanes4 [[gnu::vector_size(16)]] = float;

Lanes4 lanes_of(const KdPoint& point) noexcept {
  Lanes4 lanes;
  std::memcpy(&lanes, &point, sizeof lanes);
  return lanes;
}

/// Where centres lie on the axis along which they reach farthest.
struct Span {
  std::size_t axis = 0;
  float low = 0.0F;
  float high = 0.0F;

  explicit Span(const KdJob& job) noexcept {
    Lanes4 least = lanes_of(job.points[0]);
    Lanes4 most = least;
    for (std::size_t i = 1; i < job.count; ++i) {
      const Lanes4 point = lanes_of(job.points[i]);
      least = point < least ? point : least;
      most = point > most ? point : most;
    }
    // Halves: the reach of what is spread over all floats is finite.
    const auto reach = [&](std::size_t a) { return 0.5F * most[a] - 0.5F * least[a]; };
    for (std::size_t a = 1; a < 3; ++a) {
      if (reach(a) > reach(axis)) axis = a;
    }
    low = least[axis];
    high = most[axis];
  }
};

/// Places along a span in equal steps.
struct Steps {
  std::size_t axis;
  float half_low;
  float scale;

  Steps(const Span& span, float count) noexcept : axis(span.axis), half_low(0.5F * span.low) {
    const float reach = 0.5F * span.high - half_low;
    scale = reach > kLeastReach ? count / reach : 0.0F;
  }
  /// Within [0, count], and about as even as floats are.
  [[nodiscard]] float of(const KdPoint& point) const noexcept {
    return (0.5F * point.at[axis] - half_low) * scale;
  }
};

/// How many points the first side takes: half of the subtrees, all of them full.
std::size_t cut_of(std::size_t count) noexcept {
  std::size_t places = kBlockRows;
  while (16 * places < count) places *= 16;
  return ((count + places - 1) / places + 1) / 2 * places;
}

/// Moves points of sides 0, 1 and 2 one behind the other; side 1 is to begin at `first`, side 2 at
/// `last`. Which side a point is on no branch predictor can guess: each is written to both places
/// that it may go to. False, and nothing is moved, if the room does not hold sides 1 and 2.
template <typename Side>
bool partition(const KdJob& job, std::size_t first, std::size_t last, Side&& side) noexcept {
  if (job.count - first > KdJob::room_for(job.count)) return false;
  KdPoint unused;
  KdPoint* kept = job.points;
  std::array<KdPoint*, 3> to{&unused, job.room, job.room + (last - first)};
  for (std::size_t i = 0; i < job.count; ++i) {
    const KdPoint point = job.points[i];
    const std::size_t s = side(point);
    *kept = point;
    kept += s == 0 ? 1 : 0;
    *to[s] = point;
    to[s] += s != 0 ? 1 : 0;
  }
  std::copy_n(job.room, job.count - first, job.points + first);
  return true;
}

/// Moves the `cut` points that come first on an axis to the front: by counting in bins, so that
/// only those of one bin have to be compared.
void select(const KdJob& job, const Span& span, std::size_t cut) noexcept {
  std::uint32_t bins = kMostBins;
  while (4 * bins > job.count && bins > kBlockRows) bins /= 2;
  const Steps steps(span, static_cast<float>(bins));
  const auto bin_of = [&](const KdPoint& point) {
    return std::min(static_cast<std::uint32_t>(steps.of(point)), bins - 1);
  };
  std::array<std::uint32_t, kMostBins> size;
  std::fill_n(size.begin(), bins, 0U);
  for (std::size_t i = 0; i < job.count; ++i) ++size[bin_of(job.points[i])];
  std::size_t before = 0;
  std::uint32_t middle = 0;
  while (before + size[middle] < cut) before += size[middle++];
  std::size_t first = before;
  std::size_t last = before + size[middle];
  const auto side_of = [&](const KdPoint& point) {
    const std::uint32_t bin = bin_of(point);
    return static_cast<std::size_t>(bin >= middle) + static_cast<std::size_t>(bin > middle);
  };
  if (!partition(job, first, last, side_of)) {
    first = 0;
    last = job.count;
  }
  std::nth_element(job.points + first, job.points + cut, job.points + last,
                   [&](const KdPoint& a, const KdPoint& b) {
                     const std::size_t axis = span.axis;
                     return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.row < b.row;
                   });
}

/// Sorts a few points on an axis, as finely as it takes: each counts how many come before it, which
/// is loops without branches.
void rank(const KdJob& job, const Span& span) noexcept {
  const Steps steps(span, 1U << 25U);
  // The index behind the place on the axis: no two keys are alike.
  std::array<std::int32_t, kFewToRank> key;
  std::array<KdPoint, kFewToRank> point;
  key.fill(std::numeric_limits<std::int32_t>::max());
  for (std::size_t i = 0; i < job.count; ++i) {
    point[i] = job.points[i];
    key[i] = static_cast<std::int32_t>(steps.of(point[i])) * static_cast<std::int32_t>(kFewToRank) +
             static_cast<std::int32_t>(i);
  }
  for (std::size_t i = 0; i < job.count; ++i) {
    std::int32_t before = 0;
    for (const std::int32_t other : key) before += other < key[i] ? 1 : 0;
    job.points[before] = point[i];
  }
}

/// Leaves the first side to `job` and returns the other.
KdJob split(KdJob& job) noexcept {
  const std::size_t cut = cut_of(job.count);
  const Span span(job);
  if (job.count <= kFewToRank) {
    rank(job, span);
  } else {
    select(job, span, cut);
  }
  KdJob second = job;
  second.points += cut;
  second.count -= cut;
  second.room += KdJob::room_for(cut);
  job.count = cut;
  return second;
}

void finish(KdJob job) noexcept {
  while (job.count > kBlockRows) finish(split(job));
}

}  // namespace

bool sort_by_kd_cuts(const BoundsPool& pool, std::span<std::uint32_t> rows,
                     Column<KdPoint>& scratch, const Execution& execution) {
  const std::size_t count = rows.size();
  if (!scratch.resize(count + KdJob::room_for(count))) return false;
  if (count == 0) return true;
  const std::size_t tasks = (count + kPointsPerTask - 1) / kPointsPerTask;
  const auto for_points = [&](auto&& work) {
    execution.for_each(tasks, [&](std::size_t task) {
      const std::size_t end = std::min(count, (task + 1) * kPointsPerTask);
      for (std::size_t i = task * kPointsPerTask; i < end; ++i) work(i);
    });
  };
  for_points([&](std::size_t i) {
    KdPoint& point = scratch[i];
    for (std::size_t a = 0; a < 3; ++a) {
      point.at[a] = 0.5F * pool.column(a)[rows[i]] + 0.5F * pool.column(3 + a)[rows[i]];
    }
    point.row = rows[i];
  });
  run_split_jobs(KdJob{scratch.data(), count, scratch.data() + count}, kKdWorthSharing, execution,
                 split, finish);
  for_points([&](std::size_t i) { rows[i] = scratch[i].row; });
  return true;
}

}  // namespace winnow
