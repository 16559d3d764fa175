#include "pipeline/manifold/patch_outline.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace winnow {

namespace {

// A polygon whose area is this much smaller than its size squared, or whose plane is so close to
// the normal, looks like a segment.
constexpr double kThin = 1e-12;
constexpr double kSteep = 1e-6;

double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
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

Outline::Outline(const Patch& patch, const PatchFrame& frame, double up) noexcept
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

void Outline::take(const Patch& patch, const PatchFrame& frame, std::uint32_t vertex) noexcept {
  const double* p = patch.vertex[vertex];
  x[count] = dot(frame.axis[0], p);
  y[count] = dot(frame.axis[1], p);
  h[count] = dot(frame.axis[2], p);
  vertex_id[count] = feature_id(FeatureKind::vertex, patch.vertex_feature[vertex]);
  // A segment is its own edge, a point has none.
  edge_id[count] =
      feature_id(FeatureKind::edge, patch.count < 3 ? patch.feature : patch.edge_feature[vertex]);
  ++count;
}

// The farthest vertices in fifteen directions around, and the deepest.
void Outline::take_outermost(const Patch& patch, const PatchFrame& frame, double up) noexcept {
  std::uint32_t chosen[kOutlineVertices];
  for (std::uint32_t k = 0; k < kOutlineVertices; ++k) {
    const double turn = 0.41887902047863906 * k;
    double direction[3];
    for (int i = 0; i < 3; ++i) {
      direction[i] = k == 15
                         ? up * frame.axis[2][i]
                         : std::cos(turn) * frame.axis[0][i] + std::sin(turn) * frame.axis[1][i];
    }
    double best = -INFINITY;
    chosen[k] = 0;
    for (std::uint32_t i = 0; i < patch.count; ++i) {
      const double reach = dot(direction, patch.vertex[i]);
      if (reach > best) {
        best = reach;
        chosen[k] = i;
      }
    }
  }
  std::sort(chosen, chosen + kOutlineVertices);
  const std::uint32_t* end = std::unique(chosen, chosen + kOutlineVertices);
  for (const std::uint32_t* i = chosen; i != end; ++i) take(patch, frame, *i);
}

// The polygon's normal by the sum of its triangles' (Newell).
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
  double least = INFINITY;
  double farthest = 0.0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double away = std::hypot(x[i] - x[vertex], y[i] - y[vertex]);
    if (!(away > 1e-9 * size)) continue;
    const double rise = up * (h[vertex] - h[i]) / away;
    if (rise < least - 1e-9 || (rise <= least + 1e-9 && away > farthest)) {
      least = rise;
      farthest = away;
      best = i;
    }
  }
  return best;
}

// Its ends if they are the deepest of it, else the deepest vertex and the one to which it rises
// least: on that edge of the outline the other patch is met.
void Outline::flatten(double up) noexcept {
  const double same = 1e-9 * size;
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

}  // namespace winnow
