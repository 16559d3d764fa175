#include "pipeline/exact/exact_simplex.h"

namespace winnow {
namespace {

/// True if the origin projects into the interior of the segment; then `toward` leads there.
[[nodiscard]] bool segment_faces(const ExactVector& a, const ExactVector& b,
                                 ExactVector& toward) noexcept {
  const ExactVector edge = b - a;
  const Dyadic along = dot(a, edge);
  if (along.sign() >= 0 || dot(b, edge).sign() <= 0) return false;
  toward = edge * along - a * dot(edge, edge);
  return true;
}

[[nodiscard]] bool triangle_faces(const ExactVector& a, const ExactVector& b, const ExactVector& c,
                                  ExactVector& toward) noexcept {
  const ExactVector normal = cross(b - a, c - a);
  if (dot(normal, cross(b, c)).sign() <= 0 || dot(normal, cross(c, a)).sign() <= 0 ||
      dot(normal, cross(a, b)).sign() <= 0) {
    return false;
  }
  const int side = dot(normal, a).sign();
  toward = side > 0 ? -normal : side < 0 ? normal : ExactVector{};
  return true;
}

/// Points of a simplex by the bits of a mask.
struct Face {
  int count = 0;
  int index[4] = {};
};

[[nodiscard]] Face face_of(unsigned mask) noexcept {
  Face face;
  for (int i = 0; i < 4; ++i) {
    if ((mask >> i & 1U) != 0) face.index[face.count++] = i;
  }
  return face;
}

[[nodiscard]] bool is_nearest(const ExactSimplex& s, unsigned mask, ExactVector& toward) noexcept {
  const Face face = face_of(mask);
  const ExactVector& first = s.point[face.index[0]];
  bool faces = true;
  switch (face.count) {
    case 1:
      toward = -first;
      break;
    case 2:
      faces = segment_faces(first, s.point[face.index[1]], toward);
      break;
    default:
      faces = triangle_faces(first, s.point[face.index[1]], s.point[face.index[2]], toward);
  }
  if (!faces) return false;
  const Dyadic plane = dot(toward, first);
  for (int i = 0; i < s.size; ++i) {
    if ((mask >> i & 1U) == 0 && compare(dot(toward, s.point[i]), plane) > 0) return false;
  }
  return true;
}

void keep(ExactSimplex& s, unsigned mask) noexcept {
  int kept = 0;
  for (int i = 0; i < s.size; ++i) {
    if ((mask >> i & 1U) == 0) continue;
    if (kept != i) {
      s.point[kept] = s.point[i];
      s.a[kept] = s.a[i];
      s.b[kept] = s.b[i];
    }
    ++kept;
  }
  s.size = kept;
}

}  // namespace

void keep_nearest_face(ExactSimplex& simplex, ExactVector& toward) noexcept {
  const unsigned newest = 1U << (simplex.size - 1);
  for (int count = 1; count <= 3; ++count) {
    for (unsigned mask = newest; mask < 2 * newest; ++mask) {
      if (face_of(mask).count != count || !is_nearest(simplex, mask, toward)) continue;
      keep(simplex, mask);
      return;
    }
  }
  toward = ExactVector{};
}

int compare_square_distance(const ExactSimplex& face, const Dyadic& square) noexcept {
  const ExactVector& a = face.point[0];
  if (face.size == 1) return compare(dot(a, a), square);
  const ExactVector edge = face.point[1] - a;
  if (face.size == 2) {
    const Dyadic along = dot(a, edge);
    const Dyadic length = dot(edge, edge);
    return compare(dot(a, a) * length - along * along, square * length);
  }
  const ExactVector normal = cross(edge, face.point[2] - a);
  const Dyadic height = dot(normal, a);
  return compare(height * height, square * dot(normal, normal));
}

}  // namespace winnow
