#pragma once

// Penetration depth of two hulls in float: the smallest height of their difference over all
// directions, found among those where it can be: normals of faces of either, and arcs between the
// normals of neighbouring faces of the first where the vertex of the second that is farthest
// changes. Every candidate left out is proven to be deeper than the result by more than float's
// errors, so that the few that are kept hold the true minimum.

#include <winnow/pipeline/narrow/hull_support.wide.h>

namespace winnow::WINNOW_ISA_NAME {

/// Height of the difference along a direction: of the first's face, or a point on an arc.
struct HullDirection {
  /// Unit, outward from the hull whose face it is, in that hull's frame.
  float normal[3];
  /// normal . x <= offset for that hull.
  float offset;
  float depth;
  /// The other hull's vertex farthest against the normal, in the same frame.
  float point[3];
  std::uint32_t vertex;
  /// The face; on an arc the one it begins at.
  std::uint32_t face;
};

/// Part of the arc between two neighbouring faces of the first: from s[0] n + t[0] m to
/// s[1] n + t[1] m, for their normals n and m.
struct HullArc {
  std::uint32_t face[2];
  std::uint32_t edge;
  std::uint32_t vertex[2];
  float s[2];
  float t[2];
};

/// What can be the smallest depth, as far as float can tell.
struct HullCandidate {
  enum class Kind : std::uint8_t { first_face, second_face, arc } kind;
  std::uint32_t face;
  float depth;
  HullArc arc;
};

class HullDepth {
 public:
  static constexpr std::uint32_t kMostFaces = 512;
  static constexpr std::uint32_t kMostCandidates = 24;

  /// False if there is more to look at than there is room for, or nothing certain to find.
  bool find(const HullPair& pair) {
    if (pair.first->dimension != 3 || pair.first->face_count > kMostFaces ||
        pair.second->face_count > kMostFaces) {
      return false;
    }
    slack_ = 2.0F * kFloatError * static_cast<float>(pair.size);
    best_ = __builtin_sqrtf(pair.depth_squared) / pair.scale * 1.00001F + slack_;
    place(pair);
    bound_faces(first_);
    bound_faces(second_);
    refine(first_);
    refine(second_);
    return follow_arcs() && count_ <= kMostCandidates;
  }

  [[nodiscard]] float best() const { return best_; }
  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] const HullCandidate& candidate(std::uint32_t i) const { return candidates_[i]; }
  /// All others are at least this deep.
  [[nodiscard]] float floor() const { return best_ + slack_; }

 private:
  using Lanes = Real<float>;
  static constexpr std::uint16_t kNone = 0xFFFF;

  /// A hull whose faces are tried, against the vertices of the other.
  struct Side {
    const HullShape* hull;
    const HullShape* other;
    HullCandidate::Kind kind;
    /// The other's place in this hull's frame.
    float turn[9];
    float shift[3];
    float center[3];
    std::uint32_t count;
    alignas(64) float bound[kMostFaces];
    std::uint16_t listed[kMostFaces];
  };

  void place(const HullPair& pair) {
    count_ = 0;
    records_ = 0;
    first_.hull = pair.first;
    first_.other = pair.second;
    first_.kind = HullCandidate::Kind::first_face;
    second_.hull = pair.second;
    second_.other = pair.first;
    second_.kind = HullCandidate::Kind::second_face;
    double back[3];
    turn_back3(pair.turn, pair.shift, back);
    for (int i = 0; i < 3; ++i) {
      first_.shift[i] = static_cast<float>(pair.shift[i]);
      second_.shift[i] = static_cast<float>(-back[i]);
      for (int k = 0; k < 3; ++k) {
        first_.turn[3 * i + k] = pair.turn_float[3 * i + k];
        second_.turn[3 * k + i] = pair.turn_float[3 * i + k];
      }
    }
    for (Side* side : {&first_, &second_}) {
      float middle[3];
      for (int i = 0; i < 3; ++i) middle[i] = static_cast<float>(side->other->center[i]);
      turn3(side->turn, middle, side->center);
      for (int i = 0; i < 3; ++i) side->center[i] += side->shift[i];
    }
  }

