#pragma once

#include "bench/rows/results.h"

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// How two reports are compared.
struct CompareOptions {
  double threshold = 1.10;  ///< at least 1; smaller factors count as no change
  double scale = 1.0;       ///< the new report's times are divided by it, its rates multiplied
};

enum class ChangeVerdict {
  same,    ///< within the threshold
  noise,   ///< beyond the threshold, but the samples overlap
  better,  ///< beyond the threshold
  worse
};

/// One value of one row in two reports.
struct Change {
  std::string table;
  std::string row;  ///< the row's id
  std::string value;
  std::string unit;
  double before = 0.0;
  double after = 0.0;  ///< scaled
  double ratio = 1.0;  ///< factor by which it got worse (< 1: better); infinite if `before` is 0
  ChangeVerdict verdict = ChangeVerdict::same;
  /// False for rows of other libraries, whose changes reflect only the machine, and for values
  /// computed from other rows, which are compared themselves.
  bool counts = true;
};

/// A measurement of the same scene and seed that found different pairs.
struct OtherPairs {
  std::string row;
  std::string value;
  std::string before;
  std::string after;
};

struct ReportComparison {
  std::vector<Change> changes;  ///< all values compared, in the order of the new report
  std::vector<OtherPairs> other_pairs;
  std::size_t only_before = 0;       ///< rows of the old report that the new one lacks
  std::size_t only_after = 0;        ///< rows of the new report that the old one lacks
  std::size_t values_gone = 0;       ///< values that the new report's row lacks
  std::vector<std::string> remarks;  ///< other differences between the reports

  /// Changes that count and are worse.
  [[nodiscard]] std::size_t regressions() const;
  /// No regression, and no other pairs.
  [[nodiscard]] bool passes() const { return regressions() == 0 && other_pairs.empty(); }
};

/// Compares the values that both reports have and whose column states whether less or more is
/// better.
///
/// A time or rate is worse if both the median and the best of its samples are worse by more than
/// the threshold, and its best sample is worse than the old median: other work on the machine
/// changes medians and the worst samples, but seldom the best. With fewer than five samples, or if
/// one of the reports was made with --quick, a difference always counts as noise. Other figures
/// (bytes, errors, shares) are deterministic: the threshold decides, and a value that was zero is
/// worse as soon as it is not zero. The rule for "better" is symmetric.
///
/// Fingerprints are compared if the same command was run with the same seed, both times with
/// --quick or both times without.
[[nodiscard]] ReportComparison compare(const Results& before, const Results& after,
                                       const CompareOptions& options);

/// Returns how many times slower the machine of `after` is, by the time of the reference sweep; 1
/// if either report lacks it.
[[nodiscard]] double machine_ratio(const Results& before, const Results& after);
/// Returns whether processor or core count differ.
[[nodiscard]] bool other_machine(const Results& before, const Results& after);

}  // namespace winnow::bench
