#include "pipeline/solver/supporting_patch.h"

#include <cmath>

namespace winnow::solver {
namespace {

constexpr std::uint32_t kCapCorners = 16;
// Numbers on cylinders and cones: corners of the upper cap from 0, of the lower from 16, the ends
// of the supporting line 32 and 33; faces and edges likewise.
constexpr std::uint32_t kLine = 2 * kCapCorners;
/// Faces up to 14 degrees off count as supporting, edges as well.
constexpr double kFaceCosine = 0.97;
constexpr double kEdgeSine = 0.25;
/// Caps of cylinders and cones up to 45 degrees off, else a line of the side.
constexpr double kCapCosine = 0.7071;

std::uint32_t farthest_corner(const Core& core, const Vec& outward) noexcept {
  const Vec d = core.rotation.transpose() * outward;
  std::uint32_t best = 0;
  double top = -std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < core.hull->vertex_count; ++i) {
    const double value = core.hull->vertex[0][i] * d.x() + core.hull->vertex[1][i] * d.y() +
                         core.hull->vertex[2][i] * d.z();
    if (value <= top) continue;
    top = value;
    best = i;
  }
  return best;
}

bool face_has(const HullShape& hull, const HullFace& face, std::uint32_t corner) noexcept {
  for (std::uint32_t i = 0; i < face.count; ++i) {
    if (hull.loop[face.first + i] == corner) return true;
  }
  return false;
}

}  // namespace

SupportingPatch::SupportingPatch(const Core& core, const Vec& outward) noexcept {
  rounding_ = core.rounding;
  switch (core.kind) {
    case CoreKind::box: {
      const Vec d = core.rotation.transpose() * outward;
      int axis = 0;
      d.cwiseAbs().maxCoeff(&axis);
      add_face(core, 2 * static_cast<std::uint32_t>(axis) + (d[axis] > 0.0 ? 1U : 0U));
      break;
    }
    case CoreKind::triangle:
      add_face(core, 0);
      break;
    case CoreKind::segment:
      add_edge(core, 0, 0);
      break;
    case CoreKind::hull:
      add_hull(core, outward);
      break;
    case CoreKind::cylinder:
    case CoreKind::cone:
      add_round(core, outward);
      break;
    default:
      add(core.center, 0, 0);
      break;
  }
}

SupportingPatch SupportingPatch::of_half_space(const Core& core, const Vec& middle,
                                               double reach) noexcept {
  SupportingPatch patch;
  const Vec& n = core.normal;
  int least = 0;
  n.cwiseAbs().minCoeff(&least);
  const Vec u = without(Vec::Unit(least), n);
  const Vec v = n.cross(u);
  const Vec foot = middle - n * (n.dot(middle - core.center) - core.offset);
  patch.add(foot - (u + v) * reach, 0, 0);
  patch.add(foot + (u - v) * reach, 1, 1);
  patch.add(foot + (u + v) * reach, 2, 2);
  patch.add(foot - (u - v) * reach, 3, 3);
  return patch;
}

void SupportingPatch::add(const Vec& v, std::uint32_t vertex_feature,
                          std::uint32_t edge_feature) noexcept {
  Vec::Map(vertex_[count_]) = v;
  vertex_feature_[count_] = vertex_feature;
  edge_feature_[count_] = edge_feature;
  ++count_;
}

void SupportingPatch::add_face(const Core& core, std::uint32_t face) noexcept {
  const std::uint32_t size = face_size(core, face);
  // Of faces with more corners than there is room for, every second (third, ...) is taken.
  const std::uint32_t stride = (size + kRoom - 1) / kRoom;
  for (std::uint32_t i = 0; i < size; i += stride) {
    const std::uint32_t corner = face_vertex(core, face, i);
    add(vertex(core, corner), corner, face_edge(core, face, i));
  }
  feature_ = face;
}

void SupportingPatch::add_edge(const Core& core, std::uint32_t number,
                               std::uint32_t feature) noexcept {
  for (const std::uint32_t corner : edge(core, number)) add(vertex(core, corner), corner, number);
  feature_ = feature;
}

void SupportingPatch::add_hull(const Core& core, const Vec& outward) noexcept {
  const HullShape& hull = *core.hull;
  const std::uint32_t corner = farthest_corner(core, outward);
  double best = kFaceCosine;
  std::uint32_t best_face = hull.face_count;
  for (std::uint32_t f = 0; f < hull.face_count; ++f) {
    const double cosine = face_normal(core, f).dot(outward);
    if (cosine <= best || !face_has(hull, hull.faces[f], corner)) continue;
    best = cosine;
    best_face = f;
  }
  if (best_face < hull.face_count) return add_face(core, best_face);
  best = kEdgeSine;
  std::uint32_t best_edge = hull.edge_count;
  for (std::uint32_t e = 0; e < hull.edge_count; ++e) {
    if (hull.edges[e].vertex[0] != corner && hull.edges[e].vertex[1] != corner) continue;
    const double sine = std::abs(direction(core, e).dot(outward));
    if (sine >= best) continue;
    best = sine;
    best_edge = e;
  }
  if (best_edge < hull.edge_count) return add_edge(core, best_edge, hull.face_count + best_edge);
  add(vertex(core, corner), corner, 0);
  feature_ = hull.face_count + hull.edge_count + corner;
}

void SupportingPatch::add_cap(const Core& core, const Vec& out, double z) noexcept {
  const std::uint32_t first = z > 0.0 ? 0 : kCapCorners;
  for (std::uint32_t i = 0; i < kCapCorners; ++i) {
    constexpr double kStep = 6.283185307179586 / kCapCorners;
    const double c = std::cos(kStep * i);
    const double s = std::sin(kStep * i);
    const Vec at(core.half.x() * (c * out.x() - s * out.y()),
                 core.half.x() * (c * out.y() + s * out.x()), z);
    add(core.center + core.rotation * at, first + i, first + i);
  }
  feature_ = first;
}

void SupportingPatch::add_round(const Core& core, const Vec& outward) noexcept {
  const Vec d = core.rotation.transpose() * outward;
  const double r = core.half.x();
  const double h = core.half.z();
  const double radial = std::hypot(d.x(), d.y());
  // A direction along the axis has no side; the cap then begins at +x, always.
  const Vec out = radial > 1e-9 ? Vec(d.x() / radial, d.y() / radial, 0.0) : Vec::UnitX();
  const bool cone = core.kind == CoreKind::cone;
  const bool on_tip = cone && h * d.z() >= r * radial - h * d.z();
  // A cone has but the lower cap.
  const double over_cap = cone ? -d.z() : std::abs(d.z());
  if (over_cap > kCapCosine) return add_cap(core, out, d.z() > 0.0 ? h : -h);
  const Vec top = cone ? Vec(0.0, 0.0, h) : Vec(out * r + Vec(0.0, 0.0, h));
  add(core.center + core.rotation * top, kLine, kLine);
  feature_ = kLine;
  if (on_tip && radial <= 1e-9) return;
  add(core.center + core.rotation * (out * r - Vec(0.0, 0.0, h)), kLine + 1, kLine);
}

}  // namespace winnow::solver