  /// The other hull holds a ball, so a face is at least that deep; lists the faces that are not
  /// too deep by this. A face of the first that has the other's middle outside is listed too: over
  /// an arc between two faces that do not, the bound is smallest at an end.
  void bound_faces(Side& side) {
    side.count = 0;
    const float* const* plane = side.hull->plane_float;
    const Vec3<float> middle{side.center[0], side.center[1], side.center[2]};
    const Lanes radius(static_cast<float>(side.other->inner_radius));
    const Lanes limit(best_ + slack_);
    for (std::uint32_t row = 0; row < side.hull->face_count; row += 16) {
      const Vec3<float> n{Lanes::load(plane[0] + row), Lanes::load(plane[1] + row),
                          Lanes::load(plane[2] + row)};
      const Lanes height = Lanes::load(plane[3] + row) - dot(n, middle);
      const Lanes bound = height + radius;
      bound.store(side.bound + row);
      Mask16 hit = bits((bound <= limit) | (height <= Lanes(slack_)));
      const std::uint32_t left = side.hull->face_count - row;
      if (left < 16) hit &= lanes_below(left);
      for (; hit != 0; hit &= hit - 1) {
        side.listed[side.count++] = static_cast<std::uint16_t>(row + first(hit));
      }
    }
  }

  /// Depths along the listed faces' normals.
  void refine(Side& side) {
    for (std::uint32_t i = 0; i < side.count; i += 16) {
      const std::uint32_t left = side.count - i;
      measure(side, side.listed + i, left < 16 ? left : 16);
    }
  }

  /// Sixteen faces a lane each, against one vertex of the other after another.
  void measure(Side& side, const std::uint16_t* faces, std::uint32_t count) {
    alignas(64) float staged[4][16];
    const float* const* plane = side.hull->plane_float;
    for (std::uint32_t lane = 0; lane < 16; ++lane) {
      const std::uint32_t face = faces[lane < count ? lane : 0];
      for (int k = 0; k < 4; ++k) staged[k][lane] = plane[k][face];
    }
    const Vec3<float> n{Lanes::load(staged[0]), Lanes::load(staged[1]), Lanes::load(staged[2])};
    const float* t = side.turn;
    const Vec3<float> d{n.x * Lanes(t[0]) + n.y * Lanes(t[3]) + n.z * Lanes(t[6]),
                        n.x * Lanes(t[1]) + n.y * Lanes(t[4]) + n.z * Lanes(t[7]),
                        n.x * Lanes(t[2]) + n.y * Lanes(t[5]) + n.z * Lanes(t[8])};
    const float* const* vertex = side.other->vertex_float;
    Lanes lowest(__builtin_inff());
    Lanes where(0.0F);
    for (std::uint32_t v = 0; v < side.other->vertex_count; ++v) {
      const Lanes height =
          d.x * Lanes(vertex[0][v]) + d.y * Lanes(vertex[1][v]) + d.z * Lanes(vertex[2][v]);
      const Truth<float> lower = height < lowest;
      lowest = select(lower, height, lowest);
      where = select(lower, Lanes(static_cast<float>(v)), where);
    }
    const Vec3<float> shift{side.shift[0], side.shift[1], side.shift[2]};
    const Lanes depth = Lanes::load(staged[3]) - (lowest + dot(n, shift));
    note(side, faces, count, n, staged[3], depth, where);
  }

