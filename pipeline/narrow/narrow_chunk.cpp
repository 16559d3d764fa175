#include "pipeline/narrow/narrow_chunk.h"

#include <algorithm>
#include <numeric>

namespace winnow {
namespace {

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

void write_answer(NarrowJob& job, NarrowLevel level, std::uint32_t i,
                  const PairAnswer& answer) noexcept {
  if (level == NarrowLevel::boolean) {
    job.overlap[i] = answer.overlap ? 1 : 0;
    return;
  }
  job.distance[i] = answer.distance;
  job.error_bound[i] = answer.error_bound;
  for (int axis = 0; axis < 3; ++axis) job.normal[axis][i] = answer.normal[axis];
  if (level == NarrowLevel::manifold) return write_contacts(job, i, answer, job.contacts);
  for (int axis = 0; axis < 3; ++axis) job.point[axis][i] = answer.point[axis];
}

}  // namespace

ChunkOutcome answer_chunk(NarrowJob& job, NarrowLevel level, NarrowKernel kernel) noexcept {
  std::uint32_t uncertified[kChunkPairs];
  ChunkOutcome outcome;
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
    const PairAnswer answer = solve_pair(job.tables, job.shapes[pair.a], a, job.shapes[pair.b], b,
                                         level, job.margin, outcome.solver);
    write_answer(job, level, i, answer);
  }
  outcome.contacts = job.contacts.size;
  return outcome;
}

void turn_answer(const NarrowJob& job, NarrowLevel level, std::uint32_t i) noexcept {
  if (level == NarrowLevel::boolean) return;
  const double* const a = job.poses[job.pairs[i].a].position;
  const double* const b = job.poses[job.pairs[i].b].position;
  for (int axis = 0; axis < 3; ++axis) {
    const double apart = b[axis] - a[axis];
    if (level == NarrowLevel::distance) {
      job.point[axis][i] += job.distance[i] * job.normal[axis][i] - apart;
    } else {
      float* const column = job.contacts.position[axis] + job.contact_first[i];
      for (std::uint32_t k = 0; k < job.contact_count[i]; ++k) {
        column[k] = static_cast<float>(static_cast<double>(column[k]) - apart);
      }
    }
    job.normal[axis][i] = -job.normal[axis][i];
  }
  if (level != NarrowLevel::manifold) return;
  std::uint64_t* const feature = job.contacts.feature + job.contact_first[i];
  for (std::uint32_t k = 0; k < job.contact_count[i]; ++k) {
    feature[k] = feature[k] << 32U | feature[k] >> 32U;
  }
}

}  // namespace winnow
