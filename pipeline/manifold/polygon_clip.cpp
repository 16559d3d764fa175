// Intersections of projected patches: polygons, segments and points in all combinations; see
// polygon_clip.h.

#include "pipeline/manifold/polygon_clip.h"

#include "pipeline/kinds/hypotenuse.h"
#include "pipeline/manifold/feature_rules.h"
#include "pipeline/shapes/directions_around.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace winnow {
namespace {

// Slopes that differ by less count as equal.
constexpr double kSameRise = 1e-9;

// Finds a direction that is fixed in the body: takes the edge with the least id, starting at its
// end with the lesser id, and rotates it towards the inside by the angle of kOffAxes. `at` writes
// the position of a vertex.
template <typename At>
void find_fixed_direction(const std::uint32_t* vertex_name, const std::uint32_t* edge_name,
                          std::uint32_t count, At&& at, double (&direction)[2]) {
  std::uint32_t i = 0;
  for (std::uint32_t k = 1; k < count; ++k) {
    if (edge_name[k] < edge_name[i]) i = k;
  }
  std::uint32_t j = i + 1 == count ? 0 : i + 1;
  if (vertex_name[j] < vertex_name[i]) std::swap(i, j);
  double from[2];
  double to[2];
  at(i, from);
  at(j, to);
  const double along[2] = {to[0] - from[0], to[1] - from[1]};
  double inside = 0.0;
  for (std::uint32_t k = 0; k < count; ++k) {
    at(k, to);
    inside += along[0] * (to[1] - from[1]) - along[1] * (to[0] - from[0]);
  }
  const double turn = inside < 0.0 ? -kOffAxes[1] : kOffAxes[1];
  direction[0] = kOffAxes[0] * along[0] - turn * along[1];
  direction[1] = kOffAxes[0] * along[1] + turn * along[0];
}

}  // namespace

// Duff et al., "Building an orthonormal basis, revisited", JCGT 2017.
PatchFrame::PatchFrame(const double normal[3]) noexcept {
  const double x = normal[0];
  const double y = normal[1];
  const double z = normal[2];
  const double sign = std::copysign(1.0, z);
  const double a = -1.0 / (sign + z);
  const double b = x * y * a;
  const double axes[3][3] = {
      {1.0 + sign * x * x * a, sign * b, -sign * x}, {b, sign + y * y * a, -y}, {x, y, z}};
  for (int i = 0; i < 3; ++i) std::copy_n(axes[i], 3, axis[i]);
}

Outline::Outline(const SupportingFeature& patch, const PatchFrame& frame, double up) noexcept
    : face_id(feature_id(FeatureKind::face, patch.feature)),
      count(0),
      size(0.0),
      slope{0.0, 0.0},
      cosine(0.0) {
  if (patch.count <= kOutlineVertices) {
    for (std::uint32_t i = 0; i < patch.count; ++i) take(patch, frame, i);
  } else {
    take_outermost(patch, frame, up);
  }
  double low[2] = {x[0], y[0]};
  double high[2] = {x[0], y[0]};
  for (std::uint32_t i = 1; i < count; ++i) {
    low[0] = std::min(low[0], x[i]);
    low[1] = std::min(low[1], y[i]);
    high[0] = std::max(high[0], x[i]);
    high[1] = std::max(high[1], y[i]);
  }
  size = std::max(high[0] - low[0], high[1] - low[1]);
  if (count >= 3) orient(up);
  if (count == 2 && !(size > kSteep * std::abs(h[1] - h[0]))) {
    if (up * h[1] > up * h[0]) {
      std::swap(h[0], h[1]);
      std::swap(x[0], x[1]);
      std::swap(y[0], y[1]);
      std::swap(vertex_id[0], vertex_id[1]);
    }
    count = 1;
  }
}

PatchFrame::PatchFrame(const ProjectedFaces& faces) noexcept {
  const double* row = faces.rows;
  for (auto& along : axis) {
    for (double& x : along) {
      x = *row;
      row += ProjectedFaces::kStride;
    }
  }
}

