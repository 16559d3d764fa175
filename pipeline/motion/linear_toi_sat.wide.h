#pragma once

// The first sample of pairs that do not rotate, by the separating axis test (SAT). If two convex
// polyhedra are disjoint, they are separated along the normal of a face or along the cross product
// of two edges, one of each polyhedron (Gottschalk, Lin, Manocha, "OBBTree", 1996). The gap along
// each of these directions changes linearly. The last gap to close closes at the time of impact; if
// another gap opens before, there is no impact. Round shapes can touch along other directions, too.
// For them the last gap to close only proves that they are apart before, because a gap along any
// direction separates the shapes. impact_lanes.kernel.cpp runs this step; linear_toi_gjk.wide.h
// continues.

#include "pipeline/motion/closed_forms.wide.h"
#include "pipeline/motion/impact_block.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// Pairs of kinds (in the solver's order) for which this step saves time.
[[nodiscard]] constexpr bool has_start(ShapeKind a, ShapeKind b) {
  const auto has_edges = [](ShapeKind kind) {
    return kind == ShapeKind::box || kind == ShapeKind::triangle || kind == ShapeKind::capsule ||
           kind == ShapeKind::cylinder;
  };
  if (has_closed_form(a, b)) return false;
  return (has_edges(a) && has_edges(b)) || (a == ShapeKind::box && b == ShapeKind::cone);
}

/// Calls visit(KindLanes<Shape>) for a kind that has directions of faces and edges. No pair with
/// another kind has a start.
template <typename Visit>
[[gnu::always_inline]] inline decltype(auto) with_axes_of(ShapeKind kind, Visit&& visit) {
  return with_core(
      kind, [&](auto core) __attribute__((always_inline))->decltype(auto) {
        if constexpr (requires { &decltype(core)::axes; }) {
          return visit(core);
        } else {
          return visit(KindLanes<BoxShape>{});
        }
      });
}

/// A placed core and its directions.
struct AxisCore : CoreAxes {
  const CoreTable& table;
  const MovingCore& core;

  AxisCore(const CoreTable& of_table, const MovingCore& of_core) : table(of_table), core(of_core) {
    with_axes_of(table.kind, [&](auto kind) { kind.axes(core, *this); });
  }

  /// Support along a direction and its opposite, from the centre.
  [[gnu::always_inline]] void reach(const Vector& n, Doubles& high, Doubles& low) const {
    with_axes_of(
        table.kind, [&](auto kind)
                        __attribute__((always_inline)) { kind.range(core, n, high, low); });
  }

  /// The point of the core nearest to `p`, both relative to its centre.
  [[nodiscard]] Vector nearest(const Vector& p) const {
    return with_axes_of(table.kind, [&](auto kind) {
      if constexpr (requires { kind.nearest_placed(core, p); }) {
        return kind.nearest_placed(core, p);
      } else {
        return core.axes.to_world(kind.nearest(core, core.axes.to_local(p)));
      }
    });
  }
};

/// A gap along a direction and its rate of change, both multiplied by the direction's length.
struct ChangingGap {
  Vector along;
  Doubles gap;
  Doubles rate;
};

/// The directions of faces and edges along which two cores may first touch.
class SeparatingAxes {
 public:
  SeparatingAxes(const AxisCore& a, const AxisCore& b, const Vector& between, const PairLanes& p)
      : a_(a),
        b_(b),
        between_(between),
        travel_(p.travel),
        roundings_(p.roundings),
        is_rounded_(bits(p.roundings > Doubles(0.0)) != 0) {
    const Doubles zero(0.0);
    closing = {zero_vector(), zero, Doubles(1.0)};
    opening = {zero_vector(), Doubles(-1.0), zero};
    edge_a = edge_b = zero_vector();
    is_face_of_a = is_of_edges = zero > zero;
    for (int i = 0; i < a.normals; ++i) is_face_of_a = is_face_of_a | closes_last(a.normal[i]);
    for (int i = 0; i < b.normals; ++i) is_face_of_a = is_face_of_a & !closes_last(b.normal[i]);
    for (int i = 0; i < a.edges; ++i) {
      for (int k = 0; k < b.edges; ++k) {
        const DoubleMask last = closes_last(cross(a.edge[i], b.edge[k]));
        is_of_edges = is_of_edges | last;
        edge_a = select(last, a.edge[i], edge_a);
        edge_b = select(last, b.edge[k], edge_b);
      }
    }
  }

