#include <winnow/pipeline/narrow_phase.h>
#include "pipeline/kernels/kernels.h"
#include "pipeline/narrow/narrow_chunk.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace winnow {
namespace {

// Chunks between two moments at which parallel tasks' contacts are put in order: bounds what is
// held twice.
constexpr std::size_t kWave = 64;
constexpr std::size_t kChunkContacts = std::size_t{kChunkPairs} * kManifoldPoints;

template <typename T>
[[nodiscard]] T* offset(T* column, std::size_t first) noexcept {
  return column == nullptr ? nullptr : column + first;
}

[[nodiscard]] NarrowKernel pick(const NarrowRun& run, const NarrowOptions& options) noexcept {
  const NarrowKernels* const kernels = narrow_kernels(run.a, run.b);
  if (kernels == nullptr || options.tier == NarrowTier::reference) return nullptr;
  const auto level = static_cast<std::size_t>(options.level);
  const bool fast = options.tier == NarrowTier::fast && kernels->fast[level] != nullptr;
  return fast ? kernels->fast[level] : kernels->robust[level];
}

}  // namespace

struct NarrowPhase::Chunk {
  NarrowJob job;
  NarrowKernel kernel;
  std::uint32_t first;
  ChunkOutcome outcome;
};

struct NarrowPhase::Call {
  const ShapeTables& tables;
  const Bodies& bodies;
  std::span<const BodyPair> pairs;
  const NarrowOptions& options;

  void answer(Chunk& chunk, const NarrowResult& result, bool any_turned) const noexcept {
    chunk.outcome = answer_chunk(chunk.job, options.level, chunk.kernel);
    if (!any_turned) return;
    for (std::uint32_t i = 0; i < chunk.job.count; ++i) {
      const BodyPair& given = pairs[result.pair_of(chunk.first + i)];
      if (given.a != chunk.job.pairs[i].a) turn_answer(chunk.job, options.level, i);
    }
  }
};

NarrowPhase::NarrowPhase(std::pmr::memory_resource* memory) noexcept
    : buckets_(memory), scratch_(memory) {}

Status NarrowPhase::collide(const ShapePool& shapes, const Bodies& bodies,
                            std::span<const BodyPair> pairs, const NarrowOptions& options,
                            NarrowResult& result) {
  return collide(shapes.tables(), bodies, pairs, options, result);
}

Status NarrowPhase::collide(const ShapeTables& tables, const Bodies& bodies,
                            std::span<const BodyPair> pairs, const NarrowOptions& options,
                            NarrowResult& result) {
  statistics_ = {};
  bad_body_ = ~0U;
  const Call call{tables, bodies, pairs, options};
  Status status = Status::ok;
  if (bodies.shapes.size() != bodies.poses.size()) {
    status = Status::size_mismatch;
  } else if (!std::isfinite(options.margin) || options.margin < 0.0) {
    status = Status::invalid_argument;
  } else {
    status =
        buckets_.sort(call.tables, bodies.shapes, pairs, result.order_, result.runs_, bad_body_);
  }
  if (status == Status::ok && !result.resize(pairs.size(), options.level)) {
    status = Status::out_of_memory;
  }
  if (status == Status::ok) status = run(call, result);
  if (status != Status::ok) result.clear();
  return status;
}

Status NarrowPhase::run(const Call& call, NarrowResult& result) {
  Chunk wave[kWave];
  std::size_t filled = 0;
  for (const NarrowRun& run : result.runs()) {
    const NarrowKernel kernel = pick(run, call.options);
    if (kernel == nullptr) statistics_.without_lanes += run.count;
    for (std::uint32_t at = 0; at < run.count; at += kChunkPairs) {
      const std::uint32_t count = std::min(kChunkPairs, run.count - at);
      wave[filled++] = chunk_of(call, result, kernel, run.first + at, count);
      if (filled < kWave) continue;
      if (!answer_wave(call, {wave, filled}, result)) return Status::out_of_memory;
      filled = 0;
    }
  }
  if (!answer_wave(call, {wave, filled}, result)) return Status::out_of_memory;
  // Chunks write where there is room for all that they may find: with this much, a call that finds
  // no more than this one needs no more room, wherever in it its contacts are.
  if (call.options.level == NarrowLevel::manifold && call.options.execution.concurrency() == 1 &&
      !result.contacts_.grow(result.contacts() + kChunkContacts)) {
    return Status::out_of_memory;
  }
  statistics_.pairs = call.pairs.size();
  return bad_body_ == ~0U ? Status::ok : Status::invalid_pose;
}

