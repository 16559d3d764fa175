#pragma once

// Step 3 of the hull kernels, for pairs that touch or overlap (hull_answers.wide.h has the
// sequence): the penetration depth of two hulls, the smallest height of their Minkowski difference
// over all directions.
//
// HullDepth searches in float. The minimum is at a face normal of either hull, or on an arc of the
// Gauss map between the normals of neighbouring faces of the first, where the supporting vertex of
// the second changes. Most faces and arcs are skipped because a known point of the difference is
// higher than the best depth along them; an arc is skipped if one point is higher at both ends,
// since heights are concave in between. Skipped directions are deeper than the result by more than
// the errors of float, so the few candidates that are kept contain the true minimum. HullMeasure
// measures candidates in double, over all vertices.
//
// If several vertices of the second have the same height along a face normal of the first, up to
// the errors of float (a tie), HullDepth keeps the face as a candidate and skips its arcs; HullTies
// searches these arcs in double. hull_manifold.wide.h calls HullMeasure and HullTies.

#include "pipeline/kernels/hull/hull_gjk.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// The height of the difference along a direction: the normal of a face of the first, or a
/// direction on an arc.
struct HullDirection {
  /// Unit, outward from the hull that has the face, in that hull's frame.
  float normal[3];
  /// normal . x <= offset for that hull.
  float offset;
  float depth;
  /// The other hull's supporting vertex against the normal, in the same frame.
  float point[3];
  std::uint32_t vertex;
  /// The face; on an arc, the face at which it begins.
  std::uint32_t face;
};

/// A part of the arc between the normals n and m of two neighbouring faces of the first, from s[0]
/// n + t[0] m to s[1] n + t[1] m.
struct HullArc {
  std::uint32_t face[2];
  std::uint32_t edge;
  std::uint32_t vertex[2];
  float s[2];
  float t[2];

  [[nodiscard]] bool is_whole() const { return t[0] == 0.0F && s[1] == 0.0F; }
};

/// A face or arc that may have the smallest depth, up to the errors of float.
struct HullCandidate {
  enum class Kind : std::uint8_t { first_face, second_face, arc } kind;
  std::uint32_t face;
  float depth;
  HullArc arc;
};

class HullDepth {
 public:
  static constexpr std::uint32_t kMaxFaces = 512;
  static constexpr std::uint32_t kMaxCandidates = 24;

