#include <winnow/pipeline/narrow_phase.h>
#include "core/hooks/stage_scope.h"
#include "core/memory/columns.h"
#include "core/memory/new_in.h"
#include "core/sort/stretches.h"
#include "core/threads/float_environment.h"
#include "pipeline/narrow/question.h"
#include "pipeline/shapes/pair_order.h"
#include "pipeline/solver/solver.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <numeric>
#include <type_traits>
#include <utility>

namespace winnow {
namespace {

constexpr std::uint32_t kTopBit = 1U << 31U;
constexpr std::uint8_t kMirrored = 0x80;

/// Of the kinds of two shapes the number of their pair, with kMirrored if they are given the other
/// way round.
struct KindCodes {
  static constexpr std::uint32_t kKinds = ShapeId{}.kind_index() + 1;
  std::uint8_t of[kKinds][kKinds] = {};

  constexpr KindCodes() {
    for (std::uint32_t a = 0; a < kShapeKinds; ++a) {
      for (std::uint32_t b = 0; b < kShapeKinds; ++b) {
        const std::uint32_t code = KindPairs::index(std::min(a, b), std::max(a, b));
        of[a][b] = static_cast<std::uint8_t>(code | (a > b ? kMirrored : 0U));
      }
    }
  }
};
constexpr KindCodes kKindCodes;

// The length of the stretches of so many pairs that tasks look at.
[[nodiscard]] constexpr std::size_t stretch_of(std::size_t pairs) noexcept {
  constexpr std::size_t kLeast = 16384;
  constexpr std::size_t kMostStretches = 64;
  return even_stretch(pairs, kLeast, kMostStretches);
}

// True if all of a, b < limit <= 2^31: sums and ors alone, so that every compiler makes it wide.
[[nodiscard]] bool all_below(std::span<const BodyPair> pairs, std::uint32_t limit) noexcept {
  std::uint32_t outside = 0;
  for (const BodyPair& pair : pairs) {
    outside |= pair.a | pair.b | (limit - 1 - pair.a) | (limit - 1 - pair.b);
  }
  return (outside & kTopBit) == 0;
}

// The only kind that a pool holds, or kShapeKinds.
[[nodiscard]] std::uint32_t only_kind(const ShapeTables& tables) noexcept {
  std::uint32_t only = kShapeKinds;
  for (std::uint32_t kind = 0; kind < kShapeKinds; ++kind) {
    if (tables.count[kind] == 0) continue;
    if (only != kShapeKinds) return kShapeKinds;
    only = kind;
  }
  return only;
}

[[nodiscard]] bool all_are(std::span<const ShapeId> shapes, std::uint32_t kind, std::uint32_t limit,
                           const Execution& execution) noexcept {
  constexpr std::size_t kShapesPerTask = 65536;
  const std::uint32_t base = kind << ShapeId::kIndexBits;
  std::atomic<std::uint32_t> any_outside{0};
  for_even_stretches(
      execution, shapes.size(), kShapesPerTask, [&](std::size_t first, std::size_t end) {
        std::uint32_t outside = 0;
        for (const ShapeId& id : shapes.subspan(first, end - first)) {  // no copy: not made wide
          const std::uint32_t index = id.bits - base;
          outside |= index | (limit - 1 - index);
        }
        any_outside.fetch_or(outside, std::memory_order_relaxed);
      });
  return (any_outside.load(std::memory_order_relaxed) & kTopBit) == 0;
}

}  // namespace

/// Pairs sorted by the kinds of their shapes (stable), the smaller kind first in each.
class PairBuckets {
 public:
  explicit PairBuckets(std::pmr::memory_resource* memory) noexcept
      : sorted_(memory), codes_(memory), looks_(memory) {}

  /// Sorts, or finds that nothing is to be sorted. `order` is set to the place of each sorted pair
  /// in the input. `invalid_argument` for a body that does not exist, `invalid_key` for a shape
  /// that does not (`bad_body` says whose).
  Status sort(const ShapeTables& tables, std::span<const ShapeId> shapes,
              std::span<const BodyPair> pairs, const Execution& execution,
              Column<std::uint32_t>& order, Column<NarrowRun>& runs, std::uint32_t& bad_body);

