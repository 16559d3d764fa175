// Detects resting scenes for RestingPairs.

#include "partitions/pairs/resting_pairs.h"

#include <array>
#include <cfloat>
#include <cmath>

namespace winnow {

bool RestDetector::seems_at_rest(const Rows& rows) noexcept {
  if (delay_left_ != 0) {
    --delay_left_;
    return false;
  }
  if (frames_compared_ == 0 || sample_.empty()) {
    frames_compared_ = take_sample(rows) ? 1 : 0;
    return false;
  }
  // Over three frames a drifting object moves three steps, a random walk sqrt(3) steps; the limit
  // excludes both.
  constexpr float kNoFurther = 1.4F;
  const float step = step_of_sample(rows);
  if (frames_compared_ == 1) first_ = step;
  furthest_ = frames_compared_ == 1 ? step : std::max(furthest_, step);
  const bool rests = step <= kNoFurther * first_ + kMinSkin * edge_ && skin() <= kMaxSkin * edge_;
  frames_compared_ = rests ? frames_compared_ + 1 : 0;
  return frames_compared_ > kFramesToCompare;
}

bool RestDetector::take_sample(const Rows& rows) noexcept {
  sample_.clear();
  if (!sample_.reserve(kSample)) return false;
  std::array<float, kSample> edges;
  const std::size_t count = rows.pool().rows();
  for (std::size_t s = 0; s < kSample; ++s) {
    const ObjectId id = rows.pool().ids()[count * s / kSample];
    Aabb box;
    const Key key = rows.keys().key_of(id);
    if (rows.bounds(key, box) != Status::ok) continue;
    const Vec3f edge = box.max - box.min;
    edges[sample_.size()] = std::max({edge.x(), edge.y(), edge.z()});
    (void)sample_.push_back(
        {key, {box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}});
  }
  if (sample_.empty()) return false;
  const auto middle = edges.begin() + sample_.size() / 2;
  std::nth_element(edges.begin(), middle, edges.begin() + sample_.size());
  edge_ = *middle;
  return edge_ < FLT_MAX;
}

// Returns the distance within which about 97 % of the sampled objects are from their sampled
// positions. Skips objects that were removed or have infinite boxes.
float RestDetector::step_of_sample(const Rows& rows) const noexcept {
  std::array<float, kSample> steps;
  std::size_t size = 0;
  for (const SampledBox& old : sample_) {
    Aabb box;
    if (rows.bounds(old.key, box) != Status::ok) continue;
    float step = 0.0F;
    for (int axis = 0; axis < 3; ++axis) {
      step = std::max(step, std::abs(box.min[axis] - old.min[axis]));
      step = std::max(step, std::abs(box.max[axis] - old.max[axis]));
    }
    if (step < FLT_MAX) steps[size++] = step;
  }
  if (size == 0) return FLT_MAX;
  const auto most = steps.begin() + (size - 1 - size / 32);
  std::nth_element(steps.begin(), most, steps.begin() + size);
  return *most;
}

void RestDetector::end() noexcept {
  delay_ = frames_ < kWorthwhile ? std::min(2 * delay_ + 4, kLongest) : 0;
  delay_left_ = delay_;
  frames_ = 0;
  frames_compared_ = 0;
}

void RestDetector::release() noexcept {
  sample_.release();
  frames_compared_ = 0;
}

Bytes RestDetector::bytes() const noexcept {
  return sample_.bytes();
}

}  // namespace winnow
