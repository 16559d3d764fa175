#pragma once

#include "pipeline/scene/queries/swept_shapes.h"

namespace winnow {

/// A mesh, height field or compound that moves along a line without turning. As it sees it, what
/// stands comes the other way: cast are those of its parts that the box of what stands meets on
/// that way. The cast must outlive it.
class CompositeSweep final : public SweptShape {
 public:
  CompositeSweep(const PartTraversal& parts, const ShapeCast& cast, double tolerance) noexcept;
  void note_contact(const double from[3], const ConvexPart& part,
                    impact::RestingContacts& resting) const noexcept override;
  [[nodiscard]] bool meets(const double from[3], const ConvexPart& part, double limit,
                           const KnownMeetings& known,
                           SweepMeeting& meeting) const noexcept override;
  void describe(const double from[3], const ConvexPart& part,
                SweepMeeting& meeting) const noexcept override;

 private:
  class Approach;

  const PartTraversal& parts_;
  const ShapeCast& cast_;
};

}  // namespace winnow