  [[nodiscard]] const BodyPair* pairs() const noexcept { return pairs_; }
  /// True if some pair is given the other way round than it was.
  [[nodiscard]] bool any_mirrored() const noexcept { return any_mirrored_; }
  [[nodiscard]] Bytes bytes() const noexcept { return bytes_of(sorted_, codes_, looks_); }

 private:
  /// Numbers of pairs of kinds, from the lowest to the highest that there is.
  struct Codes {
    std::uint32_t low = KindPairs::kCount;
    std::uint32_t high = 0;

    void add(std::uint32_t code) noexcept {
      low = std::min(low, code);
      high = std::max(high, code);
    }
  };
  /// What a task found that looked at a stretch of the pairs.
  struct Look {
    Status status;
    std::uint32_t bad_body;
    std::uint32_t mirrored;
    Codes codes;
    /// Of each pair of kinds. Where pairs are sorted, later: where the next of it goes.
    std::uint32_t counts[KindPairs::kCount];

    void clear() noexcept {
      status = Status::ok;
      mirrored = 0;
      codes = {};
      std::ranges::fill(counts, 0U);
    }
    void add(std::uint32_t code, std::uint32_t pairs) noexcept {
      counts[code] += pairs;
      codes.add(code);
    }
  };

  Status take_one(const ShapeTables& tables, std::span<const ShapeId> shapes,
                  std::span<const BodyPair> pair, Column<std::uint32_t>& order,
                  Column<NarrowRun>& runs, std::uint32_t& bad_body);
  template <typename Body>
  void for_looks(std::span<const BodyPair> pairs, const Execution& execution, Body&& body);
  template <typename Note>
  void for_codes(const ShapeTables& tables, std::span<const ShapeId> shapes,
                 std::span<const BodyPair> pairs, std::size_t first, Look& look,
                 Note&& note) noexcept;
  void look_at(const ShapeTables& tables, std::span<const ShapeId> shapes,
               std::span<const BodyPair> pairs, std::size_t first, Look& look) noexcept;
  Status sum_up(std::uint32_t& bad_body) noexcept;
  void find_places() noexcept;
  void place(std::span<const BodyPair> pairs, std::size_t first, Look& look,
             std::uint32_t* order) noexcept;
  Status add_runs(Column<NarrowRun>& runs) const;

