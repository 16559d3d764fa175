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

/// What filters cost in one question to a partition, on one thread.
struct FilterRow {
  std::string filters;                ///< see filter_setting_names()
  std::string question;               ///< see filter_question_names()
  std::vector<double> plain_ms{};     ///< without filters, by rounds
  std::vector<double> filtered_ms{};  ///< with them
  std::size_t wrong = 0;  ///< answers that are not those of a comparison of all with all

  [[nodiscard]] double over_plain() const { return median_of(filtered_ms) / median_of(plain_ms); }
};

/// Who may meet whom: "1 % apart" in a layer that does not meet itself, "mixed" by chance in two
/// layers that all meet, "static" nine tenths that do not meet each other, "never, mixed" and
/// "never, apart" in two layers of which each meets itself alone, by chance and by place.
[[nodiscard]] std::span<const std::string_view> filter_setting_names() noexcept;

/// What is asked: "all move" and "few move" for all pairs after so many boxes changed, "another"
/// for pairs with a second partition, "rays" for the closest hits, "boxes" for what overlaps them.
[[nodiscard]] std::span<const std::string_view> filter_question_names() noexcept;

/// A scene's frames from the first one on.
using MakeFrames = std::function<std::unique_ptr<FrameSource>()>;

/// All settings in all questions, each beside the same question without filters, in turns over the
/// same frames. What the last round found is compared with all pairs by `BoundsNSquared` without
/// filters, of which those are taken that `may_meet` lets pass.
[[nodiscard]] std::vector<FilterRow> race_filters(const MakeFrames& frames,
                                                  std::string_view partition, std::size_t rounds);

}  // namespace winnow::bench
