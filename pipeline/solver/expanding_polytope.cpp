// The expanding polytope algorithm (EPA): InnerPolytope stores the polytope and attaches points to
// it, PolytopeExpansion feeds it with support points of b - a. Called by core_distance.cpp for
// cores that overlap.

#include "pipeline/solver/expanding_polytope.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace winnow::solver {
namespace {

/// Distance of a segment from the origin.
[[nodiscard]] double segment_distance(const Vec& a, const Vec& b) noexcept {
  const Vec along = unit(b - a);
  const double at = std::clamp(-along.dot(a), 0.0, (b - a).norm());
  return (a + along * at).norm();
}

/// A polytope of triangles that contains the origin and grows by points outside of it. Faces are
/// kept in a heap by their distance from the origin. The size is fixed, about 140 KB, for the
/// stack.
class InnerPolytope {
 public:
  struct PolytopeFace {
    std::array<std::uint16_t, 3> point;
    /// across[i] is the face on the other side of the edge from point i to the next.
    std::array<std::uint16_t, 3> across;
    bool alive;
    /// On the surface of the Minkowski difference: cannot grow any more.
    bool settled;
    /// Unit and outward; `low` is a lower bound of the distance of the face's plane.
    Vec normal;
    double low;
  };

  /// `noise`: lengths up to this cannot be distinguished from zero.
  explicit InnerPolytope(double noise) noexcept : noise_(noise) {}

  [[nodiscard]] std::uint32_t point_count() const noexcept { return point_count_; }
  [[nodiscard]] const Vec& point(std::uint32_t i) const noexcept { return points_[i]; }
  /// Adds one of the first four points.
  void add(const Vec& w) noexcept { points_[point_count_++] = w; }
  /// Makes the faces of the first four points; returns false if these are in a plane.
  bool make_tetrahedron() noexcept;

  /// Removes the nearest face from the heap; returns false if the heap is empty.
  bool take_nearest(std::uint16_t& face) noexcept;
  [[nodiscard]] const PolytopeFace& face(std::uint16_t f) const noexcept { return faces_[f]; }
  /// The height of a point above the face's plane.
  [[nodiscard]] double height(const PolytopeFace& face, const Vec& w) const noexcept {
    return face.normal.dot(w - points_[face.point[0]]);
  }
  /// Marks a face as part of the surface of the Minkowski difference.
  void settle(std::uint16_t f) noexcept { faces_[f].settled = true; }

  /// Replaces the faces visible from w, of which `seen` is one, by a fan from w. Returns false if
  /// there is no room or if rounding has made the horizon anything but a single loop; the polytope
  /// must not be used after that.
  bool attach(const Vec& w, std::uint16_t seen) noexcept;

 private:
  static constexpr std::uint32_t kPoints = 384;
  static constexpr std::uint32_t kFaces = 6 * kPoints;

  /// An edge of the horizon: it stays when the faces visible from a new point are removed.
  struct HorizonEdge {
    std::uint16_t from;
    std::uint16_t to;
    std::uint16_t face;
  };

  bool add_face(std::uint16_t p, std::uint16_t q, std::uint16_t r, std::uint16_t& at) noexcept;
  bool find_horizon(const Vec& w, std::uint16_t seen) noexcept;
  [[nodiscard]] double triangle_distance(std::uint16_t p, std::uint16_t q,
                                         std::uint16_t r) const noexcept;
  [[nodiscard]] bool is_visible(const Vec& w, const PolytopeFace& face, std::uint16_t from,
                                std::uint16_t to) const noexcept;
  void push(std::uint16_t face) noexcept;
  std::uint16_t pop() noexcept;
  void compact() noexcept;
  [[nodiscard]] bool is_farther(std::uint16_t f, std::uint16_t g) const noexcept {
    return faces_[f].low > faces_[g].low || (faces_[f].low == faces_[g].low && f > g);
  }