  /// The lanes in which a gap opens before the last of the others has closed.
  [[nodiscard]] DoubleMask pass() const {
    return opening.gap * closing.rate + closing.gap * opening.rate > Doubles(0.0);
  }

  /// The gap that closes last among open gaps, and the gap that opens first. Initially: a gap of 0
  /// that closes, and a closed gap that does not change.
  ChangingGap closing;
  ChangingGap opening;
  /// The direction of the gap that closes last is the normal of a face of a. Valid if is_of_edges
  /// is false.
  DoubleMask is_face_of_a;
  /// The direction of the gap that closes last is the cross product of edge_a and edge_b.
  DoubleMask is_of_edges;
  Vector edge_a;
  Vector edge_b;

 private:
  /// Tests both senses of a direction: in one the gap closes, in the other it opens. Returns the
  /// lanes in which the gap closes later than all gaps tested before.
  [[gnu::always_inline]] DoubleMask closes_last(const Vector& n) {
    Doubles high_a;
    Doubles low_a;
    Doubles high_b;
    Doubles low_b;
    a_.reach(n, high_a, low_a);
    b_.reach(n, high_b, low_b);
    const Doubles rounding = is_rounded_ ? roundings_ * length(n) : Doubles(0.0);
    const Doubles between = dot(n, between_);
    const Doubles ahead = between + low_b - high_a - rounding;
    const Doubles behind = low_a - high_b - between - rounding;
    const Doubles speed = dot(n, travel_);
    const DoubleMask comes = speed < Doubles(0.0);
    const Doubles rate = abs(speed);
    const ChangingGap closes{select(comes, n, -n), select(comes, ahead, behind), rate};
    const ChangingGap opens{select(comes, -n, n), select(comes, behind, ahead), rate};
    take(opens.gap * opening.rate > opening.gap * rate, opens, opening);
    const DoubleMask last = closes.gap * closing.rate > closing.gap * rate;
    take(last, closes, closing);
    return last;
  }
  [[gnu::always_inline]] static void take(const DoubleMask& where, const ChangingGap& gap,
                                          ChangingGap& kept) {
    kept.along = select(where, gap.along, kept.along);
    kept.gap = select(where, gap.gap, kept.gap);
    kept.rate = select(where, gap.rate, kept.rate);
  }

  const AxisCore& a_;
  const AxisCore& b_;
  const Vector& between_;
  const Vector& travel_;
  const Doubles& roundings_;
  bool is_rounded_;
};

/// The first step of a block. Lanes that it does not end continue at the time to which it has
/// advanced them.
class LinearToiSat : BlockStep {
 public:
  LinearToiSat(const ImpactJob& job, ImpactBlock& block)
      : BlockStep(job, block), a_(tables_.a, p_.a), b_(tables_.b, p_.b) {}

  /// Returns the lanes that continue.
  [[nodiscard]] Mask16 run() {
    sample_.between = p_.start + p_.travel * p_.time;
    const SeparatingAxes axes(a_, b_, sample_.between, p_);
    const DoubleMask closes = active_ & (axes.closing.gap > Doubles(0.0));
    try_along(axes.closing.along);
    apart_ = closes & sample_.parted;
    move_on();
    if (bits(active_ & axes.pass()) != 0) part(axes);
    if (bits(active_ & apart_) != 0) touch(axes);
    return continuing_lanes();
  }