NarrowPhase::Chunk NarrowPhase::chunk_of(const Call& call, NarrowResult& result,
                                         NarrowKernel kernel, std::uint32_t first,
                                         std::uint32_t count) const noexcept {
  NarrowJob job{};
  job.pairs = buckets_.pairs() + first;
  job.count = count;
  job.shapes = call.bodies.shapes.data();
  job.poses = call.bodies.poses.data();
  job.tables = call.tables;
  job.margin = call.options.margin;
  job.overlap = offset(result.overlap_.data(), first);
  job.distance = offset(result.distance_.data(), first);
  job.error_bound = offset(result.error_bound_.data(), first);
  for (int axis = 0; axis < 3; ++axis) {
    job.normal[axis] = offset(result.normal_[axis].data(), first);
    job.point[axis] = offset(result.point_[axis].data(), first);
  }
  job.contact_first = offset(result.contact_first_.data(), first);
  job.contact_count = offset(result.contact_count_.data(), first);
  return {job, kernel, first, {}};
}

bool NarrowPhase::answer_wave(const Call& call, std::span<Chunk> wave, NarrowResult& result) {
  const bool manifold = call.options.level == NarrowLevel::manifold;
  const bool turned = buckets_.any_turned();
  if (!manifold) {
    call.options.execution.for_each(wave.size(),
                                    [&](std::size_t i) { call.answer(wave[i], result, turned); });
  } else if (call.options.execution.concurrency() == 1) {
    for (Chunk& chunk : wave) {
      if (!result.contacts_.grow(result.contacts() + kChunkContacts)) return false;
      chunk.job.contacts = result.contacts_.writer(result.contacts());
      call.answer(chunk, result, turned);
      take_contacts(chunk, result);
    }
  } else {
    if (!scratch_.grow(wave.size() * kChunkContacts)) return false;
    call.options.execution.for_each(wave.size(), [&](std::size_t i) {
      wave[i].job.contacts = scratch_.writer(i * kChunkContacts);
      call.answer(wave[i], result, turned);
    });
    if (!gather_contacts(call, wave, result)) return false;
  }
  for (const Chunk& chunk : wave) {
    if (chunk.kernel != nullptr) statistics_.recomputed += chunk.outcome.uncertified;
    statistics_.solver += chunk.outcome.solver;
    bad_body_ = std::min(bad_body_, chunk.outcome.bad_body);
  }
  return true;
}

// Of a chunk that wrote to where its contacts stay.
void NarrowPhase::take_contacts(const Chunk& chunk, NarrowResult& result) noexcept {
  const auto base = static_cast<std::uint32_t>(result.contacts());
  for (std::uint32_t i = 0; i < chunk.job.count; ++i) chunk.job.contact_first[i] += base;
  result.contacts_.set_size(base + chunk.outcome.contacts);
}

bool NarrowPhase::gather_contacts(const Call& call, std::span<const Chunk> wave,
                                  NarrowResult& result) {
  std::size_t base[kWave + 1] = {result.contacts()};
  for (std::size_t i = 0; i < wave.size(); ++i) base[i + 1] = base[i] + wave[i].outcome.contacts;
  if (!result.contacts_.grow(base[wave.size()])) return false;
  call.options.execution.for_each(wave.size(), [&](std::size_t i) {
    const ContactWriter from = scratch_.writer(i * kChunkContacts);
    const ContactWriter to = result.contacts_.writer(base[i]);
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
  footprint.scratch += buckets_.bytes();
  footprint.scratch += scratch_.bytes();
  return footprint;
}

}  // namespace winnow