  /// Finds the candidates. Returns false if there are more than fit, if the cores may be apart, or
  /// if an arc has more parts than the search can follow.
  bool find(const HullPair& pair) {
    if (pair.first->dimension != 3 || pair.first->face_count > kMaxFaces ||
        pair.second->face_count > kMaxFaces) {
      return false;
    }
    slack_ = 2.0F * kFloatError * static_cast<float>(pair.size);
    best_ = __builtin_sqrtf(pair.depth_squared) / pair.scale * 1.00001F + slack_;
    count_ = 0;
    records_ = 0;
    tie_.face = kMaxFaces;
    place(pair);
    close_faces(second_);
    measure_open_faces();
    close_faces(first_);
    return best_ + slack_ > 0.0F && follow_arcs() && count_ <= kMaxCandidates;
  }

  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] const HullCandidate& candidate(std::uint32_t i) const { return candidates_[i]; }

 private:
  /// Heights that differ by less than this fraction of the slack are tied.
  static constexpr float kTie = 0.25F;
  /// The number of edges of a hull of kMaxFaces triangles.
  static constexpr std::uint32_t kMaxEdges = kMaxFaces / 2 * 3;

  /// A hull whose faces are tested against the vertices of the other hull.
  struct TestedHull {
    const HullShape* hull;
    const HullShape* other;
    HullCandidate::Kind kind;
    /// The other hull's placement in this hull's frame.
    float turn[9];
    float shift[3];
    float center[3];
    /// Known points of this hull minus the other.
    float known[HullPair::kTrail][3];
    std::uint32_t known_count;
    /// For each face, bits of the known points that are higher along its normal than the best
    /// depth; 0.0F if there are none.
    alignas(64) float closed[kMaxFaces];
  };

  /// One bit of `closed`, in a bit pattern that is a normal float.
  static float closed_bit(std::uint32_t i) {
    return __builtin_bit_cast(float, kClosedPattern | 1U << i);
  }
  static constexpr std::uint32_t kClosedPattern = 0x40000000U;
  static constexpr std::uint32_t kBallBit = HullPair::kTrail;

  void place(const HullPair& pair) {
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
    for (TestedHull* side : {&first_, &second_}) {
      float middle[3];
      for (int i = 0; i < 3; ++i) middle[i] = static_cast<float>(side->other->center[i]);
      turn3(side->turn, middle, side->center);
      for (int i = 0; i < 3; ++i) side->center[i] += side->shift[i];
      side->known_count =
          pair.trail_length < HullPair::kTrail ? pair.trail_length : HullPair::kTrail;
    }
    const float scale = 1.0F / pair.scale;
    for (std::uint32_t i = 0; i < first_.known_count; ++i) {
      float* w = first_.known[i];
      for (int k = 0; k < 3; ++k) w[k] = pair.trail[i][k] * scale;
      turn_back3(first_.turn, w, second_.known[i]);
      for (int k = 0; k < 3; ++k) second_.known[i][k] = -second_.known[i][k];
    }
  }

  static Floats either(const Floats& a, const Floats& b) {
    Floats r;
    for (int i = 0; i < Floats::kParts; ++i) r.part[i] = a.part[i] | b.part[i];
    return r;
  }

  /// Determines for each face the known points that are higher along its normal than the best
  /// depth; such points close the face. Another such point is on the ball inside the other hull:
  /// the one farthest against the normal. It is used if the center of the ball is inside the face's
  /// plane, because only then is the height of the ball concave along arcs, too.
  void close_faces(TestedHull& side) {
    const float* const* plane = side.hull->plane_float;
    const Vec3<float> middle{side.center[0], side.center[1], side.center[2]};
    const Floats radius(static_cast<float>(side.other->inner_radius));
    const Floats limit(best_ + slack_);
    const Floats none(0.0F);
    for (std::uint32_t row = 0; row < side.hull->face_count; row += kLanes) {
      const Vec3<float> n{Floats::load(plane[0] + row), Floats::load(plane[1] + row),
                          Floats::load(plane[2] + row)};
      const Floats height = Floats::load(plane[3] + row) - dot(n, middle);
      Floats closed = select((height + radius > limit) & (height > Floats(slack_)),
                             Floats(closed_bit(kBallBit)), none);
      for (std::uint32_t i = 0; i < side.known_count; ++i) {
        const float* w = side.known[i];
        const LaneMask<float> higher = dot(n, Vec3<float>{w[0], w[1], w[2]}) > limit;
        closed = either(closed, select(higher, Floats(closed_bit(i)), none));
      }
      closed.store(side.closed + row);
    }
  }

  /// Measures the depths along the normals of the second's faces that no known point closes.
  void measure_open_faces() {
    const float* const* plane = second_.hull->plane_float;
    for (std::uint32_t row = 0; row < second_.hull->face_count; row += kLanes) {
      Mask16 hit = bits(Floats::load(second_.closed + row) <= Floats(0.0F));
      const std::uint32_t left = second_.hull->face_count - row;
      if (left < kLanes) hit &= lanes_below(left);
      for (; hit != 0; hit &= hit - 1) {
        const std::uint32_t face = row + first(hit);
        const float normal[3] = {plane[0][face], plane[1][face], plane[2][face]};
        float direction[3];
        turn_back3(second_.turn, normal, direction);
        for (float& x : direction) x = -x;
        const float depth =
            plane[3][face] - dot3(normal, second_.shift) + height_of(*second_.other, direction);
        propose_face(HullCandidate::Kind::second_face, face, depth, 0.0F);
      }
    }
  }

  /// Measures the depth along the normal of a face of the first.
  void measure(std::uint32_t face, HullDirection& record) {
    const float* const* plane = first_.hull->plane_float;
    for (int k = 0; k < 3; ++k) record.normal[k] = plane[k][face];
    record.offset = plane[3][face];
    record.face = face;
    find_support(record);
    if (record.depth <= best_ + slack_) find_tied_vertices(record);
    // This face stays a candidate up to a slightly larger depth, for the arcs that `is_tied_end`
    // leaves to HullTies.
    propose_face(HullCandidate::Kind::first_face, face, record.depth, kTie * slack_);
  }

  /// If several vertices of the second are lowest along a face's normal, up to the errors of float,
  /// stores their mean.
  void find_tied_vertices(const HullDirection& face) {
    float local[3];
    turn_back3(first_.turn, face.normal, local);
    for (float& x : local) x = -x;
    const float height = dot3(face.normal, first_.shift) - dot3(face.normal, face.point);
    float middle[3];
    if (middle_from(*first_.other, local, height - kTie * slack_, middle) < 2) return;
    turn3(first_.turn, middle, tie_.middle);
    for (int k = 0; k < 3; ++k) tie_.middle[k] += first_.shift[k];
    tie_.face = face.face;
    tie_.depth = face.depth;
  }

  /// True if one end of an arc is the tied face, and the mean of its tied vertices is deeper than
  /// the best depth at the other end. As heights are concave along the arc, it is then nowhere less
  /// deep than at the tied face, which is a candidate.
  [[nodiscard]] bool is_deeper_than_tie(const HullEdge& edge) const {
    const std::uint32_t* face = edge.face;
    if (face[0] != tie_.face && face[1] != tie_.face) return false;
    if (!(tie_.depth > slack_) || tie_.depth > best_ + slack_) return false;
    const std::uint32_t other = face[0] == tie_.face ? face[1] : face[0];
    const float* const* plane = first_.hull->plane_float;
    const float normal[3] = {plane[0][other], plane[1][other], plane[2][other]};
    return plane[3][other] - dot3(normal, tie_.middle) > best_ + slack_;
  }

  /// Finds the supporting vertex of the second hull along minus `direction.normal`, and the depth
  /// along the normal.
  [[gnu::always_inline]] void find_support(HullDirection& direction) const {
    float local[3];
    turn_back3(first_.turn, direction.normal, local);
    for (float& x : local) x = -x;
    direction.vertex = farthest_vertex(*first_.other, local);
    float x[3];
    vertex_at(*first_.other, direction.vertex, x);
    turn3(first_.turn, x, direction.point);
    for (int k = 0; k < 3; ++k) direction.point[k] += first_.shift[k];
    direction.depth = direction.offset - dot3(direction.normal, direction.point);
  }

  /// `less`: by how much other directions that the face stands for may be less deep.
  void propose_face(HullCandidate::Kind kind, std::uint32_t face, float depth, float less) {
    best_ = depth < best_ ? depth : best_;
    if (!(depth - less <= best_ + slack_)) return;
    HullCandidate c;
    c.kind = kind;
    c.face = face;
    c.depth = depth - less;
    propose(c);
  }

  void propose_arc(const HullArc& arc, float depth) {
    if (!(depth <= best_ + slack_)) return;
    HullCandidate c;
    c.kind = HullCandidate::Kind::arc;
    c.face = arc.face[0];
    c.depth = depth;
    c.arc = arc;
    propose(c);
  }

  /// Adds a candidate. If there is no room, first drops candidates that have become too deep.
  void propose(const HullCandidate& candidate) {
    if (count_ >= kMaxCandidates) drop_deep();
    if (count_ < kMaxCandidates) candidates_[count_] = candidate;
    ++count_;
  }

  void drop_deep() {
    if (count_ > kMaxCandidates) return;
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (candidates_[i].depth <= best_ + slack_) candidates_[kept++] = candidates_[i];
    }
    count_ = kept;
  }

  /// Searches all arcs of the first that no single known point closes at both ends.
  bool follow_arcs() {
    const HullShape& hull = *first_.hull;
    if (hull.edge_count > kMaxEdges) return false;
    const std::uint32_t count = list_open_arcs(hull);
    measure_ends(hull, count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const HullEdge& edge = hull.edges[open_[i]];
      if (is_deep(edge) || is_deeper_than_tie(edge)) continue;
      const HullDirection& a = measured(edge.face[0]);
      const HullDirection& b = measured(edge.face[1]);
      if (a.vertex == b.vertex || is_deep(edge)) continue;
      HullArc arc;
      arc.face[0] = edge.face[0];
      arc.face[1] = edge.face[1];
      arc.edge = open_[i];
      arc.s[0] = 1.0F;
      arc.t[0] = 0.0F;
      arc.s[1] = 0.0F;
      arc.t[1] = 1.0F;
      if (!follow(arc, a, b)) return false;
    }
    drop_deep();
    return true;
  }

  /// Fills open_; returns the number of arcs.
  std::uint32_t list_open_arcs(const HullShape& hull) {
    std::uint32_t count = 0;
    for (std::uint32_t e = 0; e < hull.edge_count; ++e) {
      const HullEdge& edge = hull.edges[e];
      const std::uint32_t a = closed_by(edge.face[0]);
      const std::uint32_t b = closed_by(edge.face[1]);
      // Branchless: the branch would be mispredicted at every arc found.
      open_[count] = e;
      count += (a & b) == 0 ? 1U : 0U;
    }
    return count;
  }

  /// Measures the faces of the first that are not closed, which are ends of open arcs, except the
  /// neighbours of a tied face that is_deeper_than_tie excludes.
  void measure_ends(const HullShape& hull, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const HullEdge& edge = hull.edges[open_[i]];
      if (is_deeper_than_tie(edge)) continue;
      for (const std::uint32_t face : edge.face) {
        if (closed_by(face) == 0) measured(face);
      }
    }
  }

  /// Bits of the known points that are higher than the best depth along a face of the first.
  [[nodiscard]] std::uint32_t closed_by(std::uint32_t face) const {
    return __builtin_bit_cast(std::uint32_t, first_.closed[face]) & ~kClosedPattern;
  }

  [[nodiscard]] bool has_record(std::uint32_t face) const {
    const std::uint32_t record = record_of_[face];
    return record < records_ && record_[record].face == face;
  }

  const HullDirection& measured(std::uint32_t face) {
    if (!has_record(face)) {
      record_of_[face] = static_cast<std::uint16_t>(records_);
      measure(face, record_[records_++]);
    }
    return record_[record_of_[face]];
  }

  /// The heights of one point of the difference along the normals of two faces of the first.
  struct Heights {
    float here;
    float there;
  };

  /// The heights of a point that is high along the normal of `here`: of the highest point, if that
  /// face has been measured.
  [[nodiscard, gnu::always_inline]] Heights high_point(std::uint32_t here, std::uint32_t there,
                                                       float cosine) const {
    const float* const* plane = first_.hull->plane_float;
    const float n[3] = {plane[0][here], plane[1][here], plane[2][here]};
    const float m[3] = {plane[0][there], plane[1][there], plane[2][there]};
    if (has_record(here)) {
      const HullDirection& record = record_[record_of_[here]];
      return {record.depth, plane[3][there] - dot3(m, record.point)};
    }
    const std::uint32_t closed = closed_by(here);
    if ((closed >> kBallBit & 1U) != 0) {
      // The point of the ball in the other hull that is farthest against the normal.
      const auto radius = static_cast<float>(first_.other->inner_radius);
      return {plane[3][here] - dot3(n, first_.center) + radius,
              plane[3][there] - dot3(m, first_.center) + radius * cosine};
    }
    const float* w = first_.known[__builtin_ctz(closed)];
    return {dot3(n, w), dot3(m, w)};
  }

  /// True if two known points prove, as in `cut`, that the whole arc is deeper than the best depth.
  /// Only for ends that are less than a right angle apart.
  [[nodiscard, gnu::always_inline]] bool is_deep(const HullEdge& edge) const {
    const float* const* plane = first_.hull->plane_float;
    const std::uint32_t f = edge.face[0];
    const std::uint32_t g = edge.face[1];
    const float cosine =
        plane[0][f] * plane[0][g] + plane[1][f] * plane[1][g] + plane[2][f] * plane[2][g];
    if (!(cosine > 0.0F)) return false;
    const Heights a = high_point(f, g, cosine);
    const Heights b = high_point(g, f, cosine);
    float p = b.here - a.there;
    float q = a.here - b.there;
    // As in `cut`, the slack is multiplied by (p + q) / sqrt(square), which is at most sqrt(2).
    const float limit = best_ + 1.5F * slack_;
    // If the point of one end is at least as high at the other end as the point found there, it
    // bounds the whole arc alone.
    if (!(p > 0.0F)) {
      return a.here > 0.0F && a.there > 0.0F && has_deep_ends(a.here, a.there, limit, f, g);
    }
    if (!(q > 0.0F)) {
      return b.here > 0.0F && b.there > 0.0F && has_deep_ends(b.there, b.here, limit, f, g);
    }
    const float height_a = p * a.here + q * a.there;
    const float height_b = p * b.there + q * b.here;
    const float height = height_a < height_b ? height_a : height_b;
    const float square = p * p + q * q + 2.0F * p * q * cosine;
    return height > 0.0F && height * height > limit * limit * square &&
           has_deep_ends(a.here, b.here, limit, f, g);
  }

  /// The bound of an arc holds between its ends. Ends that were measured are candidates themselves.
  [[nodiscard]] bool has_deep_ends(float a, float b, float limit, std::uint32_t f,
                                   std::uint32_t g) const {
    return (a > limit || has_record(f)) && (b > limit || has_record(g));
  }

  /// Searches an arc for depths near the best. An arc is split where a third vertex of the second
  /// is the supporting one.
  bool follow(const HullArc& whole, const HullDirection& from, const HullDirection& to) {
    struct StackedArc {
      HullDirection end[2];
      HullArc arc;
    };
    constexpr int kDeepest = 12;
    StackedArc stack[kDeepest];
    int height = 0;
    if (!search(whole, from, to, stack, height)) return false;
    while (height > 0) {
      if (height + 1 > kDeepest) return false;
      const StackedArc part = stack[--height];
      if (!search(part.arc, part.end[0], part.end[1], stack, height)) return false;
    }
    return true;
  }

  /// Processes one arc: makes it a candidate, pushes two halves on the stack, or drops it.
  template <typename StackedArc>
  bool search(HullArc arc, const HullDirection& from, const HullDirection& to, StackedArc* stack,
              int& height) {
    HullDirection middle;
    float weight[2];
    float lowest = 0.0F;
    const ArcDepth arc_depth = cut(from, to, arc.is_whole(), middle, weight, lowest);
    if (arc_depth == ArcDepth::lost) return false;
    arc.vertex[0] = from.vertex;
    arc.vertex[1] = to.vertex;
    if (arc_depth == ArcDepth::deep) {
      // The ends of a whole arc are candidates, and HullTies searches around them.
      if (!arc.is_whole()) propose_arc(arc, from.depth < to.depth ? from.depth : to.depth);
      return true;
    }
    if (middle.vertex == arc.vertex[0] || middle.vertex == arc.vertex[1] ||
        middle.depth <= lowest + 0.25F * slack_) {
      propose_arc(arc, lowest);
      return true;
    }
    const float s = weight[0] * arc.s[0] + weight[1] * arc.s[1];
    const float t = weight[0] * arc.t[0] + weight[1] * arc.t[1];
    StackedArc& left = stack[height++];
    left = {{from, middle}, arc};
    left.arc.s[1] = s;
    left.arc.t[1] = t;
    StackedArc& right = stack[height++];
    right = {{middle, to}, arc};
    right.arc.s[0] = s;
    right.arc.t[0] = t;
    return true;
  }

  /// True if, at one end of a whole arc, the points of both ends have the same height up to the
  /// errors of float, and the arc is nowhere lower. HullTies then finds both points at that face
  /// and tests all such arcs around it. `other_point`: the height at this end of the other end's
  /// point.
  [[nodiscard]] bool is_tied_end(const HullDirection& end, float other_point, float lowest) const {
    const float least = other_point < lowest ? other_point : lowest;
    return end.depth <= best_ + slack_ && least >= end.depth - kTie * slack_;
  }

  enum class ArcDepth : std::uint8_t { deep, near, lost };

  /// Bounds the heights along an arc from below by the two points found at its ends. The bound is
  /// smallest in the direction in which both points have the same height, or at an end, which has
  /// been measured. If that height is near the best depth, measures the depth in this direction.
  /// The bound is also valid for a direction with rounding errors: heights are concave, so between
  /// the direction and an end, the point of that end is at least as high as at the lower of the
  /// two.
  ArcDepth cut(const HullDirection& a, const HullDirection& b, bool whole, HullDirection& middle,
               float* weight, float& lowest) {
    const float cosine = dot3(a.normal, b.normal);
    if (!(cosine > -0.98F)) return ArcDepth::lost;
    const float a_at_b = b.offset - dot3(b.normal, a.point);
    const float b_at_a = a.offset - dot3(a.normal, b.point);
    float p = b.depth - a_at_b;
    float q = a.depth - b_at_a;
    p = p > 0.0F ? p : 0.0F;
    q = q > 0.0F ? q : 0.0F;
    if (!(p + q > 0.0F)) return ArcDepth::deep;
    const float height_a = p * a.depth + q * a_at_b;
    const float height_b = p * b_at_a + q * b.depth;
    const float height = height_a < height_b ? height_a : height_b;
    const float square = p * p + q * q + 2.0F * p * q * cosine;
    const float limit = best_ + slack_ * (p + q) / __builtin_sqrtf(square);
    if (height > 0.0F && height * height > limit * limit * square) return ArcDepth::deep;
    const float scale = 1.0F / __builtin_sqrtf(square);
    weight[0] = p * scale;
    weight[1] = q * scale;
    lowest = height * scale;
    if (whole && (is_tied_end(a, b_at_a, lowest) || is_tied_end(b, a_at_b, lowest))) {
      return ArcDepth::deep;
    }
    for (int k = 0; k < 3; ++k) {
      middle.normal[k] = weight[0] * a.normal[k] + weight[1] * b.normal[k];
    }
    middle.offset = weight[0] * a.offset + weight[1] * b.offset;
    middle.face = a.face;
    find_support(middle);
    best_ = middle.depth < best_ ? middle.depth : best_;
    return ArcDepth::near;
  }

  /// A face of the first along which the depth is near the smallest, and the mean of the vertices
  /// of the second that are lowest along its normal.
  struct Tie {
    std::uint32_t face;
    float depth;
    float middle[3];
  };

  TestedHull first_;
  TestedHull second_;
  Tie tie_;
  float best_;
  /// Twice the error of a height in float: directions that are deeper than the best by more are
  /// deeper in double, too.
  float slack_;
  std::uint32_t count_;
  std::uint32_t records_;
  HullCandidate candidates_[kMaxCandidates];
  std::uint32_t open_[kMaxEdges + 1];
  std::uint16_t record_of_[kMaxFaces] = {};
  HullDirection record_[kMaxFaces];
};

