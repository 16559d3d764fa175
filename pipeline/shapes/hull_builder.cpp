// Merges coplanar faces of a surface (Merge), checks convexity and lays out the columns of a hull
// in one block (Assembly). Entry points for faces are here, for points in hull_points.cpp;
// ShapePool::add_hull (kinds/hull.cpp) calls both.

#include "pipeline/shapes/hull_builder.h"
#include "core/memory/catch_bad_alloc.h"
#include "pipeline/exact/exact_vector.h"
#include "pipeline/shapes/accurate_cross.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace winnow {
namespace {

constexpr std::uint32_t kUnset = ~0U;

struct FacePlane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double offset = 0.0;
  double area = 0.0;
};

// Newell's normal (Sutherland, Sproull, Schumacker 1974), computed relative to the first vertex so
// that it loses no digits far from the origin.
[[nodiscard]] FacePlane plane_of(std::span<const Eigen::Vector3d> points,
                                 std::span<const std::uint32_t> loop) {
  const Eigen::Vector3d origin = points[loop[0]];
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    sum += accurate_cross(points[loop[i]] - origin, points[loop[i + 1]] - origin);
  }
  FacePlane plane;
  const double area = sum.norm();
  // False for NaN, which would break the sort by area.
  if (area > 0.0) {
    plane.area = area;
    plane.normal = sum / area;
  }
  plane.offset = plane.normal.dot(origin);
  return plane;
}

using Memory = std::pmr::memory_resource*;
template <typename Key>
using Numbers = std::pmr::unordered_map<Key, std::uint32_t>;

[[nodiscard]] Memory memory_of(const HullSurface& surface) {
  return surface.loops.get_allocator().resource();
}

class Merge {
 public:
  Merge(std::span<const Eigen::Vector3d> points, HullSurface& surface)
      : points_(points),
        surface_(surface),
        memory_(memory_of(surface)),
        group_(surface.faces(), kUnset, memory_),
        open_(memory_),
        face_of_(memory_) {}