  Column<BodyPair> sorted_;
  Column<std::uint8_t> codes_;
  Column<Look> looks_;
  std::uint32_t counts_[KindPairs::kCount] = {};
  Codes there_;
  const BodyPair* pairs_ = nullptr;
  bool any_mirrored_ = false;
};

Status PairBuckets::sort(const ShapeTables& tables, std::span<const ShapeId> shapes,
                         std::span<const BodyPair> pairs, const Execution& execution,
                         Column<std::uint32_t>& order, Column<NarrowRun>& runs,
                         std::uint32_t& bad_body) {
  runs.clear();
  any_mirrored_ = false;
  pairs_ = pairs.data();
  if (shapes.size() >= kTopBit) return Status::invalid_argument;
  if (pairs.size() == 1) return take_one(tables, shapes, pairs, order, runs, bad_body);
  std::ranges::fill(counts_, 0U);
  there_ = {};
  // A scene of one kind needs no look at every pair, unless these are few among many bodies.
  constexpr std::size_t kLook = 8;  // at a pair takes as long as at so many bodies
  const std::uint32_t only =
      shapes.size() / kLook <= pairs.size() ? only_kind(tables) : kShapeKinds;
  const bool one_kind = only != kShapeKinds && all_are(shapes, only, tables.count[only], execution);
  const std::size_t looks =
      (pairs.size() + stretch_of(pairs.size()) - 1) / stretch_of(pairs.size());
  if (!order.resize(pairs.size()) || !looks_.resize(looks) ||
      (!one_kind && !codes_.resize(pairs.size()))) {
    return Status::out_of_memory;
  }
  for_looks(pairs, execution, [&](std::span<const BodyPair> some, std::size_t first, Look& look) {
    look.clear();
    std::iota(order.data() + first, order.data() + first + some.size(),
              static_cast<std::uint32_t>(first));
    if (!all_below(some, static_cast<std::uint32_t>(shapes.size()))) {
      look.status = Status::invalid_argument;
    } else if (one_kind) {
      look.add(KindPairs::index(only, only), static_cast<std::uint32_t>(some.size()));
    } else {
      look_at(tables, shapes, some, first, look);
    }
  });
  if (const Status status = sum_up(bad_body); status != Status::ok) return status;
  if (there_.low >= there_.high && !any_mirrored_) return add_runs(runs);
  if (!sorted_.resize(pairs.size())) return Status::out_of_memory;
  find_places();
  for_looks(pairs, execution, [&](std::span<const BodyPair> some, std::size_t first, Look& look) {
    place(some, first, look, order.data());
  });
  pairs_ = sorted_.data();
  return add_runs(runs);
}

// Of one pair there is nothing to count, which takes several times as long as some answers do.
Status PairBuckets::take_one(const ShapeTables& tables, std::span<const ShapeId> shapes,
                             std::span<const BodyPair> pair, Column<std::uint32_t>& order,
                             Column<NarrowRun>& runs, std::uint32_t& bad_body) {
  BodyPair own = pair.front();
  if (own.a >= shapes.size() || own.b >= shapes.size()) return Status::invalid_argument;
  for (const std::uint32_t body : {own.a, own.b}) {
    if (holds(tables, shapes[body])) continue;
    bad_body = body;
    return Status::invalid_key;
  }
  any_mirrored_ = shapes[own.a].kind_index() > shapes[own.b].kind_index();
  if (any_mirrored_) {
    std::swap(own.a, own.b);
    if (!sorted_.resize(1)) return Status::out_of_memory;
    sorted_[0] = own;
    pairs_ = sorted_.data();
  }
  if (!order.resize(1)) return Status::out_of_memory;
  order[0] = 0;
  if (!runs.resize(1)) return Status::out_of_memory;
  // In place, member by member: a copy of what was just put together would wait for its stores.
  NarrowRun& run = runs[0];
  run.a = shapes[own.a].kind();
  run.b = shapes[own.b].kind();
  run.first = 0;
  run.count = 1;
  return Status::ok;
}

// Calls body(pairs, the number of the first, look) for each stretch of the pairs.
template <typename Body>
void PairBuckets::for_looks(std::span<const BodyPair> pairs, const Execution& execution,
                            Body&& body) {
  const std::size_t length = stretch_of(pairs.size());
  for_stretches(execution, pairs.size(), length, [&](std::size_t first, std::size_t end) {
    body(pairs.subspan(first, end - first), first, looks_[first / length]);
  });
}

// Calls note(i, code) for all pairs, of bodies that exist, unless a shape does not.
template <typename Note>
void PairBuckets::for_codes(const ShapeTables& tables, std::span<const ShapeId> shapes,
                            std::span<const BodyPair> pairs, std::size_t first, Look& look,
                            Note&& note) noexcept {
  std::uint32_t limit[KindCodes::kKinds] = {};
  std::copy_n(tables.count, kShapeKinds, limit);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ShapeId a = shapes[pairs[i].a];
    const ShapeId b = shapes[pairs[i].b];
    if (a.index() >= limit[a.kind_index()] || b.index() >= limit[b.kind_index()]) [[unlikely]] {
      look.bad_body = a.index() >= limit[a.kind_index()] ? pairs[i].a : pairs[i].b;
      look.status = Status::invalid_key;
      return;
    }
    const std::uint8_t code = kKindCodes.of[a.kind_index()][b.kind_index()];
    note(i, code);
    codes_[first + i] = code;
  }
}

