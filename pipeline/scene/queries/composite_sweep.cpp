#include "pipeline/scene/queries/composite_sweep.h"

#include "pipeline/scene/queries/shape_distance.h"

#include <algorithm>
#include <cmath>

namespace winnow {

/// A fixed convex part relative to the start of the composite shape, so that the parts of both keep
/// full precision far from the origin. The rounding error of the difference is added to the shape's
/// pose, where it is small.
class CompositeSweep::PartSearch {
 public:
  PartSearch(const CompositeSweep& sweep, const double from[3], const SubShape& part) noexcept
      : sweep_(sweep), standing_(part), moving_{sweep.cast_.shape, sweep.cast_.pose} {
    const TwoDiff apart = difference(part.pose.position, from);
    for (int i = 0; i < 3; ++i) {
      standing_.pose.position[i] = apart.difference[i];
      moving_.pose.position[i] = -apart.rest[i];
    }
    standing_.thickness = corner_error(standing_);
  }

  /// Calls look(own part, limit), as SubShapeQuery::met does, for own parts that may touch the
  /// fixed part by then, or come within `more` of it.
  template <typename Look>
  void each(double limit, Look&& look, double more = 0.0) const {
    sweep_.parts_.met(moving_, way(limit, more), look);
  }

  /// True if one part is a one-sided triangle and the other is behind it.
  [[nodiscard]] bool any_is_behind(const SubShape& own) const noexcept {
    return any_stands_behind(sweep_.parts_, own, standing_);
  }

  [[nodiscard]] CastPair pair(PartTables& tables, const SubShape& own) const noexcept {
    SubShape thick = own;
    thick.thickness = corner_error(own);
    CastPair pair;
    pair.moving = tables.put(0, thick);
    pair.from = own.pose;
    std::copy_n(sweep_.cast_.direction, 3, pair.direction);
    pair.standing = tables.put(1, standing_);
    pair.pose = standing_.pose;
    return pair;
  }

 private:
  /// The swept box of the fixed part in the frame of the composite shape; if that is unbounded, the
  /// box of the whole shape.
  [[nodiscard]] BoxSweep way(double limit, double more) const noexcept {
    const PreciseBox box = sweep_.parts_.box(standing_).grown(standing_.thickness + more);
    const PreciseBox& own = sweep_.extent();
    const double reach = std::max(own.min.cwiseAbs().maxCoeff(), own.max.cwiseAbs().maxCoeff()) +
                         std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
    BoxSweep sweep;
    if (std::isfinite(reach)) {
      sweep = box.grown(kSweptBoxGrowth * reach).standing();
      for (int i = 0; i < 3; ++i) sweep.direction[i] = -sweep_.direction()[i];
    } else {
      sweep = sweep_.parts_.box(moving_).standing();
    }
    sweep.max_t = limit;
    return sweep;
  }

  const CompositeSweep& sweep_;
  SubShape standing_;
  PlacedShape moving_;
};

CompositeSweep::CompositeSweep(const SubShapeQuery& parts, const ShapeCast& cast,
                               double tolerance) noexcept
    : SweptShape(parts.box(PlacedShape{cast.shape, at_origin(cast.pose)}), cast, tolerance),
      parts_(parts),
      cast_(cast) {}

void CompositeSweep::note_contact(const double from[3], const SubShape& part,
                                  impact::RestingContacts& resting) const noexcept {
  const PartSearch approach(*this, from, part);
  auto record = [&](const SubShape& own, double most) {
    PartTables tables(parts_.shapes());
    CastMotions(approach.pair(tables, own), max_t()).record(tables.tables(), resting);
    return most;
  };
  approach.each(0.0, record, tolerance());
}

bool CompositeSweep::meets(const double from[3], const SubShape& part, double limit,
                           const EarlierContacts& known, SweepContact& meeting) const noexcept {
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
    if (found && touch.t == limit && meeting.own_part < own.part) return most;
    found = true;
    meeting = contact_of(touch);
    meeting.own_part = own.part;
    return limit = touch.t;
  });
  return found;
}

void CompositeSweep::describe(const double from[3], const SubShape& part,
                              SweepContact& meeting) const noexcept {
  const PartSearch approach(*this, from, part);
  approach.each(max_t(), [&](const SubShape& own, double most) {
    if (own.part != meeting.own_part) return most;
    PartTables tables(parts_.shapes());
    const CastPair pair = approach.pair(tables, own);
    describe_contact(tables.tables(), pair, part, meeting);
    return -1.0;
  });
}

}  // namespace winnow
