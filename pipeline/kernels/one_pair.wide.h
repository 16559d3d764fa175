#pragma once

// Kernels of kinds that have closed forms: a pair alone is answered by the same templates with
// numbers that stand alone.

#include "pipeline/kernels/answers.wide.h"
#include "simd/lanes/alone.h"

namespace winnow::WINNOW_ISA_NAME {

/// The kernels in double of a kind whose classes answer a pair alone, too. Two pairs of boxes take
/// longer one after the other than in lanes.
template <typename Kind, int L>
std::uint32_t answer_one_or_many(NarrowJob& job) {
  return job.count == 1 ? answer_job<Kind, Alone, L>(job) : answer_job<Kind, double, L>(job);
}

/// Of kinds whose classes answer a pair alone, too; up to a level, as what makes several contacts
/// may need more lanes than one. `SureFirst`: level boolean goes over the pairs in float first,
/// which is no gain where loading them takes longer than the answer.
template <typename Kind, int MostAlone = kManifold, bool SureFirst = true>
constexpr NarrowKernels closed_form_kernels_of() {
  constexpr NarrowKernel boolean = [] {
    constexpr NarrowKernel in_double = answer_one_or_many<Kind, kBoolean>;
    if constexpr (SureFirst) return answer_sure_first<Kind, in_double>;
    return in_double;
  }();
  constexpr NarrowKernel manifold = [] {
    if constexpr (MostAlone == kManifold) return answer_one_or_many<Kind, kManifold>;
    return answer_job<Kind, double, kManifold>;
  }();
  return {{boolean, answer_one_or_many<Kind, kDistance>, manifold}};
}

}  // namespace winnow::WINNOW_ISA_NAME