Outline::Outline(const ProjectedFaces& faces, int side) noexcept {
  const FaceNames& names = kFaceNames[faces.face[side]];
  const std::uint32_t first =
      ProjectedFaces::kFaces + static_cast<std::uint32_t>(side) * ProjectedFaces::kFaceRows;
  const double* const rows = faces.rows + first * ProjectedFaces::kStride;
  const auto number = [&](std::uint32_t row) { return rows[row * ProjectedFaces::kStride]; };
  face_id = feature_id(FeatureKind::face, names.face);
  count = names.count;
  size = number(ProjectedFaces::kSize);
  slope[0] = number(ProjectedFaces::kSlope);
  slope[1] = number(ProjectedFaces::kSlope + 1);
  cosine = number(ProjectedFaces::kCosine);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t corner = faces.clockwise[side] ? count - 1 - i : i;
    x[i] = number(ProjectedFaces::kX + corner);
    y[i] = number(ProjectedFaces::kY + corner);
    h[i] = number(ProjectedFaces::kH + corner);
    vertex_id[i] = feature_id(FeatureKind::vertex, names.vertex[corner]);
    // If the order is reversed, the edge that ended at a vertex begins there.
    const std::uint32_t edge = faces.clockwise[side] ? (2 * count - 2 - i) % count : i;
    edge_id[i] = feature_id(FeatureKind::edge, names.edge[edge]);
  }
}

void Outline::take(const SupportingFeature& patch, const PatchFrame& frame,
                   std::uint32_t vertex) noexcept {
  const double* p = patch.vertex[vertex];
  x[count] = dot(frame.axis[0], p);
  y[count] = dot(frame.axis[1], p);
  h[count] = dot(frame.axis[2], p);
  vertex_id[count] = feature_id(FeatureKind::vertex, patch.vertex_feature[vertex]);
  // A segment is its own edge; a point has no edge.
  edge_id[count] =
      feature_id(FeatureKind::edge, patch.count < 3 ? patch.feature : patch.edge_feature[vertex]);
  ++count;
}

// Takes the farthest vertices in fifteen directions that are fixed in the body, and the deepest
// vertex if it is deeper than these by more than the tolerance kTiedDepth.
void Outline::take_outermost(const SupportingFeature& patch, const PatchFrame& frame,
                             double up) noexcept {
  static_assert(kOutlineVertices == std::size(kFifteenthsOfTurn) + 1);
  const auto at = [&](std::uint32_t i, double(&place)[2]) {
    for (int k = 0; k < 2; ++k) place[k] = dot(frame.axis[k], patch.vertex[i]);
  };
  const auto farthest = [&](const double(&direction)[3]) {
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < patch.count; ++i) {
      if (dot(direction, patch.vertex[i]) > dot(direction, patch.vertex[best])) best = i;
    }
    return best;
  };
  double first[2];
  find_fixed_direction(patch.vertex_feature, patch.edge_feature, patch.count, at, first);
  std::uint32_t chosen[kOutlineVertices];
  std::uint32_t* end = chosen;
  for (const auto& [c, s] : kFifteenthsOfTurn) {
    const double along[2] = {c * first[0] - s * first[1], c * first[1] + s * first[0]};
    double direction[3];
    for (int i = 0; i < 3; ++i) {
      direction[i] = along[0] * frame.axis[0][i] + along[1] * frame.axis[1][i];
    }
    *end++ = farthest(direction);
  }
  const double* const axis = frame.axis[2];
  const std::uint32_t deepest = farthest({up * axis[0], up * axis[1], up * axis[2]});
  double reach = 0.0;
  double height = -std::numeric_limits<double>::infinity();
  for (const std::uint32_t* i = chosen; i != end; ++i) {
    const double* const p = patch.vertex[*i];
    const double* const q = patch.vertex[chosen[0]];
    const double away[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
    reach = std::max(reach, dot(away, away));
    height = std::max(height, up * dot(axis, p));
  }
  if (up * dot(axis, patch.vertex[deepest]) > height + kTiedDepth * std::sqrt(reach)) {
    *end++ = deepest;
  }
  std::sort(chosen, end);
  end = std::unique(chosen, end);
  for (const std::uint32_t* i = chosen; i != end; ++i) take(patch, frame, *i);
}

