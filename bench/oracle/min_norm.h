#pragma once

#include "bench/oracle/polytope.h"

#include <cstdint>
#include <vector>

namespace winnow::oracle {

/// The gap between two cores along a direction, and the vertices that bound it.
template <typename T>
struct Gap {
  T width{};
  std::uint32_t a = 0;
  std::uint32_t b = 0;
};

/// Returns the minimum of n.b over b minus the maximum of n.a over a, for a unit direction n.
[[nodiscard]] Gap<double> gap_along(const Polytope& a, const Polytope& b, const Vector<double>& n);
[[nodiscard]] Gap<Number> gap_along(const Polytope& a, const Polytope& b, const Vector<Number>& n);

/// Up to four vertices of the Minkowski difference b - a of two cores.
struct Simplex {
  struct Corner {
    std::uint32_t a;
    std::uint32_t b;
    friend bool operator==(const Corner&, const Corner&) = default;
  };
  std::vector<Corner> corner;
};

/// The point of the Minkowski difference of two cores that is nearest to the origin.
template <typename T>
struct Nearest {
  Vector<T> point;
  /// Length of `point`, and the width of the gap along `point`. The exact distance is in
  /// [lower, upper].
  T upper{};
  T lower{};
  bool proven = false;
};

/// Starts from `simplex`, which must not be empty, and stores the last simplex in it. In double the
/// result is a guess; in Number it is proven to 1e-60 of the unit length, or `proven` is false.
/// Coordinates must be of the order of 1.
template <typename T>
[[nodiscard]] Nearest<T> nearest_point(const Polytope& a, const Polytope& b, Simplex& simplex);

}  // namespace winnow::oracle