  double noise_;
  std::array<Vec, kPoints> points_;
  std::array<PolytopeFace, kFaces> faces_;
  std::array<std::uint16_t, kFaces> heap_;
  std::array<HorizonEdge, kFaces> horizon_;
  std::array<std::uint16_t, kFaces> moved_;
  std::uint32_t point_count_ = 0;
  std::uint32_t face_count_ = 0;
  std::uint32_t heap_count_ = 0;
  std::uint32_t horizon_count_ = 0;
};

bool InnerPolytope::make_tetrahedron() noexcept {
  const Vec n = (points_[1] - points_[0]).cross(points_[2] - points_[0]);
  if (n.dot(points_[3] - points_[0]) > 0.0) std::swap(points_[1], points_[2]);
  std::uint16_t face = 0;
  if (!add_face(0, 1, 2, face) || !add_face(0, 2, 3, face) || !add_face(0, 3, 1, face) ||
      !add_face(1, 3, 2, face)) {
    return false;
  }
  faces_[0].across = {2, 3, 1};
  faces_[1].across = {0, 3, 2};
  faces_[2].across = {1, 3, 0};
  faces_[3].across = {2, 1, 0};
  return true;
}

bool InnerPolytope::take_nearest(std::uint16_t& face) noexcept {
  // At most 2 * point_count_ faces are alive, and one step adds no more than that.
  if (face_count_ + 2 * point_count_ > kFaces) compact();
  while (heap_count_ > 0) {
    face = pop();
    if (faces_[face].alive) return true;
  }
  return false;
}

/// Returns false if there is no room or the three points are on a line.
bool InnerPolytope::add_face(std::uint16_t p, std::uint16_t q, std::uint16_t r,
                             std::uint16_t& at) noexcept {
  if (face_count_ == kFaces) return false;
  const Vec e = points_[q] - points_[p];
  const Vec f = points_[r] - points_[q];
  const Vec g = points_[p] - points_[r];
  const double le = e.squaredNorm();
  const double lf = f.squaredNorm();
  const double lg = g.squaredNorm();
  const Vec cross = le >= lf && le >= lg ? (lf < lg ? e.cross(f) : g.cross(e))
                    : lf >= lg           ? (lg < le ? f.cross(g) : e.cross(f))
                                         : (le < lf ? g.cross(e) : f.cross(g));
  const double area = cross.norm();
  if (!(area > 0.0)) return false;
  at = static_cast<std::uint16_t>(face_count_++);
  PolytopeFace& face = faces_[at];
  face.point = {p, q, r};
  face.alive = true;
  face.settled = false;
  face.normal = unit(cross);
  const double offset = std::max(
      {face.normal.dot(points_[p]), face.normal.dot(points_[q]), face.normal.dot(points_[r])});
  // Rounding error of the plane's distance. It is large for slivers; for these the distance of the
  // triangle itself is a better lower bound, unless the triangle is on the wrong side of the
  // origin.
  const double doubt = kConvergence * noise_ / area * std::max({le, lf, lg});
  face.low = offset - std::max(doubt, noise_);
  if (doubt > noise_ && offset >= -doubt)
    face.low = std::max(face.low, triangle_distance(p, q, r) - noise_);
  push(at);
  return true;
}

/// Distance of a triangle from the origin, right to a few roundings for slivers too: computed from
/// the longest side and the third point's component perpendicular to it. (With Gram determinants
/// the foot of the origin on a sliver may appear to be on a side.)
double InnerPolytope::triangle_distance(std::uint16_t p, std::uint16_t q,
                                        std::uint16_t r) const noexcept {
  const Vec* a = &points_[p];
  const Vec* b = &points_[q];
  const Vec* c = &points_[r];
  for (int turn = 0; turn < 2; ++turn) {
    const double length = (*b - *a).squaredNorm();
    if (length >= (*c - *b).squaredNorm() && length >= (*a - *c).squaredNorm()) break;
    std::swap(a, b);
    std::swap(b, c);
  }
  const double length = (*b - *a).norm();
  const Vec along = (*b - *a) / length;
  const double apex = along.dot(*c - *a);
  const Vec arm = (*c - *a) - along * apex;
  const double height = arm.norm();
  const Vec up = unit(arm);
  const Vec below = *a - along * along.dot(*a);
  const double x = -along.dot(*a);
  const double y = -up.dot(below);
  const bool is_over =
      y >= 0.0 && x * height >= apex * y && (length - x) * height >= (length - apex) * y;
  if (is_over) return (below + up * y).norm();
  return std::min({segment_distance(*a, *b), segment_distance(*b, *c), segment_distance(*c, *a)});
}

void InnerPolytope::push(std::uint16_t face) noexcept {
  heap_[heap_count_++] = face;
  std::push_heap(heap_.begin(), heap_.begin() + heap_count_,
                 [this](std::uint16_t f, std::uint16_t g) { return is_farther(f, g); });
}

std::uint16_t InnerPolytope::pop() noexcept {
  std::pop_heap(heap_.begin(), heap_.begin() + heap_count_,
                [this](std::uint16_t f, std::uint16_t g) { return is_farther(f, g); });
  return heap_[--heap_count_];
}

/// Removes dead faces to make room.
void InnerPolytope::compact() noexcept {
  std::uint32_t kept = 0;
  for (std::uint32_t f = 0; f < face_count_; ++f) {
    if (!faces_[f].alive) continue;
    moved_[f] = static_cast<std::uint16_t>(kept);
    faces_[kept++] = faces_[f];
  }
  face_count_ = kept;
  heap_count_ = 0;
  for (std::uint32_t f = 0; f < kept; ++f) {
    for (std::uint16_t& across : faces_[f].across) across = moved_[across];
    if (!faces_[f].settled) heap_[heap_count_++] = static_cast<std::uint16_t>(f);
  }
  std::make_heap(heap_.begin(), heap_.begin() + heap_count_,
                 [this](std::uint16_t f, std::uint16_t g) { return is_farther(f, g); });
}

bool InnerPolytope::attach(const Vec& w, std::uint16_t seen) noexcept {
  if (point_count_ == kPoints || !find_horizon(w, seen)) return false;
  const auto apex = static_cast<std::uint16_t>(point_count_);
  points_[point_count_++] = w;
  if (face_count_ + horizon_count_ > kFaces) return false;
  const auto first = static_cast<std::uint16_t>(face_count_);
  for (std::uint32_t i = 0; i < horizon_count_; ++i) {
    const HorizonEdge& side = horizon_[i];
    std::uint16_t at = 0;
    if (!add_face(side.from, side.to, apex, at)) return false;
    const std::uint32_t before = i == 0 ? horizon_count_ - 1 : i - 1;
    const std::uint32_t after = i + 1 == horizon_count_ ? 0 : i + 1;
    faces_[at].across = {side.face, static_cast<std::uint16_t>(first + after),
                         static_cast<std::uint16_t>(first + before)};
    PolytopeFace& other = faces_[side.face];
    for (std::size_t k = 0; k < 3; ++k) {
      if (other.point[k] == side.to && other.point[(k + 1) % 3] == side.from) other.across[k] = at;
    }
  }
  return true;
}

/// True if w is above the face, or in its plane and on the line of the side between `from` and
/// `to`: a new face over that side would have no area.
bool InnerPolytope::is_visible(const Vec& w, const PolytopeFace& face, std::uint16_t from,
                               std::uint16_t to) const noexcept {
  const double above = height(face, w);
  if (above > kConvergence * noise_) return true;
  if (above < -kConvergence * noise_) return false;
  const Vec side = points_[to] - points_[from];
  const Vec out = w - points_[from];
  return side.cross(out).squaredNorm() <= 1e-16 * side.squaredNorm() * out.squaredNorm();
}

/// Collects the edges of the horizon in order, by a depth-first search over the faces visible from
/// w. Each face is entered by one side; its other sides follow in order.
bool InnerPolytope::find_horizon(const Vec& w, std::uint16_t seen) noexcept {
  horizon_count_ = 0;
  struct Visit {
    std::uint16_t face;
    std::uint8_t side;
    std::uint8_t left;
  };
  std::array<Visit, 2 * kPoints> visits;
  std::size_t depth = 0;
  faces_[seen].alive = false;
  visits[depth++] = {seen, 0, 3};
  while (depth > 0) {
    Visit& visit = visits[depth - 1];
    if (visit.left == 0) {
      --depth;
      continue;
    }
    const std::uint8_t k = visit.side;
    visit.side = static_cast<std::uint8_t>((k + 1) % 3);
    --visit.left;
    const PolytopeFace& face = faces_[visit.face];
    const std::uint16_t next = face.across[k];
    PolytopeFace& other = faces_[next];
    if (!other.alive) continue;
    const std::uint16_t from = face.point[k];
    const std::uint16_t to = face.point[(k + 1U) % 3];
    if (is_visible(w, other, from, to)) {
      if (depth == visits.size()) return false;
      std::uint8_t entered = 0;
      while (entered < 2 && other.point[entered] != to) ++entered;
      other.alive = false;
      visits[depth++] = {next, static_cast<std::uint8_t>((entered + 1) % 3), 2};
    } else {
      horizon_[horizon_count_++] = {from, to, next};
    }
  }
  if (horizon_count_ < 3) return false;
  for (std::uint32_t i = 0; i < horizon_count_; ++i) {
    if (horizon_[i].to != horizon_[i + 1 == horizon_count_ ? 0 : i + 1].from) return false;
  }
  return true;
}

/// Grows a polytope inside the Minkowski difference b - a.
class PolytopeExpansion {
 public:
  PolytopeExpansion(const Core& a, const Core& b, double noise) noexcept
      : a_(a), b_(b), noise_(noise), inner_(noise) {}

