#pragma once

// Kernel tables for pair kinds with closed forms. A job with one pair runs the same templates with
// scalars instead of SIMD lanes.

#include "pipeline/kernels/answers.wide.h"
#include "simd/lanes/scalar_lane.h"

namespace winnow::WINNOW_ISA_NAME {

/// The kernel in double of a kind whose class also supports scalars. Only a job with a single pair
/// is computed with scalars.
template <typename Kind, int L>
std::uint32_t answer_one_or_many(NarrowJob& job) {
  return job.count == 1 ? answer_job<Kind, ScalarLane, L>(job) : answer_job<Kind, double, L>(job);
}

/// The kernel table of a kind whose class also supports scalars. `MaxScalarLevel`: kManifold if a
/// single manifold is computed with scalars too; some algorithms for several contacts need more
/// than one lane. `TwoPasses`: level boolean makes a first pass in float, which does not pay if
/// loading the shapes takes longer than the test.
template <typename Kind, int MaxScalarLevel = kManifold, bool TwoPasses = true>
constexpr NarrowKernels closed_form_kernels_of() {
  constexpr NarrowKernel boolean = [] {
    constexpr NarrowKernel in_double = answer_one_or_many<Kind, kBoolean>;
    if constexpr (TwoPasses) return answer_in_two_passes<Kind, in_double>;
    return in_double;
  }();
  constexpr NarrowKernel manifold = [] {
    if constexpr (MaxScalarLevel == kManifold) return answer_one_or_many<Kind, kManifold>;
    return answer_job<Kind, double, kManifold>;
  }();
  return {{boolean, answer_one_or_many<Kind, kDistance>, manifold}};
}

}  // namespace winnow::WINNOW_ISA_NAME