  /// `invalid_shape` unless the surface is closed, connected and has no handles.
  Status pair_edges() {
    face_of_.reserve(surface_.loops.size());
    for (std::size_t f = 0; f < surface_.faces(); ++f) {
      const auto loop = surface_.loop(f);
      if (loop.size() < 3) return Status::invalid_shape;
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const auto key = edge(loop[i], loop[(i + 1) % loop.size()]);
        if (!face_of_.emplace(key, static_cast<std::uint32_t>(f)).second) {
          return Status::invalid_shape;
        }
      }
    }
    std::pmr::vector<std::uint32_t> used(surface_.loops, memory_);
    std::sort(used.begin(), used.end());
    const auto vertices = std::unique(used.begin(), used.end()) - used.begin();
    for (const auto& [key, face] : face_of_) {
      if (!face_of_.contains(key << 32U | key >> 32U)) return Status::invalid_shape;
    }
    const auto edges = static_cast<std::ptrdiff_t>(face_of_.size() / 2);
    const auto faces = static_cast<std::ptrdiff_t>(surface_.faces());
    return vertices - edges + faces == 2 ? Status::ok : Status::invalid_shape;
  }

  /// Faces that are coplanar to `relative` of the size of the surface are merged.
  Status run(double relative) {
    Status status = pair_edges();
    if (status != Status::ok) return status;
    const double coplanar = extent() * relative;
    std::pmr::vector<FacePlane> planes(memory_);
    planes.reserve(surface_.faces());
    for (std::size_t f = 0; f < surface_.faces(); ++f) {
      planes.push_back(plane_of(points_, surface_.loop(f)));
    }
    std::pmr::vector<std::uint32_t> by_area(surface_.faces(), memory_);
    std::iota(by_area.begin(), by_area.end(), 0U);
    // std::stable_sort would allocate a buffer on the global heap.
    std::ranges::sort(by_area, [&](std::uint32_t a, std::uint32_t b) {
      return planes[a].area > planes[b].area || (planes[a].area == planes[b].area && a < b);
    });
    std::uint32_t groups = 0;
    for (const std::uint32_t seed : by_area) {
      if (group_[seed] == kUnset) absorb(seed, groups++, planes, coplanar);
    }
    return rebuild(groups, coplanar);
  }

 private:
  [[nodiscard]] static std::uint64_t edge(std::uint32_t from, std::uint32_t to) {
    return static_cast<std::uint64_t>(from) << 32U | to;
  }

  [[nodiscard]] double extent() const {
    Eigen::AlignedBox3d box;
    for (const std::uint32_t v : surface_.loops) box.extend(points_[v]);
    return box.diagonal().norm();
  }

  // Flood fill from `seed` over neighbouring faces that lie in the seed's plane.
  void absorb(std::uint32_t seed, std::uint32_t group, std::span<const FacePlane> planes,
              double tolerance) {
    const FacePlane& plane = planes[seed];
    open_.assign(1, seed);
    group_[seed] = group;
    while (!open_.empty()) {
      const std::uint32_t face = open_.back();
      open_.pop_back();
      const auto loop = surface_.loop(face);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::uint32_t next = face_of_.at(edge(loop[(i + 1) % loop.size()], loop[i]));
        if (group_[next] != kUnset || !is_coplanar(next, plane, planes[next], tolerance)) continue;
        group_[next] = group;
        open_.push_back(next);
      }
    }
  }

  [[nodiscard]] bool is_coplanar(std::uint32_t face, const FacePlane& plane, const FacePlane& own,
                                 double tolerance) const {
    // The normal of a sliver is meaningless. Otherwise the normals must agree, so that the two
    // sides of a flat hull are not merged.
    if (own.area > tolerance * tolerance && own.normal.dot(plane.normal) <= 0.0) return false;
    return std::ranges::all_of(surface_.loop(face), [&](std::uint32_t v) {
      return std::abs(plane.normal.dot(points_[v]) - plane.offset) <= tolerance;
    });
  }

  // Replaces the faces by the outlines of the groups, without vertices on a straight line between
  // two corners.
  Status rebuild(std::uint32_t groups, double tolerance) {
    std::pmr::vector<Numbers<std::uint32_t>> next(groups, memory_);
    Numbers<std::uint32_t> face_counts(memory_);
    for (std::size_t f = 0; f < surface_.faces(); ++f) {
      const auto loop = surface_.loop(f);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::uint32_t from = loop[i];
        const std::uint32_t to = loop[(i + 1) % loop.size()];
        if (group_[face_of_.at(edge(to, from))] == group_[f]) continue;
        if (!next[group_[f]].emplace(from, to).second) return Status::invalid_shape;
        ++face_counts[from];
      }
    }
    HullSurface merged(memory_);
    std::pmr::vector<std::uint32_t> loop(memory_);
    for (const auto& outline : next) {
      if (!follow(outline, loop) || !add_corners(loop, face_counts, tolerance, merged)) {
        return Status::invalid_shape;
      }
    }
    surface_ = std::move(merged);
    return Status::ok;
  }

  // Writes the vertices of an outline in order. Returns false if it is not one loop.
  static bool follow(const Numbers<std::uint32_t>& outline, std::pmr::vector<std::uint32_t>& loop) {
    loop.clear();
    if (outline.empty()) return false;
    // Start at the smallest vertex, so that the result does not depend on the hash order.
    std::uint32_t start = kUnset;
    for (const auto& [from, to] : outline) start = std::min(start, from);
    std::uint32_t at = start;
    do {
      loop.push_back(at);
      const auto found = outline.find(at);
      if (found == outline.end()) return false;
      at = found->second;
    } while (at != start && loop.size() <= outline.size());
    return at == start && loop.size() == outline.size() && loop.size() >= 3;
  }

  // Adds the outline as a face of `merged`. Vertices shared by at least three faces are corners.
  // Vertices shared by two faces are dropped if all of them between two corners lie on a straight
  // line. Returns false if fewer than three vertices remain.
  bool add_corners(std::span<const std::uint32_t> loop, const Numbers<std::uint32_t>& face_counts,
                   double tolerance, HullSurface& merged) const {
    const std::size_t count = loop.size();
    std::size_t first = 0;
    while (first < count && face_counts.at(loop[first]) == 2) ++first;
    std::pmr::vector<bool> stays(count, true, memory_);
    for (std::size_t i = first; first < count && i < first + count;) {
      std::size_t end = i + 1;
      while (face_counts.at(loop[end % count]) == 2) ++end;
      if (end < i + count && is_straight(loop, i, end, tolerance)) {
        for (std::size_t k = i + 1; k < end; ++k) stays[k % count] = false;
      }
      i = end;
    }
    const std::size_t before = merged.loops.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (stays[i]) merged.loops.push_back(loop[i]);
    }
    merged.end_face();
    return merged.loops.size() - before >= 3;
  }

  // Called for both faces along a line, in opposite directions; `minmax` makes the results equal.
  [[nodiscard]] bool is_straight(std::span<const std::uint32_t> loop, std::size_t from,
                                 std::size_t to, double tolerance) const {
    const std::size_t count = loop.size();
    const auto [low, high] = std::minmax(loop[from % count], loop[to % count]);
    const Eigen::Vector3d line = points_[high] - points_[low];
    const double most = tolerance * line.norm();
    for (std::size_t i = from + 1; i < to; ++i) {
      const Eigen::Vector3d way = points_[loop[i % count]] - points_[low];
      // The outline of a thin face can run backwards along its own line.
      const double along = way.dot(line);
      if (!(along >= 0.0 && along <= line.squaredNorm())) return false;
      if (!(accurate_cross(line, way).norm() <= most)) return false;
    }
    return true;
  }

  std::span<const Eigen::Vector3d> points_;
  HullSurface& surface_;
  Memory memory_;
  std::pmr::vector<std::uint32_t> group_;
  std::pmr::vector<std::uint32_t> open_;
  Numbers<std::uint64_t> face_of_;
};

}  // namespace

