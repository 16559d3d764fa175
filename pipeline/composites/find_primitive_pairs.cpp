// Finds the pairs of primitives of pairs of bodies (mid_phase.h). PrimitivePairSearch
// (primitive_pair_search.cpp) finds the pairs of one chunk of body pairs; this file runs the chunks
// as tasks, and copies the results to PrimitivePairs.

#include "core/hooks/stage_scope.h"
#include "pipeline/composites/composites.h"
#include "pipeline/composites/primitive_pair_search.h"

#include <algorithm>
#include <utility>

namespace winnow::mid {
namespace {

constexpr std::size_t kPairsPerTask = 32;

/// Results of the search of one chunk, for the task that writes them out. The record consists of
/// 32-bit integers, like all data in the scratch column.
struct ChunkRecord {
  std::uint32_t primitive_block;
  std::uint32_t pair_block;
  std::uint32_t primitives;
  std::uint32_t triangles;
  std::uint32_t pairs;
  // Totals of all earlier chunks.
  std::uint32_t first_primitive;
  std::uint32_t first_triangle;
  std::uint32_t first_pair;
};
static_assert(sizeof(ChunkRecord) % sizeof(std::uint32_t) == 0);

class PrimitivePairFinder {
 public:
  PrimitivePairFinder(const Composites& all, const ShapeTables& tables, const Bodies& bodies,
                      std::span<const BodyPair> pairs, const PairMargins& margins,
                      PrimitivePairs& out) noexcept
      : all_(all),
        tables_(tables),
        bodies_(bodies),
        pairs_(pairs),
        margins_(margins),
        out_(out),
        pool_hulls_(tables.count[static_cast<std::size_t>(ShapeKind::hull)]),
        chunks_((pairs.size() + kPairsPerTask - 1) / kPairsPerTask),
        head_(BumpAllocator::blocks_for(chunks_ * sizeof(ChunkRecord) / sizeof(std::uint32_t)) +
              BumpAllocator::blocks_for(pairs.size())) {}

  [[nodiscard]] Status run(const Execution& execution) noexcept;

 private:
  [[nodiscard]] bool copy_hulls() noexcept;
  [[nodiscard]] bool search_all(const Execution& execution) noexcept;
  void search(std::size_t chunk, BumpAllocator& arena) noexcept;
  [[nodiscard]] Status count() noexcept;
  void write(std::size_t chunk) noexcept;
  void write_primitive(const TransformedShape& body, std::uint32_t number, std::size_t at,
                       std::uint32_t& triangle) noexcept;
  void write_triangle(const TransformedShape& body, std::uint32_t number, std::size_t at,
                      std::uint32_t triangle) noexcept;

  // The shape of a body may have been removed: then the body has no pairs.
  [[nodiscard]] bool is_there(std::uint32_t body) const noexcept {
    if (body >= bodies_.shapes.size() || body >= bodies_.poses.size()) return false;
    const ShapeId shape = bodies_.shapes[body];
    if (shape.is_composite()) return all_.contains(shape);
    const std::uint32_t kind = shape.kind_index();
    return kind < kShapeKinds && shape.index() < tables_.count[kind];
  }
  [[nodiscard]] TransformedShape placed(std::uint32_t body, std::uint32_t origin) const noexcept {
    const auto position = as_eigen(bodies_.poses[body].position);
    const auto from = as_eigen(bodies_.poses[origin].position);
    return TransformedShape(all_, tables_, bodies_.shapes[body], bodies_.poses[body],
                            body == origin ? Vec(Vec::Zero()) : finite(position - from));
  }
  [[nodiscard]] ChunkRecord* records() const noexcept {
    return reinterpret_cast<ChunkRecord*>(out_.scratch.data());
  }
  /// Number of primitives of each pair of bodies.
  [[nodiscard]] std::uint32_t* primitive_counts() const noexcept {
    const std::uint64_t records =
        BumpAllocator::blocks_for(chunks_ * sizeof(ChunkRecord) / sizeof(std::uint32_t));
    return out_.scratch.data() + records * BumpAllocator::kBlock;
  }
  [[nodiscard]] std::uint32_t* blocks() const noexcept {
    return out_.scratch.data() + head_ * BumpAllocator::kBlock;
  }

