// Contact and rest offsets of bodies. Each pair has its own contact distance, which is its margin
// in the narrow phase; contacts are then measured from the surfaces moved by the rest offsets.
// Collision (collide.cpp) calls this before the narrow phase (limit and margins) and after it. In a
// scene without offsets, all pairs have the scene's margin, and the other functions return at once.

#include "core/hooks/log.h"
#include "core/sort/parallel_ranges.h"
#include "core/threads/float_environment.h"
#include "pipeline/narrow/narrow_columns.h"
#include "pipeline/narrow/tight_growth.h"
#include "pipeline/scene/collision.h"
#include "pipeline/scene/scene_observer.h"

#include <cmath>
#include <limits>

namespace winnow {
namespace {

constexpr double kLargestLength = std::numeric_limits<double>::max();
constexpr std::size_t kOffsetPairsPerRange = 256;
/// Relative rounding error of a sum of two doubles.
constexpr double kSumError = 0x1p-52;

/// Updates the depth and position of a point after both surfaces moved out by their rest offsets.
void shift(float& depth, float* const (&position)[3], const Vec3d& normal,
           const double (&rest)[2]) noexcept {
  depth = static_cast<float>(static_cast<double>(depth) + rest[0] + rest[1]);
  for (int k = 0; k < 3; ++k) {
    *position[k] = static_cast<float>(static_cast<double>(*position[k]) +
                                      0.5 * (rest[0] - rest[1]) * normal[k]);
  }
}

/// Bounds the rounding error of a distance plus rest offsets.
[[nodiscard]] double sum_error(double distance, const double (&rest)[2]) noexcept {
  return kSumError * (std::abs(distance) + std::abs(rest[0]) + std::abs(rest[1]));
}

}  // namespace

bool are_good(const ContactOffsets& offsets) noexcept {
  return std::isfinite(offsets.contact) && std::isfinite(offsets.rest) && offsets.contact >= 0.0 &&
         offsets.contact >= offsets.rest;
}

Status Scene::set_offsets(Key key, const ContactOffsets& offsets) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::set_offsets");
  SceneState& s = *state_;
  if (!s.keys.is_valid(key)) return logged(Status::invalid_key, "Scene::set_offsets");
  if (!are_good(offsets)) return logged(Status::invalid_argument, "Scene::set_offsets");
  if (s.offsets.of(key.id) != offsets) {
    if (!s.offsets.begin(s.shape.size(), s.shape.capacity()))
      return logged(Status::out_of_memory, "Scene::set_offsets");
    s.offsets.column[key.id] = offsets;
    s.shaped_at[key.id] = s.clock;
    s.stale.mark(key.id);
  }
  if (s.observer != nullptr) s.observer->set_offsets(key, offsets);
  return Status::ok;
}

bool BodyOffsets::begin(std::size_t bodies, std::size_t room) noexcept {
  if (any) return true;
  if (!column.grow(room)) return false;
  any = true;
  column.set_size(bodies);
  std::fill(column.begin(), column.end(), ContactOffsets{});
  return true;
}

double ContactFilters::gap_of(const BodyPair& pair) const noexcept {
  const double own = scene_.offsets.of(pair.a).contact + scene_.offsets.of(pair.b).contact;
  return std::min(scene_.options.contact_margin + own, kLargestLength);
}

// Sets the limit that decides for all pairs whether they are in contact; no pair's own contact
// distance exceeds it. `trim` therefore replaces a distance that exceeds the pair's own contact
// distance by the limit plus the excess.
void ContactFilters::find_limit() noexcept {
  call_.limit = scene_.options.contact_margin;
  if (!scene_.offsets.any) return;
  for (const Column<BodyPair>* const list : {&scene_.batch.convex, &scene_.batch.composite}) {
    for (const BodyPair& pair : *list) {
      const double gap = gap_of(pair);
      const double rest = scene_.offsets.of(pair.a).rest + scene_.offsets.of(pair.b).rest;
      call_.limit = std::max(call_.limit, std::min(gap - std::min(rest, 0.0), kLargestLength));
    }
  }
}

bool ContactFilters::find_margins(const Column<BodyPair>& pairs, double more,
                                  PairMargins& margins) {
  margins = std::min(scene_.options.contact_margin + more, kLargestLength);
  if (!scene_.offsets.any) return true;
  Column<double>& gaps = scene_.batch.gaps;
  if (!resize_tightly(gaps, pairs.size())) return false;
  double largest = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    gaps[i] = std::min(gap_of(pairs[i]) + more, kLargestLength);
    largest = std::max(largest, gaps[i]);
  }
  margins = {largest, {gaps.data(), gaps.size()}};
  return true;
}

