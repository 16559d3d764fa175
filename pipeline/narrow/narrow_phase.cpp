// NarrowPhase::collide, in these steps:
// 1. PairBuckets (pair_buckets.h) validates the pairs and sorts them by the kinds of their shapes.
// 2. State::run cuts each kind into chunks of up to kJobPairs, and collects them in waves of 64.
// 3. State::answer_wave answers the chunks of a wave in parallel: `answer_job` calls the SIMD
//    kernel of the kinds, then the solver for each pair that the kernel could not certify.
// 4. If a pair was given in the other order of kinds, `mirror_answer` turns its result around.
// 5. At level manifold, contacts go directly into the result (one thread) or from scratch into the
//    result (`gather_contacts`).

#include <winnow/pipeline/narrow_phase.h>
#include "core/hooks/stage_scope.h"
#include "core/memory/new_in.h"
#include "core/threads/float_environment.h"
#include "pipeline/kernels/kernels.h"
#include "pipeline/narrow/narrow_columns.h"
#include "pipeline/narrow/pair_buckets.h"
#include "pipeline/narrow/validate_options.h"
#include "pipeline/solver/solver.h"

#include <algorithm>
#include <cstddef>
#include <new>
#include <numeric>
#include <type_traits>
#include <utility>

namespace winnow {
namespace {

// Number of chunks that are answered in parallel before their contacts are copied to the result. It
// bounds how many contacts are stored twice.
constexpr std::size_t kWave = 64;
/// With more bodies than this the poses take about four megabytes or more, and kernels prefetch
/// them.
constexpr std::size_t kManyBodies = 65536;

// Room for the contacts of a chunk of this many pairs, and for the values that kernels write beyond
// the last contact, where another chunk's contacts may begin.
[[nodiscard]] std::size_t room_for(std::size_t pairs) noexcept {
  return pairs * kManifoldPoints + kContactSlack;
}
// Room for any wave of this many chunks in a call of this many pairs, whatever the kinds of the
// pairs.
[[nodiscard]] std::size_t room_for_wave(std::size_t pairs, std::size_t chunks) noexcept {
  return std::min(pairs, kWave * kJobPairs) * kManifoldPoints + chunks * kContactSlack;
}
// Room for the largest chunk in a call of this many pairs.
[[nodiscard]] std::size_t max_room_for(std::size_t pairs) noexcept {
  return room_for(std::min<std::size_t>(kJobPairs, pairs));
}

template <typename T>
[[nodiscard]] T* offset(T* column, std::size_t first) noexcept {
  return column == nullptr ? nullptr : column + first;
}

struct ChunkOutcome {
  std::uint32_t contacts = 0;
  std::uint32_t uncertified = 0;
  /// The smallest body with an invalid pose, or ~0U.
  std::uint32_t bad_body = ~0U;
  SolverCounts solver;
};

/// Consecutive sorted pairs of the same two kinds that one task answers.
struct PairChunk {
  NarrowJob job;
  NarrowKernel kernel;
  std::uint32_t first;
  ChunkOutcome outcome;
  /// Index of the chunk's first contact among the contacts of the wave.
  std::size_t contacts_from = 0;
};

/// Chunks that are answered in parallel. Storage is uninitialized, so that a call with few pairs
/// constructs only the chunks that it needs.
class Wave {
 public:
  /// Adds a chunk. The caller must fill in the job, which is not initialized.
  [[nodiscard]] PairChunk& add() noexcept { return *new (first() + size_++) PairChunk; }
  void clear() noexcept { size_ = 0; }
  [[nodiscard]] bool full() const noexcept { return size_ == kWave; }
  [[nodiscard]] std::span<PairChunk> chunks() noexcept { return {first(), size_}; }

 private:
  static_assert(std::is_trivially_destructible_v<PairChunk>);
  [[nodiscard]] PairChunk* first() noexcept { return reinterpret_cast<PairChunk*>(room_); }

