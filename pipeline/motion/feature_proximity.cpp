#include "pipeline/motion/feature_proximity.h"

#include <algorithm>

namespace winnow {
namespace {

/// Position of the point of a segment nearest to p: 0 at a, 1 at a + side.
double nearest_on_segment(const Vec3d& p, const Vec3d& a, const Vec3d& side) noexcept {
  const double square = side.squared_norm();
  return square > 0.0 ? std::clamp((p - a).dot(side) / square, 0.0, 1.0) : 0.0;
}

void keep_if_nearer(const MeshProximity& candidate, MeshProximity& best) noexcept {
  if (candidate.distance < best.distance) best = candidate;
}

/// Computes the points and the distance from the weights.
void place_by_weights(FeaturePair kind, const std::array<Vec3d, 4>& p, MeshProximity& at) noexcept {
  const std::array<double, 4>& w = at.weight;
  if (kind == FeaturePair::vertex_face) {
    at.point = {p[0], w[1] * p[1] + w[2] * p[2] + w[3] * p[3]};
  } else {
    at.point = {w[0] * p[0] + w[1] * p[1], w[2] * p[2] + w[3] * p[3]};
  }
  at.distance = (at.point[1] - at.point[0]).norm();
}

/// The candidates are the nearest point of each side of the face and, if the vertex projects into
/// the face, its projection.
void nearest_of_face(const std::array<Vec3d, 4>& p, MeshProximity& best) noexcept {
  MeshProximity at = best;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = 1 + k;
    const std::size_t b = 1 + (k + 1) % 3;
    const double s = nearest_on_segment(p[0], p[a], p[b] - p[a]);
    at.weight = {1.0, 0.0, 0.0, 0.0};
    at.weight[a] = 1.0 - s;
    at.weight[b] = s;
    place_by_weights(FeaturePair::vertex_face, p, at);
    keep_if_nearer(at, best);
  }
  const Vec3d n = (p[2] - p[1]).cross(p[3] - p[1]);
  const double square = n.squared_norm();
  if (!(square > 0.0)) return;
  const double b = n.dot((p[0] - p[1]).cross(p[3] - p[1])) / square;
  const double c = n.dot((p[2] - p[1]).cross(p[0] - p[1])) / square;
  if (!(b >= 0.0 && c >= 0.0 && b + c <= 1.0)) return;
  at.weight = {1.0, 1.0 - b - c, b, c};
  place_by_weights(FeaturePair::vertex_face, p, at);
  keep_if_nearer(at, best);
}

/// The candidates are each end of an edge with its nearest point of the other edge and, if they are
/// inside both edges, the closest points of both lines.
void nearest_of_edges(const std::array<Vec3d, 4>& p, MeshProximity& best) noexcept {
  const Vec3d u = p[1] - p[0];
  const Vec3d v = p[3] - p[2];
  MeshProximity at = best;
  const auto consider = [&](double s, double t) {
    at.weight = {1.0 - s, s, 1.0 - t, t};
    place_by_weights(FeaturePair::edge_edge, p, at);
    keep_if_nearer(at, best);
  };
  consider(0.0, nearest_on_segment(p[0], p[2], v));
  consider(1.0, nearest_on_segment(p[1], p[2], v));
  consider(nearest_on_segment(p[2], p[0], u), 0.0);
  consider(nearest_on_segment(p[3], p[0], u), 1.0);
  const Vec3d n = u.cross(v);
  const double square = n.squared_norm();
  if (!(square > 0.0)) return;
  const Vec3d r = p[2] - p[0];
  const double s = n.dot(r.cross(v)) / square;
  const double t = n.dot(r.cross(u)) / square;
  if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) consider(s, t);
}

}  // namespace

void find_nearest_points(FeaturePair kind, const std::array<Vec3d, 4>& points,
                         MeshProximity& result) noexcept {
  result.distance = std::numeric_limits<double>::infinity();
  if (kind == FeaturePair::vertex_face) {
    nearest_of_face(points, result);
  } else {
    nearest_of_edges(points, result);
  }
}

}  // namespace winnow