Status merge_coplanar(std::span<const Eigen::Vector3d> points, HullSurface& surface,
                      const HullTolerance& tolerance) {
  return Merge(points, surface).run(tolerance.coplanar);
}

namespace {

constexpr std::size_t kLineBytes = 64;
// Relative error bound of a length.
constexpr double kRoundings = 1e-15;

[[nodiscard]] constexpr std::size_t padded(std::size_t count) {
  return (count + 15) / 16 * 16;
}

// Allocates cache-line-aligned parts of a block. Without a block it only counts bytes.
class HullBlock {
 public:
  explicit HullBlock(std::byte* base) : base_(base) {}

  template <typename T>
  T* take(std::size_t count) {
    T* const part = base_ == nullptr ? nullptr : new (base_ + used_) T[count == 0 ? 1 : count];
    used_ += (count * sizeof(T) + kLineBytes - 1) / kLineBytes * kLineBytes;
    return part;
  }
  [[nodiscard]] std::size_t used() const { return used_; }

 private:
  std::byte* base_;
  std::size_t used_ = 0;
};

struct HullColumns {
  double* vertex[3];
  float* vertex_float[3];
  HullFace* faces;
  float* plane_float[4];
  HullEdge* edges;
  std::uint32_t* loop;
  std::uint32_t* loop_edge;
  std::uint32_t* neighbour_first;
  std::uint32_t* neighbour;
};

HullColumns lay_out(HullBlock& block, const HullShape& hull) {
  HullColumns c{};
  for (auto& column : c.vertex) column = block.take<double>(padded(hull.vertex_count));
  for (auto& column : c.vertex_float) column = block.take<float>(padded(hull.vertex_count));
  c.faces = block.take<HullFace>(hull.face_count);
  for (auto& column : c.plane_float) column = block.take<float>(padded(hull.face_count));
  c.edges = block.take<HullEdge>(hull.edge_count);
  c.loop = block.take<std::uint32_t>(2 * std::size_t{hull.edge_count});
  c.loop_edge = block.take<std::uint32_t>(2 * std::size_t{hull.edge_count});
  c.neighbour_first = block.take<std::uint32_t>(std::size_t{hull.vertex_count} + 1);
  c.neighbour = block.take<std::uint32_t>(2 * std::size_t{hull.edge_count});
  return c;
}

/// Owns the block of a hull until the hull is complete.
class OwnedBlock {
 public:
  OwnedBlock(Memory memory, std::size_t bytes)
      : memory_(memory),
        bytes_(bytes),
        base_(static_cast<std::byte*>(memory->allocate(bytes, kLineBytes))) {}
  ~OwnedBlock() {
    if (base_ != nullptr) memory_->deallocate(base_, bytes_, kLineBytes);
  }
  OwnedBlock(const OwnedBlock&) = delete;
  OwnedBlock& operator=(const OwnedBlock&) = delete;

