#pragma once

// Penetration depth of two cores by the expanding polytope algorithm: a polytope inside their
// Minkowski difference grows at its face nearest to the origin (van den Bergen, "Proximity queries
// and penetration depth computation on 3D game objects", 2001). The nearest face bounds the depth
// from below, the support along its normal from above.
//
// If the difference is smooth, these bounds converge slowly. The search then computes local minima
// that are certain for a range of directions around them (curved_minimum.wide.h), and closes the
// faces that have only such directions near them. It ends when no open face is nearer than the
// smallest minimum. User shapes provide only support points: no range around a minimum is certain
// (curved_tangent.wide.h), and the polytope grows there until it proves the depth.

#include "pipeline/kernels/curved/curved_tangent.wide.h"
#include "simd/lanes/rows.h"

namespace winnow::WINNOW_ISA_NAME::curved {

class CurvedDepth {
 public:
  /// Tolerance of the depth relative to the sizes, and the largest gap that is accepted if the
  /// polytope's storage is full.
  static constexpr double kTolerance = 4e-10;
  static constexpr double kMaxGap = 8e-10;
  /// As above for user shapes, whose curvature is unknown. Relative to the measured extent of the
  /// difference, since the radius that the user gives may be far larger.
  static constexpr double kUserTolerance = 3.5e-7;
  static constexpr double kUserMaxGap = 3.8e-7;

  /// Starts from the four points around the origin that the search found; returns false if the
  /// polytope outgrows its storage or is too flat.
  bool find(const CurvedPair& pair) {
    pair_ = &pair;
    has_user_shape_ = has_user_shape(pair);
    points_ = 0;
    faces_ = 0;
    for (int i = 0; i < 4; ++i) add_point(pair.difference[i], pair.on_first[i]);
    reach_ = reach_of_points();
    tolerance_ = has_user_shape_ ? kUserTolerance * reach_ : kTolerance;
    if (!begin()) return false;
    minima_ = 0;
    best_height_ = __builtin_inf();
    sure_ = __builtin_inf();
    is_minimum_ = false;
    next_try_ = kFirstTry;
    leads_ = true;
    nearest_ = find_nearest();
    for (;;) {
      face_ = nearest_;
      lower_ = open_[face_];
      if (lower_ >= best_height_ - tolerance_) return end_in_minimum();
      if (is_closed(face_)) {
        open_[face_] = __builtin_inf();
        nearest_ = find_nearest();
        continue;
      }
      if (!has_user_shape_ || !measure_nearer_to_best()) {
        const FaceOutcome outcome = test_face();
        if (outcome == FaceOutcome::again) continue;
        if (outcome != FaceOutcome::grows) return outcome == FaceOutcome::proves;
      }
      if (points_ == kMaxFacePoints)
        return end_full(has_user_shape_ ? kUserMaxGap * reach_ : kMaxGap);
      if (!grow(add_point(growth_.w, growth_.mine))) return false;
    }
  }

  /// Bounds of the depth, after `find` has returned true.
  [[nodiscard]] double upper() const { return upper_; }
  [[nodiscard]] double lower() const { return lower_; }

  /// The unit direction of least depth, from the first to the second, and the point of the first
  /// that touches the second after the second is moved out. Returns false if the foot of the origin
  /// is not in the nearest face: the point is then unknown.
  bool answer(double* direction, double* point) const {
    if (is_minimum_) {
      for (int k = 0; k < 3; ++k) {
        direction[k] = best_normal_[k];
        point[k] = best_point_[k];
      }
      return true;
    }
    double weight[3];
    if (!(foot_weights(face_, weight) >= kInside)) return false;
    for (int k = 0; k < 3; ++k) {
      direction[k] = normal_[k][face_];
      point[k] = 0.0;
      for (int i = 0; i < 3; ++i) point[k] += weight[i] * mine_[vertex_[face_][i]][k];
    }
    return true;
  }

