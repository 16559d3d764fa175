#pragma once

#include <winnow/core/status.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_rays.h>
#include "bench/common/json.h"

namespace winnow::bench {

/// Answers queries about shapes of any type, each in a scene of its own.
class SceneQuestions {
 public:
  SceneQuestions(NarrowTier tier, bool with_contacts) noexcept
      : tier_(tier), with_contacts_(with_contacts) {}

  /// Returns whether answers about pairs list the contacts.
  [[nodiscard]] bool with_contacts() const noexcept { return with_contacts_; }

  /// Writes the overlap, the distance and the contacts of "a" and "b" to the answer; see `answer`
  /// in questions.h. Writes nothing if the status is not `ok`.
  [[nodiscard]] Status answer_pair(const Json& question, Json& answer) const;
  /// Writes the first hit of "ray" on "target" to the answer, as `answer_pair`.
  [[nodiscard]] Status answer_ray(const Json& question, Json& answer) const;

 private:
  NarrowTier tier_;
  bool with_contacts_;
};

/// Writes a hit of a ray to its answer.
void write_ray_hit(const ShapeHit& hit, Json& answer);

}  // namespace winnow::bench