  std::size_t size_ = 0;
  alignas(PairChunk) std::byte room_[kWave * sizeof(PairChunk)];
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

/// Answers a job: by `kernel` (null if there is none), then by the solver for each uncertified
/// pair. Pairs with an invalid pose, which kernels do not certify, get no answer.
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

/// Turns answer i of a job into the answer about (b, a).
void mirror_answer(const NarrowJob& job, ContactLevel level, std::uint32_t i) noexcept {
  if (level == ContactLevel::boolean) return;
  const double* const a = job.poses[job.pairs[i].a].position.data();
  const double* const b = job.poses[job.pairs[i].b].position.data();
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

/// The arguments of `collide` and references to its outputs. The counters are updated in place, as
/// copying them would stall on their stores.
struct Call {
  const ShapeTables& tables;
  const Bodies& bodies;
  std::span<const BodyPair> pairs;
  const NarrowOptions& options;
  NarrowStatistics& statistics;
  std::uint32_t& bad_body;

  void answer(PairChunk& chunk, const NarrowResult& result, bool any_mirrored) const noexcept {
    // Left uninitialized if all pairs have one margin.
    double margins[kJobPairs];
    if (!options.contact_margins.empty()) {
      for (std::uint32_t i = 0; i < chunk.job.count; ++i) {
        margins[i] = options.contact_margins[result.pair_of(chunk.first + i)];
      }
      std::fill(margins + chunk.job.count, margins + kJobPairs, 0.0);
      chunk.job.margins = margins;
    }
    answer_job(chunk.job, options.level, chunk.kernel, chunk.outcome);
    // Pairs with an invalid pose have no answer to mirror, and the call fails.
    if (!any_mirrored || chunk.outcome.bad_body != ~0U) return;
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
  void fill_job(PairChunk& chunk, const Call& call, NarrowResult& result, std::uint32_t first,
                std::uint32_t count) const noexcept;
  [[nodiscard]] bool answer_wave(const Call& call, std::span<PairChunk> wave, NarrowResult& result);
  [[nodiscard]] bool gather_contacts(const Call& call, std::span<const PairChunk> wave,
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
      bad_body_(std::exchange(other.bad_body_, ~0U)) {}

Status NarrowPhase::collide(const ShapePool& shapes, const Bodies& bodies,
                            std::span<const BodyPair> pairs, const NarrowOptions& options,
                            NarrowResult& result) {
  return collide(shapes.tables(), bodies, pairs, options, result);
}

Status NarrowPhase::collide(const ShapeTables& tables, const Bodies& bodies,
                            std::span<const BodyPair> pairs, const NarrowOptions& options,
                            NarrowResult& result) {
  const DefaultFloatEnvironment environment;
  const StageScope stage(WorkStage::narrow_phase);
  statistics_ = {};
  bad_body_ = ~0U;
  if (state_ == nullptr) state_ = new_in<State>(memory_, memory_);
  Status status = Status::out_of_memory;
  if (state_ != nullptr) {
    const Call call{tables, bodies, pairs, options, statistics_, bad_body_};
    status = state_->collide(call, result);
  }
  if (status != Status::ok) NarrowColumns::clear(result);
  return status;
}

Status NarrowPhase::State::collide(const Call& call, NarrowResult& result) {
  const NarrowOptions& options = call.options;
  const bool are_matched =
      call.bodies.shapes.size() == call.bodies.poses.size() &&
      (options.contact_margins.empty() || options.contact_margins.size() == call.pairs.size());
  if (!are_matched) return Status::size_mismatch;
  if (!are_valid(options)) return Status::invalid_argument;
  const Status status = buckets.sort(call.tables, call.bodies.shapes, call.pairs, options.execution,
                                     result.order_, result.runs_, call.bad_body);
  if (status != Status::ok) return status;
  return NarrowColumns::resize(result, call.pairs.size(), options.level) ? run(call, result)
                                                                         : Status::out_of_memory;
}

Status NarrowPhase::State::run(const Call& call, NarrowResult& result) {
  Wave wave;
  for (const NarrowRun& run : result.runs()) {
    const NarrowKernel kernel = kernel_for(run.a, run.b, call.options);
    if (kernel == nullptr) call.statistics.without_lanes += run.count;
    for (std::uint32_t at = 0; at < run.count; at += kJobPairs) {
      PairChunk& chunk = wave.add();
      chunk.kernel = kernel;
      fill_job(chunk, call, result, run.first + at, std::min(kJobPairs, run.count - at));
      if (!wave.full()) continue;
      if (!answer_wave(call, wave.chunks(), result)) return Status::out_of_memory;
      wave.clear();
    }
  }
  if (!answer_wave(call, wave.chunks(), result)) return Status::out_of_memory;
  // A chunk needs room for the most contacts that it may find. With this much spare room, a later
  // call that finds no more contacts than this one does not allocate.
  if (call.options.level == ContactLevel::manifold && call.options.execution.concurrency() == 1 &&
      !result.contacts_.grow(result.contacts() + max_room_for(call.pairs.size()))) {
    return Status::out_of_memory;
  }
  call.statistics.pairs = call.pairs.size();
  return call.bad_body == ~0U ? Status::ok : Status::invalid_pose;
}

void NarrowPhase::State::fill_job(PairChunk& chunk, const Call& call, NarrowResult& result,
                                  std::uint32_t first, std::uint32_t count) const noexcept {
  chunk.first = first;
  NarrowJob& job = chunk.job;
  job.pairs = buckets.pairs() + first;
  job.count = count;
  job.shapes = call.bodies.shapes.data();
  job.poses = call.bodies.poses.data();
  job.has_many_bodies = call.bodies.poses.size() > kManyBodies;
  job.tables = &call.tables;
  job.margin = call.options.contact_margin;
  job.margins = nullptr;
  job.overlap = offset(result.overlap_.data(), first);
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

bool NarrowPhase::State::answer_wave(const Call& call, std::span<PairChunk> wave,
                                     NarrowResult& result) {
  const bool manifold = call.options.level == ContactLevel::manifold;
  const bool any_mirrored = buckets.any_mirrored();
  if (!manifold && wave.size() == 1) {
    call.answer(wave.front(), result, any_mirrored);
  } else if (!manifold) {
    call.options.execution.for_each(
        wave.size(), [&](std::size_t i) { call.answer(wave[i], result, any_mirrored); });
  } else if (call.options.execution.concurrency() == 1) {
    const std::size_t room = max_room_for(call.pairs.size());
    for (PairChunk& chunk : wave) {
      const auto base = static_cast<std::uint32_t>(result.contacts());
      if (!result.contacts_.grow(base + room)) return false;
      chunk.job.contacts = writer_to(result.contacts_, base);
      call.answer(chunk, result, any_mirrored);
      for (std::uint32_t i = 0; i < chunk.job.count; ++i) chunk.job.contact_first[i] += base;
      result.contacts_.set_size(base + chunk.outcome.contacts);
    }
  } else {
    std::size_t from = 0;
    for (PairChunk& chunk : wave) {
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
  for (const PairChunk& chunk : wave) {
    if (chunk.kernel != nullptr) call.statistics.recomputed += chunk.outcome.uncertified;
    call.statistics.exact += chunk.outcome.solver.exact;
    call.statistics.bounded += chunk.outcome.solver.bounded;
    call.bad_body = std::min(call.bad_body, chunk.outcome.bad_body);
  }
  return true;
}

bool NarrowPhase::State::gather_contacts(const Call& call, std::span<const PairChunk> wave,
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
