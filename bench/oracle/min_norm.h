#pragma once

#include "bench/oracle/polytope.h"

#include <cstdint>
#include <vector>

namespace winnow::oracle {

/// How far two cores are apart along a direction, and the vertices that say so.
template <typename T>
struct Gap {
  T width{};
  std::uint32_t a = 0;
  std::uint32_t b = 0;
};

/// min over b of n.b less max over a of n.a, for a direction of length 1.
[[nodiscard]] Gap<double> gap_along(const Polytope& a, const Polytope& b, const Vector<double>& n);
[[nodiscard]] Gap<Number> gap_along(const Polytope& a, const Polytope& b, const Vector<Number>& n);

/// Up to four vertices of the difference of two cores, b less a.
struct Simplex {
  struct Corner {
    std::uint32_t a;
    std::uint32_t b;
    friend bool operator==(const Corner&, const Corner&) = default;
  };
  std::vector<Corner> corner;
};

/// The point of the difference of two cores that is nearest to the origin.
template <typename T>
struct Nearest {
  Vector<T> point;
  /// Its length, and that of the widest gap along it: the truth lies between.
  T upper{};
  T lower{};
  bool proven = false;
};

/// From the simplex given, which must not be empty; it is left where the search ended. In double
/// the result is a guess; in Number it is proven to 1e-60 of the unit length or says that it is
/// not. Coordinates are of the order of 1.
template <typename T>
[[nodiscard]] Nearest<T> nearest_point(const Polytope& a, const Polytope& b, Simplex& simplex);

}  // namespace winnow::oracle