 private:
  /// Samples the gap along a direction.
  void try_along(const Vector& direction) {
    const CorePair pair{tables_.a, tables_.b, p_.a, p_.b, sample_.between};
    Vector own_a;
    Vector own_b;
    pair.facing(direction, bits(active_), own_a, own_b);
    ClosestLanes& closest = sample_.closest;
    closest.on_a = pair.on_a(own_a);
    closest.on_b = pair.on_b(own_b);
    closest.axis = direction * (Doubles(1.0) / length(direction));
    sample_.slope = dot(closest.axis, p_.travel);
    judge();
  }
  /// Recomputes the gap at the current time.
  void judge() {
    ClosestLanes& closest = sample_.closest;
    sample_.noise = noise_at(sample_.between);
    closest.lower = dot(closest.axis, sample_.between + closest.on_b - closest.on_a);
    sample_.gap = closest.lower - p_.roundings - sample_.noise;
    sample_.parted = sample_.gap > Doubles(0.0);
  }

  /// Advances the lanes to the time at which the tested direction no longer shows a gap.
  void move_on() {
    const Doubles free = free_along(p_, sample_);
    end_apart(apart_ & ((free >= p_.last) | (free > p_.until)));
    const DoubleMask far = sample_.gap > p_.tolerance * Doubles(kNearEnough);
    p_.axis = select(active_ & apart_, sample_.closest.axis, p_.axis);
    p_.time = select(active_ & apart_ & far, free, p_.time);
    sample_.between = p_.start + p_.travel * p_.time;
  }

  /// Ends lanes that are separated from now on along the direction that opens.
  void part(const SeparatingAxes& axes) {
    const SampleLanes closing = sample_;
    try_along(axes.opening.along);
    end_apart(axes.pass() & sample_.parted & (sample_.slope >= Doubles(0.0)));
    sample_ = closing;
  }

  /// Ends lanes in which points near the expected contact are within the tolerance.
  void touch(const SeparatingAxes& axes) {
    judge();
    ClosestLanes& closest = sample_.closest;
    find_points(place_of(axes), active_);
    // If faces or edges are parallel, the first corner may not be opposite the other shape.
    const DoubleMask again = active_ & apart_ & !is_near();
    if (bits(again) != 0) find_points(closest.on_a + closest.between, again);
    const DoubleMask will_touch = sample_.gap + sample_.slope * (p_.last - p_.time) <= Doubles(0.0);
    const DoubleMask hit = active_ & apart_ & sample_.parted & is_near() & will_touch;
    answers_.put_impact(bits(hit), p_, sample_);
    active_ = active_ & !hit;
    p_.axis = select(active_ & apart_ & (closest.upper > Doubles(0.0)), closest.between, p_.axis);
  }

  /// The expected contact, relative to the centre of a: a corner that touches a face, or the
  /// crossing of two edges.
  [[nodiscard]] Vector place_of(const SeparatingAxes& axes) const {
    const ClosestLanes& closest = sample_.closest;
    const Vector corner_b = sample_.between + closest.on_b;
    const Vector way = corner_b - closest.on_a;
    const Doubles mixed = dot(axes.edge_a, axes.edge_b);
    const Doubles square = dot(axes.edge_b, axes.edge_b);
    const Doubles area = dot(axes.edge_a, axes.edge_a) * square - mixed * mixed;
    const Doubles share = (dot(axes.edge_a, way) * square - mixed * dot(axes.edge_b, way)) /
                          select(area > Doubles(0.0), area, Doubles(1.0));
    const Vector on_edge = closest.on_a + axes.edge_a * share;
    return select(axes.is_of_edges, on_edge, select(axes.is_face_of_a, corner_b, closest.on_a));
  }

  /// In `lanes`, sets the point of a that is closest to `place`, and the vector from it to the
  /// closest point of b.
  void find_points(const Vector& place, const DoubleMask& lanes) {
    ClosestLanes& closest = sample_.closest;
    const Vector on_a = a_.nearest(place);
    const Vector between = sample_.between + b_.nearest(on_a - sample_.between) - on_a;
    closest.on_a = select(lanes, on_a, closest.on_a);
    closest.between = select(lanes, between, closest.between);
    closest.upper = length(closest.between);
    sample_.most = closest.upper - p_.roundings + sample_.noise;
  }
  [[nodiscard]] DoubleMask is_near() const { return sample_.most <= closed(); }

  AxisCore a_;
  AxisCore b_;
  /// The direction that closes last shows a gap.
  DoubleMask apart_;
};

}  // namespace winnow::WINNOW_ISA_NAME::impact