void PairBuckets::look_at(const ShapeTables& tables, std::span<const ShapeId> shapes,
                          std::span<const BodyPair> pairs, std::size_t first, Look& look) noexcept {
  constexpr std::size_t kFew = 192;
  if (pairs.size() < kFew) {
    return for_codes(tables, shapes, pairs, first, look, [&](std::size_t, std::uint32_t code) {
      look.add(code & (kMirrored - 1U), 1);
      look.mirrored += code / kMirrored;
    });
  }
  // They take turns: where one kind of pair follows itself, none waits for the count before.
  constexpr std::size_t kTurns = 2;
  std::uint32_t counts[kTurns][kMirrored + KindPairs::kCount];
  for (auto& some : counts) std::ranges::fill(some, 0U);
  for_codes(tables, shapes, pairs, first, look,
            [&](std::size_t i, std::uint32_t code) { ++counts[i % kTurns][code]; });
  for (std::uint32_t code = 0; code < KindPairs::kCount; ++code) {
    const std::uint32_t mirrored = counts[0][code | kMirrored] + counts[1][code | kMirrored];
    const std::uint32_t all = counts[0][code] + counts[1][code] + mirrored;
    if (all != 0) look.add(code, all);
    look.mirrored += mirrored;
  }
}

// A body that does not exist comes before a shape that does not, and is not told.
Status PairBuckets::sum_up(std::uint32_t& bad_body) noexcept {
  const Look* refused = nullptr;
  for (const Look& look : looks_) {
    if (look.status == Status::invalid_argument) return Status::invalid_argument;
    if (refused == nullptr && look.status != Status::ok) refused = &look;
    any_mirrored_ = any_mirrored_ || look.mirrored != 0;
    for (std::uint32_t code = look.codes.low; code <= look.codes.high; ++code) {
      counts_[code] += look.counts[code];
    }
    there_.low = std::min(there_.low, look.codes.low);
    there_.high = std::max(there_.high, look.codes.high);
  }
  if (refused == nullptr) return Status::ok;
  bad_body = refused->bad_body;
  return refused->status;
}

// Tells every look where its pairs go.
void PairBuckets::find_places() noexcept {
  std::uint32_t next = 0;
  for (std::uint32_t code = there_.low; code <= there_.high; ++code) {
    for (Look& look : looks_) next += std::exchange(look.counts[code], next);
  }
}

void PairBuckets::place(std::span<const BodyPair> pairs, std::size_t first, Look& look,
                        std::uint32_t* order) noexcept {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::uint32_t code = codes_[first + i];
    const std::uint32_t at = look.counts[code & (kMirrored - 1U)]++;
    const BodyPair pair = pairs[i];
    sorted_[at] = (code & kMirrored) != 0 ? BodyPair{pair.b, pair.a} : pair;
    order[at] = static_cast<std::uint32_t>(first + i);
  }
}

Status PairBuckets::add_runs(Column<NarrowRun>& runs) const {
  std::uint32_t first = 0;
  for (std::uint32_t code = there_.low; code <= there_.high; ++code) {
    if (counts_[code] == 0) continue;
    const NarrowRun run{static_cast<ShapeKind>(KindPairs::first(code)),
                        static_cast<ShapeKind>(KindPairs::second(code)), first, counts_[code]};
    if (!runs.push_back(run)) return Status::out_of_memory;
    first += counts_[code];
  }
  return Status::ok;
}

