// The cores of the solver: for each kind of core a struct with its support function, projection,
// features (vertices, edges, faces) and bounds of its rotation. The other files of this folder
// build on them.

#include "pipeline/solver/core.h"

#include "pipeline/kinds/hypotenuse.h"

#include <algorithm>
#include <cmath>

namespace winnow::solver {

Vec unit(const Vec& v) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return Vec::Zero();
  // Vectors in this range need no scaling: their squares neither overflow nor underflow, and
  // scaling by a power of two would not change the result.
  constexpr double kSafe = 1e140;
  if (largest > 1.0 / kSafe && largest < kSafe) return v / v.norm();
  int exponent = 0;
  std::frexp(largest, &exponent);
  const int half = exponent / 2;
  const Vec scaled = v * std::ldexp(1.0, -half) * std::ldexp(1.0, half - exponent);
  return scaled / scaled.norm();
}

Vec perpendicular(const Vec& e, const Vec& f) noexcept {
  return without(unit(e.cross(f)), e);
}

Vec without(const Vec& v, const Vec& e) noexcept {
  const Vec once = unit(v - e * e.dot(v));
  return unit(once - e * e.dot(once));
}

// The maximum of eight products is computed first, then compared with the best so far: only one
// comparison in eight depends on the vertices before.
std::uint32_t farthest_vertex(const HullShape& hull, const Vec& d, double& value) noexcept {
  constexpr int kBlock = 8;
  using Block = Eigen::Array<double, kBlock, 1>;
  double best = -std::numeric_limits<double>::infinity();
  std::uint32_t best_at = 0;
  for (std::uint32_t i = 0; i < hull.vertex_count; i += kBlock) {
    const Block dot = Block::Map(hull.vertex[0] + i) * d.x() +
                      Block::Map(hull.vertex[1] + i) * d.y() +
                      Block::Map(hull.vertex[2] + i) * d.z();
    const double top = dot.maxCoeff();
    if (!(top > best)) continue;
    best = top;
    int k = 0;
    while (k + 1 < kBlock && dot[k] != top) ++k;
    best_at = i + static_cast<std::uint32_t>(k);
  }
  value = best;
  // The columns are padded with copies of vertex 0.
  return best_at < hull.vertex_count ? best_at : 0;
}

namespace {

/// Length of the part orthogonal to z; |w| is at most 1.
double across_z(const Vec& w) noexcept {
  return std::sqrt(w.x() * w.x() + w.y() * w.y());
}

/// The largest distance of a rim of `radius` at height z from an axis w.
double rim_reach(double radius, double z, const Vec& w) noexcept {
  const double nearest = std::max(0.0, std::abs(z * w.z()) - radius * across_z(w));
  return std::sqrt(std::max(0.0, radius * radius + z * z - nearest * nearest));
}

struct PointForm {
  static Vec support(const Core& core, const Vec& /*direction*/) noexcept { return core.center; }
  static AxisRange project(const Core& /*core*/, const Vec& /*n*/) noexcept { return {0.0, 0.0}; }
  static std::uint32_t vertex_count(const Core& /*core*/) noexcept { return 1; }
  static Vec vertex(const Core& core, std::uint32_t /*i*/) noexcept { return core.center; }
  static std::uint32_t edge_count(const Core& /*core*/) noexcept { return 0; }
  static Edge edge(const Core& /*core*/, std::uint32_t /*i*/) noexcept { return {0, 1}; }
  static std::uint32_t direction_count(const Core& /*core*/) noexcept { return 0; }
  static Vec direction(const Core& core, std::uint32_t /*i*/) noexcept {
    return core.rotation.col(2);
  }
  static std::uint32_t normal_count(const Core& /*core*/) noexcept { return 0; }
  static Vec normal(const Core& core, std::uint32_t /*i*/) noexcept { return core.rotation.col(2); }
  static std::uint32_t face_count(const Core& /*core*/) noexcept { return 0; }
  static std::uint32_t face_size(const Core& /*core*/, std::uint32_t /*face*/) noexcept {
    return 0;
  }
  static std::uint32_t face_vertex(const Core& /*core*/, std::uint32_t /*face*/,
                                   std::uint32_t i) noexcept {
    return i;
  }
  static std::uint32_t face_edge(const Core& /*core*/, std::uint32_t /*face*/,
                                 std::uint32_t i) noexcept {
    return i;
  }
  static Vec face_normal(const Core& core, std::uint32_t /*face*/) noexcept {
    return core.rotation.col(2);
  }
  static double reach_about(const Core& /*core*/, const Vec& /*w*/) noexcept { return 0.0; }
  static bool is_invariant(const Core& /*core*/, const Vec& /*w*/) noexcept { return true; }
  static double extent(const Core& core) noexcept { return core.size; }
};

/// A core with vertices, which are relative to `center`.
struct CornersForm : PointForm {
  template <typename Form>
  static double reach_of_corners(const Core& core, const Vec& w) noexcept {
    double square = 0.0;
    for (std::uint32_t i = 0; i < Form::vertex_count(core); ++i) {
      square = std::max(square, (Form::vertex(core, i) - core.center).cross(w).squaredNorm());
    }
    return std::sqrt(square);
  }
  static bool is_invariant(const Core& /*core*/, const Vec& /*w*/) noexcept { return false; }
};

/// A core that is symmetric about its z axis.
struct RevolvedForm : PointForm {
  static bool is_invariant(const Core& /*core*/, const Vec& w) noexcept {
    return across_z(w) <= kSameAxis;
  }
};

struct SegmentForm : RevolvedForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const Vec d = core.rotation.transpose() * direction;
    return core.center +
           core.rotation * Vec(0.0, 0.0, d.z() < 0.0 ? -core.half.z() : core.half.z());
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    const double along = std::abs(d.z()) * core.half.z();
    return {-along, along};
  }
  static std::uint32_t vertex_count(const Core& /*core*/) noexcept { return 2; }
  static Vec vertex(const Core& core, std::uint32_t i) noexcept {
    return core.center + core.rotation.col(2) * (i == 0 ? -core.half.z() : core.half.z());
  }
  static std::uint32_t edge_count(const Core& /*core*/) noexcept { return 1; }
  static std::uint32_t direction_count(const Core& /*core*/) noexcept { return 1; }
  static double reach_about(const Core& core, const Vec& w) noexcept {
    return core.half.z() * across_z(w);
  }
};