  /// Completes the simplex to a tetrahedron. Returns false if the difference is flat; bounds() then
  /// returns its normal and depth 0.
  bool begin(const GjkSimplex& simplex) noexcept;
  void grow(double tolerance) noexcept;
  [[nodiscard]] const DepthBounds& bounds() const noexcept { return bounds_; }

 private:
  [[nodiscard]] Vec support_along(const Vec& d) const noexcept {
    return support(b_, d) - support(a_, -d);
  }
  bool add_farther(const Vec& direction) noexcept;
  bool add_along(const Vec& direction, const Vec& opposite) noexcept;
  bool flat_along(const Vec& n) noexcept;

  const Core& a_;
  const Core& b_;
  double noise_;
  DepthBounds bounds_;
  InnerPolytope inner_;
};

/// Adds the support point along the direction if it is farther than the points so far. These all
/// have the same coordinate along that direction.
bool PolytopeExpansion::add_farther(const Vec& direction) noexcept {
  if (direction == Vec::Zero()) return false;
  const Vec w = support_along(direction);
  if (direction.dot(w - inner_.point(0)) <= noise_) return false;
  inner_.add(w);
  return true;
}

bool PolytopeExpansion::add_along(const Vec& direction, const Vec& opposite) noexcept {
  return add_farther(direction) || add_farther(opposite);
}

bool PolytopeExpansion::flat_along(const Vec& n) noexcept {
  const double forward = n.dot(support_along(n));
  const double backward = -n.dot(support_along(-n));
  bounds_.axis = std::abs(forward) <= std::abs(backward) ? Vec(-n) : n;
  return false;
}

bool PolytopeExpansion::begin(const GjkSimplex& simplex) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(simplex.count); ++i) {
    inner_.add(simplex.point[i].w);
  }
  if (inner_.point_count() == 4) {
    return inner_.make_tetrahedron() || flat_along(Vec::UnitX());
  }
  for (int i = 0; i < 3 && inner_.point_count() < 2; ++i) add_along(Vec::Unit(i), -Vec::Unit(i));
  if (inner_.point_count() < 2) return flat_along(Vec::UnitX());
  const Vec line = unit(inner_.point(1) - inner_.point(0));
  int least = 0;
  line.cwiseAbs().minCoeff(&least);
  const Vec side = without(Vec::Unit(least), line);
  const Vec other = line.cross(side);
  if (inner_.point_count() < 3 && !add_along(side, -side) && !add_along(other, -other)) {
    return flat_along(side);
  }
  const Vec n = perpendicular(line, unit(inner_.point(2) - inner_.point(0)));
  if (n == Vec::Zero()) return flat_along(side);
  // Take the side with the larger height, so that thin differences get a better tetrahedron.
  const double above = n.dot(support_along(n) - inner_.point(0));
  const double below = n.dot(inner_.point(0) - support_along(-n));
  const Vec better = above >= below ? n : Vec(-n);
  if (!add_farther(better)) return flat_along(n);
  return inner_.make_tetrahedron() || flat_along(n);
}