void Outline::find_direction(double (&direction)[2]) const noexcept {
  const auto at = [&](std::uint32_t i, double(&place)[2]) {
    place[0] = x[i];
    place[1] = y[i];
  };
  find_fixed_direction(vertex_id, edge_id, count, at, direction);
}

// Normal of the polygon as the sum of the normals of its triangles (Newell).
void Outline::orient(double up) noexcept {
  double normal[3] = {0.0, 0.0, 0.0};
  for (std::uint32_t i = 1; i + 1 < count; ++i) {
    const double p[3] = {x[i] - x[0], y[i] - y[0], h[i] - h[0]};
    const double q[3] = {x[i + 1] - x[0], y[i + 1] - y[0], h[i + 1] - h[0]};
    normal[0] += p[1] * q[2] - p[2] * q[1];
    normal[1] += p[2] * q[0] - p[0] * q[2];
    normal[2] += p[0] * q[1] - p[1] * q[0];
  }
  const double area = std::abs(normal[2]);
  const double length = std::sqrt(dot(normal, normal));
  if (!(area > kThin * size * size) || !(area > kSteep * length)) {
    flatten(up);
    return;
  }
  slope[0] = -normal[0] / normal[2];
  slope[1] = -normal[1] / normal[2];
  cosine = area / length;
  if (normal[2] < 0.0) reverse();
}

void Outline::reverse() noexcept {
  std::reverse(x, x + count);
  std::reverse(y, y + count);
  std::reverse(h, h + count);
  std::reverse(vertex_id, vertex_id + count);
  // The edge that ended at a vertex now begins there.
  std::reverse(edge_id, edge_id + count - 1);
}

std::uint32_t Outline::farthest_from(std::uint32_t vertex) const noexcept {
  std::uint32_t best = vertex;
  double most = 0.0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double dx = x[i] - x[vertex];
    const double dy = y[i] - y[vertex];
    if (dx * dx + dy * dy > most) {
      most = dx * dx + dy * dy;
      best = i;
    }
  }
  return best;
}

std::uint32_t Outline::least_rise_from(std::uint32_t vertex, double up) const noexcept {
  std::uint32_t best = vertex;
  double least = std::numeric_limits<double>::infinity();
  double farthest = 0.0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double away = hypotenuse(x[i] - x[vertex], y[i] - y[vertex]);
    if (!(away > kSamePlace * size)) continue;
    const double rise = up * (h[vertex] - h[i]) / away;
    if (rise < least - kSameRise || (rise <= least + kSameRise && away > farthest)) {
      least = rise;
      farthest = away;
      best = i;
    }
  }
  return best;
}

// Reduces the outline to a segment: to its two ends if they are its deepest vertices, else to the
// deepest vertex and the vertex towards which the depth decreases least, because the other patch
// touches that edge.
void Outline::flatten(double up) noexcept {
  const double same = kSamePlace * size;
  std::uint32_t ends[2] = {farthest_from(0), 0};
  ends[1] = farthest_from(ends[0]);
  std::uint32_t deepest = ends[0];
  for (std::uint32_t i = 0; i < count; ++i) {
    if (up * h[i] > up * h[deepest] + same) deepest = i;
  }
  if (up * h[deepest] > std::min(up * h[ends[0]], up * h[ends[1]]) + same) {
    ends[0] = deepest;
    ends[1] = least_rise_from(deepest, up);
  }
  const std::uint32_t edge = edge_id[std::min(ends[0], ends[1])];
  const std::uint32_t first = std::min(ends[0], ends[1]);
  const std::uint32_t second = std::max(ends[0], ends[1]);
  const std::uint32_t kept[2] = {first, second};
  for (std::uint32_t i = 0; i < 2; ++i) {
    x[i] = x[kept[i]];
    y[i] = y[kept[i]];
    h[i] = h[kept[i]];
    vertex_id[i] = vertex_id[kept[i]];
    edge_id[i] = edge;
  }
  count = first == second ? 1 : 2;
}