/// Vertex i of the second in the first's frame.
[[gnu::always_inline]] static inline void second_vertex_at(const HullPair& pair, std::uint32_t i,
                                                           double* x) {
  double local[3];
  vertex_at(*pair.second, i, local);
  turn3(pair.turn, local, x);
  for (int k = 0; k < 3; ++k) x[k] += pair.shift[k];
}

/// The smallest dot product of a vertex of the second with `direction`.
static inline double lowest_of_second(const HullPair& pair, const double* direction) {
  double local[3];
  turn_back3(pair.turn, direction, local);
  for (double& x : local) x = -x;
  return dot3(direction, pair.shift) - height_of(*pair.second, local);
}

/// Depth along a unit direction from the first to the second, over all vertices.
static inline double depth_along(const HullPair& pair, const double* normal) {
  return height_of(*pair.first, normal) - lowest_of_second(pair, normal);
}

/// The directions at the ends of an arc, in the first's frame, not normalized.
static inline void arc_ends(const HullPair& pair, const HullArc& arc, double (*end)[3]) {
  const double* n = pair.first->faces[arc.face[0]].normal.data();
  const double* m = pair.first->faces[arc.face[1]].normal.data();
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 3; ++k) {
      end[i][k] = static_cast<double>(arc.s[i]) * n[k] + static_cast<double>(arc.t[i]) * m[k];
    }
  }
}