 private:
  static constexpr std::uint32_t kWidth = Doubles::kCount;
  /// A minimum is searched for when the gap between the bounds, relative to the upper one, is below
  /// kFirstTry; this limit is multiplied by kTryFactor each time.
  static constexpr double kFirstTry = 0.2;
  static constexpr double kTryFactor = 0.2;
  /// Tangents of the widest and the narrowest angle around a minimum within which it is tested to
  /// be certain, and the rounding error of cosines.
  static constexpr double kWidest = 1.0;
  static constexpr double kNarrowest = 0x1p-6;
  static constexpr double kCosineRounding = 1e-12;
  /// Less than any cosine.
  static constexpr double kAllAround = -2.0;
  /// Directions with a larger cosine usually lead to the same minimum.
  static constexpr double kSameMinimum = 0.9;
  /// When growing near the best minimum: the direction is this fraction of the way from that
  /// minimum's normal to the face's normal, and the new point must be above the face by at least
  /// this fraction of the tolerance.
  static constexpr double kNearerShare = 0.7;
  static constexpr double kNearerRise = 0.1;
  static constexpr std::uint32_t kMaxMinima = 8;
  static constexpr std::uint32_t kMaxFacePoints = 128;
  /// A polytope of p points has 2 p - 4 faces.
  static constexpr std::uint32_t kMaxFaces = 2 * kMaxFacePoints;
  /// The largest number of visible faces. `grow` writes all their sides, also those that it then
  /// overwrites.
  static constexpr std::uint32_t kMaxVisible = 30;
  static constexpr std::uint32_t kMaxSides = 3 * kMaxVisible + 1;
  /// A face is visible from a point above its plane, or below it by at most this.
  static constexpr double kLevel = 1e-15;
  /// The foot of the origin counts as inside a face if no barycentric weight is below this.
  static constexpr double kInside = -1e-7;

  /// The outcome of testing the nearest face.
  enum class FaceOutcome : std::uint8_t { grows, again, proves, fails };

  /// Determines the point by which the polytope grows at the nearest face, unless the face proves
  /// the depth or becomes closed.
  FaceOutcome test_face() {
    measure();
    // If several faces are coplanar, use the one that contains the foot of the origin.
    if (upper_ - lower_ <= tolerance_) {
      turn_to_foot();
      measure();
      if (upper_ - lower_ <= tolerance_) {
        if (has_foot()) return FaceOutcome::proves;
        return find_minimum() ? FaceOutcome::again : FaceOutcome::fails;
      }
    }
    if (leads_ && upper_ - lower_ <= next_try_ * upper_) {
      const bool has_minimum = find_minimum();
      if (has_minimum && is_closed(face_)) return FaceOutcome::again;
      if (has_user_shape_) leads_ = find_tangent_minimum() || has_minimum;
      next_try_ *= kTryFactor;
    }
    return FaceOutcome::grows;
  }

  /// A point of the difference, and the first's point in it.
  struct DifferencePoint {
    double w[3];
    double mine[3];
  };

  std::uint32_t add_point(const double* w, const double* mine) {
    for (int k = 0; k < 3; ++k) {
      point_[points_][k] = w[k];
      mine_[points_][k] = mine[k];
    }
    point_[points_][3] = 0.0;
    return points_++;
  }

  /// Half of the largest distance of the first four points: at most the extent of the difference.
  [[nodiscard]] double reach_of_points() const {
    double square = 0.0;
    for (int i = 1; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        const double e[3] = {point_[i][0] - point_[j][0], point_[i][1] - point_[j][1],
                             point_[i][2] - point_[j][2]};
        square = largest_of(square, dot3(e, e));
      }
    }
    return 0.5 * __builtin_sqrt(square);
  }

  [[nodiscard]] double dot_normal(std::uint32_t face, const double* x) const {
    return normal_[0][face] * x[0] + normal_[1][face] * x[1] + normal_[2][face] * x[2];
  }

  /// Sets the upper bound to the support along the face's normal, and stores that support point.
  void measure() {
    const double n[3] = {normal_[0][face_], normal_[1][face_], normal_[2][face_]};
    difference_point(*pair_, n, growth_.w, growth_.mine);
    upper_ = dot_normal(face_, growth_.w);
  }

  /// Computes a support point along a direction between the normals of the face and of the best
  /// minimum: the polytope then needs fewer points there. Returns false if these normals are not
  /// close (kSameMinimum), or if the point is not above the face by kNearerRise of the tolerance.
  bool measure_nearer_to_best() {
    if (!(best_height_ < __builtin_inf())) return false;
    const double n[3] = {normal_[0][face_], normal_[1][face_], normal_[2][face_]};
    if (!(dot3(n, best_normal_) > kSameMinimum)) return false;
    double m[3];
    for (int k = 0; k < 3; ++k) {
      m[k] = best_normal_[k] + kNearerShare * (n[k] - best_normal_[k]);
    }
    difference_point(*pair_, m, growth_.w, growth_.mine);
    upper_ = best_height_;
    return dot3(n, growth_.w) - lower_ > kNearerRise * tolerance_;
  }