namespace {

// Edges with a smaller sine are parallel: they overlap along a line. Other edges cross in a point.
constexpr double kParallelSine = 1e-3;

struct Corner {
  double x;
  double y;
  double h;
  // The edge that begins here: its index in the incident polygon, or kOutlineVertices plus its
  // index in the reference.
  std::uint32_t edge;
};

struct Polygon {
  Corner corner[2 * kOutlineVertices];
  std::uint32_t count = 0;
};

// Distance of a point to the left of side i of the reference, times the length of the side.
double inside(const Outline& reference, std::uint32_t i, double x, double y) {
  const std::uint32_t j = reference.next(i);
  const double ex = reference.x[j] - reference.x[i];
  const double ey = reference.y[j] - reference.y[i];
  return ex * (y - reference.y[i]) - ey * (x - reference.x[i]);
}

double side_length(const Outline& outline, std::uint32_t i) {
  const std::uint32_t j = outline.next(i);
  return std::max(std::abs(outline.x[j] - outline.x[i]), std::abs(outline.y[j] - outline.y[i]));
}

Corner crossing(const Corner& p, const Corner& q, double at_p, double at_q, std::uint32_t edge) {
  const double t = std::clamp(at_p / (at_p - at_q), 0.0, 1.0);
  return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.h + t * (q.h - p.h), edge};
}

// Clips a polygon against one side (Sutherland and Hodgman, "Reentrant polygon clipping", 1974).
// Returns false, and does not write `to`, if all of it is inside.
bool cut(const Polygon& from, const Outline& reference, std::uint32_t side, double slack,
         Polygon& to) {
  double at[2 * kOutlineVertices];
  double least = 0.0;
  for (std::uint32_t i = 0; i < from.count; ++i) {
    at[i] = inside(reference, side, from.corner[i].x, from.corner[i].y);
    least = std::min(least, at[i]);
  }
  if (least >= -slack) return false;
  to.count = 0;
  for (std::uint32_t i = 0; i < from.count; ++i) {
    const std::uint32_t j = i + 1 == from.count ? 0 : i + 1;
    const Corner& p = from.corner[i];
    const Corner& q = from.corner[j];
    const bool p_in = at[i] >= -slack;
    const bool q_in = at[j] >= -slack;
    if (p_in) to.corner[to.count++] = p;
    if (p_in != q_in) {
      to.corner[to.count++] = crossing(p, q, at[i], at[j], p_in ? kOutlineVertices + side : p.edge);
    }
  }
  return true;
}

// The ids of a corner of the clipped polygon follow from the two edges that meet there.
void clip_polygon(const Outline& reference, const Outline& incident, int r, ClipPoints& out) {
  Polygon buffer[2];
  Polygon* now = &buffer[0];
  Polygon* other = &buffer[1];
  now->count = incident.count;
  for (std::uint32_t i = 0; i < incident.count; ++i) {
    now->corner[i] = {incident.x[i], incident.y[i], incident.h[i], i};
  }
  for (std::uint32_t side = 0; side < reference.count && now->count > 0; ++side) {
    const double slack = out.same * side_length(reference, side);
    if (cut(*now, reference, side, slack, *other)) std::swap(now, other);
  }
  for (std::uint32_t i = 0; i < now->count; ++i) {
    const Corner& c = now->corner[i];
    const std::uint32_t before = now->corner[i == 0 ? now->count - 1 : i - 1].edge;
    ClipPoint& m = out.next();
    m.x = c.x;
    m.y = c.y;
    m.height[r] = reference.height(c.x, c.y);
    m.height[1 - r] = c.h;
    const bool ref_before = before >= kOutlineVertices;
    const bool ref_after = c.edge >= kOutlineVertices;
    if (ref_before && ref_after) {
      m.id[r] = reference.vertex_id[c.edge - kOutlineVertices];
      m.id[1 - r] = incident.face_id;
    } else if (!ref_before && !ref_after) {
      m.id[r] = reference.face_id;
      m.id[1 - r] = incident.vertex_id[c.edge];
    } else {
      m.id[r] = reference.edge_id[(ref_before ? before : c.edge) - kOutlineVertices];
      m.id[1 - r] = incident.edge_id[ref_before ? c.edge : before];
    }
    out.keep_next();
  }
}

// Moves a point that is outside of a side onto the side.
void move_inside(const Outline& polygon, std::uint32_t side, ClipPoint& m) {
  const double out = -inside(polygon, side, m.x, m.y);
  if (!(out > 0.0)) return;
  const std::uint32_t next = polygon.next(side);
  const double along[2] = {polygon.x[next] - polygon.x[side], polygon.y[next] - polygon.y[side]};
  const double share = out / (along[0] * along[0] + along[1] * along[1]);
  m.x -= share * along[1];
  m.y += share * along[0];
}

