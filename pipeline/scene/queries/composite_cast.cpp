#include "pipeline/scene/queries/composite_cast.h"

#include "pipeline/composites/part_tables.h"
#include "pipeline/composites/shape_distance.h"

#include <algorithm>
#include <cmath>

namespace winnow {

/// A fixed convex part relative to the start of the composite shape, so that the parts of both
/// shapes keep full precision far from the origin. The rounding error of the difference is added to
/// the shape's pose, where it is small.
class CompositeCast::PartSearch {
 public:
  PartSearch(const CompositeCast& composite, const double from[3], const SubShape& part) noexcept
      : composite_(composite),
        stationary_(part),
        moving_{composite.cast_.shape, composite.cast_.pose} {
    const TwoDiff apart = difference(part.pose.position.data(), from);
    for (int i = 0; i < 3; ++i) {
      stationary_.pose.position[i] = apart.difference[i];
      moving_.pose.position[i] = -apart.rest[i];
    }
    stationary_.thickness = corner_error(stationary_);
  }

  /// Calls visit(own part, limit), as SubShapeQuery::visit_parts does, for own parts that may touch
  /// the fixed part by then, or come within `more` of it.
  template <typename Visit>
  void each(double limit, Visit&& visit, double more = 0.0) const {
    composite_.parts_.visit_parts(moving_, way(limit, more), visit);
  }

  /// True if one part is a one-sided triangle and the other is behind it.
  [[nodiscard]] bool any_is_behind(const SubShape& own) const noexcept {
    return is_either_behind(composite_.parts_, own, stationary_);
  }

  [[nodiscard]] CastPair pair(PartTables& tables, const SubShape& own) const noexcept {
    SubShape thick = own;
    thick.thickness = corner_error(own);
    CastPair pair;
    pair.moving = tables.put(0, thick);
    pair.from = own.pose;
    pair.direction = composite_.cast_.direction;
    pair.stationary = tables.put(1, stationary_);
    pair.pose = stationary_.pose;
    return pair;
  }

 private:
  /// The moving box of the fixed part in the frame of the composite shape; if that is unbounded,
  /// the box of the whole shape.
  [[nodiscard]] MovingBox way(double limit, double more) const noexcept {
    const mid::Box3 box = composite_.parts_.box(stationary_).grown(stationary_.thickness + more);
    const double reach = composite_.extent().largest() + box.largest();
    MovingBox moving_box;
    if (std::isfinite(reach)) {
      moving_box = stationary(box.grown(kCastBoxGrowth * reach));
      for (int i = 0; i < 3; ++i) moving_box.direction[i] = -composite_.direction()[i];
    } else {
      moving_box = stationary(composite_.parts_.box(moving_));
    }
    moving_box.max_t = limit;
    return moving_box;
  }

  const CompositeCast& composite_;
  SubShape stationary_;
  PlacedShape moving_;
};

CompositeCast::CompositeCast(const SubShapeQuery& parts, const ShapeCast& cast,
                             double tolerance) noexcept
    : LinearCast(parts.box(PlacedShape{cast.shape, at_origin(cast.pose)}), cast, tolerance),
      parts_(parts),
      cast_(cast) {}

void CompositeCast::note_contact(const double from[3], const SubShape& part,
                                 impact::RestingContacts& resting) const noexcept {
  const PartSearch approach(*this, from, part);
  auto record = [&](const SubShape& own, double most) {
    PartTables tables(parts_.shapes());
    CastMotions(approach.pair(tables, own), max_t()).record(tables.tables(), resting);
    return most;
  };
  approach.each(0.0, record, tolerance());
}

bool CompositeCast::find_contact(const double from[3], const SubShape& part, double limit,
                                 const EarlierContacts& known,
                                 CastContact& contact) const noexcept {
  const PartSearch approach(*this, from, part);
  bool found = false;
  approach.each(limit, [&](const SubShape& own, double most) {
    PartTables tables(parts_.shapes());
    CastPair pair = approach.pair(tables, own);
    pair.max_t = most = std::min(most, limit);
    if (approach.any_is_behind(own)) return most;
    if (known.resting != nullptr &&
        CastMotions(pair, max_t()).part(tables.tables(), *known.resting)) {
      return most;
    }
    CastTouch touch;
    if (!cast_shape(tables.tables(), pair, tolerance(), touch)) return most;
    if (found && touch.t == limit && contact.own_part < own.part) return most;
    found = true;
    contact = contact_of(touch);
    contact.own_part = own.part;
    return limit = touch.t;
  });
  return found;
}

void CompositeCast::describe(const double from[3], const SubShape& part,
                             CastContact& contact) const noexcept {
  const PartSearch approach(*this, from, part);
  approach.each(max_t(), [&](const SubShape& own, double most) {
    if (own.part != contact.own_part) return most;
    PartTables tables(parts_.shapes());
    const CastPair pair = approach.pair(tables, own);
    describe_contact(tables.tables(), pair, part, contact);
    return -1.0;
  });
}

}  // namespace winnow