  /// Identifies an edge of a face: four times the face's number plus the edge's.
  static std::uint32_t edge_of(std::uint32_t face, std::uint32_t edge) { return 4 * face + edge; }

  /// The base of a new face: an edge from p to q, the edge of the face across it, and the new
  /// face's number.
  struct BaseEdge {
    std::uint32_t p;
    std::uint32_t q;
    std::uint32_t across;
    std::uint32_t face;
  };

  /// Makes the tetrahedron of the first four points: one face, and its three sides joined to the
  /// fourth point.
  bool begin() {
    double e[3][3];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) e[i][k] = point_[i + 1][k] - point_[0][k];
    }
    double n[3];
    cross3(e[0], e[1], n);
    // The first face is counter-clockwise seen from outside if the fourth point is behind it.
    const bool turned = dot3(n, e[2]) > 0.0;
    const std::uint32_t corner[3] = {0, turned ? 2U : 1U, turned ? 1U : 2U};
    const BaseEdge base{corner[0], corner[1], 0, add_slot()};
    if (!set_faces(&base, 1, corner[2])) return false;
    BaseEdge side[3];
    for (std::uint32_t i = 0; i < 3; ++i) {
      side[i] = {corner[(i + 1) % 3], corner[i], edge_of(base.face, i), add_slot()};
    }
    return set_faces(side, 3, 3) && join(side, 3);
  }

  /// Returns the number of a new face.
  std::uint32_t add_slot() {
    if (faces_ % kWidth == 0) {
      Doubles(__builtin_inf()).store(distance_ + faces_);
      Doubles(__builtin_inf()).store(open_ + faces_);
    }
    visible_from_[faces_] = 0;
    return faces_++;
  }

  /// Makes the faces that join sides to a point; returns false if one has no normal or the origin
  /// is above it.
  bool set_faces(const BaseEdge* side, std::uint32_t count, std::uint32_t to) {
    const double* w = point_[to];
    for (std::uint32_t begin = 0; begin < count; begin += kWidth) {
      const std::uint32_t left = count - begin;
      const std::uint32_t batch = left < kWidth ? left : kWidth;
      const auto of_lane = [&](int lane) -> const BaseEdge& {
        const auto i = static_cast<std::uint32_t>(lane);
        return side[begin + (i < batch ? i : 0)];
      };
      const auto start = [&](int lane) { return point_[of_lane(lane).p]; };
      Doubles from[4];
      Doubles way[4];
      load_rows4(start, from);
      load_differences4([&](int lane) { return point_[of_lane(lane).q]; }, start, way);
      const Vec3<double> p{from[0], from[1], from[2]};
      const Vec3<double> e{way[0], way[1], way[2]};
      const Vec3<double> g = Vec3<double>{w[0], w[1], w[2]} - p;
      const Vec3<double> n = cross(e, g);
      const Doubles square = dot(n, n);
      const Vec3<double> unit = n * (Doubles(1.0) / sqrt(square));
      const Doubles distance = dot(unit, p);
      const LaneMask<double> good =
          (square > Doubles(1e-26) * dot(e, e) * dot(g, g)) & (distance > Doubles(-kLevel));
      if ((~bits(good) & lanes_below(batch)) != 0) return false;
      alignas(64) double plane[4][kWidth];
      unit.x.store(plane[0]);
      unit.y.store(plane[1]);
      unit.z.store(plane[2]);
      distance.store(plane[3]);
      for (std::uint32_t i = 0; i < batch; ++i) {
        const BaseEdge& s = side[begin + i];
        for (int k = 0; k < 3; ++k) normal_[k][s.face] = plane[k][i];
        distance_[s.face] = plane[3][i];
        open_[s.face] = plane[3][i];
        offer_nearest(plane[3][i], s.face);
        vertex_[s.face][0] = s.p;
        vertex_[s.face][1] = s.q;
        vertex_[s.face][2] = to;
      }
    }
    return true;
  }

  /// Connects the new faces with each other and with the faces across. Returns false unless the
  /// sides form rings, in which at each corner one side ends and one begins.
  bool join(const BaseEdge* side, std::uint32_t count) {
    std::uint64_t begins[kMaxFacePoints / 64] = {};
    std::uint64_t ends[kMaxFacePoints / 64] = {};
    for (std::uint32_t i = 0; i < count; ++i) {
      begins[side[i].p / 64] |= std::uint64_t{1} << side[i].p % 64;
      ends[side[i].q / 64] |= std::uint64_t{1} << side[i].q % 64;
      from_[side[i].p] = side[i].face;
      into_[side[i].q] = side[i].face;
    }
    int corners = 0;
    for (std::uint32_t word = 0; word < kMaxFacePoints / 64; ++word) {
      if (begins[word] != ends[word]) return false;
      corners += __builtin_popcountll(begins[word]);
    }
    if (static_cast<std::uint32_t>(corners) != count) return false;
    for (std::uint32_t i = 0; i < count; ++i) {
      const BaseEdge& s = side[i];
      across_[s.face][0] = s.across;
      across_[s.across / 4][s.across % 4] = edge_of(s.face, 0);
      across_[s.face][1] = edge_of(from_[s.q], 2);
      across_[s.face][2] = edge_of(into_[s.p], 1);
    }
    return true;
  }

  bool end_in_minimum() {
    is_minimum_ = true;
    upper_ = best_height_;
    lower_ = lower_ < sure_ ? lower_ : sure_;
    return true;
  }

  bool end_full(double doubt) {
    return best_height_ - lower_ <= doubt ? end_in_minimum() : upper_ - lower_ <= doubt;
  }

  /// Searches for a local minimum near the nearest face and keeps it; returns false if there is
  /// none.
  bool find_minimum() {
    if (minima_ == kMaxMinima) return false;
    const double* corner[3];
    const double* mine[3];
    for (int i = 0; i < 3; ++i) {
      corner[i] = point_[vertex_[face_][i]];
      mine[i] = mine_[vertex_[face_][i]];
    }
    const double near[3] = {normal_[0][face_], normal_[1][face_], normal_[2][face_]};
    LocalMinimum found;
    if (!found.find(*pair_, corner, mine, near)) return false;
    double w[3];
    double on_first[3];
    difference_point(*pair_, found.normal(), w, on_first);
    const double height = dot3(found.normal(), w);
    const double least = found.ball_lower_bound();
    if (height - least <= tolerance_) {
      keep(found, kAllAround, height, least);
      return true;
    }
    double tangent = kWidest;
    while (!found.is_least_within(tangent)) {
      tangent *= 0.5;
      if (tangent < kNarrowest) return false;
    }
    const double sure = found.height() - found.miss() * tangent;
    if (!(height - sure <= tolerance_)) return false;
    const double cosine = 1.0 / __builtin_sqrt(1.0 + tangent * tangent) + kCosineRounding;
    keep(found, cosine, height, sure);
    return true;
  }

  void keep(const LocalMinimum& found, double cosine, double height, double sure) {
    for (int k = 0; k < 3; ++k) sure_around_[minima_][k] = found.normal()[k];
    sure_cosine_[minima_] = cosine;
    ++minima_;
    sure_ = sure < sure_ ? sure : sure_;
    double point[3];
    found.write_point(point);
    offer(found.normal(), point, height);
  }

  void offer(const double* normal, const double* point, double height) {
    if (!(height < best_height_)) return;
    best_height_ = height;
    for (int k = 0; k < 3; ++k) {
      best_normal_[k] = normal[k];
      best_point_[k] = point[k];
    }
  }

  /// Searches near the nearest face for a minimum below the best so far, without a range in which
  /// it is certain. If the point of the minimum is above the face, the polytope grows by this point
  /// instead. Returns false if no such minimum is found. Does not search if the face's normal is
  /// close to that of the best minimum.
  bool find_tangent_minimum() {
    const double near[3] = {normal_[0][face_], normal_[1][face_], normal_[2][face_]};
    if (best_height_ < __builtin_inf() && dot3(near, best_normal_) > kSameMinimum) return true;
    TangentMinimum found;
    if (!found.find(*pair_, near, reach_)) return false;
    if (!(found.height() < best_height_ - tolerance_)) return false;
    offer(found.normal(), found.point(), found.height());
    if (!(dot_normal(face_, found.difference()) > distance_[face_] + kLevel)) return true;
    for (int k = 0; k < 3; ++k) {
      growth_.w[k] = found.difference()[k];
      growth_.mine[k] = found.point()[k];
    }
    return true;
  }

  /// True if all points of a face that are nearer than the smallest minimum have directions in
  /// which one of the minima is certain. These points are around the foot of the origin in the
  /// face.
  [[nodiscard]] bool is_closed(std::uint32_t face) const {
    const double around = distance_[face] / best_height_;
    for (std::uint32_t i = 0; i < minima_; ++i) {
      const double to_foot = dot_normal(face, sure_around_[i]);
      const double squares = (1.0 - to_foot * to_foot) * (1.0 - around * around);
      const double sines = squares > 0.0 ? __builtin_sqrt(squares) : 0.0;
      if (to_foot * around - sines >= sure_cosine_[i]) return true;
    }
    return false;
  }

  /// Reduction over the open distances of faces, row by row in lanes: the nearest of each lane, and
  /// the first face of its row.
  struct NearestInLanes {
    Doubles least{__builtin_inf()};
    Doubles row{0.0};

    [[gnu::always_inline]] void add(const Doubles& open, std::uint32_t first_face) {
      const LaneMask<double> nearer = open < least;
      least = select(nearer, open, least);
      row = select(nearer, Doubles(static_cast<double>(first_face)), row);
    }
  };

  /// Returns the first of the nearest open faces.
  [[nodiscard]] std::uint32_t find_nearest() {
    NearestInLanes nearest;
    for (std::uint32_t row = 0; row < faces_; row += kWidth) {
      nearest.add(Doubles::load(open_ + row), row);
    }
    take_nearest(nearest);
    return nearest_;
  }
  void take_nearest(const NearestInLanes& nearest) {
    nearest_open_ = -hull::largest_lane(-nearest.least);
    alignas(64) double row[kWidth];
    nearest.row.store(row);
    nearest_ = kMaxFaces;
    for (Mask16 at = bits(nearest.least == Doubles(nearest_open_)); at != 0; at &= at - 1) {
      const std::uint32_t lane = first(at);
      const std::uint32_t face = static_cast<std::uint32_t>(row[lane]) + lane;
      nearest_ = face < nearest_ ? face : nearest_;
    }
  }
  /// Offers a face that was written after the reduction; reading it back in lanes would stall on
  /// its stores.
  [[gnu::always_inline]] void offer_nearest(double distance, std::uint32_t face) {
    const bool nearer = distance < nearest_open_ || (distance == nearest_open_ && face < nearest_);
    nearest_open_ = nearer ? distance : nearest_open_;
    nearest_ = nearer ? face : nearest_;
  }

  /// Removes the faces visible from the new point, the nearest face among them, and joins the point
  /// to their outline. The outline has two sides more than the number of faces removed, minus two
  /// for each point inside it; such a point is level with the new one and its neighbours.
  bool grow(std::uint32_t to) {
    const std::uint32_t count = find_visible(to);
    if (count == 0) return false;
    BaseEdge side[kMaxSides];
    std::uint32_t sides = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t f = visible_[i];
      for (std::uint32_t e = 0; e < 3; ++e) {
        // Branchless: the branch would be mispredicted.
        side[sides] = {vertex_[f][e], vertex_[f][e == 2 ? 0 : e + 1], across_[f][e], 0};
        sides += visible_from_[across_[f][e] / 4] != to ? 1U : 0U;
      }
    }
    if (sides < 3 || sides > count + 2 || faces_ + 2 > kMaxFaces) return false;
    for (std::uint32_t i = 0; i < sides; ++i) side[i].face = i < count ? visible_[i] : add_slot();
    for (std::uint32_t i = sides; i < count; ++i) close_slot(visible_[i]);
    return set_faces(side, sides, to) && join(side, sides) &&
           (sides == count + 2 || is_one_ring(side, sides));
  }

  /// Marks a slot as unused.
  void close_slot(std::uint32_t face) {
    distance_[face] = __builtin_inf();
    open_[face] = __builtin_inf();
  }

  /// True if the connected sides form a single ring.
  bool is_one_ring(const BaseEdge* side, std::uint32_t count) const {
    std::uint32_t face = side[0].face;
    for (std::uint32_t i = 1; i < count; ++i) {
      face = across_[face][1] / 4;
      if (face == side[0].face) return false;
    }
    return true;
  }

  /// Lists the faces visible from a point, and the nearest face; returns their number, or 0 if
  /// there are too many.
  std::uint32_t find_visible(std::uint32_t by) {
    const double* w = point_[by];
    const Vec3<double> x{w[0], w[1], w[2]};
    const Doubles level(kLevel);
    alignas(64) static constexpr double kNumber[kWidth] = {0, 1, 2, 3, 4, 5, 6, 7};
    const Doubles number = Doubles::load(kNumber);
    const Doubles near(static_cast<double>(face_));
    NearestInLanes left;
    std::uint32_t count = 0;
    for (std::uint32_t row = 0; row < faces_; row += kWidth) {
      const Vec3<double> n{Doubles::load(normal_[0] + row), Doubles::load(normal_[1] + row),
                           Doubles::load(normal_[2] + row)};
      const LaneMask<double> goes = (dot(n, x) + level > Doubles::load(distance_ + row)) |
                                    (number + Doubles(static_cast<double>(row)) == near);
      left.add(select(goes, Doubles(__builtin_inf()), Doubles::load(open_ + row)), row);
      for (Mask16 sees = bits(goes); sees != 0; sees &= sees - 1) {
        if (count == kMaxVisible) return 0;
        const std::uint32_t f = row + first(sees);
        visible_from_[f] = by;
        visible_[count++] = f;
      }
    }
    take_nearest(left);
    return count;
  }

  /// Barycentric weights of the foot of the origin in a face, clamped to zero; returns the smallest
  /// weight before clamping.
  double foot_weights(std::uint32_t face, double* weight) const {
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

  [[nodiscard]] bool has_foot() const {
    double weight[3];
    return foot_weights(face_, weight) >= kInside;
  }

  /// If the foot is not in the current face, replaces the face by one that is as near, up to the
  /// gap of the bounds, and contains the foot.
  void turn_to_foot() {
    double weight[3];
    double most = foot_weights(face_, weight);
    if (most >= kInside) return;
    std::uint32_t best = face_;
    for (std::uint32_t f = 0; f < faces_; ++f) {
      if (!(distance_[f] <= upper_ + kLevel)) continue;
      const double here = foot_weights(f, weight);
      if (!(here > most)) continue;
      most = here;
      best = f;
    }
    face_ = best;
  }

  const CurvedPair* pair_ = nullptr;
  bool has_user_shape_ = false;
  /// The relative gap of the bounds below which a minimum is searched for next.
  double next_try_ = 0.0;
  /// True while searches for minima are worthwhile. If the points of user shapes give no minimum at
  /// first, they hardly ever do later, and each attempt takes a dozen support points.
  bool leads_ = true;
  /// The smallest minimum: its normal, the first's point in it, its height. Then a lower bound of
  /// all minima, and for each the direction and the cosine of the angle up to which it is certain.
  double best_normal_[3];
  double best_point_[3];
  double best_height_;
  double sure_;
  std::uint32_t minima_ = 0;
  double sure_around_[kMaxMinima][3];
  double sure_cosine_[kMaxMinima];
  bool is_minimum_ = false;
  /// Lower bound of the extent of the difference, and the tolerance of the depth.
  double reach_ = 0.0;
  double tolerance_ = 0.0;
  /// The point by which the polytope grows next.
  DifferencePoint growth_;
  std::uint32_t points_ = 0;
  std::uint32_t face_ = 0;
  /// The first of the nearest open faces, and its distance.
  std::uint32_t nearest_ = 0;
  double nearest_open_ = 0.0;
  double upper_ = 0.0;
  double lower_ = 0.0;
  /// Padded to four, so that points are loaded as rows of four.
  double point_[kMaxFacePoints][4];
  double mine_[kMaxFacePoints][3];
  /// By point: the new face whose first edge begins there, and the new face whose first edge ends
  /// there.
  std::uint32_t from_[kMaxFacePoints];
  std::uint32_t into_[kMaxFacePoints];
  /// Slots from faces_ to the end of its block of lanes have infinite distances.
  std::uint32_t faces_ = 0;
  std::uint32_t vertex_[kMaxFaces][3];
  /// The edge on the other side of the edge from vertex i to the next.
  std::uint32_t across_[kMaxFaces][3];
  /// The last point that saw a face; 0, which never sees a face, if there is none.
  std::uint32_t visible_from_[kMaxFaces];
  std::uint32_t visible_[kMaxVisible];
  alignas(64) double normal_[3][kMaxFaces] = {};
  alignas(64) double distance_[kMaxFaces];
  /// As distance_, but infinite for closed faces.
  alignas(64) double open_[kMaxFaces];
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