/// The corners of a box's faces, counter-clockwise seen from outside. Bit i of a corner's number is
/// set on the positive side of axis i. Face 2 i is the negative, face 2 i + 1 the positive face of
/// axis i.
constexpr std::uint32_t kBoxFace[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

/// Edge 4 i + k runs along axis i.
constexpr Edge kBoxEdge[12] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3},
                               {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};

std::uint32_t box_edge_of(std::uint32_t p, std::uint32_t q) noexcept {
  for (std::uint32_t e = 0; e < 12; ++e) {
    if (kBoxEdge[e][0] == std::min(p, q) && kBoxEdge[e][1] == std::max(p, q)) return e;
  }
  return 0;
}

struct BoxForm : CornersForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const Vec d = core.rotation.transpose() * direction;
    const Vec& h = core.half;
    const Vec local(d.x() < 0.0 ? -h.x() : h.x(), d.y() < 0.0 ? -h.y() : h.y(),
                    d.z() < 0.0 ? -h.z() : h.z());
    return core.center + core.rotation * local;
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    const double reach = d.cwiseAbs().dot(core.half);
    return {-reach, reach};
  }
  static std::uint32_t vertex_count(const Core& /*core*/) noexcept { return 8; }
  static Vec vertex(const Core& core, std::uint32_t i) noexcept {
    const Vec& h = core.half;
    return core.center + core.rotation * Vec((i & 1U) != 0 ? h.x() : -h.x(),
                                             (i & 2U) != 0 ? h.y() : -h.y(),
                                             (i & 4U) != 0 ? h.z() : -h.z());
  }
  static std::uint32_t edge_count(const Core& /*core*/) noexcept { return 12; }
  static Edge edge(const Core& /*core*/, std::uint32_t i) noexcept { return kBoxEdge[i]; }
  static std::uint32_t direction_count(const Core& /*core*/) noexcept { return 3; }
  static Vec direction(const Core& core, std::uint32_t i) noexcept {
    return core.rotation.col(static_cast<Eigen::Index>(i));
  }
  static std::uint32_t normal_count(const Core& /*core*/) noexcept { return 3; }
  static Vec normal(const Core& core, std::uint32_t i) noexcept { return direction(core, i); }
  static std::uint32_t face_count(const Core& /*core*/) noexcept { return 6; }
  static std::uint32_t face_size(const Core& /*core*/, std::uint32_t /*face*/) noexcept {
    return 4;
  }
  static std::uint32_t face_vertex(const Core& /*core*/, std::uint32_t face,
                                   std::uint32_t i) noexcept {
    return kBoxFace[face][i];
  }
  static std::uint32_t face_edge(const Core& /*core*/, std::uint32_t face,
                                 std::uint32_t i) noexcept {
    return box_edge_of(kBoxFace[face][i], kBoxFace[face][(i + 1) % 4]);
  }
  static Vec face_normal(const Core& core, std::uint32_t face) noexcept {
    return (face & 1U) != 0 ? Vec(core.rotation.col(face / 2)) : Vec(-core.rotation.col(face / 2));
  }
  static double reach_about(const Core& core, const Vec& w) noexcept {
    return reach_of_corners<BoxForm>(core, w);
  }
};

