#include "bench/oracle/least_overlap.h"

#include "bench/oracle/min_norm.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow::oracle {
namespace {

/// Error bound of a gap computed in double, for directions accurate to 1e-15.
constexpr double kRounding = 1e-13;
/// Cross products of unit vectors shorter than this are computed again in Number.
constexpr double kShort = 1e-2;

Vector<Number> unit(const Vector<Number>& v) {
  return v * (1 / length(v));
}

class Search {
 public:
  Search(const Polytope& a, const Polytope& b, double slack)
      : a_(a), b_(b), slack_(slack), along_a_(directions(a)), along_b_(directions(b)) {}

  void run() {
    for (const Vector<Number>& n : a_.normal) offer(n);
    for (const Vector<Number>& n : b_.normal) offer(n);
    std::vector<Vector<double>> guide_b;
    for (const Vector<Number>& d : along_b_) guide_b.push_back(rounded(d));
    for (std::size_t i = 0; i < along_a_.size(); ++i) {
      const Vector<double> guide_a = rounded(along_a_[i]);
      for (std::size_t k = 0; k < along_b_.size(); ++k) {
        if (can_make_face(a_.edge[i], guide_a, b_.edge[k], guide_b[k])) {
          offer_product(along_a_[i], guide_a, along_b_[k], guide_b[k]);
        }
      }
    }
  }

  [[nodiscard]] LeastOverlap result() const {
    LeastOverlap found;
    for (const Candidate& candidate : candidates_) {
      if (candidate.gap < best_ - slack_ - 2 * kRounding) continue;
      const Vector<Number> normal =
          unit(candidate.edge_a == nullptr ? *candidate.normal
                                           : cross(*candidate.edge_a, *candidate.edge_b));
      for (const int sign : {1, -1}) {
        const Vector<Number> n = normal * Number(sign);
        if (gap_along(a_, b_, rounded(n)).width < best_ - slack_ - 2 * kRounding) continue;
        found.direction.push_back({n, gap_along(a_, b_, n).width});
      }
    }
    std::stable_sort(found.direction.begin(), found.direction.end(),
                     [](const auto& p, const auto& q) { return p.gap > q.gap; });
    std::erase_if(found.direction, [&](const auto& d) {
      return d.gap < found.direction.front().gap - Number(slack_);
    });
    return found;
  }

 private:
  struct Candidate {
    double gap;
    const Vector<Number>* normal;
    const Vector<Number>* edge_a;
    const Vector<Number>* edge_b;
  };

  static std::vector<Vector<Number>> directions(const Polytope& core) {
    std::vector<Vector<Number>> result;
    for (const Polytope::Edge& edge : core.edge) result.push_back(unit(edge.direction));
    return result;
  }

  /// Returns the wider of the gaps along a direction and its opposite.
  [[nodiscard]] double widest(const Vector<double>& n) const {
    return std::max(gap_along(a_, b_, n).width, gap_along(a_, b_, n * -1.0).width);
  }

  void offer(const Vector<Number>& normal) {
    add({widest(rounded(unit(normal))), &normal, nullptr, nullptr});
  }

  void offer_product(const Vector<Number>& a, const Vector<double>& guide_a,
                     const Vector<Number>& b, const Vector<double>& guide_b) {
    Vector<double> n = cross(guide_a, guide_b);
    const double size = length(n);
    if (size >= kShort) {
      n = n * (1.0 / size);
    } else {
      const Vector<Number> product = cross(a, b);
      if (dot(product, product) <= Number(1e-92)) return;  // parallel
      n = rounded(unit(product));
    }
    add({widest(n), nullptr, &a, &b});
  }

  /// Returns false only if the arcs of the two edges on the Gauss map are clearly apart, so that
  /// the edges form no face of the Minkowski difference.
  static bool can_make_face(const Polytope::Edge& a, const Vector<double>& along_a,
                            const Polytope::Edge& b, const Vector<double>& along_b) {
    constexpr double kClear = 1e-9;
    if (a.has_sides && dot(a.beside[0], along_b) * dot(a.beside[1], along_b) > kClear) return false;
    return !b.has_sides || dot(b.beside[0], along_a) * dot(b.beside[1], along_a) <= kClear;
  }

  void add(const Candidate& candidate) {
    best_ = std::max(best_, candidate.gap);
    if (candidate.gap >= best_ - slack_ - 2 * kRounding) candidates_.push_back(candidate);
  }

  const Polytope& a_;
  const Polytope& b_;
  double slack_;
  std::vector<Vector<Number>> along_a_;
  std::vector<Vector<Number>> along_b_;
  double best_ = -std::numeric_limits<double>::infinity();
  std::vector<Candidate> candidates_;
};

}  // namespace

LeastOverlap least_overlap(const Polytope& a, const Polytope& b, double slack) {
  Search search(a, b, slack);
  search.run();
  return search.result();
}

}  // namespace winnow::oracle
