// Choice of the points of a contact region; see region_points.h.

#include "pipeline/manifold/region_points.h"

#include "core/memory/scattered.h"
#include "pipeline/shapes/directions_around.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

/// Relative to the span of a region: points whose distances differ by less than kTiedSpan count as
/// equally far, and a point outside of the hull by less than kMinWider is not chosen.
constexpr double kTiedSpan = 1e-3;
constexpr double kMinWider = 1e-4;
/// Points within this many times the tie tolerance of each other count as one position.
constexpr double kPlaces = 4.0;

}  // namespace

std::uint64_t feature_among_parts(std::uint64_t feature, const std::uint32_t (&part)[2]) noexcept {
  const auto is_vertex = [](std::uint64_t half) {
    return half >> 30U == static_cast<std::uint64_t>(FeatureKind::vertex);
  };
  const auto is_face = [](std::uint64_t half) {
    return half >> 30U == static_cast<std::uint64_t>(FeatureKind::face);
  };
  constexpr std::uint64_t kHalf = 0xFFFFFFFFU;
  const std::uint64_t a = feature >> 32U;
  const std::uint64_t b = feature & kHalf;
  std::uint64_t parts = std::uint64_t{part[0]} << 32U | part[1];
  if (is_vertex(a) && is_face(b)) {
    feature = a << 32U | kHalf;
    parts |= kHalf;
  } else if (is_vertex(b) && is_face(a)) {
    feature = kHalf << 32U | b;
    parts |= kHalf << 32U;
  }
  return scattered(feature ^ scattered(parts));
}

RegionPoints::RegionPoints(const double normal[3], const double direction[3], double tie) noexcept
    : frame_(normal), tie_(tie) {
  const double up = dot(direction, normal);
  for (int k = 0; k < 3; ++k) direction_[k] = direction[k] - up * normal[k];
}

void RegionPoints::add(const ContactPoint& contact, const double* offset,
                       const std::uint32_t (&part)[2]) noexcept {
  keep(point_of(contact, offset, part));
}

void RegionPoints::add_beside(const ContactPoint& contact, const double* offset,
                              const std::uint32_t (&part)[2]) noexcept {
  if (has_beside_ && contact.depth <= beside_.contact.depth) return;
  has_beside_ = true;
  beside_ = point_of(contact, offset, part);
}

RegionPoints::RegionPoint RegionPoints::point_of(const ContactPoint& contact, const double* offset,
                                                 const std::uint32_t (&part)[2]) const noexcept {
  RegionPoint point;
  double p[3];
  for (int k = 0; k < 3; ++k) p[k] = static_cast<double>(contact.position[k]) + offset[k];
  point.x = dot(p, frame_.axis[0]);
  point.y = dot(p, frame_.axis[1]);
  point.along = dot(p, direction_);
  for (int k = 0; k < 3; ++k) point.contact.position[k] = static_cast<float>(p[k]);
  point.contact.depth = contact.depth;
  point.contact.feature = contact.feature;
  std::copy_n(part, 2, point.part);
  return point;
}

void RegionPoints::keep(const RegionPoint& point) noexcept {
  if (count_ == kRoom) thin();
  point_[count_++] = point;
}

// Returns the first of the deepest points. There must be a point.
std::uint32_t RegionPoints::deepest() const noexcept {
  std::uint32_t deepest = 0;
  for (std::uint32_t i = 1; i < count_; ++i) {
    if (point_[i].contact.depth > point_[deepest].contact.depth) deepest = i;
  }
  return deepest;
}

// Finds a point with the largest value. Among points whose values are within `slack` of it, the
// outermost along the direction determines the position, so that the choice between equally good
// positions is stable. Returns the point with the largest value at that position, so that a corner
// is not lost to a point beside it; among several such points, the outermost, and among equally far
// ones the first that was added.
template <typename Value>
std::uint32_t RegionPoints::first_of_largest(Value&& value, double slack,
                                             double& most) const noexcept {
  double values[kRoom];
  most = -std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < count_; ++i) {
    values[i] = value(point_[i]);
    most = std::max(most, values[i]);
  }
  const auto outermost = [&](auto&& counts) {
    std::uint32_t best = count_;
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (!counts(i)) continue;
      if (best == count_ || point_[i].along > point_[best].along + tie_) best = i;
    }
    return best == count_ ? 0 : best;
  };
  const std::uint32_t place = outermost([&](std::uint32_t i) { return values[i] >= most - slack; });
  if (slack <= tie_) return place;
  const double reach = kPlaces * slack;
  const auto is_there = [&](std::uint32_t i) {
    return std::hypot(point_[i].x - point_[place].x, point_[i].y - point_[place].y) <= reach;
  };
  double most_there = values[place];
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (is_there(i)) most_there = std::max(most_there, values[i]);
  }
  return outermost([&](std::uint32_t i) { return is_there(i) && values[i] >= most_there - tie_; });
}

