// Contact points of two patches (contact_patch.h). polygon_clip.cpp finds the corners of the
// intersection of the projections; this file chooses at most four of them and writes them.

#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/polygon_clip.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {

namespace {

// Areas count as equal if they differ by less than kTiedArea times the squared extent and by less
// than kTiedShare times the larger area; depths, if they differ by less than kTiedDepth times the
// extent.
constexpr double kTiedArea = 1e-3;
constexpr double kTiedShare = 0.05;

/// A contact point projected along the normal, and its depth.
struct ProjectedPoint {
  double x;
  double y;
  double depth;
};

/// Chooses at most kManifoldPoints points of a patch. The points of the patch are added in order
/// around their convex hull.
///
/// Ties between equally good points, as in regular polygons, are broken by a direction that is
/// fixed in a body: so the choice does not change while the body jitters.
class PointSelection {
 public:
  static constexpr std::uint32_t kRoom = 2 * kOutlineVertices;
  using Chosen = std::uint32_t[kManifoldPoints];

  explicit PointSelection(const double (&direction)[2]) noexcept
      : direction_{direction[0], direction[1]} {}

  void add(double x, double y, double depth) noexcept {
    place_[count_] = {x, y, depth};
    along_[count_++] = direction_[0] * x + direction_[1] * y;
  }

  // Chooses the points that span most: the outermost along the direction, the one farthest from it,
  // the one that makes the largest triangle with both, and the one that adds most area. If none of
  // these is nearly as deep as the deepest point (kTiedDepth), the deepest point is added, or
  // replaces the one that matters least for the area if there are already kManifoldPoints. Returns
  // the number of points; the deepest of the chosen points is first.
  std::uint32_t choose(Chosen& chosen) noexcept {
    std::uint32_t count = spread(chosen);
    double most = -std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < count_; ++i) most = std::max(most, place_[i].depth);
    const double least = most - kTiedDepth * std::sqrt(extent_);
    // The first point gets the depth of the deepest point of all. Prefer the deepest of the chosen
    // points, whose own depth differs least from that.
    std::uint32_t* first = std::max_element(
        chosen, chosen + count,
        [&](std::uint32_t i, std::uint32_t k) { return place_[i].depth < place_[k].depth; });
    if (place_[*first].depth < least) {
      const std::uint32_t deepest =
          farthest([&](std::uint32_t i) { return place_[i].depth >= least; });
      first = chosen + (count < kManifoldPoints ? count++ : least_missed(chosen, deepest));
      *first = deepest;
    }
    std::swap(chosen[0], *first);
    return count;
  }