/// Measures a candidate: `depth` is an upper bound of the smallest depth, attained along `normal`;
/// `lower_bound` is a lower bound for all directions that the candidate stands for.
class HullMeasure {
 public:
  explicit HullMeasure(const HullPair& pair) : pair_(pair) {}

  double depth;
  double lower_bound;
  double normal[3];

  void face(const HullCandidate& c) {
    if (c.kind == HullCandidate::Kind::first_face) {
      for (int k = 0; k < 3; ++k) normal[k] = pair_.first->faces[c.face].normal[k];
    } else {
      double n[3];
      for (int k = 0; k < 3; ++k) n[k] = pair_.second->faces[c.face].normal[k];
      turn3(pair_.turn, n, normal);
      for (double& x : normal) x = -x;
    }
    depth = depth_along(pair_, normal);
    lower_bound = depth;
  }

  /// Bounds an arc as HullDepth::cut does.
  void arc(const HullArc& arc) {
    double end[2][3];
    double mine[3];
    vertex_at(*pair_.first, pair_.first->edges[arc.edge].vertex[0], mine);
    double w[2][3];
    arc_ends(pair_, arc, end);
    for (int i = 0; i < 2; ++i) {
      double theirs[3];
      second_vertex_at(pair_, arc.vertex[i], theirs);
      for (int k = 0; k < 3; ++k) w[i][k] = mine[k] - theirs[k];
    }
    crossing(end, w);
    // The ends of a whole arc are candidates themselves.
    if (!arc.is_whole()) bound_ends(end, w);
  }

