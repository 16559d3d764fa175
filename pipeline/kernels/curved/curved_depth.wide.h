#pragma once

// Penetration depth of two cores: a polytope inside of their difference grows where it is nearest
// to the origin (van den Bergen, "Proximity queries and penetration depth computation on 3D game
// objects", 2001). Its nearest face bounds the depth from below, the support along the face's
// normal from above.

#include "pipeline/kernels/curved/curved_pair.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// The farthest point of a core along d, in its frame, and one for two cores' difference.
static inline void farthest(const Form& form, const double* d, double scale, double* x) {
  const double* n = form.number;
  const auto towards = [](double along, double half) { return along < 0.0 ? -half : half; };
  switch (form.kind) {
    case ShapeKind::capsule:
      x[0] = 0.0;
      x[1] = 0.0;
      x[2] = towards(d[2], n[2]);
      return;
    case ShapeKind::box:
      for (int k = 0; k < 3; ++k) x[k] = towards(d[k], n[k]);
      return;
    case ShapeKind::triangle: {
      const double h[3] = {dot3(n, d), dot3(n + 3, d), dot3(n + 6, d)};
      const int best = h[1] > h[0] ? 1 : 0;
      const int vertex = h[2] > h[best] ? 2 : best;
      for (int k = 0; k < 3; ++k) x[k] = n[3 * vertex + k];
      return;
    }
    case ShapeKind::cylinder:
    case ShapeKind::cone: {
      const double across = __builtin_sqrt(d[0] * d[0] + d[1] * d[1]);
      const double tip = n[2] * d[2];
      const bool cone = form.kind == ShapeKind::cone;
      const bool on_tip = cone && tip >= n[0] * across - tip;
      const double over = on_tip ? 0.0 : n[0] / largest_of(across, 1e-150);
      x[0] = d[0] * over;
      x[1] = d[1] * over;
      x[2] = cone ? (on_tip ? n[2] : -n[2]) : towards(d[2], n[2]);
      return;
    }
    default:
      hull_support(*form.hull, d, scale, x);
  }
}

class CurvedDepth {
 public:
  /// What the depth is proved to, relative to the sizes.
  static constexpr double kTolerance = 1e-10;

  /// From the four points around the origin that the search found; false if the polytope outgrows
  /// its room or is too flat.
  bool find(const CurvedPair& pair) {
    pair_ = &pair;
    points_ = 0;
    faces_ = 0;
    free_ = kNone;
    for (int i = 0; i < 4; ++i) add_point(pair.difference[i], pair.on_first[i]);
    if (!begin()) return false;
    while (points_ < kMostPoints) {
      face_ = nearest_face();
      double w[3];
      double mine[3];
      difference_point(normal(face_), w, mine);
      upper_ = dot_normal(face_, w);
      lower_ = distance_[face_];
      if (upper_ - lower_ <= kTolerance) return true;
      if (!grow(add_point(w, mine))) return false;
    }
    return false;
  }

  /// Of the last call that was true.
  [[nodiscard]] double upper() const { return upper_; }
  [[nodiscard]] double lower() const { return lower_; }

  /// The unit direction of least depth, from the first to the second, and a point of the first that
  /// is on both once the second has been moved out; false if rounding hides where that is. Of faces
  /// that lie in one plane, takes the one that the foot of the origin is in.
  bool answer(double* direction, double* point) {
    double weight[3];
    double most = foot_weights(face_, weight);
    if (!(most >= kInside)) {
      const double limit = upper_;
      std::uint32_t best = face_;
      for (std::uint32_t f = 0; f < faces_; ++f) {
        if (!(distance_[f] <= limit)) continue;
        const double inside = foot_weights(f, weight);
        if (!(inside > most)) continue;
        most = inside;
        best = f;
      }
      if (!(most >= kInside)) return false;
      const double lower = distance_[face_];
      double w[3];
      double mine[3];
      difference_point(normal(best), w, mine);
      upper_ = dot_normal(best, w);
      if (!(upper_ - lower <= 2.0 * kTolerance)) return false;
      lower_ = lower;
      face_ = best;
      foot_weights(best, weight);
    }
    for (int k = 0; k < 3; ++k) {
      direction[k] = normal_[k][face_];
      point[k] = 0.0;
      for (int i = 0; i < 3; ++i) point[k] += weight[i] * mine_[vertex_[face_][i]][k];
    }
    return true;
  }