namespace {

// Chunks that parallel tasks answer before their contacts are put in order: bounds how many of the
// contacts are held twice.
constexpr std::size_t kWave = 64;
/// Of more, poses take four megabytes and beyond. Of 20,000 to 40,000 to ask ahead costs up to a
/// fifth of a cheap pair's time, of 80,000 and more it saves a fifth to a half.
constexpr std::size_t kManyBodies = 65536;

// Room for the contacts that a chunk of so many pairs may find, and for what kernels write behind
// the last one: another chunk's may begin there.
[[nodiscard]] std::size_t room_for(std::size_t pairs) noexcept {
  return pairs * kManifoldPoints + kContactSlack;
}
// The same for any wave of so many chunks, of so many pairs in all: as many pairs of other kinds
// need no more.
[[nodiscard]] std::size_t room_for_wave(std::size_t pairs, std::size_t chunks) noexcept {
  return std::min(pairs, kWave * kJobPairs) * kManifoldPoints + chunks * kContactSlack;
}
// The same for the largest chunk that there may be of so many pairs in all.
[[nodiscard]] std::size_t most_room_for(std::size_t pairs) noexcept {
  return room_for(std::min<std::size_t>(kJobPairs, pairs));
}

template <typename T>
[[nodiscard]] T* offset(T* column, std::size_t first) noexcept {
  return column == nullptr ? nullptr : column + first;
}

/// What became of a job.
struct ChunkOutcome {
  std::uint32_t contacts = 0;
  std::uint32_t uncertified = 0;
  /// The smallest body with an invalid pose, or ~0U.
  std::uint32_t bad_body = ~0U;
  SolverCounts solver;
};

/// Pairs of one kind, next to each other, that one task answers.
struct Chunk {
  NarrowJob job;
  NarrowKernel kernel;
  std::uint32_t first;
  ChunkOutcome outcome;
  /// Where its contacts begin among those of a wave.
  std::size_t contacts_from = 0;
};

/// Chunks that are answered together. A call of few pairs makes no more than it needs.
class Wave {
 public:
  /// The job is the caller's to fill in: to make it zero takes as long as some answers do.
  [[nodiscard]] Chunk& add() noexcept { return *new (first() + size_++) Chunk; }
  void clear() noexcept { size_ = 0; }
  [[nodiscard]] bool full() const noexcept { return size_ == kWave; }
  [[nodiscard]] std::span<Chunk> chunks() noexcept { return {first(), size_}; }

 private:
  static_assert(std::is_trivially_destructible_v<Chunk>);
  [[nodiscard]] Chunk* first() noexcept { return reinterpret_cast<Chunk*>(room_); }

  std::size_t size_ = 0;
  alignas(Chunk) std::byte room_[kWave * sizeof(Chunk)];
};

void write_contacts(const NarrowJob& job, std::uint32_t i, const PairAnswer& answer,
                    ContactWriter& contacts) noexcept {
  job.contact_first[i] = contacts.size;
  job.contact_count[i] = answer.contact_count;
  for (std::uint32_t k = 0; k < answer.contact_count; ++k) {
    const ContactPoint& point = answer.contacts[k];
    for (int axis = 0; axis < 3; ++axis) {
      contacts.position[axis][contacts.size] = point.position[axis];
    }
    contacts.depth[contacts.size] = point.depth;
    contacts.feature[contacts.size] = point.feature;
    ++contacts.size;
  }
}

void write_answer(NarrowJob& job, ContactLevel level, std::uint32_t i,
                  const PairAnswer& answer) noexcept {
  if (level == ContactLevel::boolean) {
    job.overlap[i] = answer.overlap ? 1 : 0;
    return;
  }
  job.distance[i] = answer.distance;
  job.error_bound[i] = answer.error_bound;
  for (int axis = 0; axis < 3; ++axis) job.normal[axis][i] = answer.normal[axis];
  if (level == ContactLevel::manifold) return write_contacts(job, i, answer, job.contacts);
  for (int axis = 0; axis < 3; ++axis) job.point[axis][i] = answer.point[axis];
}

/// Answers a job: by `kernel` (null: there is none), then one by one what it could not certify.
void answer_job(NarrowJob& job, ContactLevel level, NarrowKernel kernel,
                ChunkOutcome& outcome) noexcept {
  std::uint32_t uncertified[kJobPairs];
  if (kernel != nullptr) {
    job.uncertified = uncertified;
    outcome.uncertified = kernel(job);
  } else {
    std::iota(uncertified, uncertified + job.count, 0U);
    outcome.uncertified = job.count;
  }
  for (std::uint32_t k = 0; k < outcome.uncertified; ++k) {
    const std::uint32_t i = uncertified[k];
    const BodyPair pair = job.pairs[i];
    const Pose& a = job.poses[pair.a];
    const Pose& b = job.poses[pair.b];
    if (!a.is_valid() || !b.is_valid()) [[unlikely]] {
      if (!a.is_valid()) outcome.bad_body = std::min(outcome.bad_body, pair.a);
      if (!b.is_valid()) outcome.bad_body = std::min(outcome.bad_body, pair.b);
      continue;
    }
    const PairAnswer answer = solve_pair(*job.tables, job.shapes[pair.a], a, job.shapes[pair.b], b,
                                         level, job.margin_of(i), outcome.solver);
    write_answer(job, level, i, answer);
  }
  outcome.contacts = job.contacts.size;
}

/// Answer i of a job becomes that about (b, a).
void mirror_answer(const NarrowJob& job, ContactLevel level, std::uint32_t i) noexcept {
  if (level == ContactLevel::boolean) return;
  const double* const a = job.poses[job.pairs[i].a].position;
  const double* const b = job.poses[job.pairs[i].b].position;
  for (int axis = 0; axis < 3; ++axis) {
    const double apart = b[axis] - a[axis];
    if (level == ContactLevel::distance) {
      double& x = job.point[axis][i];
      x = mirrored_point(x, job.distance[i] * job.normal[axis][i], apart);
    } else {
      float* const column = job.contacts.position[axis] + job.contact_first[i];
      for (std::uint32_t k = 0; k < job.contact_count[i]; ++k) {
        column[k] = mirrored_position(column[k], apart);
      }
    }
    job.normal[axis][i] = -job.normal[axis][i];
  }
  if (level != ContactLevel::manifold) return;
  std::uint64_t* const feature = job.contacts.feature + job.contact_first[i];
  for (std::uint32_t k = 0; k < job.contact_count[i]; ++k) {
    feature[k] = mirrored_feature(feature[k]);
  }
}

/// What `collide` was given, and what it tells beside answers, in place: who copies counters waits
/// until they are stored.
struct Call {
  const ShapeTables& tables;
  const Bodies& bodies;
  std::span<const BodyPair> pairs;
  const NarrowOptions& options;
  NarrowStatistics& statistics;
  std::uint32_t& bad_body;

