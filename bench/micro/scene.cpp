#include "bench/micro/scene.h"

#include "bench/common/random.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr std::uint64_t kSeed = 1;

void store(const Aabb& box, std::size_t row, BoundsPool& pool) {
  if (pool.volume() == Volume::sphere) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      pool.column(a)[row] = box.min[axis];
      pool.column(3 + a)[row] = box.max[axis];
      pool.column(kCenterColumn + a)[row] = 0.5F * (box.min[axis] + box.max[axis]);
    }
    pool.column(kRadiusColumn)[row] = 0.5F * (box.max.x() - box.min.x());
    return;
  }
  // The first three slabs of a k-DOP are the box; those along diagonals follow from its corners.
  const std::size_t slabs = slab_count(pool.volume());
  for (std::size_t s = 0; s < slabs; ++s) {
    const auto a = static_cast<Eigen::Index>(s % 3);
    const auto b = static_cast<Eigen::Index>((s + 1) % 3);
    pool.column(low_column(slabs, s))[row] = s < 3 ? box.min[a] : box.min[a] + box.min[b];
    pool.column(high_column(slabs, s))[row] = s < 3 ? box.max[a] : box.max[a] + box.max[b];
  }
}

}  // namespace

std::vector<Aabb> random_cubes(std::size_t count) {
  Random random(kSeed);
  const double side = std::cbrt(2.0 * static_cast<double>(count));
  std::vector<Aabb> boxes(count);
  for (Aabb& box : boxes) {
    for (int a = 0; a < 3; ++a) box.min[a] = static_cast<float>(random.in(0.0, side));
    box.max = box.min + Eigen::Vector3f::Ones();
  }
  return boxes;
}

std::vector<Aabb> moved_cubes(const std::vector<Aabb>& cubes, float step) {
  Random random(kSeed + 1);
  std::vector<Aabb> boxes = cubes;
  const auto most = static_cast<double>(step);
  for (Aabb& box : boxes) {
    for (int a = 0; a < 3; ++a) {
      const auto by = static_cast<float>(random.in(-most, most));
      box.min[a] += by;
      box.max[a] += by;
    }
  }
  return boxes;
}

KernelScene::KernelScene(const std::vector<Aabb>& boxes, const Cells& cells, Volume volume)
    : pool(std::pmr::get_default_resource(), volume) {
  lay_cells(boxes, cells);
  const std::vector<std::uint32_t> order = order_by_cells(boxes);
  if (!pool.reserve(boxes.size())) throw std::bad_alloc();
  pool.append(boxes.size());
  key.reserve(boxes.size());
  for (std::size_t row = 0; row < order.size(); ++row) {
    store(boxes[order[row]], row, pool);
    pool.ids()[row] = order[row];
    key.push_back(boxes[order[row]].min[0]);
  }
  pool.pad();
}

void KernelScene::lay_cells(const std::vector<Aabb>& boxes, const Cells& cells) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  Aabb world;
  for (const Aabb& box : boxes) world.merge(box);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto index = static_cast<Eigen::Index>(a);
    const std::uint32_t count = cells.count[a];
    const float origin = world.min[index];
    const float width = (world.max[index] - origin) / static_cast<float>(count);
    for (std::uint32_t c = 0; c < count; ++c) {
      from_[a].push_back(c == 0 ? -inf : origin + static_cast<float>(c) * width);
      to_[a].push_back(c + 1 == count ? inf : origin + static_cast<float>(c + 1) * width);
    }
    // Cubes of edge 1, but for the rounding of their upper ends.
    axis[a] = {.from = from_[a].data(),
               .to = to_[a].data(),
               .count = count,
               .axis = static_cast<std::uint32_t>(a),
               .origin = origin,
               .inverse = 1.0F / width,
               .reach = 1.001F,
               .limit = 1.001F};
  }
}

std::vector<std::uint32_t> KernelScene::order_by_cells(const std::vector<Aabb>& boxes) {
  const auto cell_of = [&](std::uint32_t i) {
    std::array<std::uint32_t, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) {
      at[a] = last_cell(axis[a], boxes[i].min[static_cast<Eigen::Index>(a)]);
    }
    return (at[2] * axis[1].count + at[1]) * axis[0].count + at[0];
  };
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t cell_a = cell_of(a);
    const std::uint32_t cell_b = cell_of(b);
    return cell_a != cell_b ? cell_a < cell_b : boxes[a].min[0] < boxes[b].min[0];
  });
  start.assign(std::size_t{axis[0].count} * axis[1].count * axis[2].count + 1, 0);
  for (const std::uint32_t i : order) ++start[cell_of(i) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  return order;
}

RowView KernelScene::rows() const {
  RowView view;
  for (std::size_t c = 0; c < pool.columns(); ++c) view.column[c] = pool.column(c);
  view.further_slabs = static_cast<std::uint32_t>(slab_count(pool.volume())) - 3;
  view.spheres = pool.volume() == Volume::sphere;
  view.id = pool.ids();
  return view;
}

QueryBatch KernelScene::all_rows() const {
  QueryBatch batch;
  for (std::size_t c = 0; c < pool.columns(); ++c) batch.column[c] = pool.column(c);
  batch.is_box = pool.volume() == Volume::aabb;
  batch.id = pool.ids();
  batch.end = row_count();
  batch.mode = HitMode::query_first;
  return batch;
}

PairSink SinkBuffer::sink() {
  PairSink sink;
  sink.cursor = ids_.data();
  sink.limit = ids_.data() + 2 * kPairs;
  sink.grow = [](PairSink&) { return false; };
  return sink;
}

}  // namespace winnow::bench
