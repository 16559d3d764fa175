#include <winnow/pipeline/impacts.h>
#include "core/threads/float_environment.h"
#include "pipeline/motion/feature_stage.h"

#include <algorithm>
#include <bit>

namespace winnow {

WINNOW_DEFINE_KERNELS(FeatureTestKernels, feature_test_kernels)

namespace {

/// The columns in order: x, y, z of points 0 to 3 at the start, then at the end.
using Columns = std::array<const double*, 24>;

Columns columns_of(const FeatureColumns& pairs) noexcept {
  Columns columns{};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      columns[3 * k + axis] = pairs.start[k][axis];
      columns[12 + 3 * k + axis] = pairs.end[k][axis];
    }
  }
  return columns;
}

/// Tests eight pairs; writes the times of the first `count`.
void find_eight(FeaturePair kind, const Columns& columns, std::size_t first, std::size_t count,
                double* times, const FeatureImpactOptions& options) noexcept {
  const FeatureTestKernels& kernels = feature_test_kernels();
  const auto test = kind == FeaturePair::vertex_face ? kernels.vertex_face : kernels.edge_edge;
  std::fill_n(times, count, std::numeric_limits<double>::infinity());
  std::uint32_t open = test(columns.data(), first, options.min_separation);
  for (open &= (1U << count) - 1U; open != 0; open &= open - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(open));
    std::array<Vec3d, 4> points[2];
    for (std::size_t c = 0; c < 24; ++c)
      points[c / 12][c % 12 / 3][c % 3] = columns[c][first + lane];
    FeatureMotion motion;
    times[lane] = read_motion(kind, points[0], points[1], options.min_separation, motion)
                      ? first_impact(motion, options).time
                      : std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace

bool are_in_range(const FeatureImpactOptions& options) noexcept {
  return options.min_separation >= 0.0 &&
         options.min_separation <= std::numeric_limits<double>::max() && options.tolerance > 0.0 &&
         options.tolerance <= 1.0 && options.max_intervals > 0;
}

void FeatureStage::find(FeaturePair kind, double (&times)[kFeatureLanes],
                        const FeatureImpactOptions& options) const noexcept {
  Columns columns;
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = column_[c];
  find_eight(kind, columns, 0, size_, times, options);
}

Answer<FeatureImpact> feature_impact(FeaturePair kind, const std::array<Vec3d, 4>& start,
                                     const std::array<Vec3d, 4>& end,
                                     const FeatureImpactOptions& options) noexcept {
  const DefaultFloatEnvironment environment;
  if (!are_in_range(options)) return Status::invalid_argument;
  FeatureMotion motion;
  if (!read_motion(kind, start, end, options.min_separation, motion)) return Status::invalid_bounds;
  return first_impact(motion, options);
}

Status feature_impacts(FeaturePair kind, const FeatureColumns& pairs, std::span<double> times,
                       const FeatureImpactOptions& options) noexcept {
  const DefaultFloatEnvironment environment;
  if (times.size() != pairs.count) return Status::size_mismatch;
  const Columns columns = columns_of(pairs);
  const bool missing =
      pairs.count != 0 && std::find(columns.begin(), columns.end(), nullptr) != columns.end();
  if (!are_in_range(options) || missing) return Status::invalid_argument;
  std::size_t i = 0;
  for (; i + kFeatureLanes <= pairs.count; i += kFeatureLanes) {
    find_eight(kind, columns, i, kFeatureLanes, times.data() + i, options);
  }
  if (i == pairs.count) return Status::ok;
  FeatureStage rest;
  for (; i < pairs.count; ++i) {
    std::array<Vec3d, 4> points[2];
    for (std::size_t c = 0; c < 24; ++c) points[c / 12][c % 12 / 3][c % 3] = columns[c][i];
    rest.add(points[0], points[1]);
  }
  double last[kFeatureLanes];
  rest.find(kind, last, options);
  std::copy_n(last, rest.size(), times.end() - static_cast<std::ptrdiff_t>(rest.size()));
  return Status::ok;
}

}  // namespace winnow