struct TriangleForm : CornersForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const double d0 = core.corner[0].dot(direction);
    const double d1 = core.corner[1].dot(direction);
    const double d2 = core.corner[2].dot(direction);
    return core.center + core.corner[d0 >= d1 && d0 >= d2 ? 0 : (d1 >= d2 ? 1 : 2)];
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const double d0 = core.corner[0].dot(n);
    const double d1 = core.corner[1].dot(n);
    const double d2 = core.corner[2].dot(n);
    return {std::min({d0, d1, d2}), std::max({d0, d1, d2})};
  }
  static std::uint32_t vertex_count(const Core& /*core*/) noexcept { return 3; }
  static Vec vertex(const Core& core, std::uint32_t i) noexcept {
    return core.center + core.corner[i];
  }
  static std::uint32_t edge_count(const Core& /*core*/) noexcept { return 3; }
  static Edge edge(const Core& /*core*/, std::uint32_t i) noexcept {
    return {i, i == 2 ? 0U : i + 1};
  }
  static std::uint32_t direction_count(const Core& /*core*/) noexcept { return 3; }
  static Vec direction(const Core& core, std::uint32_t i) noexcept { return core.side[i]; }
  static std::uint32_t normal_count(const Core& /*core*/) noexcept { return 1; }
  static Vec normal(const Core& core, std::uint32_t /*i*/) noexcept {
    // Use the longest side, which has the most accurate direction, and the shortest.
    std::array<double, 3> length{};
    for (std::size_t i = 0; i < 3; ++i) {
      length[i] = (core.corner[(i + 1) % 3] - core.corner[i]).squaredNorm();
    }
    const auto longest =
        static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
    const std::size_t next = (longest + 1) % 3;
    const std::size_t last = (longest + 2) % 3;
    const bool next_is_shorter = length[next] < length[last];
    return perpendicular(core.side[longest],
                         next_is_shorter ? core.side[next] : Vec(-core.side[last]));
  }
  static std::uint32_t face_count(const Core& /*core*/) noexcept { return 1; }
  static std::uint32_t face_size(const Core& /*core*/, std::uint32_t /*face*/) noexcept {
    return 3;
  }
  static Vec face_normal(const Core& core, std::uint32_t face) noexcept {
    return normal(core, face);
  }
  static double reach_about(const Core& core, const Vec& w) noexcept {
    return reach_of_corners<TriangleForm>(core, w);
  }
  static double extent(const Core& core) noexcept {
    return core.rounding + std::max({(core.corner[1] - core.corner[0]).norm(),
                                     (core.corner[2] - core.corner[1]).norm(),
                                     (core.corner[0] - core.corner[2]).norm()}) /
                               2.0;
  }
};