  /// For the arc between two directions and two points of the difference: measures the direction in
  /// which both points have the same height. If one point is higher at both ends, measures the end
  /// at which it is lower.
  void crossing(const double (*end)[3], const double (*w)[3]) {
    const double here[2] = {dot3(end[0], w[0]), dot3(end[0], w[1])};
    const double there[2] = {dot3(end[1], w[0]), dot3(end[1], w[1])};
    const double q = here[0] - here[1];
    const double p = there[1] - there[0];
    const bool crosses = (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
    const int top = q > 0.0 || p < 0.0 ? 0 : 1;
    double weight[2] = {p < 0.0 ? -p : p, q < 0.0 ? -q : q};
    if (!crosses) {
      const bool at_start = here[top] < there[top];
      weight[0] = at_start ? 1.0 : 0.0;
      weight[1] = at_start ? 0.0 : 1.0;
    }
    for (int k = 0; k < 3; ++k) normal[k] = weight[0] * end[0][k] + weight[1] * end[1][k];
    const double scale = 1.0 / __builtin_sqrt(dot3(normal, normal));
    for (double& x : normal) x *= scale;
    depth = depth_along(pair_, normal);
    const double heights[2] = {dot3(normal, w[0]), dot3(normal, w[1])};
    const int low = heights[0] < heights[1] ? 0 : 1;
    lower_bound = heights[crosses ? low : top];
  }

  /// If both points rise along an arc, the larger of their heights is smallest at an end: lowers
  /// the bound to the larger height at each end.
  void bound_ends(const double (*end)[3], const double (*w)[3]) {
    for (int i = 0; i < 2; ++i) {
      const double heights[2] = {dot3(end[i], w[0]), dot3(end[i], w[1])};
      const double height = (heights[0] > heights[1] ? heights[0] : heights[1]) /
                            __builtin_sqrt(dot3(end[i], end[i]));
      lower_bound = height < lower_bound ? height : lower_bound;
    }
  }

 private:
  const HullPair& pair_;
};

/// Searches arcs that float cannot resolve. If hulls are nearly parallel, several vertices of the
/// second are equally far along a face normal of the first, up to the errors of float, and the
/// float search may have found the same vertex at both ends of an arc along which the vertex
/// changes. This class distinguishes them in double, on all arcs around the face.
class HullTies {
 public:
  /// `best` is the smallest depth found, `lower_bound` a lower bound of the depth.
  HullTies(const HullPair& pair, double best, double lower_bound)
      : pair_(pair), measure_(pair), best_(best), lower_bound_(lower_bound) {}