  [[nodiscard]] std::byte* base() const { return base_; }
  void release() { base_ = nullptr; }

 private:
  Memory memory_;
  std::size_t bytes_;
  std::byte* base_;
};

class Assembly {
 public:
  Assembly(std::span<const Eigen::Vector3d> points, const HullSurface& surface, double convex)
      : points_(points),
        surface_(surface),
        convex_(convex),
        scratch_(memory_of(surface)),
        used_(surface.loops, scratch_) {}

  Status run(Memory memory, HullShape& hull) {
    number_vertices();
    hull_.vertex_count = static_cast<std::uint32_t>(used_.size());
    hull_.face_count = static_cast<std::uint32_t>(surface_.faces());
    hull_.edge_count = hull_.face_count == 0
                           ? hull_.vertex_count - 1
                           : static_cast<std::uint32_t>(surface_.loops.size() / 2);
    hull_.dimension = hull_.face_count == 0   ? hull_.vertex_count - 1
                      : hull_.face_count == 2 ? 2
                                              : 3;
    OwnedBlock owned(memory, hull_bytes(hull_));
    HullBlock block(owned.base());
    c_ = lay_out(block, hull_);
    write_vertices();
    write_edges();
    write_neighbours();
    if (!write_faces()) return Status::invalid_shape;
    publish();
    owned.release();
    hull = hull_;
    return Status::ok;
  }

 private:
  void number_vertices() {
    if (surface_.faces() == 0) {
      for (std::uint32_t i = 0; i < points_.size(); ++i) used_.push_back(i);
    }
    std::sort(used_.begin(), used_.end());
    used_.erase(std::unique(used_.begin(), used_.end()), used_.end());
  }
  [[nodiscard]] std::uint32_t number(std::uint32_t point) const {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(used_, point) - used_.begin());
  }
  [[nodiscard]] Eigen::Vector3d at(std::uint32_t v) const { return points_[used_[v]]; }

