#pragma once

#include <winnow/core/rays.h>
#include <winnow/core/volumes.h>
#include "pipeline/composites/parts.h"

#include <Eigen/Core>

namespace winnow {

/// Converts a moving box in double to queries in float for partitions, so that nothing is missed.
/// The path is divided into pieces, which are consecutive intervals of t.
///
/// Each piece starts at the position of the box in double, and moves by the direction rounded to
/// float. At its end the deviation from the true path is at most 2^-24 of the length of the piece;
/// the start position has an error of a few roundings of the coordinates. The box of the BoxCast is
/// enlarged by more than both, so it contains the true box at every t. A body's box in the
/// partition contains the body. The length of a piece is at most 2^10 times the distance from the
/// start at which the piece begins, or for the first piece 2^10 times the largest coordinate. Its
/// box is thus too large by at most about 2^-13 of this distance or coordinate. After kMaxPieces
/// pieces, or at the end of the range of float, the rest of the path is tested as one box that
/// contains it.
class BoxPath {
 public:
  /// The direction must be finite and not zero, max_t >= 0 may be infinite, the box must be finite.
  /// Partition coordinates are relative to `origin`.
  BoxPath(const mid::Box3& box, const Eigen::Vector3d& origin, const double direction[3],
          double max_t) noexcept;

  /// Advances to the next piece; call it for the first piece too. Returns false at the end.
  [[nodiscard]] bool next() noexcept;
  /// True for a last piece that is too long for `cast`: test the box `rest` instead.
  [[nodiscard]] bool is_rest() const noexcept { return is_rest_; }

  /// Start of the piece, in the caller's t.
  [[nodiscard]] double begin() const noexcept;
  /// Returns the cast of the piece up to slightly more than t = limit; min_t = 0 is the start of
  /// the piece.
  [[nodiscard]] BoxCast cast(double limit) const noexcept;
  [[nodiscard]] Aabb rest(double limit) const noexcept;

 private:
  [[nodiscard]] mid::Box3 at(double path) const noexcept;
  [[nodiscard]] double slack(double end) const noexcept;

  // Path parameters are t times 2^exponent_, which makes them approximately lengths.
  mid::Box3 box_;
  Eigen::Vector3d step_;
  int exponent_ = 0;
  double reach_ = 0.0;
  /// Largest coordinate that was rounded, including world coordinates.
  double rounded_reach_ = 0.0;
  double from_ = 0.0;
  double to_ = 0.0;
  double last_ = 0.0;
  int pieces_ = 0;
  bool is_rest_ = false;
};

}  // namespace winnow
