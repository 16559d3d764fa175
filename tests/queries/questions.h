#pragma once

#include <deque>
#include <vector>

#include "tests/queries/answers.h"
#include "tests/support/hostile_scenes.h"
#include "tests/support/random.h"

namespace winnow::test {

/// Returns regions of every kind at, around and between the boxes of a scene. The planes of regions
/// are added to `planes`, which must outlive the regions and not lose an element.
[[nodiscard]] std::vector<Region> some_regions(std::span<const Aabb> boxes, std::size_t count,
                                               Random& random,
                                               std::deque<std::vector<Plane>>& planes);

/// Returns casts of every kind.
[[nodiscard]] std::vector<Cast> some_casts(std::span<const Aabb> boxes, std::size_t count,
                                           Random& random);

/// A scene with queries and their right results. The id of an object is the index of its box.
struct QuestionSet {
  std::string name;
  std::vector<Aabb> boxes;
  std::vector<Object> objects;
  std::vector<Cast> casts;
  std::vector<CastCandidates> cast_truths;
  std::deque<std::vector<Plane>> planes;
  std::vector<Region> regions;
  std::vector<RegionCandidates> region_truths;
};

/// Adds a scene with this number of casts and regions and their right results.
void add_questions(std::deque<QuestionSet>& sets, const Scene& scene, std::size_t casts,
                   std::size_t regions);

/// Returns random, degenerate, infinite and extreme scenes, and scenes of every size near the size
/// of a block. Created once per process.
[[nodiscard]] const std::deque<QuestionSet>& question_sets();

/// Texts for messages.
[[nodiscard]] std::string to_string(const Cast& cast);
[[nodiscard]] std::string to_string(const Region& region);

}  // namespace winnow::test