  void write_vertices() {
    const std::size_t room = padded(used_.size());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < room; ++i) {
      const Eigen::Vector3d p = points_[used_[i < used_.size() ? i : 0]];
      for (int axis = 0; axis < 3; ++axis) {
        c_.vertex[axis][i] = p[axis];
        c_.vertex_float[axis][i] = static_cast<float>(p[axis]);
      }
      // Adds fractions instead of dividing the sum, so that the mean of numbers near the largest
      // double does not overflow.
      if (i < used_.size()) sum += p / static_cast<double>(used_.size());
    }
    for (std::uint32_t v = 0; v < hull_.vertex_count; ++v) {
      hull_.radius = std::max(hull_.radius, (at(v) - sum).stableNorm());
    }
    hull_.radius *= 1.0 + kRoundings;
    for (int axis = 0; axis < 3; ++axis) hull_.center[axis] = sum[axis];
  }

  void write_edges() {
    if (hull_.face_count == 0) {
      if (hull_.edge_count == 1) c_.edges[0] = {{0, 1}, {~0U, ~0U}};
      return;
    }
    Numbers<std::uint64_t> seen(scratch_);
    seen.reserve(hull_.edge_count);
    std::uint32_t edges = 0;
    std::uint32_t slot = 0;
    for (std::uint32_t f = 0; f < hull_.face_count; ++f) {
      const auto loop = surface_.loop(f);
      for (std::size_t i = 0; i < loop.size(); ++i, ++slot) {
        const std::uint32_t from = number(loop[i]);
        const std::uint32_t to = number(loop[(i + 1) % loop.size()]);
        c_.loop[slot] = from;
        const auto back = seen.find(std::uint64_t{to} << 32U | from);
        if (back != seen.end()) {
          c_.edges[back->second].face[1] = f;
          c_.loop_edge[slot] = back->second;
          continue;
        }
        seen.emplace(std::uint64_t{from} << 32U | to, edges);
        c_.edges[edges] = {{from, to}, {f, f}};
        c_.loop_edge[slot] = edges++;
      }
    }
  }

  void write_neighbours() {
    std::fill_n(c_.neighbour_first, hull_.vertex_count + 1, 0U);
    const std::span edges(c_.edges, hull_.edge_count);
    for (const HullEdge& e : edges) {
      for (const std::uint32_t v : e.vertex) ++c_.neighbour_first[v + 1];
    }
    for (std::uint32_t v = 0; v < hull_.vertex_count; ++v) {
      c_.neighbour_first[v + 1] += c_.neighbour_first[v];
    }
    std::pmr::vector<std::uint32_t> fill(c_.neighbour_first,
                                         c_.neighbour_first + hull_.vertex_count, scratch_);
    for (const HullEdge& e : edges) {
      c_.neighbour[fill[e.vertex[0]]++] = e.vertex[1];
      c_.neighbour[fill[e.vertex[1]]++] = e.vertex[0];
    }
  }

  // Returns false if the surface is not convex along an edge. For a closed surface without handles,
  // local convexity implies convexity (van Heijenoort, "On locally convex manifolds", 1952).
  bool write_faces() {
    const Eigen::Vector3d center(hull_.center[0], hull_.center[1], hull_.center[2]);
    std::uint32_t first = 0;
    hull_.inner_radius = hull_.dimension == 3 ? hull_.radius : 0.0;
    for (std::uint32_t f = 0; f < hull_.face_count; ++f) {
      HullFace& face = c_.faces[f];
      face.first = first;
      face.count = static_cast<std::uint32_t>(surface_.loop(f).size());
      first += face.count;
      const Eigen::Vector3d normal = normal_of(face);
      if (normal.isZero()) return false;
      face.offset = normal.dot(at(c_.loop[face.first]));
      for (std::uint32_t i = 1; i < face.count; ++i) {
        face.offset = std::max(face.offset, normal.dot(at(c_.loop[face.first + i])));
      }
      for (int axis = 0; axis < 3; ++axis) face.normal[axis] = normal[axis];
      if (hull_.dimension == 3) {
        hull_.inner_radius = std::min(hull_.inner_radius, face.offset - normal.dot(center));
      }
    }
    hull_.inner_radius = std::max(0.0, hull_.inner_radius * (1.0 - kRoundings));
    for (std::uint32_t f = 0; f < hull_.face_count; ++f) {
      if (!is_convex_around(f)) return false;
    }
    return true;
  }

  // Newell's normal, with edges scaled so that small hulls lose no digits. Computed exactly for
  // slivers, where the cross products of edges nearly cancel.
  [[nodiscard]] Eigen::Vector3d normal_of(const HullFace& face) const {
    constexpr double kSliver = 1e-4;
    const Eigen::Vector3d origin = at(c_.loop[face.first]);
    const double scale = hull_.radius > 0.0 ? 1.0 / hull_.radius : 1.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double size = 0.0;
    for (std::uint32_t i = 1; i + 1 < face.count; ++i) {
      const Eigen::Vector3d a = (at(c_.loop[face.first + i]) - origin) * scale;
      const Eigen::Vector3d b = (at(c_.loop[face.first + i + 1]) - origin) * scale;
      sum += a.cross(b);
      size += a.norm() * b.norm();
    }
    return sum.norm() > kSliver * size ? sum.stableNormalized() : exact_normal_of(face);
  }

  [[nodiscard]] Eigen::Vector3d exact_normal_of(const HullFace& face) const {
    const auto edge = [&](std::uint32_t i) {
      return exact_vector(at(c_.loop[face.first + i])) - exact_vector(at(c_.loop[face.first]));
    };
    ExactVector sum = cross(edge(1), edge(2));
    for (std::uint32_t i = 2; i + 1 < face.count; ++i) sum = sum + cross(edge(i), edge(i + 1));
    if (is_zero(sum)) return Eigen::Vector3d::Zero();
    return Eigen::Vector3d::Map(RoundedDirection(sum).d).normalized();
  }

  bool is_convex_around(std::uint32_t f) {
    HullFace& face = c_.faces[f];
    const Eigen::Vector3d normal(face.normal[0], face.normal[1], face.normal[2]);
    double farthest = face.offset;
    for (std::uint32_t i = 0; i < face.count; ++i) {
      const HullEdge& edge = c_.edges[c_.loop_edge[face.first + i]];
      const HullFace& other = c_.faces[edge.face[0] == f ? edge.face[1] : edge.face[0]];
      for (std::uint32_t k = 0; k < other.count; ++k) {
        farthest = std::max(farthest, normal.dot(at(c_.loop[other.first + k])));
      }
    }
    if (farthest > face.offset + convex_ * hull_.radius) return false;
    face.offset = farthest;
    return true;
  }

  void publish() {
    const std::size_t room = padded(hull_.face_count);
    for (std::size_t f = 0; f < room; ++f) {
      const HullFace& face = c_.faces[f < hull_.face_count ? f : 0];
      for (int axis = 0; axis < 3; ++axis) {
        c_.plane_float[axis][f] = static_cast<float>(face.normal[axis]);
      }
      c_.plane_float[3][f] = static_cast<float>(face.offset);
    }
    std::copy_n(c_.vertex, 3, hull_.vertex);
    std::copy_n(c_.vertex_float, 3, hull_.vertex_float);
    std::copy_n(c_.plane_float, 4, hull_.plane_float);
    hull_.faces = c_.faces;
    hull_.edges = c_.edges;
    hull_.loop = c_.loop;
    hull_.loop_edge = c_.loop_edge;
    hull_.neighbour_first = c_.neighbour_first;
    hull_.neighbour = c_.neighbour;
  }

  std::span<const Eigen::Vector3d> points_;
  const HullSurface& surface_;
  double convex_;
  Memory scratch_;
  std::pmr::vector<std::uint32_t> used_;
  HullShape hull_;
  HullColumns c_{};
};

}  // namespace