double RegionPoints::distance_from_hull(const RegionPoint& p, const Chosen& hull,
                                        std::uint32_t count) const noexcept {
  double nearest = std::numeric_limits<double>::infinity();
  bool is_left = count == 3;
  bool is_right = count == 3;
  for (std::uint32_t i = 0; i < count; ++i) {
    const RegionPoint& a = point_[hull[i]];
    const RegionPoint& b = point_[hull[i + 1 == count ? 0 : i + 1]];
    const double along[2] = {b.x - a.x, b.y - a.y};
    const double to[2] = {p.x - a.x, p.y - a.y};
    const double turn = along[0] * to[1] - along[1] * to[0];
    is_left = is_left && turn >= 0.0;
    is_right = is_right && turn <= 0.0;
    const double square = along[0] * along[0] + along[1] * along[1];
    const double run = to[0] * along[0] + to[1] * along[1];
    const double share = square > 0.0 ? std::clamp(run / square, 0.0, 1.0) : 0.0;
    const double off[2] = {to[0] - share * along[0], to[1] - share * along[1]};
    nearest = std::min(nearest, off[0] * off[0] + off[1] * off[1]);
  }
  return is_left || is_right ? 0.0 : std::sqrt(nearest);
}

// The first point is already chosen. Returns the number of chosen points.
std::uint32_t RegionPoints::spread(Chosen& chosen, double span) const noexcept {
  const double least = std::max(tie_, kMinWider * span);
  const double slack = std::max(tie_, kTiedSpan * span);
  std::uint32_t count = 1;
  for (; count < kManifoldPoints; ++count) {
    const auto value = [&](const RegionPoint& p) {
      const double away = distance_from_hull(p, chosen, count);
      return away > least ? away : -std::numeric_limits<double>::infinity();
    };
    double most = 0.0;
    const std::uint32_t next = first_of_largest(value, slack, most);
    if (!(most > least)) break;
    chosen[count] = next;
  }
  return count;
}

double RegionPoints::span_from(std::uint32_t point) const noexcept {
  double square = 0.0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const double away[2] = {point_[i].x - point_[point].x, point_[i].y - point_[point].y};
    square = std::max(square, away[0] * away[0] + away[1] * away[1]);
  }
  return std::sqrt(square);
}

// Parts that share a side may report the same position several times, and a part beside the side
// may report almost the same position. Returns the deepest of these points.
const RegionPoints::RegionPoint& RegionPoints::deepest_at(const RegionPoint& place) const noexcept {
  constexpr double kPositionTies = 16.0;
  const RegionPoint* best = &place;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const RegionPoint& p = point_[i];
    const bool is_there = std::abs(p.x - place.x) <= kPositionTies * tie_ &&
                          std::abs(p.y - place.y) <= kPositionTies * tie_;
    if (is_there && p.contact.depth - best->contact.depth > static_cast<float>(tie_)) best = &p;
  }
  return *best;
}

// Keeps the farthest points in sixteen directions, and the deepest, in the order in which they were
// added. Among equally far points, keeps the one that is farther counter-clockwise.
void RegionPoints::thin() noexcept {
  bool stays[kRoom] = {};
  double unused = 0.0;
  const double first[2] = {dot(direction_, frame_.axis[0]), dot(direction_, frame_.axis[1])};
  for (const auto& turn : kSixteenthsOfTurn) {
    const double c = turn[0] * first[0] - turn[1] * first[1];
    const double s = turn[0] * first[1] + turn[1] * first[0];
    double most = -std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < count_; ++i) {
      most = std::max(most, c * point_[i].x + s * point_[i].y);
    }
    stays[first_of_largest(
        [&](const RegionPoint& p) {
          return c * p.x + s * p.y >= most - tie_ ? c * p.y - s * p.x
                                                  : -std::numeric_limits<double>::infinity();
        },
        tie_, unused)] = true;
  }
  stays[deepest()] = true;
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (stays[i]) point_[kept++] = point_[i];
  }
  count_ = kept;
}

std::uint32_t RegionPoints::choose(ContactPoint* out) noexcept {
  if (count_ == 0 && has_beside_) keep(beside_);
  if (count_ == 0) return 0;
  if (count_ == kRoom) thin();
  const auto depth_of = [](const RegionPoint& p) { return static_cast<double>(p.contact.depth); };
  double depth = 0.0;
  Chosen chosen;
  chosen[0] = first_of_largest([](const RegionPoint& p) { return p.along; }, tie_, depth);
  const double span = span_from(chosen[0]);
  const double tie = std::max(tie_, kTiedDepth * span);
  std::uint32_t deepest = first_of_largest(depth_of, tie, depth);
  std::uint32_t count = spread(chosen, span);
  if (has_beside_ && depth_of(beside_) > depth) {
    depth = depth_of(beside_);
    deepest = count_;
    keep(beside_);
  }
  // The first point gets the depth of the deepest point of all. Prefer the deepest of the chosen
  // points, whose own depth differs least from that.
  std::uint32_t* first = std::max_element(
      chosen, chosen + count,
      [&](std::uint32_t i, std::uint32_t k) { return depth_of(point_[i]) < depth_of(point_[k]); });
  if (depth_of(point_[*first]) < depth - tie) {
    count = std::min(count + 1, kManifoldPoints);
    first = chosen + count - 1;
    *first = deepest;
  }
  std::swap(chosen[0], *first);
  for (std::uint32_t i = 0; i < count; ++i) {
    const RegionPoint& point = deepest_at(point_[chosen[i]]);
    out[i] = point.contact;
    out[i].feature = feature_among_parts(point.contact.feature, point.part);
  }
  out[0].depth = static_cast<float>(depth);
  return count;
}

}  // namespace winnow