 private:
  // Returns the point farthest along the direction for which `counts` is true.
  template <typename Counts>
  [[nodiscard]] std::uint32_t farthest(Counts&& counts) const noexcept {
    std::uint32_t best = count_;
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (counts(i) && (best == count_ || along_[i] > along_[best])) best = i;
    }
    return best;
  }

  // Returns a point with the largest value. Values are areas; at least one of them is 0.
  template <typename Value>
  [[nodiscard]] std::uint32_t largest(Value&& value) const noexcept {
    double values[kRoom];
    double most = 0.0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      values[i] = value(place_[i]);
      most = std::max(most, values[i]);
    }
    const double least = most - std::min(kTiedArea * extent_, kTiedShare * most);
    return farthest([&](std::uint32_t i) { return values[i] >= least; });
  }

  // Returns the number of distinct points.
  std::uint32_t spread(Chosen& kept) noexcept {
    kept[0] = farthest([](std::uint32_t) { return true; });
    const ProjectedPoint& p = place_[kept[0]];
    for (std::uint32_t i = 0; i < count_; ++i) {
      extent_ = std::max(extent_, squared_distance(p, place_[i]));
    }
    kept[1] = largest([&](const ProjectedPoint& x) { return squared_distance(p, x); });
    const ProjectedPoint& q = place_[kept[1]];
    kept[2] = largest([&](const ProjectedPoint& x) { return std::abs(area(p, q, x)); });
    const ProjectedPoint& r = place_[kept[2]];
    const double turn = area(p, q, r) < 0.0 ? -1.0 : 1.0;
    kept[3] = largest([&](const ProjectedPoint& x) {
      return -std::min({turn * area(p, q, x), turn * area(q, r, x), turn * area(r, p, x)});
    });
    std::uint32_t count = 1;
    for (std::uint32_t i = 1; i < kManifoldPoints; ++i) {
      if (std::find(kept, kept + count, kept[i]) == kept + count) kept[count++] = kept[i];
    }
    return count;
  }

  // Returns which of four points to replace by `place` so that the largest area remains.
  [[nodiscard]] std::uint32_t least_missed(const Chosen& chosen,
                                           std::uint32_t place) const noexcept {
    std::uint32_t best = 0;
    double most = -std::numeric_limits<double>::infinity();
    for (std::uint32_t left_out = 0; left_out < kManifoldPoints; ++left_out) {
      Chosen around;
      std::copy_n(chosen, kManifoldPoints, around);
      around[left_out] = place;
      std::sort(around, around + kManifoldPoints);
      const double left = area_around(around);
      if (!(left > most + kTiedArea * extent_)) continue;
      most = left;
      best = left_out;
    }
    return best;
  }

  // Twice the area of the polygon of four points in order.
  [[nodiscard]] double area_around(const Chosen& i) const noexcept {
    return area(place_[i[0]], place_[i[1]], place_[i[2]]) +
           area(place_[i[0]], place_[i[2]], place_[i[3]]);
  }
  // Twice the area of a triangle, positive if it is counter-clockwise.
  [[nodiscard]] static double area(const ProjectedPoint& a, const ProjectedPoint& b,
                                   const ProjectedPoint& c) noexcept {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }
  [[nodiscard]] static double squared_distance(const ProjectedPoint& a,
                                               const ProjectedPoint& b) noexcept {
    return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
  }

  double direction_[2];
  ProjectedPoint place_[kRoom];
  double along_[kRoom];
  std::uint32_t count_ = 0;
  /// Largest squared distance from the first chosen point.
  double extent_ = 0.0;
};

ContactPoint contact_of(const ClipPoint& m, const PatchFrame& frame, const double rounding[2]) {
  const double top = m.height[0] + rounding[0];
  const double bottom = m.height[1] - rounding[1];
  const double middle = 0.5 * (top + bottom);
  ContactPoint point;
  for (int i = 0; i < 3; ++i) {
    point.position[i] = static_cast<float>(m.x * frame.axis[0][i] + m.y * frame.axis[1][i] +
                                           middle * frame.axis[2][i]);
  }
  point.depth = static_cast<float>(top - bottom);
  point.feature = static_cast<std::uint64_t>(m.id[0]) << 32U | m.id[1];
  return point;
}

/// Corners of the intersection of two patches that are within the margin, in order around it, and
/// the deepest one.
struct PatchIntersection {
  PatchFrame frame;
  ClipPoints corners;
  double rounding[2];
  std::uint32_t deepest = 0;
  /// Breaks ties; fixed in one of the bodies. Set only if there are more corners than a manifold
  /// has.
  double direction[2] = {0.0, 0.0};

  PatchIntersection(const SupportingFeature& a, const SupportingFeature& b, const double normal[3],
                    double margin) noexcept
      : frame(normal), corners(0.0), rounding{a.rounding, b.rounding} {
    intersect({a, frame, 1.0}, {b, frame, -1.0}, margin);
  }
  PatchIntersection(const ProjectedFaces& faces, double margin) noexcept
      : frame(faces), corners(0.0), rounding{faces.rounding[0], faces.rounding[1]} {
    intersect({faces, 0}, {faces, 1}, margin);
  }

  /// Writes the deepest corner and the corners that span the largest area with it.
  std::uint32_t write_widest(ContactPoint* out) const noexcept {
    if (corners.count <= kManifoldPoints) return write_all(out);
    PointSelection places(direction);
    for (std::uint32_t i = 0; i < corners.count; ++i) {
      const ClipPoint& m = corners.point[i];
      places.add(m.x, m.y, core_depth(m));
    }
    std::uint32_t chosen[kManifoldPoints];
    const std::uint32_t count = places.choose(chosen);
    for (std::uint32_t i = 0; i < count; ++i) out[i] = contact(chosen[i]);
    out[0].depth = contact(deepest).depth;
    return count;
  }

