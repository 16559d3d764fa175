#pragma once

#include "pipeline/scene/scene_state.h"

namespace winnow {

/// Asks about objects of partitions what a scene has been told about bodies.
struct BodyPredicate {
  const SceneState& scene;
  const std::uint32_t* first_body;
  const std::uint32_t* second_body;

  /// Without a predicate where nothing was told. This must outlive the question.
  [[nodiscard]] PairOptions options() const noexcept {
    PairOptions options;
    if (scene.meets_all()) return options;
    options.predicate = {[](void* context, ObjectId first, ObjectId second) {
                           const auto& asked = *static_cast<const BodyPredicate*>(context);
                           return asked.scene.may_pair(asked.first_body[first],
                                                       asked.second_body[second]);
                         },
                         const_cast<BodyPredicate*>(this)};
    return options;
  }
};

}  // namespace winnow