struct HullForm : CornersForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    double value = 0.0;
    const Vec d = core.rotation.transpose() * direction;
    return vertex(core, farthest_vertex(*core.hull, d, value));
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    AxisRange range{};
    farthest_vertex(*core.hull, d, range.high);
    farthest_vertex(*core.hull, -d, range.low);
    range.low = -range.low * core.unit[0] * core.unit[1];
    range.high = range.high * core.unit[0] * core.unit[1];
    return range;
  }
  static std::uint32_t vertex_count(const Core& core) noexcept { return core.hull->vertex_count; }
  static Vec vertex(const Core& core, std::uint32_t i) noexcept {
    const Vec local(core.hull->vertex[0][i], core.hull->vertex[1][i], core.hull->vertex[2][i]);
    const Vec point = core.rotation * (local * core.unit[0] * core.unit[1]);
    return core.center + point;
  }
  static std::uint32_t edge_count(const Core& core) noexcept { return core.hull->edge_count; }
  static Edge edge(const Core& core, std::uint32_t i) noexcept {
    return {core.hull->edges[i].vertex[0], core.hull->edges[i].vertex[1]};
  }
  static std::uint32_t direction_count(const Core& core) noexcept { return edge_count(core); }
  static Vec direction(const Core& core, std::uint32_t i) noexcept {
    const HullShape& hull = *core.hull;
    const auto [p, q] = edge(core, i);
    const Vec local(hull.vertex[0][q] - hull.vertex[0][p], hull.vertex[1][q] - hull.vertex[1][p],
                    hull.vertex[2][q] - hull.vertex[2][p]);
    return core.rotation * unit(local);
  }
  static std::uint32_t normal_count(const Core& core) noexcept { return core.hull->face_count; }
  static Vec normal(const Core& core, std::uint32_t i) noexcept { return face_normal(core, i); }
  static std::uint32_t face_count(const Core& core) noexcept { return core.hull->face_count; }
  static std::uint32_t face_size(const Core& core, std::uint32_t face) noexcept {
    return core.hull->faces[face].count;
  }
  static std::uint32_t face_vertex(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
    return core.hull->loop[core.hull->faces[face].first + i];
  }
  static std::uint32_t face_edge(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
    return core.hull->loop_edge[core.hull->faces[face].first + i];
  }
  static Vec face_normal(const Core& core, std::uint32_t face) noexcept {
    return core.rotation * Eigen::Map<const Vec>(core.hull->faces[face].normal);
  }
  static double reach_about(const Core& core, const Vec& w) noexcept {
    const HullShape& hull = *core.hull;
    double square = 0.0;
    for (std::uint32_t i = 0; i < hull.vertex_count; ++i) {
      const auto own = [&](std::size_t axis) {
        return hull.vertex[axis][i] * core.unit[0] * core.unit[1];
      };
      const double x = own(1) * w.z() - own(2) * w.y();
      const double y = own(2) * w.x() - own(0) * w.z();
      const double z = own(0) * w.y() - own(1) * w.x();
      square = std::max(square, x * x + y * y + z * z);
    }
    return std::sqrt(square);
  }
  static double extent(const Core& core) noexcept {
    return core.rounding + core.hull->radius * core.unit[0] * core.unit[1];
  }
};

Vec rim(const Core& core, const Vec& local, double z) noexcept {
  const double length = hypotenuse(local.x(), local.y());
  if (length == 0.0) return {0.0, 0.0, z};
  // Divide by the length first: for very short directions, radius / length may overflow.
  return {core.half.x() * (local.x() / length), core.half.x() * (local.y() / length), z};
}

double radial(const Core& core, const Vec& local) noexcept {
  return core.half.x() * hypotenuse(local.x(), local.y());
}

/// A cylinder or cone: its direction and its normal are its axis.
struct CappedForm : RevolvedForm {
  static std::uint32_t direction_count(const Core& /*core*/) noexcept { return 1; }
  static std::uint32_t normal_count(const Core& /*core*/) noexcept { return 1; }
  static double extent(const Core& core) noexcept {
    return core.rounding + hypotenuse(core.half.x(), core.half.z());
  }
};

struct CylinderForm : CappedForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const Vec d = core.rotation.transpose() * direction;
    const double z = d.z() < 0.0 ? -core.half.z() : core.half.z();
    return core.center + core.rotation * rim(core, d, z);
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    const double reach = radial(core, d) + std::abs(d.z()) * core.half.z();
    return {-reach, reach};
  }
  static double reach_about(const Core& core, const Vec& w) noexcept {
    return rim_reach(core.half.x(), core.half.z(), w);
  }
};

struct ConeForm : CappedForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const Vec d = core.rotation.transpose() * direction;
    const double h = core.half.z();
    const bool on_tip = h * d.z() >= radial(core, d) - h * d.z();
    const Vec local = on_tip ? Vec(0.0, 0.0, h) : rim(core, d, -h);
    return core.center + core.rotation * local;
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    const double tip = core.half.z() * d.z();
    const double side = radial(core, d);
    return {std::min(tip, -side - tip), std::max(tip, side - tip)};
  }
  static double reach_about(const Core& core, const Vec& w) noexcept {
    return std::max(rim_reach(core.half.x(), -core.half.z(), w), core.half.z() * across_z(w));
  }
};

struct SupportForm : PointForm {
  /// Relative to the center, in the core's axes; `d` is unit.
  static Vec farthest_point(const Core& core, const Vec& d) noexcept {
    return core.farthest.farthest(d) * core.unit[0] * core.unit[1];
  }
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const Vec d = core.rotation.transpose() * direction;
    const Vec local = farthest_point(core, unit(d));
    return core.center + core.rotation * local;
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    const Vec u = unit(d);
    return {d.dot(farthest_point(core, -u)), d.dot(farthest_point(core, u))};
  }
  static double reach_about(const Core& core, const Vec& /*w*/) noexcept {
    return core.size - core.rounding;
  }
  static bool is_invariant(const Core& /*core*/, const Vec& /*w*/) noexcept { return false; }
};