Status assemble_hull(std::span<const Eigen::Vector3d> points, const HullSurface& surface,
                     std::pmr::memory_resource* memory, HullShape& hull,
                     const HullTolerance& tolerance) {
  return Assembly(points, surface, tolerance.convex).run(memory, hull);
}

namespace {

/// Throws if the surface's memory throws.
Status take_faces(std::span<const Eigen::Vector3d> points, const HullFaces& faces,
                  HullSurface& surface) {
  std::size_t at = 0;
  for (const std::uint32_t size : faces.sizes) {
    if (size > faces.indices.size() - at) return Status::invalid_shape;
    for (const std::uint32_t index : faces.indices.subspan(at, size)) {
      if (index >= points.size() || !points[index].allFinite()) return Status::invalid_shape;
      surface.loops.push_back(index);
    }
    at += size;
    surface.end_face();
  }
  return at == faces.indices.size() ? Status::ok : Status::invalid_shape;
}

/// Returns whether the points make a hull without faces.
[[nodiscard]] bool is_point_or_segment(std::span<const Eigen::Vector3d> points) {
  const bool distinct = points.size() == 1 || (points.size() == 2 && points[0] != points[1]);
  return distinct && std::ranges::all_of(points, [](const auto& p) { return p.allFinite(); });
}

[[nodiscard]] Status build_of_faces(const PointView& given, const HullFaces& faces,
                                    std::pmr::memory_resource* memory, HullShape& hull,
                                    const HullTolerance& tolerance) {
  std::pmr::monotonic_buffer_resource scratch(memory);
  const std::pmr::vector<Eigen::Vector3d> points = copied(given, &scratch);
  HullSurface surface(&scratch);
  Status status = take_faces(points, faces, surface);
  if (status == Status::ok && surface.faces() < 2) status = Status::invalid_shape;
  if (status == Status::ok) status = merge_coplanar(points, surface, tolerance);
  return status == Status::ok ? assemble_hull(points, surface, memory, hull, tolerance) : status;
}

// Does not merge: merging faces that are already merged could change their order.
[[nodiscard]] Status rebuild_without_merging(const PointView& given, const HullFaces& faces,
                                             std::pmr::memory_resource* memory, HullShape& hull) {
  std::pmr::monotonic_buffer_resource scratch(memory);
  const std::pmr::vector<Eigen::Vector3d> points = copied(given, &scratch);
  HullSurface surface(&scratch);
  Status status = take_faces(points, faces, surface);
  if (status != Status::ok) return status;
  if (surface.faces() == 0) {
    if (!is_point_or_segment(points)) return Status::invalid_shape;
    return assemble_hull(points, surface, memory, hull);
  }
  if (surface.faces() < 2) return Status::invalid_shape;
  status = Merge(points, surface).pair_edges();
  return status == Status::ok ? assemble_hull(points, surface, memory, hull) : status;
}

}  // namespace