  const Composites& all_;
  const ShapeTables& tables_;
  const Bodies& bodies_;
  std::span<const BodyPair> pairs_;
  const PairMargins& margins_;
  PrimitivePairs& out_;
  std::uint32_t pool_hulls_;
  std::size_t chunks_;
  std::uint64_t head_;
};

Status PrimitivePairFinder::run(const Execution& execution) noexcept {
  if (!out_.first.resize(pairs_.size() + 1)) return Status::out_of_memory;
  out_.first[0] = 0;
  if (!copy_hulls() || !search_all(execution)) return Status::out_of_memory;
  const Status status = count();
  if (status != Status::ok) return status;
  execution.for_each(chunks_, [&](std::size_t chunk) { write(chunk); });
  return Status::ok;
}

// The narrow phase reads the hulls of the pool and of convex solids from one table.
bool PrimitivePairFinder::copy_hulls() noexcept {
  const Column<HullShape>& own = all_.hulls.entries;
  if (own.empty()) return true;
  if (!out_.hulls.resize(pool_hulls_ + own.size())) return false;
  std::copy_n(tables_.hulls, pool_hulls_, out_.hulls.begin());
  std::copy(own.begin(), own.end(), out_.hulls.begin() + pool_hulls_);
  return true;
}

bool PrimitivePairFinder::search_all(const Execution& execution) noexcept {
  // A chunk that finds anything uses at least one block for primitives and one for pairs.
  std::uint64_t blocks = 2 * chunks_;
  while (true) {
    const std::uint64_t words = (head_ + blocks) * BumpAllocator::kBlock;
    if (!std::in_range<std::size_t>(words)) return false;
    if (!out_.scratch.resize(static_cast<std::size_t>(words))) return false;
    // Use all memory that the column has, so that a later call with as many results searches only
    // once.
    blocks = out_.scratch.capacity() / BumpAllocator::kBlock - head_;
    BumpAllocator arena(this->blocks(), blocks);
    execution.for_each(chunks_, [&](std::size_t chunk) { search(chunk, arena); });
    if (arena.was_enough()) return true;
    blocks = std::max(arena.requested(), blocks + blocks / 2);
  }
}

void PrimitivePairFinder::search(std::size_t chunk, BumpAllocator& arena) noexcept {
  PrimitivePairSearch search(arena);
  const std::size_t end = std::min((chunk + 1) * kPairsPerTask, pairs_.size());
  for (std::size_t i = chunk * kPairsPerTask; i < end; ++i) {
    const std::uint64_t primitives = search.primitives().size();
    const std::uint64_t found = search.pairs().size();
    if (is_there(pairs_[i].a) && is_there(pairs_[i].b)) {
      search.run(placed(pairs_[i].a, pairs_[i].a), placed(pairs_[i].b, pairs_[i].a),
                 margins_.of(i));
    }
    primitive_counts()[i] = static_cast<std::uint32_t>(search.primitives().size() - primitives);
    out_.first[i + 1] = static_cast<std::uint32_t>((search.pairs().size() - found) / 2);
  }
  records()[chunk] = {search.primitives().first_block(),
                      search.pairs().first_block(),
                      static_cast<std::uint32_t>(search.primitives().size()),
                      static_cast<std::uint32_t>(search.triangles()),
                      static_cast<std::uint32_t>(search.pairs().size() / 2),
                      0,
                      0,
                      0};
}

Status PrimitivePairFinder::count() noexcept {
  std::uint64_t primitives = 0;
  std::uint64_t triangles = 0;
  std::uint64_t pairs = 0;
  for (std::size_t chunk = 0; chunk < chunks_; ++chunk) {
    ChunkRecord& record = records()[chunk];
    record.first_primitive = static_cast<std::uint32_t>(primitives);
    record.first_triangle = static_cast<std::uint32_t>(triangles);
    record.first_pair = static_cast<std::uint32_t>(pairs);
    primitives += record.primitives;
    triangles += record.triangles;
    pairs += record.pairs;
  }
  constexpr std::uint64_t kMaxShapeTriangles = std::uint64_t{1} << ShapeId::kIndexBits;
  if (triangles > kMaxShapeTriangles || primitives >> 32U != 0 || pairs >> 32U != 0) {
    return Status::too_many_objects;
  }
  for (std::size_t i = 0; i < pairs_.size(); ++i) out_.first[i + 1] += out_.first[i];
  const auto shapes = static_cast<std::size_t>(primitives);
  const auto corners = static_cast<std::size_t>(triangles);
  const bool ok = out_.shapes.resize(shapes) && out_.poses.resize(shapes) &&
                  out_.part.resize(shapes) && out_.triangles.resize(corners) &&
                  out_.active_edges.resize(corners) &&
                  out_.pairs.resize(static_cast<std::size_t>(pairs));
  return ok ? Status::ok : Status::out_of_memory;
}

void PrimitivePairFinder::write(std::size_t chunk) noexcept {
  const ChunkRecord& record = records()[chunk];
  WordReader primitives(blocks(), record.primitive_block);
  WordReader pairs(blocks(), record.pair_block);
  std::size_t at = record.first_primitive;
  std::uint32_t triangle = record.first_triangle;
  const std::size_t end = std::min((chunk + 1) * kPairsPerTask, pairs_.size());
  for (std::size_t i = chunk * kPairsPerTask; i < end; ++i) {
    const std::uint32_t count = primitive_counts()[i];
    if (count == 0) continue;
    const TransformedShape a = placed(pairs_[i].a, pairs_[i].a);
    const TransformedShape b = placed(pairs_[i].b, pairs_[i].a);
    ChildOfPart of_a(a);
    ChildOfPart of_b(b);
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t word = primitives.get();
      std::uint32_t number = word & ~PrimitivePairSearch::kSecond;
      const TransformedShape& body =
          ((word & PrimitivePairSearch::kSecond) != 0 ? of_b : of_a).find(number);
      write_primitive(body, number, at++, triangle);
    }
  }
  for (std::uint32_t i = 0; i < record.pairs; ++i) {
    const std::uint32_t a = pairs.get();
    const std::uint32_t b = pairs.get();
    out_.pairs[record.first_pair + i] = {record.first_primitive + a, record.first_primitive + b};
  }
}

void PrimitivePairFinder::write_primitive(const TransformedShape& body, std::uint32_t number,
                                          std::size_t at, std::uint32_t& triangle) noexcept {
  if (body.is_surface()) return write_triangle(body, number, at, triangle++);
  const PlacedPart part = body.part(number);
  ShapeId shape = part.shape;
  if (body.is_solid_hull()) {
    shape = ShapeId::of(ShapeKind::hull, pool_hulls_ + shape.index());
  } else if (shape.kind() == ShapeKind::triangle) {
    out_.triangles[triangle] = tables_.triangles[shape.index()];
    out_.active_edges[triangle] = PrimitivePairs::kAllActive;
    shape = ShapeId::of(ShapeKind::triangle, triangle++);
  }
  out_.shapes[at] = shape;
  out_.poses[at] = pose_of(part.position, body.part_turn(number));
  out_.part[at] = body.shown_number(number);
}

void PrimitivePairFinder::write_triangle(const TransformedShape& body, std::uint32_t number,
                                         std::size_t at, std::uint32_t triangle) noexcept {
  Corners corners;
  static_cast<void>(body.corners(number, corners));
  out_.triangles[triangle] = corners.triangle();
  out_.shapes[at] = ShapeId::of(ShapeKind::triangle, triangle);
  out_.poses[at] = pose_of(corners.first, {1.0, 0.0, 0.0, 0.0});
  std::uint32_t bits = body.active(number);
  if (body.front != 0) bits |= PrimitivePairs::kOneSided;
  if (body.front < 0) bits |= PrimitivePairs::kClockwise;
  out_.active_edges[triangle] = static_cast<std::uint8_t>(bits);
  out_.part[at] = body.shown_number(number);
}

}  // namespace

Status find_primitive_pairs(const CompositePool& pool, const ShapePool& shapes,
                            const Bodies& bodies, std::span<const BodyPair> pairs,
                            const PairMargins& margins, const Execution& execution,
                            PrimitivePairs& out) {
  const StageScope stage(WorkStage::mid_phase);
  const Composites* const all = PoolAccess::composites(pool);
  out.clear();
  if (pairs.empty() || all == nullptr) {
    if (!out.first.resize(pairs.size() + 1)) return Status::out_of_memory;
    std::fill(out.first.begin(), out.first.end(), 0U);
    return Status::ok;
  }
  const Status status =
      PrimitivePairFinder(*all, shapes.tables(), bodies, pairs, margins, out).run(execution);
  if (status != Status::ok) out.clear();
  return status;
}

}  // namespace winnow::mid