void PolytopeExpansion::grow(double tolerance) noexcept {
  // The depth along the best axis so far.
  double upper = std::numeric_limits<double>::infinity();
  // The smallest `low` of the settled faces.
  double settled = std::numeric_limits<double>::infinity();
  std::uint16_t nearest = 0;
  while (inner_.take_nearest(nearest)) {
    const InnerPolytope::PolytopeFace& face = inner_.face(nearest);
    bounds_.lower = std::min(settled, face.low);
    if (upper - bounds_.lower <= tolerance) break;
    const Vec w = support_along(face.normal);
    const double high = face.normal.dot(w);
    if (high < upper) {
      upper = high;
      // Outward normals of b - a run from b to a.
      bounds_.axis = -face.normal;
    }
    if (upper - bounds_.lower <= tolerance) break;
    if (inner_.height(face, w) <= kConvergence * noise_) {
      settled = std::min(settled, face.low);
      inner_.settle(nearest);
      continue;
    }
    if (!inner_.attach(w, nearest)) {
      settled = std::min(settled, face.low);
      break;
    }
  }
  bounds_.lower = std::clamp(std::min(bounds_.lower, settled), 0.0, std::max(upper, 0.0));
}

}  // namespace

DepthBounds expand_polytope(const Core& a, const Core& b, const GjkSimplex& simplex, double noise,
                            double tolerance) noexcept {
  PolytopeExpansion expansion(a, b, noise);
  if (expansion.begin(simplex)) expansion.grow(tolerance);
  return expansion.bounds();
}

}  // namespace winnow::solver
