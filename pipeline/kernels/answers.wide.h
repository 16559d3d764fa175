#pragma once

// The results that kernels compute for the pairs in their lanes, the functions that write them to
// the columns of a job, and the loops of kernels over a job. Included by nearly all kernels.

#include "pipeline/kernels/pair_lanes.wide.h"
#include "simd/lanes/compress.h"

namespace winnow::WINNOW_ISA_NAME {

/// ContactLevel as a template argument.
enum Level : int { kBoolean, kDistance, kManifold };

/// Machine epsilon: the distance from 1 to the next number.
template <typename T>
inline constexpr T kEpsilon = sizeof(T) == sizeof(double) ? T(0x1p-52) : T(0x1p-23F);

/// Results at levels distance and manifold, as described at the columns of NarrowJob.
template <typename T>
struct AnswerLanes {
  Lanes<T> distance;
  Lanes<T> error_bound;
  Vec3<T> normal;
  /// Used at level distance only.
  Vec3<T> point;
};

/// One contact point per lane, for the lanes in the mask.
template <typename T>
struct ContactLanes {
  Vec3<T> position;
  Lanes<T> depth;
  /// Integers below 2^24: the two halves of ContactPoint::feature.
  Lanes<T> feature_a;
  Lanes<T> feature_b;
  Mask16 lanes;
};

/// The lanes in which lengths can be squared without overflow or loss of digits. `square` is the
/// square of the scale of the pair.
template <typename T>
[[gnu::always_inline]] inline LaneMask<T> in_range(const Lanes<T>& square) {
  constexpr bool is_double = sizeof(T) == sizeof(double);
  return (square > Lanes<T>(is_double ? T(1e-100) : T(1e-24F))) &
         (square < Lanes<T>(is_double ? T(1e100) : T(1e24F)));
}

/// True in the first pass of level boolean, which computes in float. Pairs that float cannot decide
/// are computed again in double.
template <typename T>
inline constexpr bool kFirstPass = sizeof(T) == sizeof(float);

/// Spreads eight bits to the lowest bits of eight bytes.
[[gnu::always_inline]] inline std::uint64_t bytes_of_bits(Mask16 bits) {
  const std::uint64_t low = (bits & 0x7FU) * 0x02040810204081ULL & 0x0101010101010101ULL;
  return low | static_cast<std::uint64_t>(bits >> 7U & 1U) << 56U;
}

/// Writes the results of level boolean.
template <typename T>
[[gnu::always_inline]] inline void write_overlap(const NarrowJob& job, const PairBlock<T>& block,
                                                 Mask16 overlap) {
  std::uint8_t* out = job.overlap + block.first;
  if constexpr (Lanes<T>::kCount == 1) {
    *out = static_cast<std::uint8_t>(overlap & 1U);
  } else if (block.count == Lanes<T>::kCount) {
    for (unsigned byte = 0; byte < Lanes<T>::kCount; byte += 8) {
      const std::uint64_t bytes = bytes_of_bits(overlap >> byte & 0xFFU);
      __builtin_memcpy(out + byte, &bytes, 8);
    }
  } else {
    for (unsigned lane = 0; lane < block.count; ++lane) {
      out[lane] = static_cast<std::uint8_t>(overlap >> lane & 1U);
    }
  }
}

template <typename T>
[[gnu::always_inline]] inline void write_column(double* column, const PairBlock<T>& block,
                                                const Lanes<T>& v) {
  constexpr unsigned lanes = Lanes<T>::kCount;
  double* out = column + block.first;
  if constexpr (lanes == 1) {
    *out = v.part[0];
  } else {
    alignas(64) double stage[lanes];
    double* to = block.count == lanes ? out : stage;
    v.store_unaligned(to);
    if (block.count == lanes) return;
    for (unsigned lane = 0; lane < block.count; ++lane) out[lane] = stage[lane];
  }
}

/// Writes the results of levels distance and manifold except the contacts.
template <int L, typename T>
[[gnu::always_inline]] inline void write_answer(const NarrowJob& job, const PairBlock<T>& block,
                                                const AnswerLanes<T>& answer) {
  write_column(job.distance, block, answer.distance);
  write_column(job.error_bound, block, answer.error_bound);
  write_column(job.normal[0], block, answer.normal.x);
  write_column(job.normal[1], block, answer.normal.y);
  write_column(job.normal[2], block, answer.normal.z);
  if constexpr (L == kDistance) {
    write_column(job.point[0], block, answer.point.x);
    write_column(job.point[1], block, answer.point.y);
    write_column(job.point[2], block, answer.point.z);
  }
}

/// Appends the pairs in `lanes` to the list of uncertified pairs.
template <typename T>
[[gnu::always_inline]] inline std::uint32_t write_uncertified(const NarrowJob& job,
                                                              const PairBlock<T>& block,
                                                              std::uint32_t size, Mask16 lanes) {
  for (; lanes != 0; lanes &= lanes - 1) job.uncertified[size++] = block.first + first(lanes);
  return size;
}

/// Writes columns contact_first and contact_count. lanes[p] are the lanes that have a contact point
/// number p.
template <int Points, typename T>
[[gnu::always_inline]] inline void write_contact_runs(const NarrowJob& job,
                                                      const PairBlock<T>& block,
                                                      const Mask16 (&lanes)[Points]) {
  std::uint32_t before = job.contacts.size;
  for (unsigned from = 0; from < block.count; from += 8) {
    std::uint64_t counts = 0;
    for (int p = 0; p < Points; ++p) counts += bytes_of_bits(lanes[p] >> from & 0xFFU);
    // Byte i of the product is the sum of bytes 0 to i.
    const std::uint64_t sums = counts * 0x0101010101010101ULL;
    const std::uint64_t starts = sums << 8U;
    std::uint32_t* first_out = job.contact_first + block.first + from;
    std::uint32_t* count_out = job.contact_count + block.first + from;
    if (from + 8 <= block.count) {
      store_bytes(starts, before, first_out);
      store_bytes(counts, 0, count_out);
    } else {
      for (unsigned i = 0; from + i < block.count; ++i) {
        first_out[i] = before + static_cast<std::uint32_t>(starts >> 8U * i & 0xFFU);
        count_out[i] = static_cast<std::uint32_t>(counts >> 8U * i & 0xFFU);
      }
    }
    before += static_cast<std::uint32_t>(sums >> 56U);
  }
}

/// Converts to float. If there are fewer lanes than floats, the remaining floats are unspecified.
template <typename T>
[[gnu::always_inline]] inline Floats as_floats(const Lanes<T>& v) {
  if constexpr (Lanes<T>::kCount == 1) {
    return Floats(static_cast<float>(v.part[0]));
  } else {
    return to_single(v);
  }
}

/// The columns of a contact: position x, y, z, depth, feature of a, feature of b.
struct ContactRegisters {
  Floats column[6];
};

template <typename T>
[[gnu::always_inline]] inline ContactRegisters columns_of(const ContactLanes<T>& point) {
  return {{as_floats(point.position.x), as_floats(point.position.y), as_floats(point.position.z),
           as_floats(point.depth), as_floats(point.feature_a), as_floats(point.feature_b)}};
}

/// Appends the contacts in `lanes`.
[[gnu::always_inline]] inline void append_contacts(ContactWriter& out, Mask16 lanes,
                                                   const ContactRegisters& c) {
  for (int k = 0; k < 3; ++k) compress_store(lanes, c.column[k], out.position[k] + out.size);
  compress_store(lanes, c.column[3], out.depth + out.size);
  compress_words(lanes, c.column[5], c.column[4], out.feature + out.size);
  out.size += count(lanes);
}

/// Appends up to two points per lane.
[[gnu::always_inline]] inline void append_zipped(ContactWriter& out, const Mask16 (&lanes)[2],
                                                 const ContactRegisters (&c)[2]) {
  ContactRegisters zipped;
  for (int k = 0; k < 6; ++k) zipped.column[k] = interleave<0>(c[0].column[k], c[1].column[k]);
  append_contacts(out, interleave_bits(lanes[0], lanes[1]), zipped);
}

/// Appends up to `Points` points per lane.
template <int Points>
inline void append_pair_by_pair(ContactWriter& out, const Mask16 (&lanes)[Points],
                                const ContactRegisters (&columns)[Points]) {
  alignas(64) float stage[Points][6][kLanes];
  for (int p = 0; p < Points; ++p) {
    for (int c = 0; c < 6; ++c) columns[p].column[c].store_unaligned(stage[p][c]);
  }
  std::uint32_t size = out.size;
  for (Mask16 rest = lanes[0]; rest != 0; rest &= rest - 1) {
    const unsigned lane = first(rest);
    for (int p = 0; p < Points && (lanes[p] >> lane & 1U) != 0; ++p, ++size) {
      for (int c = 0; c < 3; ++c) out.position[c][size] = stage[p][c][lane];
      out.depth[size] = stage[p][3][lane];
      out.feature[size] = static_cast<std::uint64_t>(stage[p][4][lane]) << 32U |
                          static_cast<std::uint64_t>(stage[p][5][lane]);
    }
  }
  out.size = size;
}

/// Writes the contacts of the pairs in the lanes, pair after pair. A lane that has point p must
/// have all points before it. Masks must not contain lanes of pairs that are uncertified or beyond
/// the job's count.
template <int Points, typename T>
[[gnu::always_inline]] inline void write_contacts(NarrowJob& job, const PairBlock<T>& block,
                                                  const ContactLanes<T> (&points)[Points]) {
  static_assert(Points == 1 || Points == 2 || Points == 4);
  Mask16 lanes[Points];
  for (int p = 0; p < Points; ++p) lanes[p] = points[p].lanes;
  write_contact_runs(job, block, lanes);
  if (lanes[0] == 0) return;
  ContactRegisters columns[Points];
  for (int p = 0; p < Points; ++p) columns[p] = columns_of(points[p]);
  if constexpr (Points == 1) {
    append_contacts(job.contacts, lanes[0], columns[0]);
  } else if constexpr (Points == 2) {
    append_zipped(job.contacts, lanes, columns);
  } else {
    append_pair_by_pair(job.contacts, lanes, columns);
  }
}

/// Answers a job with a class of one pair kind. The class has a template `Mask16 block<T,
/// L>(NarrowJob&, const PairBlock<T>&)` that answers the pairs of a block and returns the lanes
/// that it could not certify.
template <typename Kind, typename T, int L>
std::uint32_t answer_job(NarrowJob& job) {
  std::uint32_t uncertified = 0;
  for_blocks<T>(
      job, [&](const PairBlock<T>& block) __attribute__((always_inline)) {
        const Mask16 lanes = Kind::template block<T, L>(job, block) & block.lanes();
        if (lanes != 0) uncertified = write_uncertified(job, block, uncertified, lanes);
      });
  return uncertified;
}

/// Level boolean in two passes: float first, which handles twice as many pairs per block, then
/// double for the pairs that float could not decide. A job that fits in one block of doubles is
/// computed in double only.
template <typename Kind, NarrowKernel in_double>
std::uint32_t answer_in_two_passes(NarrowJob& job) {
  if (job.count <= Doubles::kCount) return in_double(job);
  NarrowJob part = job;
  const std::uint32_t doubtful = answer_job<Kind, float, kBoolean>(part);
  constexpr std::uint32_t kRoom = 64;
  BodyPair pairs[kRoom];
  std::uint8_t overlap[kRoom];
  std::uint32_t left[kRoom];
  part.pairs = pairs;
  part.overlap = overlap;
  part.uncertified = left;
  std::uint32_t uncertified = 0;
  for (std::uint32_t from = 0; from < doubtful; from += kRoom) {
    const std::uint32_t* const index = job.uncertified + from;
    part.count = doubtful - from < kRoom ? doubtful - from : kRoom;
    for (std::uint32_t i = 0; i < part.count; ++i) pairs[i] = job.pairs[index[i]];
    const std::uint32_t count = answer_job<Kind, double, kBoolean>(part);
    for (std::uint32_t i = 0; i < part.count; ++i) job.overlap[index[i]] = overlap[i];
    // At most as many indices are written as have been read, so unread entries are not overwritten.
    for (std::uint32_t i = 0; i < count; ++i) left[i] = index[left[i]];
    for (std::uint32_t i = 0; i < count; ++i) job.uncertified[uncertified++] = left[i];
  }
  return uncertified;
}

}  // namespace winnow::WINNOW_ISA_NAME
