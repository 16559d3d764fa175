#pragma once

#include "pipeline/scene/queries/swept_shapes.h"

namespace winnow {

/// A mesh, height field or compound that moves along a line without turning. In its frame the other
/// body moves the opposite way: only its parts that the swept box of the other part overlaps are
/// cast. The cast must outlive this object.
class CompositeSweep final : public SweptShape {
 public:
  CompositeSweep(const SubShapeQuery& parts, const ShapeCast& cast, double tolerance) noexcept;
  void note_contact(const double from[3], const SubShape& part,
                    impact::RestingContacts& resting) const noexcept override;
  [[nodiscard]] bool meets(const double from[3], const SubShape& part, double limit,
                           const EarlierContacts& known,
                           SweepContact& meeting) const noexcept override;
  void describe(const double from[3], const SubShape& part,
                SweepContact& meeting) const noexcept override;

 private:
  class PartSearch;

  const SubShapeQuery& parts_;
  const ShapeCast& cast_;
};

}  // namespace winnow