  /// Writes all corners, the deepest first.
  std::uint32_t write_all(ContactPoint* out) const noexcept {
    out[0] = contact(deepest);
    std::uint32_t count = 1;
    for (std::uint32_t i = 0; i < corners.count; ++i) {
      if (i != deepest) out[count++] = contact(i);
    }
    return count;
  }

 private:
  [[nodiscard]] ContactPoint contact(std::uint32_t i) const noexcept {
    return contact_of(corners.point[i], frame, rounding);
  }

  void intersect(const Outline& a, const Outline& b, double margin) noexcept {
    corners.same = kSamePlace * std::max(a.size, b.size);
    intersect_patches(a, b, corners);
    find_deepest();
    drop_beyond(margin);
    if (corners.count > kManifoldPoints) (is_finer(b, a) ? b : a).find_direction(direction);
  }

  // True if `p` rather than `q` is the patch that rests on the other one: it has more vertices, or
  // equally many and is smaller.
  [[nodiscard]] static bool is_finer(const Outline& p, const Outline& q) noexcept {
    constexpr double kSmaller = 1.0 - 1e-6;
    if (p.count != q.count) return p.count > q.count;
    return p.size < kSmaller * q.size;
  }

  // The depth at a corner, without rounding.
  [[nodiscard]] static double core_depth(const ClipPoint& m) noexcept {
    return m.height[0] - m.height[1];
  }

  // Among equally deep corners takes the first.
  void find_deepest() noexcept {
    double most = core_depth(corners.point[0]);
    for (std::uint32_t i = 1; i < corners.count; ++i) {
      most = std::max(most, core_depth(corners.point[i]));
    }
    while (core_depth(corners.point[deepest]) < most - corners.same) ++deepest;
  }

  void drop_beyond(double margin) noexcept {
    const double least = -margin - rounding[0] - rounding[1] - corners.same;
    std::uint32_t kept = 0;
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < corners.count; ++i) {
      if (i == deepest) first = kept;
      if (i == deepest || core_depth(corners.point[i]) >= least) {
        corners.point[kept++] = corners.point[i];
      }
    }
    deepest = first;
    corners.count = kept;
  }
};

static_assert(kMaxIntersectionCorners == 2 * kOutlineVertices);

}  // namespace

std::uint32_t contact_patch(const SupportingFeature& a, const SupportingFeature& b,
                            const double normal[3], double margin, ContactPoint* out) noexcept {
  if (a.count == 0 || b.count == 0) return 0;
  return PatchIntersection(a, b, normal, margin).write_widest(out);
}

std::uint32_t projected_contacts(const ProjectedFaces& faces, double margin,
                                 ContactPoint* out) noexcept {
  return PatchIntersection(faces, margin).write_widest(out);
}

std::uint32_t intersection_corners(const SupportingFeature& a, const SupportingFeature& b,
                                   const double normal[3], double margin,
                                   ContactPoint* out) noexcept {
  if (a.count == 0 || b.count == 0) return 0;
  return PatchIntersection(a, b, normal, margin).write_all(out);
}

double tied_depth(const ContactPoint* points, std::uint32_t count) noexcept {
  double square = 0.0;
  for (std::uint32_t i = 1; i < count; ++i) {
    double away[3];
    for (int k = 0; k < 3; ++k) {
      away[k] =
          static_cast<double>(points[i].position[k]) - static_cast<double>(points[0].position[k]);
    }
    square = std::max(square, dot(away, away));
  }
  return kTiedDepth * std::sqrt(square);
}