  /// Searches around a face of the first, along whose normal the depth is `depth`; returns false if
  /// there is more to search than there is room for.
  bool around(std::uint32_t face, double depth) {
    const HullFace& f = pair_.first->faces[face];
    return !has_ties(f.normal.data(), f.offset - depth) || search_arcs(face, f.offset - depth);
  }

  /// Searches an arc again on which a third vertex is nearer than the two that were found.
  bool along_arc(const HullArc& arc) {
    measure_.arc(arc);
    const double high = height_of(*pair_.first, measure_.normal);
    if (!has_ties(measure_.normal, high - measure_.depth)) return false;
    double ends[2][3];
    arc_ends(pair_, arc, ends);
    vertex_at(*pair_.first, pair_.first->edges[arc.edge].vertex[0], mine_);
    return search_arc(arc.edge, ends[0], ends[1]);
  }

  void bound(double depth) { lower_bound_ = depth < lower_bound_ ? depth : lower_bound_; }

  [[nodiscard]] double best() const { return best_; }
  [[nodiscard]] double lower_bound() const { return lower_bound_; }
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] const HullCandidate& winner() const { return winner_; }
  [[nodiscard]] const double* normal() const { return normal_; }

 private:
  static constexpr int kMaxParts = 16;

  /// Part of an arc between two directions, and the supporting vertices of the second there.
  struct ArcPart {
    double end[2][3];
    std::uint32_t vertex[2];
  };

