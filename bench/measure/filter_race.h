#pragma once

#include <winnow/core/aabb.h>
#include "bench/common/sample.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Cost of filters in one kind of query of a partition, on one thread.
struct FilterRow {
  std::string filters;                ///< see filter_setting_names()
  std::string question;               ///< see filter_question_names()
  std::vector<double> plain_ms{};     ///< without filters, by round
  std::vector<double> filtered_ms{};  ///< with filters, by round
  std::size_t wrong = 0;              ///< results that differ from a test of all pairs

  [[nodiscard]] double over_plain() const { return median_of(filtered_ms) / median_of(plain_ms); }
};

/// Names of the filter settings: "1 % apart": pairs within a random 1 % of the objects are
/// excluded. "mixed": two random layers, no pairs excluded. "static": pairs within a random nine
/// tenths of the objects are excluded. "never, mixed" and "never, apart": two layers with pairs
/// only within each, assigned at random or by position.
[[nodiscard]] std::span<const std::string_view> filter_setting_names() noexcept;

/// Names of the queries: "all move" and "few move" find all pairs after all or few boxes changed;
/// "another" finds pairs with a second partition; "rays" finds closest hits; "boxes" finds the
/// objects that overlap boxes.
[[nodiscard]] std::span<const std::string_view> filter_question_names() noexcept;

/// Returns the frames of a scene from the first one on.
using MakeFrames = std::function<std::unique_ptr<FrameSource>()>;

/// Runs all settings in all queries, interleaved with the same query without filters, on the same
/// frames. The results of the last round are compared with a reference: `BoundsNSquared` finds all
/// pairs without filters, and `filters_allow` selects from them.
[[nodiscard]] std::vector<FilterRow> race_filters(const MakeFrames& frames,
                                                  std::string_view partition, std::size_t rounds);

}  // namespace winnow::bench