std::uint32_t corners_on_plane(const SupportingFeature& patch, const double up[3], double highest,
                               std::uint32_t* corner) noexcept {
  const PatchFrame frame(up);
  const Outline outline(patch, frame, -1.0);
  double direction[2];
  outline.find_direction(direction);
  PointSelection places(direction);
  std::uint32_t within[kOutlineVertices];
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < outline.count; ++i) {
    if (!(outline.h[i] <= highest)) continue;
    places.add(outline.x[i], outline.y[i], -outline.h[i]);
    within[count++] = outline.vertex_id[i];
  }
  if (count == 0) return 0;
  std::uint32_t chosen[kManifoldPoints];
  count = places.choose(chosen);
  for (std::uint32_t i = 0; i < count; ++i) corner[i] = within[chosen[i]];
  return count;
}

namespace {

SupportingFeature view(const FlatFeature& p) {
  return {p.vertex, p.vertex_feature, p.edge_feature, p.count, p.feature, p.rounding};
}

// The vertex positions are not set.
FlatFeature named(const FaceNames& names, double rounding) {
  FlatFeature patch;
  patch.count = names.count;
  patch.feature = names.face;
  patch.rounding = rounding;
  std::copy_n(names.vertex, 4, patch.vertex_feature);
  std::copy_n(names.edge, 4, patch.edge_feature);
  return patch;
}

}  // namespace

FlatFeature flat_box_feature(const BoxFrame& box, const double normal[3]) noexcept {
  double rise[3];
  for (int i = 0; i < 3; ++i) rise[i] = dot(box.axis[i], normal);
  std::uint32_t i = std::abs(rise[1]) > std::abs(rise[0]) ? 1 : 0;
  if (std::abs(rise[2]) > std::abs(rise[i])) i = 2;
  const std::uint32_t k = (i + 1) % 3;
  const std::uint32_t l = (i + 2) % 3;
  const bool up = rise[i] > 0.0;
  const FaceNames& names = kFaceNames[2 * i + (up ? 1 : 0)];
  FlatFeature patch = named(names, box.rounding);
  for (std::uint32_t c = 0; c < 4; ++c) {
    const double arm_i = up ? box.half[i] : -box.half[i];
    const double arm_k = kPlusCorner[c][0] ? box.half[k] : -box.half[k];
    const double arm_l = kPlusCorner[c][1] ? box.half[l] : -box.half[l];
    for (int r = 0; r < 3; ++r) {
      patch.vertex[c][r] = box.center[r] + (arm_i * box.axis[i][r] +
                                            (arm_k * box.axis[k][r] + arm_l * box.axis[l][r]));
    }
  }
  return patch;
}

FlatFeature flat_triangle_feature(const TriangleFrame& triangle) noexcept {
  FlatFeature patch = named(kFaceNames[kTriangleFace], triangle.rounding);
  for (std::uint32_t i = 0; i < 3; ++i) std::copy_n(triangle.vertex[i], 3, patch.vertex[i]);
  return patch;
}

std::uint32_t flat_contacts(const FlatFeature& a, const FlatFeature& b, const double normal[3],
                            double margin, ContactPoint* out) noexcept {
  return contact_patch(view(a), view(b), normal, margin, out);
}

double deepest_point(const SupportingFeature& a, const SupportingFeature& b, const double normal[3],
                     double point[3]) noexcept {
  const PatchFrame frame(normal);
  const Outline outline[2] = {{a, frame, 1.0}, {b, frame, -1.0}};
  ClipPoints m(kSamePlace * std::max(outline[0].size, outline[1].size));
  intersect_patches(outline[0], outline[1], m);
  const ClipPoint* best = m.point;
  for (std::uint32_t i = 1; i < m.count; ++i) {
    const ClipPoint& p = m.point[i];
    if (p.height[0] - p.height[1] > best->height[0] - best->height[1]) best = &p;
  }
  for (int r = 0; r < 3; ++r) {
    point[r] = best->x * frame.axis[0][r] + best->y * frame.axis[1][r] +
               best->height[0] * frame.axis[2][r];
  }
  const bool overlap = m.apart <= m.same;
  return overlap ? best->height[0] - best->height[1] : -std::numeric_limits<double>::infinity();
}

double deepest_point(const FlatFeature& a, const FlatFeature& b, const double normal[3],
                     double point[3]) noexcept {
  return deepest_point(view(a), view(b), normal, point);
}

}  // namespace winnow