/// Not bounded: it has no support points and no range.
struct HalfSpaceForm : PointForm {
  static bool is_invariant(const Core& core, const Vec& w) noexcept {
    return core.normal.cross(w).norm() <= kSameAxis;
  }
  static double extent(const Core& /*core*/) noexcept { return 0.0; }
};

/// Calls visit(form) with the form of a core, and returns its result.
template <typename Visit>
decltype(auto) with_form(const Core& core, Visit&& visit) {
  switch (core.kind) {
    case CoreKind::segment:
      return visit(SegmentForm{});
    case CoreKind::box:
      return visit(BoxForm{});
    case CoreKind::triangle:
      return visit(TriangleForm{});
    case CoreKind::hull:
      return visit(HullForm{});
    case CoreKind::cylinder:
      return visit(CylinderForm{});
    case CoreKind::cone:
      return visit(ConeForm{});
    case CoreKind::support:
      return visit(SupportForm{});
    case CoreKind::half_space:
      return visit(HalfSpaceForm{});
    case CoreKind::point:
      break;
  }
  return visit(PointForm{});
}

}  // namespace

Vec support(const Core& core, const Vec& direction) noexcept {
  return with_form(core, [&](auto form) { return form.support(core, direction); });
}

AxisRange project(const Core& core, const Vec& n) noexcept {
  return with_form(core, [&](auto form) { return form.project(core, n); });
}

double highest(const Core& core, const Vec& n) noexcept {
  if (core.kind != CoreKind::hull) return project(core, n).high;
  double value = 0.0;
  farthest_vertex(*core.hull, core.rotation.transpose() * n, value);
  return value * core.unit[0] * core.unit[1];
}

double separation(const Core& a, const Core& b, const Vec& axis) noexcept {
  return axis.dot(b.center - a.center) + project(b, axis).low - project(a, axis).high;
}

Core meridian(const Core& core, const Vec& direction) noexcept {
  if (core.kind != CoreKind::cylinder && core.kind != CoreKind::cone) return core;
  const Vec d = core.rotation.transpose() * direction;
  // Along the axis all meridian planes are alike.
  if (hypotenuse(d.x(), d.y()) <= 1e-7 * std::abs(d.z())) return core;
  const double h = core.half.z();
  const Vec low = rim(core, d, -h);
  const Vec high = core.kind == CoreKind::cone ? Vec(0.0, 0.0, h) : rim(core, d, h);
  const Vec middle(0.0, 0.0, core.kind == CoreKind::cylinder && d.z() > 0.0 ? h : -h);
  Core triangle = core;
  triangle.kind = CoreKind::triangle;
  triangle.corner = {core.rotation * low, core.rotation * high, core.rotation * middle};
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.side[i] = unit(triangle.corner[(i + 1) % 3] - triangle.corner[i]);
  }
  return triangle;
}

std::uint32_t vertex_count(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.vertex_count(core); });
}
Vec vertex(const Core& core, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.vertex(core, i); });
}
std::uint32_t edge_count(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.edge_count(core); });
}
Edge edge(const Core& core, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.edge(core, i); });
}
std::uint32_t direction_count(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.direction_count(core); });
}
Vec direction(const Core& core, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.direction(core, i); });
}
std::uint32_t normal_count(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.normal_count(core); });
}
Vec normal(const Core& core, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.normal(core, i); });
}
std::uint32_t face_count(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.face_count(core); });
}
std::uint32_t face_size(const Core& core, std::uint32_t face) noexcept {
  return with_form(core, [&](auto form) { return form.face_size(core, face); });
}
std::uint32_t face_vertex(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.face_vertex(core, face, i); });
}
std::uint32_t face_edge(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.face_edge(core, face, i); });
}
Vec face_normal(const Core& core, std::uint32_t face) noexcept {
  return with_form(core, [&](auto form) { return form.face_normal(core, face); });
}
double reach_about(const Core& core, const Vec& w) noexcept {
  return with_form(core, [&](auto form) { return form.reach_about(core, w); });
}
bool is_invariant(const Core& core, const Vec& w) noexcept {
  return with_form(core, [&](auto form) { return form.is_invariant(core, w); });
}
double extent(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.extent(core); });
}

}  // namespace winnow::solver
