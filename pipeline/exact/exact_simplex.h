#pragma once

#include "pipeline/exact/exact_vector.h"

#include <cstdint>

namespace winnow {

/// Up to four affinely independent points, the newest last.
struct ExactSimplex {
  int size = 0;
  ExactVector point[4];
  /// Where they come from.
  std::uint32_t a[4];
  std::uint32_t b[4];
};

/// Keeps the smallest face of the simplex that contains its point nearest to the origin, which is
/// one that contains the newest point. `toward` becomes a direction from that nearest point to the
/// origin, zero if they are the same: the origin then lies in the relative interior of the face.
///
/// Tries faces by dimension; one is the nearest if the origin projects into its interior and the
/// other points lie behind the plane through it (Johnson's conditions: Gilbert, Johnson and
/// Keerthi, 1988), so no distances are compared.
void keep_nearest_face(ExactSimplex& simplex, ExactVector& toward) noexcept;

/// Sign of (squared distance of the origin from the face that keep_nearest_face kept) - `square`.
[[nodiscard]] int compare_square_distance(const ExactSimplex& face, const Dyadic& square) noexcept;

}  // namespace winnow