 private:
  static constexpr std::uint32_t kMostPoints = 64;
  /// A polytope of p points has 2 p - 4 faces; new ones are there before old ones go.
  static constexpr std::uint32_t kMostFaces = 4 * kMostPoints;
  static constexpr std::uint32_t kNone = ~0U;
  /// Faces whose plane a point is above by less are not seen from it.
  static constexpr double kLevel = 1e-15;
  /// The foot of the origin is in a face if no weight of a corner is below this.
  static constexpr double kInside = -1e-9;

  struct Direction {
    double x[3];
  };

  /// Of the corners of a face, for the foot of the origin, none below zero; returns the smallest,
  /// as it was before that.
  [[gnu::noinline]] double foot_weights(std::uint32_t face, double* weight) const {
    double total = 0.0;
    double smallest = __builtin_inf();
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      double n[3];
      cross3(point_[vertex_[face][(i + 1) % 3]], point_[vertex_[face][(i + 2) % 3]], n);
      weight[i] = dot_normal(face, n);
      sum += weight[i];
      smallest = weight[i] < smallest ? weight[i] : smallest;
      weight[i] = weight[i] > 0.0 ? weight[i] : 0.0;
      total += weight[i];
    }
    for (int i = 0; i < 3; ++i) weight[i] /= total;
    return smallest / sum;
  }

  std::uint32_t add_point(const double* w, const double* mine) {
    for (int k = 0; k < 3; ++k) {
      point_[points_][k] = w[k];
      mine_[points_][k] = mine[k];
    }
    return points_++;
  }

  [[nodiscard]] Direction normal(std::uint32_t face) const {
    return {{normal_[0][face], normal_[1][face], normal_[2][face]}};
  }
  [[nodiscard]] double dot_normal(std::uint32_t face, const double* x) const {
    return normal_[0][face] * x[0] + normal_[1][face] * x[1] + normal_[2][face] * x[2];
  }

  /// The farthest point of first - second, and that of the first in it.
  void difference_point(const Direction& n, double* w, double* mine) const {
    double back[3];
    double local[3];
    double theirs[3];
    farthest(pair_->first, n.x, pair_->scale, mine);
    turn_back3(pair_->turn, n.x, back);
    for (double& x : back) x = -x;
    farthest(pair_->second, back, pair_->scale, local);
    turn3(pair_->turn, local, theirs);
    for (int k = 0; k < 3; ++k) w[k] = mine[k] - (theirs[k] + pair_->shift[k]);
  }

  /// The tetrahedron of the first four points.
  bool begin() {
    static constexpr std::uint32_t kCorners[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
    double e[3][3];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) e[i][k] = point_[i + 1][k] - point_[0][k];
    }
    double n[3];
    cross3(e[0], e[1], n);
    // Counter-clockwise seen from outside if the fourth point is behind the first face.
    const bool turned = dot3(n, e[2]) > 0.0;
    for (const auto& c : kCorners) {
      const std::uint32_t f = add_face(c[0], turned ? c[2] : c[1], turned ? c[1] : c[2]);
      if (f == kNone) return false;
    }
    for (std::uint32_t f = 0; f < 4; ++f) {
      for (int i = 0; i < 3; ++i) {
        for (std::uint32_t g = 0; g < 4; ++g) {
          if (has_edge(g, vertex_[f][(i + 1) % 3], vertex_[f][i]) != kNone) neighbour_[f][i] = g;
        }
      }
    }
    return true;
  }

  /// Which edge of a face runs from p to q.
  [[nodiscard]] std::uint32_t has_edge(std::uint32_t face, std::uint32_t p, std::uint32_t q) const {
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (vertex_[face][i] == p && vertex_[face][(i + 1) % 3] == q) return i;
    }
    return kNone;
  }

  /// kNone if the face has no normal or the origin is above it.
  std::uint32_t add_face(std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    std::uint32_t f = free_;
    if (f != kNone) {
      free_ = neighbour_[f][0];
    } else if (faces_ < kMostFaces) {
      f = faces_++;
      // What a vector reads beyond the last face is no face.
      if (f % Doubles::kCount == 0) {
        for (std::uint32_t i = 0; i < Doubles::kCount; ++i) distance_[f + i] = __builtin_inf();
      }
    } else {
      return kNone;
    }
    double e[3];
    double g[3];
    double n[3];
    for (int k = 0; k < 3; ++k) {
      e[k] = point_[q][k] - point_[p][k];
      g[k] = point_[r][k] - point_[p][k];
    }
    cross3(e, g, n);
    const double square = dot3(n, n);
    if (!(square > 1e-26 * dot3(e, e) * dot3(g, g))) return kNone;
    const double over = 1.0 / __builtin_sqrt(square);
    for (int k = 0; k < 3; ++k) normal_[k][f] = n[k] * over;
    distance_[f] = dot_normal(f, point_[p]);
    vertex_[f][0] = p;
    vertex_[f][1] = q;
    vertex_[f][2] = r;
    return distance_[f] > -kLevel ? f : kNone;
  }

  void remove_face(std::uint32_t f) {
    distance_[f] = __builtin_inf();
    neighbour_[f][0] = free_;
    free_ = f;
  }

  [[nodiscard]] std::uint32_t nearest_face() const {
    Doubles least = Doubles::load(distance_);
    for (std::uint32_t f = Doubles::kCount; f < faces_; f += Doubles::kCount) {
      least = min(least, Doubles::load(distance_ + f));
    }
    alignas(64) double value[Doubles::kCount];
    least.store(value);
    double smallest = value[0];
    for (const double v : value) smallest = v < smallest ? v : smallest;
    for (std::uint32_t f = 0;; f += Doubles::kCount) {
      const Mask16 at = bits(Doubles::load(distance_ + f) == Doubles(smallest));
      if (at != 0) return f + first(at);
    }
  }

  [[nodiscard]] bool is_seen(std::uint32_t face, const double* w) const {
    return dot_normal(face, w) > distance_[face] + kLevel;
  }

  /// Takes away the faces that the new point sees, the nearest one among them, and joins it to
  /// their outline.
  bool grow(std::uint32_t to) {
    const double* w = point_[to];
    std::uint32_t seen[kMostFaces];
    std::uint32_t count = 1;
    seen[0] = face_;
    // Marked by where it is in the list.
    const auto listed = [&](std::uint32_t f) {
      for (std::uint32_t i = 0; i < count; ++i) {
        if (seen[i] == f) return true;
      }
      return false;
    };
    struct Side {
      std::uint32_t p;
      std::uint32_t q;
      std::uint32_t beyond;
      std::uint32_t edge;
    };
    Side outline[kMostOutline];
    std::uint32_t sides = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      for (int e = 0; e < 3; ++e) {
        const std::uint32_t g = neighbour_[seen[i]][e];
        if (listed(g)) continue;
        if (is_seen(g, w)) {
          if (count == kMostOutline) return false;
          seen[count++] = g;
        }
      }
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      for (int e = 0; e < 3; ++e) {
        const std::uint32_t f = seen[i];
        const std::uint32_t g = neighbour_[f][e];
        if (listed(g)) continue;
        if (sides == kMostOutline) return false;
        const std::uint32_t p = vertex_[f][e];
        const std::uint32_t q = vertex_[f][(e + 1) % 3];
        outline[sides++] = {p, q, g, has_edge(g, q, p)};
      }
    }
    for (std::uint32_t i = 0; i < count; ++i) remove_face(seen[i]);
    std::uint32_t begins[kMostPoints];
    std::uint32_t ends[kMostPoints];
    for (std::uint32_t i = 0; i < sides; ++i) {
      begins[outline[i].p] = kNone;
      begins[outline[i].q] = kNone;
    }
    for (std::uint32_t i = 0; i < sides; ++i) {
      const Side& s = outline[i];
      if (s.edge == kNone || begins[s.p] != kNone) return false;
      const std::uint32_t f = add_face(s.p, s.q, to);
      if (f == kNone) return false;
      neighbour_[f][0] = s.beyond;
      neighbour_[s.beyond][s.edge] = f;
      begins[s.p] = f;
      ends[s.q] = f;
    }
    // The outline is a ring: of each corner one side begins and one ends.
    for (std::uint32_t i = 0; i < sides; ++i) {
      const Side& s = outline[i];
      if (begins[s.q] == kNone) return false;
      neighbour_[begins[s.p]][1] = begins[s.q];
      neighbour_[begins[s.p]][2] = ends[s.p];
    }
    return true;
  }

  static constexpr std::uint32_t kMostOutline = 32;

  const CurvedPair* pair_ = nullptr;
  std::uint32_t points_ = 0;
  std::uint32_t faces_ = 0;
  std::uint32_t free_ = kNone;
  std::uint32_t face_ = 0;
  double upper_ = 0.0;
  double lower_ = 0.0;
  double point_[kMostPoints + 1][3];
  double mine_[kMostPoints + 1][3];
  std::uint32_t vertex_[kMostFaces][3];
  /// Across the edge from vertex i to the next.
  std::uint32_t neighbour_[kMostFaces][3];
  alignas(64) double normal_[3][kMostFaces];
  alignas(64) double distance_[kMostFaces];
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
