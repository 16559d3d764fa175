#pragma once

#include <deque>
#include <vector>

#include "tests/queries/answers.h"
#include "tests/support/hostile_scenes.h"
#include "tests/support/random.h"

namespace winnow::test {

/// Regions of every kind at, around and between the boxes of a scene. Planes that a region looks at
/// are added to `planes`, which must outlive it and not lose an element.
[[nodiscard]] std::vector<Region> some_regions(std::span<const Aabb> boxes, std::size_t count,
                                               Random& random,
                                               std::deque<std::vector<Plane>>& planes);

/// Casts of every kind.
[[nodiscard]] std::vector<Cast> some_casts(std::span<const Aabb> boxes, std::size_t count,
                                           Random& random);

/// A scene with questions about it and their right answers; object ids count the boxes.
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

/// So many casts and regions about a scene, with their right answers.
void add_questions(std::deque<QuestionSet>& sets, const Scene& scene, std::size_t casts,
                   std::size_t regions);

/// Random, degenerate, infinite and extreme scenes, and those of every size about a block's. Made
/// once per process.
[[nodiscard]] const std::deque<QuestionSet>& question_sets();

/// For messages.
[[nodiscard]] std::string to_string(const Cast& cast);
[[nodiscard]] std::string to_string(const Region& region);

}  // namespace winnow::test