  /// `least`: the height of the second's lowest vertices along the face's normal.
  [[gnu::noinline]] bool search_arcs(std::uint32_t face, double least) {
    const HullShape& hull = *pair_.first;
    const double* normal = hull.faces[face].normal.data();
    double local[3];
    against(normal, local);
    double tied[3];
    const double height = dot3(normal, pair_.shift) - least;
    middle_from(*pair_.second, local, height - kDoubleError * pair_.size, tied);
    double middle[3];
    turn3(pair_.turn, tied, middle);
    for (int k = 0; k < 3; ++k) middle[k] += pair_.shift[k];
    for (std::uint32_t i = 0; i < hull.faces[face].count; ++i) {
      const std::uint32_t edge = hull.loop_edge[hull.faces[face].first + i];
      const std::uint32_t* sides = hull.edges[edge].face;
      const std::uint32_t other = sides[0] == face ? sides[1] : sides[0];
      vertex_at(hull, hull.edges[edge].vertex[0], mine_);
      if (bounds_arc(middle, normal, hull.faces[other].normal.data())) continue;
      if (!search_arc(edge, normal, hull.faces[other].normal.data())) return false;
    }
    return true;
  }

  /// True if several vertices are within float's errors of the lowest, whose height is `least`.
  [[nodiscard]] bool has_ties(const double* normal, double least) const {
    const double doubt = 4.0 * static_cast<double>(kFloatError) * pair_.size;
    double local[3];
    against(normal, local);
    std::uint32_t vertex = 0;
    const double height = dot3(normal, pair_.shift) - least;
    return !sole_vertex_from(*pair_.second, local, height - doubt, vertex);
  }