// Clips a segment against a polygon (Cyrus and Beck, 1978). A segment along a side counts as
// inside, in whichever direction it deviates slightly: points outside are moved onto the side.
void clip_segment(const Outline& polygon, const Outline& segment, int r, ClipPoints& out) {
  const double near = kAlongSide * std::min(polygon.size, segment.size);
  double t[2] = {0.0, 1.0};
  std::uint32_t end_side[2] = {~0U, ~0U};
  std::uint32_t beside = ~0U;
  for (std::uint32_t side = 0; side < polygon.count; ++side) {
    const double length = side_length(polygon, side);
    const double slack = out.same * length;
    const double at[2] = {inside(polygon, side, segment.x[0], segment.y[0]),
                          inside(polygon, side, segment.x[1], segment.y[1])};
    if (at[0] >= -slack && at[1] >= -slack) continue;
    if (std::max(std::abs(at[0]), std::abs(at[1])) <= near * length) {
      beside = side;
      continue;
    }
    if (at[0] < -slack && at[1] < -slack) return;
    const int end = at[0] < -slack ? 0 : 1;
    const double s = std::clamp(at[0] / (at[0] - at[1]), 0.0, 1.0);
    if (end == 0 ? s > t[0] : s < t[1]) {
      t[end] = s;
      end_side[end] = side;
    }
  }
  if (t[0] > t[1]) return;
  for (int end = 0; end < 2; ++end) {
    const double s = t[end];
    ClipPoint m = {segment.x[0] + s * (segment.x[1] - segment.x[0]),
                   segment.y[0] + s * (segment.y[1] - segment.y[0]),
                   {0.0, 0.0},
                   {0, 0}};
    if (beside != ~0U) move_inside(polygon, beside, m);
    m.height[r] = polygon.height(m.x, m.y);
    m.height[1 - r] = segment.h[0] + s * (segment.h[1] - segment.h[0]);
    const bool vertex = end_side[end] == ~0U;
    m.id[r] = vertex ? polygon.face_id : polygon.edge_id[end_side[end]];
    m.id[1 - r] = vertex ? segment.vertex_id[end] : segment.edge_id[0];
    out.add(m);
  }
}

// The point of an edge that is closest to a given point.
struct EdgePoint {
  double x;
  double y;
  double h;
  // Squared distance from the given point.
  double away;
  std::uint32_t id;
};

EdgePoint project(const Outline& outline, std::uint32_t i, double x, double y) {
  const std::uint32_t j = outline.next(i);
  const double ex = outline.x[j] - outline.x[i];
  const double ey = outline.y[j] - outline.y[i];
  const double length = ex * ex + ey * ey;
  const double along = ex * (x - outline.x[i]) + ey * (y - outline.y[i]);
  const double t = length > 0.0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
  EdgePoint p = {outline.x[i] + t * ex, outline.y[i] + t * ey,
                 outline.h[i] + t * (outline.h[j] - outline.h[i]), 0.0, outline.edge_id[i]};
  p.away = (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y);
  if (t == 0.0) p.id = outline.vertex_id[i];
  if (t == 1.0) p.id = outline.vertex_id[j];
  return p;
}