Status hull_of_faces(const PointView& given, const HullFaces& faces,
                     std::pmr::memory_resource* memory, HullShape& hull,
                     const HullTolerance& tolerance) {
  return catch_bad_alloc([&] { return build_of_faces(given, faces, memory, hull, tolerance); },
                         Status::out_of_memory);
}

Status rebuild_hull(const PointView& given, const HullFaces& faces,
                    std::pmr::memory_resource* memory, HullShape& hull) {
  return catch_bad_alloc([&] { return rebuild_without_merging(given, faces, memory, hull); },
                         Status::out_of_memory);
}

std::pmr::vector<Eigen::Vector3d> copied(const PointView& points,
                                         std::pmr::memory_resource* memory) {
  std::pmr::vector<Eigen::Vector3d> result(points.count, memory);
  for (std::size_t i = 0; i < points.count; ++i) result[i] = points[i];
  return result;
}

HullShape point_hull() noexcept {
  alignas(64) static constexpr double kZeros[16] = {};
  alignas(64) static constexpr float kFloatZeros[16] = {};
  static constexpr std::uint32_t kNoNeighbours[2] = {};
  HullShape hull;
  hull.vertex_count = 1;
  for (auto& column : hull.vertex) column = kZeros;
  for (auto& column : hull.vertex_float) column = kFloatZeros;
  for (auto& column : hull.plane_float) column = kFloatZeros;
  hull.neighbour_first = kNoNeighbours;
  return hull;
}

std::size_t hull_bytes(const HullShape& hull) noexcept {
  if (hull.vertex_count == 0) return 0;
  if (hull.vertex[0] != nullptr && hull.vertex[0] == point_hull().vertex[0]) return 0;
  HullBlock block(nullptr);
  lay_out(block, hull);
  return block.used();
}

void release_hull(const HullShape& hull, std::pmr::memory_resource* memory) noexcept {
  const std::size_t bytes = hull_bytes(hull);
  if (bytes == 0) return;
  memory->deallocate(const_cast<double*>(hull.vertex[0]), bytes, kLineBytes);
}

}  // namespace winnow
