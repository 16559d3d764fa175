#pragma once

// Runs the jobs of the curved kernels: pairs are placed, searched by GJK in lanes of double
// (curved_search.wide.h), and finished one at a time (curved_depth, parallel_depth, curved_patch).
// Level boolean first tries the faster overlap tests of hull/single_overlap_test.wide.h.

#include "pipeline/kernels/cores/single_overlap_test.wide.h"
#include "pipeline/kernels/curved/curved_depth.wide.h"
#include "pipeline/kernels/curved/curved_patch.wide.h"
#include "pipeline/kernels/curved/curved_search.wide.h"
#include "pipeline/kernels/curved/parallel_depth.wide.h"
#include "pipeline/kernels/hull/hull_manifold.wide.h"
#include "pipeline/kernels/kernels.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// Recomputes the closest points of a pair in the triangle with which the search ended, and a lower
/// bound of the distance. For pairs whose bounds still differ because of rounding errors of the
/// search.
static inline void end_in_triangle(CurvedPair& pair) {
  double weight[3];
  if (pair.count != 3 || !weigh_thin_triangle(pair.difference, weight)) return;
  double gap[3];
  double normal[3];
  for (int k = 0; k < 3; ++k) {
    gap[k] = 0.0;
    for (int i = 0; i < 3; ++i) gap[k] += weight[i] * pair.difference[i][k];
  }
  const double length = __builtin_sqrt(dot3(gap, gap));
  if (!(length > 0.0)) return;
  for (int k = 0; k < 3; ++k) normal[k] = -gap[k] / length;
  double w[3];
  double mine[3];
  difference_point(pair, normal, w, mine);
  for (int k = 0; k < 3; ++k) pair.gap[k] = gap[k];
  pair.upper = length;
  pair.lower = -dot3(normal, w);
}

/// Answers jobs of one level.
template <int Level>
class CurvedAnswers {
 public:
  static std::uint32_t run(NarrowJob& job) {
    if constexpr (Level == 0) {
      // Float decides most pairs.
      return hull::answer_uncertified<CurvedAnswers>(job, overlap_test(job));
    } else {
      CurvedAnswers answers(job);
      for (std::uint32_t i = 0; i < job.count; ++i) {
        fetch_ahead(job, i);
        answers.take(i);
      }
      return answers.finish_taken();
    }
  }

 private:
  static constexpr std::uint32_t kChunk = 64;
  /// If the bounds of a distance differ by more than this fraction of it, they are recomputed.
  static constexpr double kLoose = 1e-10;
  /// The largest error bound of an answer, relative to the sizes, and the same for user shapes.
  static constexpr double kCertified = 1e-9;
  static constexpr double kCertifiedUser = 4e-7;

  template <typename Answers>
  friend std::uint32_t hull::answer_uncertified(NarrowJob& job, std::uint32_t count);

  explicit CurvedAnswers(NarrowJob& job) : job_(job) {}

  /// Answers the remaining pairs; returns the total number of uncertified pairs.
  std::uint32_t finish_taken() {
    answer_taken();
    return uncertified_;
  }

  void take(std::uint32_t i) {
    CurvedPair& pair = pair_[taken_];
    pair.index = i;
    pair.far = Level == 0 ? 0.0 : (Level == 1 ? __builtin_inf() : job_.margin_of(i));
    if (!place_pair(job_, job_.pairs[i], pair)) return leave_uncertified(i);
    if (++taken_ == kChunk) answer_taken();
  }

  void answer_taken() {
    if (taken_ == 0) return;
    CurvedSearch(pair_, taken_, Level == 0).run();
    for (std::uint32_t i = 0; i < taken_; ++i) {
      if (!answer(pair_[i])) leave_uncertified(pair_[i].index);
    }
    taken_ = 0;
  }

  /// Rounding, and user shapes whose points contradict each other, may make the lower bound exceed
  /// the upper one. So the error is the absolute difference.
  static double width_between(double lower, double upper) { return __builtin_fabs(upper - lower); }

  /// Leaves pair i of the job to the solver.
  void leave_uncertified(std::uint32_t i) { job_.uncertified[uncertified_++] = i; }

  bool answer(CurvedPair& pair) {
    switch (pair.state) {
      case CurvedState::far:
        return write_far(pair);
      case CurvedState::apart:
        return write_apart(pair);
      case CurvedState::inside:
        return write_inside(pair);
      default:
        return false;
    }
  }

  bool write_far(const CurvedPair& pair) {
    if constexpr (Level == 0) {
      job_.overlap[pair.index] = 0;
    } else {
      double normal[3];
      for (int k = 0; k < 3; ++k) normal[k] = -pair.gap[k] / pair.upper;
      double world[3];
      write_normal(pair, normal, world);
      job_.distance[pair.index] = (pair.lower - pair.rounding) * pair.unit;
      job_.error_bound[pair.index] =
          (width_between(pair.lower, pair.upper) + kRoundingError * (pair.size + pair.rounding)) *
          pair.unit;
      job_.contact_first[pair.index] = job_.contacts.size;
      job_.contact_count[pair.index] = 0;
    }
    return true;
  }