  void answer(Chunk& chunk, const NarrowResult& result, bool any_mirrored) const noexcept {
    // Not set if all pairs have one margin: that would take as long as some answers do.
    double margins[kJobPairs];
    if (!options.margins.empty()) {
      for (std::uint32_t i = 0; i < chunk.job.count; ++i) {
        margins[i] = options.margins[result.pair_of(chunk.first + i)];
      }
      std::fill(margins + chunk.job.count, margins + kJobPairs, 0.0);
      chunk.job.margins = margins;
    }
    answer_job(chunk.job, options.level, chunk.kernel, chunk.outcome);
    if (!any_mirrored) return;
    for (std::uint32_t i = 0; i < chunk.job.count; ++i) {
      const BodyPair& given = pairs[result.pair_of(chunk.first + i)];
      if (given.a != chunk.job.pairs[i].a) mirror_answer(chunk.job, options.level, i);
    }
  }
};

[[nodiscard]] ContactWriter writer_to(ContactColumns& to, std::size_t from) noexcept {
  return {
      {to.position[0].data() + from, to.position[1].data() + from, to.position[2].data() + from},
      to.depth.data() + from,
      to.feature.data() + from,
      0};
}

}  // namespace

struct NarrowPhase::State {
  explicit State(std::pmr::memory_resource* memory) noexcept : buckets(memory), scratch(memory) {}

  [[nodiscard]] Status collide(const Call& call, NarrowResult& result);
  [[nodiscard]] Status run(const Call& call, NarrowResult& result);
  void begin(Chunk& chunk, const Call& call, NarrowResult& result, std::uint32_t first,
             std::uint32_t count) const noexcept;
  [[nodiscard]] bool answer_wave(const Call& call, std::span<Chunk> wave, NarrowResult& result);
  static void take_contacts(const Chunk& chunk, NarrowResult& result) noexcept;
  [[nodiscard]] bool gather_contacts(const Call& call, std::span<const Chunk> wave,
                                     NarrowResult& result);

  PairBuckets buckets;
  ContactColumns scratch;
};

NarrowPhase::~NarrowPhase() {
  delete_in(memory_, state_);
}

