#include "pipeline/manifold/patch_meetings.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace winnow {

namespace {

// Edges of a smaller sine are parallel: they meet along a line, others in a point.
constexpr double kParallel = 1e-3;

struct Corner {
  double x;
  double y;
  double h;
  // Of the edge that begins here: that of the incident polygon, or kOutlineVertices + that of the
  // reference.
  std::uint32_t edge;
};

struct Polygon {
  Corner corner[2 * kOutlineVertices];
  std::uint32_t count = 0;
};

// How far left of side i of the reference a point is, times the length of the side.
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

// Keeps what is left of a side (Sutherland and Hodgman, "Reentrant polygon clipping", 1974). False
// if nothing had to be done.
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

// What a corner of the clipped polygon is called follows from the edges that meet there.
void polygon_meetings(const Outline& reference, const Outline& incident, int r, Meetings& out) {
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
    Meeting m = {c.x, c.y, {0.0, 0.0}, {0, 0}};
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
    out.add(m);
  }
}

// The part of a segment inside of a polygon (Cyrus and Beck, 1978).
void segment_meetings(const Outline& polygon, const Outline& segment, int r, Meetings& out) {
  double t[2] = {0.0, 1.0};
  std::uint32_t end_side[2] = {~0U, ~0U};
  for (std::uint32_t side = 0; side < polygon.count; ++side) {
    const double slack = out.same * side_length(polygon, side);
    const double at[2] = {inside(polygon, side, segment.x[0], segment.y[0]),
                          inside(polygon, side, segment.x[1], segment.y[1])};
    if (at[0] < -slack && at[1] < -slack) return;
    if (at[0] >= -slack && at[1] >= -slack) continue;
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
    Meeting m = {segment.x[0] + s * (segment.x[1] - segment.x[0]),
                 segment.y[0] + s * (segment.y[1] - segment.y[0]),
                 {0.0, 0.0},
                 {0, 0}};
    m.height[r] = polygon.height(m.x, m.y);
    m.height[1 - r] = segment.h[0] + s * (segment.h[1] - segment.h[0]);
    const bool vertex = end_side[end] == ~0U;
    m.id[r] = vertex ? polygon.face_id : polygon.edge_id[end_side[end]];
    m.id[1 - r] = vertex ? segment.vertex_id[end] : segment.edge_id[0];
    out.add(m);
  }
}

// The point of an edge that is closest to another.
struct EdgePoint {
  double x;
  double y;
  double h;
  // From the other point, squared.
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

// Two segments: where they cross, or the ends of what parallel ones share.
void crossing_meetings(const Outline& a, const Outline& b, Meetings& out) {
  const double e[2] = {a.x[1] - a.x[0], a.y[1] - a.y[0]};
  const double f[2] = {b.x[1] - b.x[0], b.y[1] - b.y[0]};
  const double turn = e[0] * f[1] - e[1] * f[0];
  const double lengths = std::sqrt((e[0] * e[0] + e[1] * e[1]) * (f[0] * f[0] + f[1] * f[1]));
  if (std::abs(turn) > kParallel * lengths) {
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
  // An end of one that projects into the other is a meeting, if the other is there.
  const double near = kParallel * std::min(a.size, b.size);
  const auto ends = [&](const Outline& p, const Outline& q, int of) {
    for (std::uint32_t i = 0; i < 2; ++i) {
      const EdgePoint on = project(q, 0, p.x[i], p.y[i]);
      if (on.away > near * near) continue;
      Meeting m = {0.5 * (p.x[i] + on.x), 0.5 * (p.y[i] + on.y), {0.0, 0.0}, {0, 0}};
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

// Where outlines come closest to each other that do not meet, but for rounding, or of which one is
// a point: a vertex of one and an edge of the other, the deepest of equally close ones.
void closest_meeting(const Outline* const outline[2], Meetings& out) {
  double least = INFINITY;
  double deepest = -INFINITY;
  Meeting best = {};
  for (int of = 0; of < 2; ++of) {
    const Outline& p = *outline[of];
    const Outline& q = *outline[1 - of];
    for (std::uint32_t i = 0; i < p.count; ++i) {
      for (std::uint32_t k = 0; k < q.count; ++k) {
        const EdgePoint on = project(q, k, p.x[i], p.y[i]);
        Meeting m = {0.5 * (p.x[i] + on.x), 0.5 * (p.y[i] + on.y), {0.0, 0.0}, {0, 0}};
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
}

// A point over or under a polygon.
void point_meeting(const Outline& polygon, const Outline& point, int r, Meetings& out) {
  for (std::uint32_t side = 0; side < polygon.count; ++side) {
    if (inside(polygon, side, point.x[0], point.y[0]) < 0.0) return;
  }
  Meeting m = {point.x[0], point.y[0], {0.0, 0.0}, {0, 0}};
  m.height[r] = polygon.height(m.x, m.y);
  m.height[1 - r] = point.h[0];
  m.id[r] = polygon.face_id;
  m.id[1 - r] = point.vertex_id[0];
  out.add(m);
}

}  // namespace

void find_meetings(const Outline& a, const Outline& b, Meetings& out) noexcept {
  const Outline* const outline[2] = {&a, &b};
  // The polygon, or of two the one that faces the normal better.
  const int r = a.count >= 3 && (b.count < 3 || a.cosine >= b.cosine) ? 0 : 1;
  const Outline& reference = *outline[r];
  const Outline& incident = *outline[1 - r];
  if (reference.count >= 3) {
    if (incident.count >= 3) polygon_meetings(reference, incident, r, out);
    if (incident.count == 2) segment_meetings(reference, incident, r, out);
    if (incident.count == 1) point_meeting(reference, incident, r, out);
  } else if (a.count == 2 && b.count == 2) {
    crossing_meetings(a, b, out);
  }
  if (out.count == 0) closest_meeting(outline, out);
}

}  // namespace winnow
