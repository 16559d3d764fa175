#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/cast.h>
#include "pipeline/scene/queries/queries_parts.h"

namespace winnow {

/// The way of a box in double as the partitions can be asked about it, in float, so that nothing is
/// missed. It comes in pieces, each an interval of t, in order:
///
/// A piece begins where the box is at its beginning, in double, and moves by the direction rounded
/// to float; up to its end, that leaves the true way by at most 2^-24 of the length of the piece,
/// and what double and float make of the beginning is a few roundings of the coordinates: the box
/// of the BoxCast is larger by more than both, and so contains the true box at every t. A body's
/// own box in the partition contains the body. The first piece is no longer than the coordinates at
/// its beginning times 2^10, and each further one 2^10 times as long: at every t the box is so at
/// most 2^-14 of the distance from the beginning too large. After some of these, and where floats
/// end, the rest of the way is asked about as a box that contains all of it.
class BoxWay {
 public:
  /// The direction is finite and not zero, max_t >= 0 may be infinite, the box is finite.
  BoxWay(const PreciseBox& box, const double direction[3], double max_t) noexcept;

  /// Goes to the next piece, the first one to begin with. False if there is none.
  [[nodiscard]] bool next() noexcept;
  /// True for a last piece that is to be asked about by `rest`.
  [[nodiscard]] bool is_rest() const noexcept { return is_rest_; }

  /// Where the piece begins, in the caller's t.
  [[nodiscard]] double begin() const noexcept;
  /// The piece up to t = limit, and a little more; min_t = 0 is its beginning.
  [[nodiscard]] BoxCast cast(double limit) const noexcept;
  [[nodiscard]] Aabb rest(double limit) const noexcept;

 private:
  [[nodiscard]] PreciseBox at(double way) const noexcept;
  [[nodiscard]] double slack(double end) const noexcept;

  // Lengths of way are t times a power of two that makes them about lengths.
  PreciseBox box_;
  Eigen::Vector3d step_;
  int exponent_ = 0;
  double reach_ = 0.0;
  double from_ = 0.0;
  double to_ = 0.0;
  double last_ = 0.0;
  int pieces_ = 0;
  bool is_rest_ = false;
};

}  // namespace winnow