// Two segments: the point where they cross, or, if they are parallel, the ends of their overlap.
void cross_segments(const Outline& a, const Outline& b, ClipPoints& out) {
  const double e[2] = {a.x[1] - a.x[0], a.y[1] - a.y[0]};
  const double f[2] = {b.x[1] - b.x[0], b.y[1] - b.y[0]};
  const double turn = e[0] * f[1] - e[1] * f[0];
  const double lengths = std::sqrt((e[0] * e[0] + e[1] * e[1]) * (f[0] * f[0] + f[1] * f[1]));
  if (std::abs(turn) > kParallelSine * lengths) {
    const double d[2] = {b.x[0] - a.x[0], b.y[0] - a.y[0]};
    const double s = (d[0] * f[1] - d[1] * f[0]) / turn;
    const double t = (d[0] * e[1] - d[1] * e[0]) / turn;
    const double slack = out.same / std::max(a.size, b.size);
    if (s < -slack || s > 1.0 + slack || t < -slack || t > 1.0 + slack) return;
    out.add({a.x[0] + s * e[0],
             a.y[0] + s * e[1],
             {a.h[0] + s * (a.h[1] - a.h[0]), b.h[0] + t * (b.h[1] - b.h[0])},
             {a.edge_id[0], b.edge_id[0]}});
    return;
  }
  // An end of one segment is a corner if it is within tolerance of the other segment.
  const double near = kParallelSine * std::min(a.size, b.size);
  const auto ends = [&](const Outline& p, const Outline& q, int of) {
    for (std::uint32_t i = 0; i < 2; ++i) {
      const EdgePoint on = project(q, 0, p.x[i], p.y[i]);
      if (on.away > near * near) continue;
      ClipPoint m = {0.5 * (p.x[i] + on.x), 0.5 * (p.y[i] + on.y), {0.0, 0.0}, {0, 0}};
      m.height[of] = p.h[i];
      m.height[1 - of] = on.h;
      m.id[of] = p.vertex_id[i];
      m.id[1 - of] = on.id;
      out.add(m);
    }
  };
  ends(a, b, 0);
  ends(b, a, 1);
}

// For outlines that do not overlap, up to rounding, or of which one is a point: finds where they
// are closest, a vertex of one and an edge of the other. Among equally close pairs, takes the
// deepest.
void find_closest(const Outline* const outline[2], ClipPoints& out) {
  double least = std::numeric_limits<double>::infinity();
  double deepest = -std::numeric_limits<double>::infinity();
  ClipPoint best = {};
  for (int of = 0; of < 2; ++of) {
    const Outline& p = *outline[of];
    const Outline& q = *outline[1 - of];
    for (std::uint32_t i = 0; i < p.count; ++i) {
      for (std::uint32_t k = 0; k < q.count; ++k) {
        const EdgePoint on = project(q, k, p.x[i], p.y[i]);
        ClipPoint m = {0.5 * (p.x[i] + on.x), 0.5 * (p.y[i] + on.y), {0.0, 0.0}, {0, 0}};
        m.height[of] = p.h[i];
        m.height[1 - of] = on.h;
        m.id[of] = p.vertex_id[i];
        m.id[1 - of] = on.id;
        const double away = std::sqrt(on.away);
        const double depth = m.height[0] - m.height[1];
        if (away < least - out.same || (away <= least + out.same && depth > deepest)) {
          least = std::min(least, away);
          deepest = depth;
          best = m;
        }
      }
    }
  }
  out.add(best);
  out.apart = least;
}

// Adds a point that is above or below a polygon.
void clip_point(const Outline& polygon, const Outline& point, int r, ClipPoints& out) {
  for (std::uint32_t side = 0; side < polygon.count; ++side) {
    if (inside(polygon, side, point.x[0], point.y[0]) < 0.0) return;
  }
  ClipPoint m = {point.x[0], point.y[0], {0.0, 0.0}, {0, 0}};
  m.height[r] = polygon.height(m.x, m.y);
  m.height[1 - r] = point.h[0];
  m.id[r] = polygon.face_id;
  m.id[1 - r] = point.vertex_id[0];
  out.add(m);
}

}  // namespace

void intersect_patches(const Outline& a, const Outline& b, ClipPoints& out) noexcept {
  const Outline* const outline[2] = {&a, &b};
  // The reference is the polygon; of two polygons, the one that faces the normal better.
  const int r = a.count >= 3 && (b.count < 3 || a.cosine >= b.cosine) ? 0 : 1;
  const Outline& reference = *outline[r];
  const Outline& incident = *outline[1 - r];
  if (reference.count >= 3) {
    if (incident.count >= 3) clip_polygon(reference, incident, r, out);
    if (incident.count == 2) clip_segment(reference, incident, r, out);
    if (incident.count == 1) clip_point(reference, incident, r, out);
  } else if (a.count == 2 && b.count == 2) {
    cross_segments(a, b, out);
  }
  if (out.count == 0) find_closest(outline, out);
}

}  // namespace winnow
