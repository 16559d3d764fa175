#include "pipeline/shapes/hull_builder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace winnow {
namespace {

// Faces whose vertices lie this close to one plane, in units of the hull's size, are one face. An
// error of this size in a depth is below what the tier `reference` promises.
constexpr double kCoplanar = 1e-13;
constexpr std::uint32_t kNone = ~0U;

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double offset = 0.0;
  double area = 0.0;
};

// Newell's normal (Sutherland, Sproull, Schumacker 1974), from the first vertex so that places far
// from the origin cost no digits.
[[nodiscard]] Plane plane_of(std::span<const Eigen::Vector3d> points,
                             std::span<const std::uint32_t> loop) {
  const Eigen::Vector3d origin = points[loop[0]];
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    sum += (points[loop[i]] - origin).cross(points[loop[i + 1]] - origin);
  }
  Plane plane;
  plane.area = sum.norm();
  if (plane.area > 0.0) plane.normal = sum / plane.area;
  plane.offset = plane.normal.dot(origin);
  return plane;
}

class Merge {
 public:
  Merge(std::span<const Eigen::Vector3d> points, HullSurface& surface)
      : points_(points), surface_(surface), group_(surface.faces(), kNone) {}

  Status run() {
    Status status = pair_edges();
    if (status != Status::ok) return status;
    const double size = extent();
    std::vector<Plane> planes;
    for (std::size_t f = 0; f < surface_.faces(); ++f) {
      planes.push_back(plane_of(points_, surface_.loop(f)));
    }
    std::vector<std::uint32_t> by_area(surface_.faces());
    std::iota(by_area.begin(), by_area.end(), 0U);
    std::stable_sort(by_area.begin(), by_area.end(), [&](std::uint32_t a, std::uint32_t b) {
      return planes[a].area > planes[b].area;
    });
    std::uint32_t groups = 0;
    for (const std::uint32_t seed : by_area) {
      if (group_[seed] == kNone) absorb(seed, groups++, planes, size * kCoplanar);
    }
    return rebuild(groups);
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

  Status pair_edges() {
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
    std::vector<std::uint32_t> used(surface_.loops);
    std::sort(used.begin(), used.end());
    const auto vertices = std::unique(used.begin(), used.end()) - used.begin();
    for (const auto& [key, face] : face_of_) {
      if (!face_of_.contains(key << 32U | key >> 32U)) return Status::invalid_shape;
    }
    const auto edges = static_cast<std::ptrdiff_t>(face_of_.size() / 2);
    const auto faces = static_cast<std::ptrdiff_t>(surface_.faces());
    return vertices - edges + faces == 2 ? Status::ok : Status::invalid_shape;
  }

  // Takes the neighbours that lie in the seed's plane, and theirs.
  void absorb(std::uint32_t seed, std::uint32_t group, const std::vector<Plane>& planes,
              double tolerance) {
    const Plane& plane = planes[seed];
    std::vector<std::uint32_t> open{seed};
    group_[seed] = group;
    while (!open.empty()) {
      const std::uint32_t face = open.back();
      open.pop_back();
      const auto loop = surface_.loop(face);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::uint32_t next = face_of_.at(edge(loop[(i + 1) % loop.size()], loop[i]));
        if (group_[next] != kNone || !lies_in(next, plane, planes[next], tolerance)) continue;
        group_[next] = group;
        open.push_back(next);
      }
    }
  }

  [[nodiscard]] bool lies_in(std::uint32_t face, const Plane& plane, const Plane& own,
                             double tolerance) const {
    // A sliver's own normal says nothing; the two sides of a flat hull must stay apart.
    if (own.area > tolerance * tolerance && own.normal.dot(plane.normal) <= 0.0) return false;
    return std::ranges::all_of(surface_.loop(face), [&](std::uint32_t v) {
      return std::abs(plane.normal.dot(points_[v]) - plane.offset) <= tolerance;
    });
  }

  // The outlines of the groups, without vertices between only two of them.
  Status rebuild(std::uint32_t groups) {
    std::vector<std::unordered_map<std::uint32_t, std::uint32_t>> next(groups);
    std::unordered_map<std::uint32_t, std::uint32_t> meets;
    for (std::size_t f = 0; f < surface_.faces(); ++f) {
      const auto loop = surface_.loop(f);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::uint32_t from = loop[i];
        const std::uint32_t to = loop[(i + 1) % loop.size()];
        if (group_[face_of_.at(edge(to, from))] == group_[f]) continue;
        if (!next[group_[f]].emplace(from, to).second) return Status::invalid_shape;
        ++meets[from];
      }
    }
    // A polygon has two sides alone: all of its vertices lie between only two faces.
    const bool flat = groups == 2;
    HullSurface merged;
    for (const auto& outline : next) {
      if (!follow(outline, meets, flat, merged)) return Status::invalid_shape;
    }
    surface_ = std::move(merged);
    return Status::ok;
  }

  static bool follow(const std::unordered_map<std::uint32_t, std::uint32_t>& outline,
                     const std::unordered_map<std::uint32_t, std::uint32_t>& meets, bool flat,
                     HullSurface& merged) {
    if (outline.empty()) return false;
    // The smallest vertex begins, so that the result does not depend on the order of a hash.
    std::uint32_t start = kNone;
    for (const auto& [from, to] : outline) start = std::min(start, from);
    std::size_t steps = 0;
    std::uint32_t at = start;
    const std::size_t before = merged.loops.size();
    do {
      if (flat || meets.at(at) != 2) merged.loops.push_back(at);
      const auto found = outline.find(at);
      if (found == outline.end()) return false;
      at = found->second;
    } while (at != start && ++steps <= outline.size());
    if (at != start || steps + 1 != outline.size()) return false;
    merged.end_face();
    return merged.loops.size() - before >= 3;
  }

  std::span<const Eigen::Vector3d> points_;
  HullSurface& surface_;
  std::vector<std::uint32_t> group_;
  std::unordered_map<std::uint64_t, std::uint32_t> face_of_;
};

}  // namespace

Status merge_coplanar(std::span<const Eigen::Vector3d> points, HullSurface& surface) {
  return Merge(points, surface).run();
}

}  // namespace winnow
