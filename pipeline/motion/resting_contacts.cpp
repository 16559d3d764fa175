// A direction that separates two parts at the start, and along which their motions do not close the
// gap, proves that they never touch. If a body slides at a contact at the start, the normal of the
// contact is such a direction also for other parts that are flush with the parts in contact, for
// example other triangles of a floor. A search by closest points would prove this for each part
// separately, but fails if the gap is negative or of the size of rounding errors. body_impact.cpp
// calls this.

#include "pipeline/motion/resting_contacts.h"

#include <winnow/pipeline/narrow_phase.h>
#include "pipeline/solver/problem.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace winnow::impact {
namespace {

/// Normals that differ by less are equal up to rounding.
constexpr double kSameNormal = 1e-14;
/// A face is tested as a separating direction if the cosine between its normal and the contact
/// normal has at least this magnitude.
constexpr double kFaceOfContact = 0.99;
/// Exceeds the rounding of a gap, in units of the noise.
constexpr double kRounded = 8.0;

/// Returns a lower bound on the gap during the whole motion, the larger of two: the gap of the
/// swept volumes, and the smaller gap at both ends minus the amount by which the gap can fall below
/// its chord.
[[nodiscard]] double least_gap(MovingPair& pair, const Vec& normal) noexcept {
  pair.place(0.0);
  const double swept = pair.swept_gap(normal);
  const double least = std::min(swept, swept - pair.swept_closing(normal));
  if (pair.has_half_space()) return least;
  // The swept volume may extend far more into the gap than the shape does at any time.
  const double sag = 0.5 * pair.curvature(normal);
  const double first = pair.gap(normal);
  pair.place(1.0);
  const double last = pair.gap(normal);
  const double bent = last - first >= sag ? first : std::min(first, last) - 0.25 * sag;
  return std::max(least, bent);
}

}  // namespace

/// Two parts in the solver's order. `is_there` is false for two half-spaces.
class RestingContacts::OrderedPair {
 public:
  OrderedPair(const ShapeTables& tables, const MovingPart& a, const MovingPart& b) noexcept
      : mirrored_(solver::is_prepared_mirrored(a.shape.kind(), b.shape.kind())),
        shape_{mirrored_ ? b.shape : a.shape, mirrored_ ? a.shape : b.shape},
        pair_(tables, mirrored_ ? b : a, mirrored_ ? a : b) {}

  [[nodiscard]] MovingPair& pair() noexcept { return pair_; }
  [[nodiscard]] bool is_there() const noexcept { return pair_.a().kind != ShapeKind::half_space; }
  /// Converts a normal between the caller's order and the solver's.
  [[nodiscard]] Vec turned(const Vec& normal) const noexcept {
    return mirrored_ ? Vec(-normal) : normal;
  }
  /// Returns false for shapes that the solver rejects.
  [[nodiscard]] bool distance_at_start(const ShapeTables& tables, PairAnswer& answer) noexcept {
    Pose pose[2];
    pair_.poses(0.0, pose[0], pose[1]);
    const NarrowOptions options{.level = ContactLevel::distance};
    return collide(tables, shape_[0], pose[0], shape_[1], pose[1], options, answer) == Status::ok;
  }

 private:
  bool mirrored_;
  ShapeId shape_[2];
  MovingPair pair_;
};

double RestingContacts::tolerance(const MovingPair& pair) const noexcept {
  const solver::Scale scaled(pair.problem().exponent);
  return std::max(share_ * pair.size() + scaled(length_), kRounded * pair.noise());
}

bool RestingContacts::find(const ShapeTables& tables, OrderedPair& ordered,
                           RestingContact& contact) const noexcept {
  MovingPair& pair = ordered.pair();
  PairAnswer answer;
  if (!ordered.is_there() || !ordered.distance_at_start(tables, answer)) return false;
  const solver::Scale scaled(pair.problem().exponent);
  pair.place(0.0);
  if (scaled(answer.distance) > tolerance(pair)) return false;
  const Vec normal = as_eigen(answer.normal);
  Vec best = normal;
  double gap = pair.gap(normal);
  // The direction between nearly coincident points is inaccurate, the normal of a face is not; and
  // faces that are flush share the same normal.
  double least = std::min(gap > 0.0 ? 0.0 : gap, gap - pair.noise());
  for (const solver::Core* const core : {&pair.a(), &pair.b()}) {
    for (std::uint32_t i = 0; i < normal_count(*core); ++i) {
      const Vec face = solver::normal(*core, i);
      const double cosine = face.dot(normal);
      if (std::abs(cosine) < kFaceOfContact) continue;
      const Vec axis = cosine > 0.0 ? face : Vec(-face);
      if (pair.gap(axis) <= least) continue;
      best = axis;
      gap = least = pair.gap(axis);
    }
  }
  contact = {ordered.turned(best), unscaled(pair.problem(), gap + pair.noise()),
             gap > 0.0 && touch_ != StartTouch::impact_unless_sliding};
  return contact.apart || touch_ != StartTouch::impact;
}

void RestingContacts::keep(const RestingContact& contact) noexcept {
  for (RestingContact& known : std::span(contacts_.data(), count_)) {
    if ((known.normal - contact.normal).squaredNorm() > kSameNormal * kSameNormal) continue;
    if (contact.gap < known.gap) known = contact;
    return;
  }
  if (count_ < kMaxContacts) contacts_[count_++] = contact;
}

void RestingContacts::record(const ShapeTables& tables, const MovingPart& a,
                             const MovingPart& b) noexcept {
  OrderedPair pair(tables, a, b);
  RestingContact contact;
  if (find(tables, pair, contact)) keep(contact);
}

bool RestingContacts::parts(const RestingContact& contact, OrderedPair& ordered) const noexcept {
  MovingPair& pair = ordered.pair();
  const Vec normal = ordered.turned(contact.normal);
  const double least = least_gap(pair, normal);
  if (contact.apart) return least > 0.0;
  pair.place(0.0);
  const double first = pair.gap(normal) + pair.noise();
  const solver::Scale scaled(pair.problem().exponent);
  const double slack = tolerance(pair);
  const bool is_flush = first >= scaled(contact.gap) - slack;
  return is_flush && least + pair.noise() >= std::min(first, 0.0) - slack;
}

bool RestingContacts::part(const ShapeTables& tables, const MovingPart& a,
                           const MovingPart& b) const noexcept {
  if (count_ == 0) return false;
  OrderedPair pair(tables, a, b);
  if (!pair.is_there()) return false;
  const auto by = [&](const RestingContact& contact) { return parts(contact, pair); };
  if (std::any_of(contacts_.begin(), contacts_.begin() + count_, by)) return true;
  // If the store is full, also test the parts' own contact.
  RestingContact own;
  return count_ == kMaxContacts && find(tables, pair, own) && by(own);
}

}  // namespace winnow::impact