  void note(Side& side, const std::uint16_t* faces, std::uint32_t count, const Vec3<float>& n,
            const float* offset, const Lanes& depth, const Lanes& where) {
    alignas(64) float depths[16];
    alignas(64) float vertices[16];
    depth.store(depths);
    where.store(vertices);
    float least = best_;
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      least = depths[lane] < least ? depths[lane] : least;
    }
    best_ = least;
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      if (depths[lane] <= best_ + slack_) propose_face(side.kind, faces[lane], depths[lane]);
    }
    if (side.kind != HullCandidate::Kind::first_face) return;
    alignas(64) float normal[3][16];
    n.x.store(normal[0]);
    n.y.store(normal[1]);
    n.z.store(normal[2]);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      HullDirection& record = record_[records_];
      record_of_[faces[lane]] = static_cast<std::uint16_t>(records_++);
      for (int k = 0; k < 3; ++k) record.normal[k] = normal[k][lane];
      record.offset = offset[lane];
      record.depth = depths[lane];
      record.face = faces[lane];
      meet(static_cast<std::uint32_t>(vertices[lane]), record);
    }
  }

  /// Sets the vertex of the second that a direction meets.
  void meet(std::uint32_t vertex, HullDirection& direction) const {
    float x[3];
    vertex_at(*first_.other, vertex, x);
    turn3(first_.turn, x, direction.point);
    for (int k = 0; k < 3; ++k) direction.point[k] += first_.shift[k];
    direction.vertex = vertex;
  }

  void propose_face(HullCandidate::Kind kind, std::uint32_t face, float depth) {
    HullCandidate c;
    c.kind = kind;
    c.face = face;
    c.depth = depth;
    propose(c);
  }

  /// Adds a candidate, dropping those that have become too deep when the room runs out.
  void propose(const HullCandidate& candidate) {
    if (count_ >= kMostCandidates) drop_deep();
    if (count_ < kMostCandidates) candidates_[count_] = candidate;
    ++count_;
  }

  void drop_deep() {
    if (count_ > kMostCandidates) return;
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (candidates_[i].depth <= best_ + slack_) candidates_[kept++] = candidates_[i];
    }
    count_ = kept;
  }

  [[nodiscard]] bool is_open(std::uint32_t face) const {
    return first_.bound[face] <= best_ + slack_ ||
           first_.bound[face] <= static_cast<float>(first_.other->inner_radius) + slack_;
  }

  /// All arcs that begin or end at a face that is not too deep by its bound.
  bool follow_arcs() {
    const HullShape& hull = *first_.hull;
    std::uint32_t open = 0;
    for (std::uint32_t i = 0; i < first_.count; ++i) {
      if (is_open(first_.listed[i])) first_.listed[open++] = first_.listed[i];
    }
    first_.count = open;
    if (!measure_neighbours(hull)) return false;
    for (std::uint32_t i = 0; i < first_.count; ++i) {
      const std::uint32_t face = first_.listed[i];
      if (!is_open(face)) continue;
      const HullFace& f = hull.faces[face];
      for (std::uint32_t k = f.first; k < f.first + f.count; ++k) {
        const HullEdge& edge = hull.edges[hull.loop_edge[k]];
        const std::uint32_t next = edge.face[0] == face ? edge.face[1] : edge.face[0];
        if (next < face && is_open(next)) continue;
        const HullDirection& a = record_[record_of_[face]];
        const HullDirection& b = record_[record_of_[next]];
        if (a.vertex == b.vertex) continue;
        HullArc arc;
        arc.face[0] = face;
        arc.face[1] = next;
        arc.edge = hull.loop_edge[k];
        arc.s[0] = 1.0F;
        arc.t[0] = 0.0F;
        arc.s[1] = 0.0F;
        arc.t[1] = 1.0F;
        if (!follow(arc, a, b)) return false;
      }
    }
    drop_deep();
    return true;
  }

  /// Depths along the normals of faces next to listed ones, which are not listed themselves.
  bool measure_neighbours(const HullShape& hull) {
    std::uint16_t missing[16];
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < first_.count; ++i) {
      const std::uint32_t face = first_.listed[i];
      const HullFace& f = hull.faces[face];
      for (std::uint32_t k = f.first; k < f.first + f.count; ++k) {
        const HullEdge& edge = hull.edges[hull.loop_edge[k]];
        const std::uint32_t next = edge.face[0] == face ? edge.face[1] : edge.face[0];
        if (has_record(next)) continue;
        bool waits = false;
        for (std::uint32_t m = 0; m < count; ++m) waits = waits || missing[m] == next;
        if (waits) continue;
        missing[count++] = static_cast<std::uint16_t>(next);
        if (count == 16) {
          measure(first_, missing, count);
          count = 0;
        }
      }
    }
    if (count > 0) measure(first_, missing, count);
    return true;
  }

  [[nodiscard]] bool has_record(std::uint32_t face) const {
    const std::uint32_t r = record_of_[face];
    return r < records_ && record_[r].face == face;
  }

  /// Searches an arc, halved where a third vertex of the second shows up, for depths near the best.
  bool follow(const HullArc& whole, const HullDirection& from, const HullDirection& to) {
    struct Part {
      HullDirection end[2];
      HullArc arc;
    };
    constexpr int kDeepest = 12;
    Part stack[kDeepest];
    int height = 1;
    stack[0] = {{from, to}, whole};
    while (height > 0) {
      const Part part = stack[--height];
      HullDirection middle;
      float weight[2];
      float lowest = 0.0F;
      const Verdict verdict = cut(part.end[0], part.end[1], middle, weight, lowest);
      if (verdict == Verdict::lost) return false;
      if (verdict == Verdict::deep) continue;
      HullArc arc = part.arc;
      arc.vertex[0] = part.end[0].vertex;
      arc.vertex[1] = part.end[1].vertex;
      if (middle.vertex == arc.vertex[0] || middle.vertex == arc.vertex[1] ||
          middle.depth <= lowest + 0.25F * slack_) {
        if (lowest <= best_ + slack_) {
          HullCandidate c;
          c.kind = HullCandidate::Kind::arc;
          c.face = arc.face[0];
          c.depth = lowest;
          c.arc = arc;
          propose(c);
        }
        continue;
      }
      if (height + 2 > kDeepest) return false;
      const float s = weight[0] * arc.s[0] + weight[1] * arc.s[1];
      const float t = weight[0] * arc.t[0] + weight[1] * arc.t[1];
      Part& left = stack[height++];
      left.end[0] = part.end[0];
      left.end[1] = middle;
      left.arc = arc;
      left.arc.s[1] = s;
      left.arc.t[1] = t;
      Part& right = stack[height++];
      right.end[0] = middle;
      right.end[1] = part.end[1];
      right.arc = arc;
      right.arc.s[0] = s;
      right.arc.t[0] = t;
    }
    return true;
  }

  enum class Verdict : std::uint8_t { deep, near, lost };

  /// Heights along an arc are at least those of the two points of the difference known at its ends:
  /// where the two are equal this bound is smallest (or at an end, which has been looked at). If
  /// that is near the best depth, measures there. Any direction between the ends will do for a
  /// bound: to one side of the crossing one point is lower than there, to the other the other.
  Verdict cut(const HullDirection& a, const HullDirection& b, HullDirection& middle, float* weight,
              float& lowest) {
    const float cosine = dot3(a.normal, b.normal);
    if (!(cosine > -0.98F)) return Verdict::lost;
    const float a_at_b = b.offset - dot3(b.normal, a.point);
    const float b_at_a = a.offset - dot3(a.normal, b.point);
    float p = b.depth - a_at_b;
    float q = a.depth - b_at_a;
    p = p > 0.0F ? p : 0.0F;
    q = q > 0.0F ? q : 0.0F;
    if (!(p + q > 0.0F)) return Verdict::deep;
    const float height_a = p * a.depth + q * a_at_b;
    const float height_b = p * b_at_a + q * b.depth;
    const float height = height_a < height_b ? height_a : height_b;
    const float square = p * p + q * q + 2.0F * p * q * cosine;
    const float limit = best_ + slack_ * (p + q) / __builtin_sqrtf(square);
    if (height > 0.0F && height * height > limit * limit * square) return Verdict::deep;
    const float scale = 1.0F / __builtin_sqrtf(square);
    weight[0] = p * scale;
    weight[1] = q * scale;
    lowest = height * scale;
    for (int k = 0; k < 3; ++k) {
      middle.normal[k] = weight[0] * a.normal[k] + weight[1] * b.normal[k];
    }
    middle.offset = weight[0] * a.offset + weight[1] * b.offset;
    middle.face = a.face;
    float direction[3];
    turn_back3(first_.turn, middle.normal, direction);
    for (float& x : direction) x = -x;
    meet(farthest_vertex(*first_.other, direction), middle);
    middle.depth = middle.offset - dot3(middle.normal, middle.point);
    best_ = middle.depth < best_ ? middle.depth : best_;
    return Verdict::near;
  }

  Side first_;
  Side second_;
  float best_;
  float slack_;
  std::uint32_t count_;
  std::uint32_t records_;
  HullCandidate candidates_[kMostCandidates];
  std::uint16_t record_of_[kMostFaces] = {};
  HullDirection record_[kMostFaces];
};

}  // namespace winnow::WINNOW_ISA_NAME
