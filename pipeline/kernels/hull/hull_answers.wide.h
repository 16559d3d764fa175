#pragma once

// Runs the jobs of the hull kernels, in this sequence:
// 1. place_hulls reads both hulls and poses of up to kRoom pairs of the job (hull_gjk.wide.h).
// 2. HullSearch finds the closest features of these pairs, by GJK in float lanes (hull_gjk.wide.h).
// 3. HullDepth finds the depth of pairs that touch, one pair at a time (hull_depth.wide.h).
// 4. finish_apart, finish_depth and write_contacts compute the results of each pair in double
//    (hull_manifold.wide.h).
// Level boolean first tries the faster overlap tests of cores/single_overlap_test.wide.h.

#include "pipeline/kernels/cores/single_overlap_test.wide.h"
#include "pipeline/kernels/fetch_ahead.wide.h"
#include "pipeline/kernels/hull/hull_depth.wide.h"
#include "pipeline/kernels/hull/hull_gjk.wide.h"
#include "pipeline/kernels/hull/hull_manifold.wide.h"
#include "pipeline/kernels/kernels.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// Answers jobs of one level: 0 boolean, 1 distance, 2 manifold (kernel_index). `Shapes` provides
/// the hulls of the pairs:
/// - kRoom: the number of pairs that it can store at once.
/// - place(job, bodies, slot, pair): fills in a pair; false if it is out of range.
/// - complete(slot): computes the planes of faces, for pairs that the search has not decided; false
///   if the kernel cannot handle the shape.
/// - kSimpleSecond: the second hull is a simple shape.
/// - kPointSecond: the core of the second is a point at its origin.
/// - Seconds: the class that computes supports of the second.
template <typename Shapes, int Level>
class HullAnswers {
 public:
  static std::uint32_t run(NarrowJob& job) {
    if constexpr (Level == 0) {
      // Most pairs are decided by these tests.
      return answer_uncertified<HullAnswers>(job, curved::overlap_test(job));
    } else {
      HullAnswers answers(job);
      for (std::uint32_t i = 0; i < job.count; ++i) {
        fetch_ahead(job, i);
        answers.take(i);
      }
      return answers.finish_taken();
    }
  }

 private:
  static constexpr std::uint32_t kPairsAtOnce = Shapes::kRoom;

  /// Level boolean: calls `take` for the pairs that the overlap tests leave.
  template <typename Answers>
  friend std::uint32_t answer_uncertified(NarrowJob& job, std::uint32_t count);

  explicit HullAnswers(NarrowJob& job) : job_(job) {}

  /// Answers the remaining pairs; returns the total number of uncertified pairs.
  std::uint32_t finish_taken() {
    answer_taken();
    return uncertified_;
  }

  void take(std::uint32_t i) {
    if (!place(i, taken_, pair_[taken_])) return leave_uncertified(i);
    if (++taken_ == kPairsAtOnce) answer_taken();
  }

  void answer_taken() {
    if (taken_ == 0) return;
    HullSearch<typename Shapes::Seconds>(pair_, taken_, Level == 0).run();
    for (std::uint32_t i = 0; i < taken_; ++i) {
      if (!answer(pair_[i], i)) leave_uncertified(pair_[i].index);
    }
    taken_ = 0;
  }

  /// Larger than any distance that occurs.
  static constexpr double kFarthest = 1e10;

  bool place(std::uint32_t i, std::uint32_t slot, HullPair& pair) {
    pair.index = i;
    pair.far = Level == 0 ? 0.0 : __builtin_inf();
    if (Level == 2) pair.far = job_.margin_of(i) < kFarthest ? job_.margin_of(i) : kFarthest;
    return shapes_.place(job_, job_.pairs[i], slot, pair) &&
           pair.first->vertex_count <= kMaxHullVertices &&
           pair.second->vertex_count <= kMaxHullVertices;
  }

  /// Leaves pair i of the job to the solver.
  void leave_uncertified(std::uint32_t i) { job_.uncertified[uncertified_++] = i; }

  bool answer(const HullPair& pair, std::uint32_t slot) {
    if (pair.state == HullState::far) {
      if constexpr (Level == 0) {
        job_.overlap[pair.index] = 0;
      } else {
        write_far(pair);
      }
      return true;
    }
    if (Level == 0 && pair.state == HullState::inside) {
      job_.overlap[pair.index] = 1;
      return true;
    }
    if (!shapes_.complete(slot)) return false;
    HullDistance core{};
    if (pair.state == HullState::apart) {
      finish_apart(pair, core);
      // An error of the length implies an error of the direction, which this limit keeps below 0.01
      // degrees.
      if (!(core.error <= 1e-8 * core.distance)) return false;
    } else {
      if (!depth_.find(pair)) return false;
      finish_depth(pair, depth_, core);
      if (!(core.error < -core.distance)) return false;
    }
    return finish(pair, core);
  }

