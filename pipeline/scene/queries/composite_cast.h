#pragma once

#include "pipeline/scene/queries/linear_casts.h"

namespace winnow {

/// A mesh, height field or compound that moves along a line without turning. In the frame of this
/// shape the other body moves in the opposite direction. Only parts of this shape whose boxes the
/// swept box of a part of the other body overlaps are cast. The cast must outlive this object.
class CompositeCast final : public LinearCast {
 public:
  CompositeCast(const SubShapeQuery& parts, const ShapeCast& cast, double tolerance) noexcept;
  void note_contact(const double from[3], const SubShape& part,
                    impact::RestingContacts& resting) const noexcept override;
  [[nodiscard]] bool find_contact(const double from[3], const SubShape& part, double limit,
                                  const EarlierContacts& known,
                                  CastContact& contact) const noexcept override;
  void describe(const double from[3], const SubShape& part,
                CastContact& contact) const noexcept override;

 private:
  class PartSearch;

  const SubShapeQuery& parts_;
  const ShapeCast& cast_;
};

}  // namespace winnow