  /// The vertex of the second that is farthest against a direction.
  [[nodiscard]] std::uint32_t nearest(const double* direction) const {
    double local[3];
    against(direction, local);
    return highest_vertex<double>(*pair_.second, {local[0], local[1], local[2]});
  }

  /// The opposite direction, in the second's frame.
  void against(const double* direction, double* local) const {
    turn_back3(pair_.turn, direction, local);
    for (int k = 0; k < 3; ++k) local[k] = -local[k];
  }

  bool search_arc(std::uint32_t edge, const double* from, const double* to) {
    const std::uint32_t last = nearest(to);
    double theirs[3];
    second_vertex_at(pair_, last, theirs);
    if (bounds_arc(theirs, from, to)) return true;
    const double* ends[2] = {from, to};
    ArcPart stack[kMaxParts];
    for (int i = 0; i < 2; ++i) {
      for (int k = 0; k < 3; ++k) stack[0].end[i][k] = ends[i][k];
    }
    stack[0].vertex[0] = nearest(from);
    stack[0].vertex[1] = last;
    int height = 1;
    for (int tested = 0; height > 0; ++tested) {
      if (tested == kMaxParts || height + 1 >= kMaxParts) return false;
      const ArcPart part = stack[--height];
      bound_part(edge, part, stack, height);
    }
    return true;
  }

  /// Bounds an arc by one point of the second if at both ends that point is at least as deep as the
  /// best: its height is concave in between.
  bool bounds_arc(const double* point, const double* from, const double* to) {
    double w[3];
    for (int k = 0; k < 3; ++k) w[k] = mine_[k] - point[k];
    const double here = dot3(from, w) / __builtin_sqrt(dot3(from, from));
    const double there = dot3(to, w) / __builtin_sqrt(dot3(to, to));
    const double height = (here < there ? here : there) + kDoubleError * pair_.size;
    if (!(height >= best_)) return false;
    bound(height);
    return true;
  }

  /// Bounds a part of an arc, or pushes its halves on the stack if a third vertex is nearer.
  void bound_part(std::uint32_t edge, const ArcPart& part, ArcPart* stack, int& height) {
    double w[2][3];
    for (int i = 0; i < 2; ++i) {
      double theirs[3];
      second_vertex_at(pair_, part.vertex[i], theirs);
      for (int k = 0; k < 3; ++k) w[i][k] = mine_[k] - theirs[k];
    }
    const double rounding = kDoubleError * pair_.size;
    // With a single vertex, the height is lowest at an end.
    if (part.vertex[0] == part.vertex[1]) {
      for (const double(&end)[3] : part.end) {
        bound(dot3(end, w[0]) / __builtin_sqrt(dot3(end, end)) + rounding);
      }
      return;
    }
    measure_.crossing(part.end, w);
    measure_.bound_ends(part.end, w);
    if (measure_.lower_bound + rounding >= best_) return;
    const double* normal = measure_.normal;
    std::uint32_t third = nearest(normal);
    if (measure_.depth < best_) keep(edge, part);
    if (measure_.depth - measure_.lower_bound <= rounding || third == part.vertex[0] ||
        third == part.vertex[1]) {
      return bound(measure_.lower_bound);
    }
    ArcPart halves[2] = {part, part};
    for (int k = 0; k < 3; ++k) halves[0].end[1][k] = halves[1].end[0][k] = normal[k];
    halves[0].vertex[1] = third;
    halves[1].vertex[0] = third;
    stack[height++] = halves[0];
    stack[height++] = halves[1];
  }

  void keep(std::uint32_t edge, const ArcPart& part) {
    found_ = true;
    best_ = measure_.depth;
    for (int k = 0; k < 3; ++k) normal_[k] = measure_.normal[k];
    winner_.kind = HullCandidate::Kind::arc;
    winner_.arc.edge = edge;
    winner_.arc.vertex[0] = part.vertex[0];
    winner_.arc.vertex[1] = part.vertex[1];
  }

  const HullPair& pair_;
  HullMeasure measure_;
  double best_;
  double lower_bound_;
  bool found_ = false;
  double normal_[3];
  HullCandidate winner_ = {};
  /// A vertex of the first on the edge of the arc.
  double mine_[3];
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