  bool finish(const HullPair& pair, HullDistance& core) {
    const double distance = core.distance - pair.rounding;
    const double error = core.error + kDoubleError * pair.rounding;
    if (!(error < __builtin_fabs(distance))) return false;
    if (!(error <= kCertified * (pair.size + pair.rounding))) return false;
    if constexpr (Level == 0) {
      job_.overlap[pair.index] = distance <= 0.0;
      return true;
    } else {
      job_.distance[pair.index] = distance;
      job_.error_bound[pair.index] = error;
      double world[3];
      write_normal(pair, core.normal, world);
      if constexpr (Level == 2) {
        const double doubt = error + kContactError * (pair.size + pair.rounding);
        return contacts(pair, {core.normal, world, job_.margin_of(pair.index), distance, doubt},
                        core.winner);
      } else {
        if (pair.state == HullState::apart || touching_point(pair, core)) {
          write_point(pair, core, distance);
          return true;
        }
        return write_shared_point(pair, {core.normal, world, 0.0, distance, 2.0 * error},
                                  core.winner);
      }
    }
  }

  static constexpr double kCertified = 1e-12;
  /// Contacts are stored as floats: a few units in the last place.
  static constexpr double kContactError = 4e-7;

  void write_normal(const HullPair& pair, const double* local, double* world) {
    turn3(pair.frame, local, world);
    if (pair.swapped) {
      for (int k = 0; k < 3; ++k) world[k] = -world[k];
    }
    for (int k = 0; k < 3; ++k) job_.normal[k][pair.index] = world[k];
  }

  /// Writes the point on the surface of body a. If the pair is swapped, body a is the second, whose
  /// surface is `distance` beyond the first's.
  void write_point(const HullPair& pair, const HullDistance& core, double distance) {
    const double reach = pair.first->rounding + (pair.swapped ? distance : 0.0);
    double point[3];
    double world[3];
    for (int k = 0; k < 3; ++k) point[k] = core.point[k] + reach * core.normal[k];
    turn3(pair.frame, point, world);
    for (int k = 0; k < 3; ++k) {
      job_.point[k][pair.index] = pair.swapped ? world[k] - pair.offset[k] : world[k];
    }
  }

  /// Writes the point on the surface of body a if parallel features touch. Returns false if they do
  /// not contain the deepest point; the solver must answer then.
  bool write_shared_point(const HullPair& pair, const HullContacts& input,
                          const HullCandidate* winner) {
    double point[3];
    if (!point_of_features<Shapes::kSimpleSecond>(pair, input, winner, point)) return false;
    for (int k = 0; k < 3; ++k) job_.point[k][pair.index] = point[k];
    return true;
  }

  /// Returns false if no contact is as deep as the pair; the solver must answer then.
  bool contacts(const HullPair& pair, const HullContacts& input, const HullCandidate* winner) {
    job_.contact_first[pair.index] = job_.contacts.size;
    job_.contact_count[pair.index] = 0;
    if (!(input.distance <= input.margin)) return true;
    if constexpr (Shapes::kPointSecond) {
      write_point_contact(pair, input, winner, job_.contacts);
      job_.contact_count[pair.index] = 1;
      return true;
    }
    const std::uint32_t count =
        write_contacts<Shapes::kSimpleSecond>(pair, input, winner, job_.contacts);
    job_.contact_count[pair.index] = count;
    return count > 0;
  }

  /// Writes a lower bound of the distance of pairs farther apart than the margin.
  void write_far(const HullPair& pair) {
    const double gap[3] = {static_cast<double>(pair.gap[0]), static_cast<double>(pair.gap[1]),
                           static_cast<double>(pair.gap[2])};
    const double length = __builtin_sqrt(dot3(gap, gap));
    const double scale = 1.0 / static_cast<double>(pair.scale);
    // Exceeds the error of `height_along`. HullSearch added more to the margin (kLengthError),
    // so that after the roundings here the bound is still above the margin.
    constexpr double doubt = 5.5e-6;
    const double lower = (static_cast<double>(pair.height_along) / length - doubt) * scale;
    const double upper = (length + doubt) * scale;
    double normal[3];
    for (int k = 0; k < 3; ++k) normal[k] = -gap[k] / length;
    double world[3];
    write_normal(pair, normal, world);
    job_.distance[pair.index] = lower - pair.rounding;
    job_.error_bound[pair.index] = upper - lower;
    if constexpr (Level == 2) {
      job_.contact_first[pair.index] = job_.contacts.size;
      job_.contact_count[pair.index] = 0;
    }
  }

  NarrowJob& job_;
  Shapes shapes_;
  std::uint32_t uncertified_ = 0;
  std::uint32_t taken_ = 0;
  HullPair pair_[kPairsAtOnce];
  HullDepth depth_;
};

template <typename Shapes>
inline constexpr NarrowKernels kHullKernels = {
    {HullAnswers<Shapes, 0>::run, HullAnswers<Shapes, 1>::run, HullAnswers<Shapes, 2>::run}};

}  // namespace winnow::WINNOW_ISA_NAME::hull