NarrowPhase::NarrowPhase(NarrowPhase&& other) noexcept
    : memory_(other.memory_),
      state_(std::exchange(other.state_, nullptr)),
      statistics_(std::exchange(other.statistics_, {})),
      bad_body_(std::exchange(other.bad_body_, 0)) {}

Status NarrowPhase::collide(const ShapePool& shapes, const Bodies& bodies,
                            std::span<const BodyPair> pairs, const NarrowOptions& options,
                            NarrowResult& result) {
  return collide(shapes.tables(), bodies, pairs, options, result);
}

Status NarrowPhase::collide(const ShapeTables& tables, const Bodies& bodies,
                            std::span<const BodyPair> pairs, const NarrowOptions& options,
                            NarrowResult& result) {
  const DefaultEnvironment environment;
  const StageScope stage(WorkStage::narrow_phase);
  statistics_ = {};
  bad_body_ = ~0U;
  if (state_ == nullptr) state_ = new_in<State>(memory_, memory_);
  Status status = Status::out_of_memory;
  if (state_ != nullptr) {
    const Call call{tables, bodies, pairs, options, statistics_, bad_body_};
    status = state_->collide(call, result);
  }
  if (status != Status::ok) result.clear();
  return status;
}

Status NarrowPhase::State::collide(const Call& call, NarrowResult& result) {
  const NarrowOptions& options = call.options;
  const bool are_matched = call.bodies.shapes.size() == call.bodies.poses.size() &&
                           (options.margins.empty() || options.margins.size() == call.pairs.size());
  if (!are_matched) return Status::size_mismatch;
  if (!can_be_asked(options)) return Status::invalid_argument;
  const Status status = buckets.sort(call.tables, call.bodies.shapes, call.pairs, options.execution,
                                     result.order_, result.runs_, call.bad_body);
  if (status != Status::ok) return status;
  return result.resize(call.pairs.size(), options.level) ? run(call, result)
                                                         : Status::out_of_memory;
}

Status NarrowPhase::State::run(const Call& call, NarrowResult& result) {
  Wave wave;
  for (const NarrowRun& run : result.runs()) {
    const NarrowKernel kernel = kernel_for(run.a, run.b, call.options);
    if (kernel == nullptr) call.statistics.without_lanes += run.count;
    for (std::uint32_t at = 0; at < run.count; at += kJobPairs) {
      Chunk& chunk = wave.add();
      chunk.kernel = kernel;
      begin(chunk, call, result, run.first + at, std::min(kJobPairs, run.count - at));
      if (!wave.full()) continue;
      if (!answer_wave(call, wave.chunks(), result)) return Status::out_of_memory;
      wave.clear();
    }
  }
  if (!answer_wave(call, wave.chunks(), result)) return Status::out_of_memory;
  // Chunks write where there is room for all that they may find: with this much, a call that finds
  // no more than this one needs no more room, wherever in it its contacts are.
  if (call.options.level == ContactLevel::manifold && call.options.execution.concurrency() == 1 &&
      !result.contacts_.grow(result.contacts() + most_room_for(call.pairs.size()))) {
    return Status::out_of_memory;
  }
  call.statistics.pairs = call.pairs.size();
  return call.bad_body == ~0U ? Status::ok : Status::invalid_pose;
}

void NarrowPhase::State::begin(Chunk& chunk, const Call& call, NarrowResult& result,
                               std::uint32_t first, std::uint32_t count) const noexcept {
  chunk.first = first;
  NarrowJob& job = chunk.job;
  job.pairs = buckets.pairs() + first;
  job.count = count;
  job.shapes = call.bodies.shapes.data();
  job.poses = call.bodies.poses.data();
  job.has_many_bodies = call.bodies.poses.size() > kManyBodies;
  job.tables = &call.tables;
  job.margin = call.options.margin;
  job.margins = nullptr;
  job.overlap = offset(result.overlap_.data(), first);
  job.beyond_doubt = false;
  job.distance = offset(result.distance_.data(), first);
  job.error_bound = offset(result.error_bound_.data(), first);
  for (int axis = 0; axis < 3; ++axis) {
    job.normal[axis] = offset(result.normal_[axis].data(), first);
    job.point[axis] = offset(result.point_[axis].data(), first);
  }
  job.contact_first = offset(result.contact_first_.data(), first);
  job.contact_count = offset(result.contact_count_.data(), first);
  job.contacts = {};
}

