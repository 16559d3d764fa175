#pragma once

#include "pipeline/scene/scene_state.h"

namespace winnow {

/// Applies BodyPairRules::may_pair to pairs of objects of two partitions.
struct BodyPredicate {
  const SceneState& scene;
  const std::uint32_t* first_body;
  const std::uint32_t* second_body;

  /// Returns options with this predicate, or without one if the scene accepts all pairs. This
  /// object must outlive the query.
  [[nodiscard]] PairOptions options() const noexcept {
    PairOptions options;
    if (scene.rules.accepts_all()) return options;
    options.predicate = {[](void* context, ObjectId first, ObjectId second) {
                           const auto& predicate = *static_cast<const BodyPredicate*>(context);
                           return predicate.scene.rules.may_pair(predicate.first_body[first],
                                                                 predicate.second_body[second]);
                         },
                         const_cast<BodyPredicate*>(this)};
    return options;
  }
};

}  // namespace winnow
