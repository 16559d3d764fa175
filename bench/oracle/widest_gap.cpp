// The signed distance of two cores as their widest gap. No direction has a wider gap than their
// distance, and along some direction in which features face each other the gap is the distance:
// the normal of a face, the cross product of two edges, or the difference of a vertex and an edge.
// If the cores overlap, normals and cross products give all faces of the Minkowski difference.
// Doubles select the directions whose gaps are then computed in Number. oracle.cpp calls it.

#include "bench/oracle/widest_gap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace winnow::oracle {
namespace {

/// Error bound of a gap or length computed in double, for directions accurate to 1e-14.
constexpr double kRounding = 1e-13;
/// Cross products of unit vectors shorter than this are computed again in Number.
constexpr double kShort = 1e-2;
/// Cosine of 0.1 degrees.
constexpr double kSameDirection = 0.99999847691328769;

/// Returns the greatest n.x over a core.
double reach(const Polytope& core, const Vector<double>& n) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Vector<double>& v : core.vertex_double) most = std::max(most, dot(n, v));
  return most;
}
/// As above; doubles select the vertices that are compared in Number.
Number reach(const Polytope& core, const Vector<Number>& n) {
  const Vector<double> guide = rounded(n);
  const double least = reach(core, guide) - kRounding;
  Number most = least - 1.0;
  for (std::size_t i = 0; i < core.vertex.size(); ++i) {
    if (dot(guide, core.vertex_double[i]) >= least) most = std::max(most, dot(n, core.vertex[i]));
  }
  return most;
}

/// Returns the gap between the cores along a unit direction.
template <typename T>
T gap_along(const Polytope& a, const Polytope& b, const Vector<T>& n) {
  return -reach(a, n) - reach(b, n * T(-1));
}

/// Returns the vector from a point to the nearest point of an edge.
template <typename T>
Vector<T> to_edge(const Vector<T>& point, const Vector<T>& from, const Vector<T>& to) {
  const Vector<T> along = to - from;
  const T square = dot(along, along);
  const T share = square > 0 ? T(dot(along, point - from) / square) : T(0);
  return from + along * std::clamp(share, T(0), T(1)) - point;
}

class Search {
 public:
  Search(const Polytope& a, const Polytope& b, double slack) : a_(a), b_(b), slack_(slack) {}

  void run() {
    for (const Polytope* core : {&a_, &b_}) {
      for (const Vector<Number>& normal : core->normal) offer(normal);
    }
    const std::vector<Line> lines_a = lines_of(a_);
    const std::vector<Line> lines_b = lines_of(b_);
    for (const Line& p : lines_a) {
      for (const Line& q : lines_b) {
        if (can_make_face(p, q)) offer_product(p, q);
      }
    }
    std::vector<Link> links;
    add_links(a_, b_, links);
    add_links(b_, a_, links);
    const double shortest = std::ranges::min_element(links, {}, &Link::length)->length;
    for (const Link& link : links) {
      if (link.length <= shortest + kRounding) offer(to_edge(link.point, link.from, link.to));
    }
  }

  [[nodiscard]] WidestGap result() const {
    std::vector<WidestGap> found;
    for (const Candidate& candidate : candidates_) {
      if (candidate.gap < best_ - slack_ - 2 * kRounding) continue;
      const Vector<Number> normal = unit(candidate.direction);
      for (const Vector<Number>& n : {normal, normal * Number(-1)}) {
        found.push_back({gap_along(a_, b_, n), n});
      }
    }
    WidestGap widest = *std::max_element(
        found.begin(), found.end(), [](const auto& p, const auto& q) { return p.width < q.width; });
    widest.unique = std::all_of(found.begin(), found.end(), [&](const WidestGap& other) {
      return other.width < widest.width - Number(slack_) ||
             dot(other.normal, widest.normal) > kSameDirection;
    });
    return widest;
  }

 private:
  /// An edge of positive length.
  struct Line {
    const Polytope::Edge& edge;
    Vector<Number> along;
    Vector<double> guide;  ///< `along` as a unit vector
  };

  /// A vertex of a core and an edge of the other, which may be a point.
  struct Link {
    double length;  ///< their distance
    const Vector<Number>& point;
    const Vector<Number>& from;
    const Vector<Number>& to;
  };

  /// A direction of any length, and the wider of the gaps along it and its opposite.
  struct Candidate {
    double gap;
    Vector<Number> direction;
  };

  static std::vector<Line> lines_of(const Polytope& core) {
    std::vector<Line> lines;
    for (const Polytope::Edge& edge : core.edge) {
      const Vector<Number> along = core.vertex[edge.to] - core.vertex[edge.from];
      if (!is_zero(along)) lines.push_back({edge, along, unit(rounded(along))});
    }
    return lines;
  }

  void offer(const Vector<Number>& direction) {
    if (!is_zero(direction)) offer(unit(rounded(direction)), [&] { return direction; });
  }

  /// Keeps a direction if its gap may be the widest; `direction` returns it in Number.
  template <typename Direction>
  void offer(const Vector<double>& guide, const Direction& direction) {
    const double gap = std::max(gap_along(a_, b_, guide), gap_along(a_, b_, guide * -1.0));
    best_ = std::max(best_, gap);
    if (gap >= best_ - slack_ - 2 * kRounding) candidates_.push_back({gap, direction()});
  }

  void offer_product(const Line& p, const Line& q) {
    const Vector<double> n = cross(p.guide, q.guide);
    const double size = length(n);
    if (size >= kShort) {
      offer(n * (1.0 / size), [&] { return cross(p.along, q.along); });
      return;
    }
    const Vector<Number> product = cross(p.along, q.along);
    const Number scale = dot(p.along, p.along) * dot(q.along, q.along);
    if (dot(product, product) > Number(1e-92) * scale) offer(product);  // otherwise parallel
  }

  /// Returns false only if the arcs of the two edges on the Gauss map are clearly apart, so that
  /// the edges form no face of the Minkowski difference.
  static bool can_make_face(const Line& p, const Line& q) {
    constexpr double kClear = 1e-9;
    const auto are_apart = [](const Polytope::Edge& edge, const Vector<double>& along) {
      return edge.has_sides && dot(edge.beside[0], along) * dot(edge.beside[1], along) > kClear;
    };
    return !are_apart(p.edge, q.guide) && !are_apart(q.edge, p.guide);
  }

  static void add_links(const Polytope& core, const Polytope& other, std::vector<Link>& links) {
    for (std::size_t i = 0; i < core.vertex.size(); ++i) {
      for (const Polytope::Edge& edge : other.edge) {
        const Vector<double> between = to_edge(
            core.vertex_double[i], other.vertex_double[edge.from], other.vertex_double[edge.to]);
        links.push_back(
            {length(between), core.vertex[i], other.vertex[edge.from], other.vertex[edge.to]});
      }
    }
  }

  const Polytope& a_;
  const Polytope& b_;
  double slack_;
  double best_ = -std::numeric_limits<double>::infinity();
  std::vector<Candidate> candidates_;
};

}  // namespace

WidestGap widest_gap(const Polytope& a, const Polytope& b, double slack) {
  Search search(a, b, slack);
  search.run();
  return search.result();
}

}  // namespace winnow::oracle