bool NarrowPhase::State::answer_wave(const Call& call, std::span<Chunk> wave,
                                     NarrowResult& result) {
  const bool manifold = call.options.level == ContactLevel::manifold;
  const bool any_mirrored = buckets.any_mirrored();
  if (!manifold && wave.size() == 1) {
    call.answer(wave.front(), result, any_mirrored);
  } else if (!manifold) {
    call.options.execution.for_each(
        wave.size(), [&](std::size_t i) { call.answer(wave[i], result, any_mirrored); });
  } else if (call.options.execution.concurrency() == 1) {
    const std::size_t room = most_room_for(call.pairs.size());
    for (Chunk& chunk : wave) {
      if (!result.contacts_.grow(result.contacts() + room)) return false;
      chunk.job.contacts = writer_to(result.contacts_, result.contacts());
      call.answer(chunk, result, any_mirrored);
      take_contacts(chunk, result);
    }
  } else {
    std::size_t from = 0;
    for (Chunk& chunk : wave) {
      chunk.contacts_from = from;
      from += room_for(chunk.job.count);
    }
    if (!scratch.grow(room_for_wave(call.pairs.size(), wave.size()))) return false;
    call.options.execution.for_each(wave.size(), [&](std::size_t i) {
      wave[i].job.contacts = writer_to(scratch, wave[i].contacts_from);
      call.answer(wave[i], result, any_mirrored);
    });
    if (!gather_contacts(call, wave, result)) return false;
  }
  for (const Chunk& chunk : wave) {
    if (chunk.kernel != nullptr) call.statistics.recomputed += chunk.outcome.uncertified;
    call.statistics.exact += chunk.outcome.solver.exact;
    call.statistics.bounded += chunk.outcome.solver.bounded;
    call.bad_body = std::min(call.bad_body, chunk.outcome.bad_body);
  }
  return true;
}

// For a chunk that wrote its contacts to where they stay.
void NarrowPhase::State::take_contacts(const Chunk& chunk, NarrowResult& result) noexcept {
  const auto base = static_cast<std::uint32_t>(result.contacts());
  for (std::uint32_t i = 0; i < chunk.job.count; ++i) chunk.job.contact_first[i] += base;
  result.contacts_.set_size(base + chunk.outcome.contacts);
}

bool NarrowPhase::State::gather_contacts(const Call& call, std::span<const Chunk> wave,
                                         NarrowResult& result) {
  std::size_t base[kWave + 1] = {result.contacts()};
  for (std::size_t i = 0; i < wave.size(); ++i) base[i + 1] = base[i] + wave[i].outcome.contacts;
  if (!result.contacts_.grow(base[wave.size()])) return false;
  call.options.execution.for_each(wave.size(), [&](std::size_t i) {
    const ContactWriter from = writer_to(scratch, wave[i].contacts_from);
    const ContactWriter to = writer_to(result.contacts_, base[i]);
    const std::size_t count = wave[i].outcome.contacts;
    for (int axis = 0; axis < 3; ++axis) {
      std::copy_n(from.position[axis], count, to.position[axis]);
    }
    std::copy_n(from.depth, count, to.depth);
    std::copy_n(from.feature, count, to.feature);
    for (std::uint32_t k = 0; k < wave[i].job.count; ++k) {
      wave[i].job.contact_first[k] += static_cast<std::uint32_t>(base[i]);
    }
  });
  result.contacts_.set_size(base[wave.size()]);
  return true;
}

Footprint NarrowPhase::footprint() const noexcept {
  Footprint footprint;
  if (state_ == nullptr) return footprint;
  footprint.scratch += {sizeof(State), sizeof(State)};
  footprint.scratch += state_->buckets.bytes();
  footprint.scratch += state_->scratch.bytes();
  return footprint;
}

}  // namespace winnow