  bool write_apart(CurvedPair& pair) {
    if (pair.upper - pair.lower > kLoose * pair.upper) end_in_triangle(pair);
    const double error =
        width_between(pair.lower, pair.upper) + kRoundingError * (pair.size + pair.rounding);
    // An error of the length implies an error of the direction, which this limit keeps below 0.01
    // degrees.
    if (!(error <= 1e-8 * pair.upper)) return false;
    double normal[3];
    for (int k = 0; k < 3; ++k) normal[k] = -pair.gap[k] / pair.upper;
    double weight[3] = {1.0, 0.0, 0.0};
    double corner[3][3];
    for (std::uint32_t i = 0; i < pair.count; ++i) {
      for (int k = 0; k < 3; ++k) corner[i][k] = pair.difference[i][k];
    }
    if (pair.count == 2) hull::nearest_on_segment(corner, weight);
    if (pair.count == 3 && !weigh_thin_triangle(corner, weight)) {
      hull::nearest_on_triangle(corner, weight);
    }
    double point[3] = {0.0, 0.0, 0.0};
    for (std::uint32_t i = 0; i < pair.count; ++i) {
      for (int k = 0; k < 3; ++k) point[k] += weight[i] * pair.on_first[i][k];
    }
    return write(pair, pair.upper, error, normal, point);
  }

  bool write_inside(const CurvedPair& pair) {
    if constexpr (Level == 0) {
      job_.overlap[pair.index] = 1;
      return true;
    } else {
      double normal[3];
      double point[3];
      ParallelDepth parallel;
      if (parallel.find(pair)) {
        parallel.answer(normal, point);
        return write_depth(pair, parallel, normal, point);
      }
      return depth_.find(pair) && depth_.answer(normal, point) &&
             write_depth(pair, depth_, normal, point);
    }
  }

  template <typename Depth>
  bool write_depth(const CurvedPair& pair, const Depth& depth, const double* normal,
                   const double* point) {
    const double error = width_between(depth.lower(), depth.upper()) +
                         2.0 * kRoundingError * (pair.size + pair.rounding);
    // The cores overlap if the depth is certainly positive.
    return error < depth.upper() && write(pair, -depth.upper(), error, normal, point);
  }

  /// Writes an answer from the distance of the cores; all lengths are scaled.
  bool write(const CurvedPair& pair, double apart, double error, const double* normal,
             const double* point) {
    const double distance = apart - pair.rounding;
    if (!(error < __builtin_fabs(distance))) return false;
    const double widest = has_user_shape(pair) ? kCertifiedUser : kCertified;
    if (!(error <= widest * (pair.size + pair.rounding))) return false;
    if constexpr (Level == 0) {
      job_.overlap[pair.index] = distance <= 0.0;
      return true;
    } else {
      job_.distance[pair.index] = distance * pair.unit;
      job_.error_bound[pair.index] = error * pair.unit;
      double world[3];
      double place[3];
      write_normal(pair, normal, world);
      place_point(pair, normal, point, distance, place);
      if constexpr (Level == 1) {
        for (int k = 0; k < 3; ++k) job_.point[k][pair.index] = place[k];
      } else {
        write_contacts(pair, normal, world, place, point, apart);
      }
      return true;
    }
  }

  void write_normal(const CurvedPair& pair, const double* normal, double* world) {
    turn3(pair.frame, normal, world);
    for (int k = 0; k < 3; ++k) {
      if (pair.swapped) world[k] = -world[k];
      job_.normal[k][pair.index] = world[k];
    }
  }

  /// Computes the point on the surface of body a. `core` is the point on the core of the first. If
  /// the pair is swapped, body a is the second, whose surface is `distance` beyond the first's.
  static void place_point(const CurvedPair& pair, const double* normal, const double* core,
                          double distance, double* place) {
    const double reach = pair.first.rounding + (pair.swapped ? distance : 0.0);
    double local[3];
    for (int k = 0; k < 3; ++k) local[k] = (core[k] + reach * normal[k]) * pair.unit;
    turn3(pair.frame, local, place);
    if (!pair.swapped) return;
    for (int k = 0; k < 3; ++k) place[k] -= pair.offset[k];
  }

  void write_contacts(const CurvedPair& pair, const double* normal, const double* world,
                      const double* place, const double* core, double apart) {
    const double distance = job_.distance[pair.index];
    ContactWriter& writer = job_.contacts;
    job_.contact_first[pair.index] = writer.size;
    ContactPoint points[kManifoldPoints] = {};
    std::uint32_t count = 0;
    if (distance <= pair.far) {
      count = curved_contacts(pair, normal, world, place, core, apart, distance, pair.far, points);
    }
    job_.contact_count[pair.index] = count;
    for (std::uint32_t i = 0; i < count; ++i, ++writer.size) {
      for (int k = 0; k < 3; ++k) writer.position[k][writer.size] = points[i].position[k];
      writer.depth[writer.size] = points[i].depth;
      writer.feature[writer.size] = points[i].feature;
    }
  }

  NarrowJob& job_;
  std::uint32_t uncertified_ = 0;
  std::uint32_t taken_ = 0;
  CurvedPair pair_[kChunk];
  CurvedDepth depth_;
};

/// The kernels of all pair kinds of curved.kernel.cpp; the job's shapes determine the kind.
inline constexpr NarrowKernels kCurvedKernels = {
    {CurvedAnswers<0>::run, CurvedAnswers<1>::run, CurvedAnswers<2>::run}};

}  // namespace winnow::WINNOW_ISA_NAME::curved
