#pragma once

#include "bench/rows/results.h"

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// How two reports are compared.
struct CompareOptions {
  double threshold = 1.10;  ///< at least 1; less than this many times worse is no change
  double scale = 1.0;       ///< times of the new report are divided by it, rates multiplied
};

enum class ChangeVerdict {
  same,    ///< within the threshold
  noise,   ///< beyond it, but so might another run of the same be
  better,  ///< beyond it
  worse
};

/// One value of one row in two reports.
struct Change {
  std::string table;
  std::string row;  ///< its id
  std::string value;
  std::string unit;
  double before = 0.0;
  double after = 0.0;  ///< scaled
  double ratio = 1.0;  ///< above 1: that many times worse; infinite if there was nothing before
  ChangeVerdict verdict = ChangeVerdict::same;
  /// False for rows of other libraries, which tell of the machine alone, and for values computed
  /// from other rows, which are compared themselves.
  bool counts = true;
};

/// The same measurement found other pairs.
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
  std::size_t only_after = 0;        ///< and the other way round
  std::size_t values_gone = 0;       ///< values that the new report's row lacks
  std::vector<std::string> remarks;  ///< in what else the reports differ

  /// Changes that count and are worse.
  [[nodiscard]] std::size_t regressions() const;
  /// No regression, and no other pairs.
  [[nodiscard]] bool passes() const { return regressions() == 0 && other_pairs.empty(); }
};

/// Compares the values of the rows that both have and of whose columns one way is better.
///
/// A time or rate has got worse if both the median and the best of its samples are worse by more
/// than the threshold, and its best sample is worse than the old median: work that a machine did
/// beside some of the samples moves medians and the worst, seldom the best. With fewer than five
/// samples, or in a report made with --quick, it is noise whatever it is. Other figures (bytes,
/// errors, shares) are the same in each run: the threshold decides, and what was zero is worse as
/// soon as it is not. The same rule, the other way round, says what has got better.
///
/// Fingerprints are compared where the same command was run with the same seed.
[[nodiscard]] ReportComparison compare(const Results& before, const Results& after,
                                       const CompareOptions& options);

/// How many times slower the machine of `after` is, by the reference sweeps; 1 if one is unknown.
[[nodiscard]] double machine_ratio(const Results& before, const Results& after);
/// Whether processor or cores differ.
[[nodiscard]] bool other_machine(const Results& before, const Results& after);

}  // namespace winnow::bench