bool ContactFilters::find_part_margins(PairMargins& margins) {
  margins = scene_.options.contact_margin;
  if (!scene_.offsets.any) return true;
  const PrimitivePairs& parts = scene_.batch.parts->pairs;
  Column<double>& gaps = scene_.batch.parts->gaps;
  if (!resize_tightly(gaps, parts.pairs.size())) return false;
  double largest = 0.0;
  for (std::size_t i = 0; i < scene_.batch.composite.size(); ++i) {
    const double gap = gap_of(scene_.batch.composite[i]);
    std::fill(gaps.begin() + parts.first[i], gaps.begin() + parts.first[i + 1], gap);
    largest = std::max(largest, gap);
  }
  margins = {largest, {gaps.data(), gaps.size()}};
  return true;
}

void ContactFilters::trim(double gap, std::uint32_t at, const NarrowColumns& answers) noexcept {
  double& distance = answers.distance[at];
  const double beyond = distance - gap;
  if (!(beyond > 0.0)) return;
  distance = std::min(std::max(call_.limit + beyond, std::nextafter(call_.limit, kLargestLength)),
                      kLargestLength);
}

void ContactFilters::trim_convex() noexcept {
  if (call_.level < ContactLevel::distance || !scene_.offsets.any) return;
  const NarrowColumns answers = NarrowColumns::of(scene_.batch.answers);
  for_each_range(scene_.options.execution, scene_.batch.convex.size(), kOffsetPairsPerRange,
                 [&](std::size_t first, std::size_t end) {
                   for (auto i = static_cast<std::uint32_t>(first); i < end; ++i) {
                     trim(scene_.batch.gaps[i], i, answers);
                     rest(scene_.batch.convex[i], i, answers);
                   }
                 });
}

void ContactFilters::trim_parts() noexcept {
  if (call_.level < ContactLevel::distance || !scene_.offsets.any) return;
  const PartAnswers& parts = *scene_.batch.parts;
  const NarrowColumns answers = NarrowColumns::of(scene_.batch.parts->answers);
  for_each_range(scene_.options.execution, parts.gaps.size(), kOffsetPairsPerRange,
                 [&](std::size_t first, std::size_t end) {
                   for (std::size_t k = first; k < end; ++k) {
                     trim(parts.gaps[k], parts.slot[k], answers);
                   }
                 });
}

// Measures distance and points from the surfaces moved by the rest offsets.
void ContactFilters::rest(const BodyPair& bodies, std::uint32_t at,
                          const NarrowColumns& answers) noexcept {
  const double rest[2] = {scene_.offsets.of(bodies.a).rest, scene_.offsets.of(bodies.b).rest};
  double& distance = answers.distance[at];
  if ((rest[0] == 0.0 && rest[1] == 0.0) || distance > call_.limit) return;
  answers.error_bound[at] += sum_error(distance, rest);
  distance -= rest[0] + rest[1];
  const double normal[3] = {answers.normal[0][at], answers.normal[1][at], answers.normal[2][at]};
  if (call_.level == ContactLevel::distance) {
    for (int k = 0; k < 3; ++k) answers.point[k][at] += rest[0] * normal[k];
    return;
  }
  const std::uint32_t first = answers.contact_first[at];
  for (std::uint32_t i = first; i < first + answers.contact_count[at]; ++i) {
    Column<float>(&position)[3] = answers.contacts.position;
    shift(answers.contacts.depth[i], {&position[0][i], &position[1][i], &position[2][i]}, normal,
          rest);
  }
}

void ContactFilters::rest_parts() noexcept {
  if (call_.level < ContactLevel::distance || !scene_.offsets.any) return;
  const NarrowColumns answers = NarrowColumns::of(scene_.batch.parts->answers);
  for_each_range(scene_.options.execution, scene_.batch.composite.size(), kOffsetPairsPerRange,
                 [&](std::size_t first, std::size_t end) {
                   for (std::size_t i = first; i < end; ++i) {
                     const BodyPair& bodies = scene_.batch.composite[i];
                     if (call_.reduces) {
                       rest_regions(bodies, i);
                       continue;
                     }
                     const std::uint32_t* const of = scene_.batch.parts->pairs.first.data() + i;
                     for (std::uint32_t k = of[0]; k < of[1]; ++k) {
                       rest(bodies, scene_.batch.parts->slot[k], answers);
                     }
                   }
                 });
}

void ContactFilters::rest_regions(const BodyPair& bodies, std::size_t pair) noexcept {
  const double rest[2] = {scene_.offsets.of(bodies.a).rest, scene_.offsets.of(bodies.b).rest};
  if (rest[0] == 0.0 && rest[1] == 0.0) return;
  ContactRegions& all = scene_.batch.parts->regions;
  for (ContactRegion& region : std::span(all.regions.data() + all.first[pair], all.count[pair])) {
    region.error_bound += sum_error(region.distance, rest);
    region.distance -= rest[0] + rest[1];
    for (ContactPoint& point : std::span(region.point, region.count)) {
      Vec3f& at = point.position;
      shift(point.depth, {&at[0], &at[1], &at[2]}, region.normal, rest);
    }
  }
}

}  // namespace winnow
