// Continuous collision of two mesh features: finds the first time at which their polygon of
// differences comes within the separation of the origin. It removes times at which the features
// cannot be coplanar, and times at which a plane separates the polygon from the origin. If no plane
// is found at the middle of an interval, the interval is halved. Called by feature_impacts.cpp.

#include "pipeline/motion/feature_motion.h"

#include "pipeline/motion/feature_test.kernel.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

/// Error bound of the dot product of a direction and a corner at some time, relative to the sum of
/// the products' largest magnitudes: 10 roundings, and as many for the interpolation.
constexpr double kPlaneError = 0x1p-48;
/// Intervals up to this length are not halved.
constexpr double kShortest = 0x1p-52;

void read_state(FeaturePair kind, const std::array<Vec3d, 4>& p, int end,
                FeatureMotion& motion) noexcept {
  auto* const corner = motion.corner[end];
  if (kind == FeaturePair::vertex_face) {
    for (std::size_t k = 0; k < 3; ++k) corner[k] = p[0] - p[k + 1];
    motion.edge[0][end] = p[2] - p[1];
    motion.edge[1][end] = p[3] - p[1];
  } else {
    corner[0] = p[0] - p[2];
    corner[1] = p[1] - p[2];
    corner[2] = p[1] - p[3];
    corner[3] = p[0] - p[3];
    motion.edge[0][end] = p[1] - p[0];
    motion.edge[1][end] = p[3] - p[2];
  }
  motion.across[end] = corner[0];
}

template <typename Change>
void for_each_number(FeatureMotion& motion, Change&& change) noexcept {
  for (int end = 0; end < 2; ++end) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < motion.corners; ++k) change(motion.corner[end][k][axis]);
      change(motion.across[end][axis]);
      for (auto& edge : motion.edge) change(edge[end][axis]);
    }
  }
}

void scale(FeatureMotion& motion, double largest) noexcept {
  int exponent = 0;
  static_cast<void>(std::frexp(largest, &exponent));
  for_each_number(motion, [&](double& x) { x = std::ldexp(x, -exponent); });
  motion.separation = std::ldexp(motion.separation, -exponent);
}

void find_reach(FeatureMotion& motion) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    motion.reach[axis] = 0.0;
    for (const auto& state : motion.corner) {
      for (int k = 0; k < motion.corners; ++k) {
        motion.reach[axis] = std::max(motion.reach[axis], std::abs(state[k][axis]));
      }
    }
  }
}

/// det(across, first edge, second edge), a cubic in time, by its Bernstein coefficients. At times
/// at which the polygon may be within the separation of the origin, the magnitude of the
/// determinant is at most `band`.
struct SpannedVolume {
  double at[4];
  double band;
};

/// Upper bound on a determinant whose columns have at most these magnitudes.
double largest_volume(const FeatureMotion& motion) noexcept {
  double most[3][3];
  for (int axis = 0; axis < 3; ++axis) {
    const auto larger = [&](const Vec3d(&ends)[2]) {
      return std::max(std::abs(ends[0][axis]), std::abs(ends[1][axis]));
    };
    most[0][axis] = larger(motion.across);
    most[1][axis] = larger(motion.edge[0]);
    most[2][axis] = larger(motion.edge[1]);
  }
  const auto minor = [&](int y, int z) {
    return most[1][y] * most[2][z] + most[1][z] * most[2][y];
  };
  return most[0][0] * minor(1, 2) + most[0][1] * minor(2, 0) + most[0][2] * minor(0, 1);
}

SpannedVolume volume_of(const FeatureMotion& motion) noexcept {
  const Vec3d first = motion.edge[0][0].cross(motion.edge[1][0]);
  const Vec3d mixed =
      motion.edge[0][0].cross(motion.edge[1][1]) + motion.edge[0][1].cross(motion.edge[1][0]);
  const Vec3d last = motion.edge[0][1].cross(motion.edge[1][1]);
  const Vec3d& start = motion.across[0];
  const Vec3d& end = motion.across[1];
  SpannedVolume volume{{start.dot(first), (end.dot(first) + start.dot(mixed)) / 3.0,
                        (start.dot(last) + end.dot(mixed)) / 3.0, end.dot(last)},
                       kVolumeError * largest_volume(motion) + kLostByUnderflow};
  if (motion.separation > 0.0) {
    // The normal is a quadratic polynomial in time with the Bernstein coefficients `first`, `mixed`
    // / 2 and `last`.
    const double longest = std::max({first.norm(), 0.5 * mixed.norm(), last.norm()});
    const double sizes = 1e-150 + longest;
    volume.band = (volume.band + motion.separation * sizes) * (1.0 + 0x1p-40);
  }
  return volume;
}

double mix(double a, double b, double t) noexcept {
  return (1.0 - t) * a + t * b;
}

struct TimeInterval {
  double low;
  double high;
};

/// Two steps of de Casteljau's algorithm at `t`: the remaining linear polynomial of the cubic's
/// polar form (blossom).
struct PolarLine {
  double start;
  double end;

  PolarLine(const double (&c)[4], double t) noexcept {
    const double middle = mix(c[1], c[2], t);
    start = mix(mix(c[0], c[1], t), middle, t);
    end = mix(middle, mix(c[2], c[3], t), t);
  }
  [[nodiscard]] double at(double t) const noexcept { return mix(start, end, t); }
};

/// Bernstein coefficients over an interval: values of the polar form at its ends.
void coefficients_over(const double (&c)[4], const TimeInterval& time, double (&y)[4]) noexcept {
  const PolarLine at_low(c, time.low);
  const PolarLine at_high(c, time.high);
  y[0] = at_low.at(time.low);
  y[1] = at_low.at(time.high);
  y[2] = at_high.at(time.low);
  y[3] = at_high.at(time.high);
}

/// The first point, from the first coefficient's side, at which the convex hull of the coefficients
/// comes within `band` of zero: 0 to 1, or 2 if there is none.
double first_in_band(double y0, double y1, double y2, double y3, double band) noexcept {
  const double sign = y0 < 0.0 ? -1.0 : 1.0;
  const double z[4] = {sign * y0 - band, sign * y1 - band, sign * y2 - band, sign * y3 - band};
  if (!(z[0] > 0.0)) return 0.0;
  double first = 2.0;
  for (int i = 0; i < 3; ++i) {
    if (!(z[i] > 0.0)) continue;
    for (int k = i + 1; k < 4; ++k) {
      if (z[k] > 0.0) continue;
      first = std::min(first, (i + (k - i) * (z[i] / (z[i] - z[k]))) / 3.0);
    }
  }
  return first;
}

/// Removes times at both ends at which the volume is certainly outside the band (Bezier clipping).
/// Returns false if no time remains.
bool clip(const SpannedVolume& volume, TimeInterval& time) noexcept {
  constexpr double kWorthAnother = 0.5;
  for (;;) {
    double y[4];
    coefficients_over(volume.at, time, y);
    const double from = first_in_band(y[0], y[1], y[2], y[3], volume.band);
    if (from > 1.0) return false;
    const double to = 1.0 - first_in_band(y[3], y[2], y[1], y[0], volume.band);
    const double length = time.high - time.low;
    const double low = from > 0.0 ? time.low + from * length : time.low;
    const double high = to < 1.0 ? time.low + to * length : time.high;
    time = {std::min(low, high), std::max(low, high)};
    if (!(time.high - time.low < kWorthAnother * length)) return true;
  }
}

/// Searches for a plane that separates the polygon from the origin at the middle of an interval,
/// and for the time during which it does.
class PlaneSearch {
 public:
  explicit PlaneSearch(const FeatureMotion& motion) noexcept : motion_(motion) {}

  /// Returns whether it found such a plane; `apart` becomes the part of the interval in which the
  /// plane separates.
  bool find(const TimeInterval& time, double middle, TimeInterval& apart) noexcept {
    for (int k = 0; k < motion_.corners; ++k) {
      at_[k] = (1.0 - middle) * motion_.corner[0][k] + middle * motion_.corner[1][k];
    }
    if (keeps_apart(nearest_of_border(), time, middle, apart)) return true;
    const Vec3d n = (at_[1] - at_[0]).cross(at_[motion_.corners - 1] - at_[0]);
    return keeps_apart(n.dot(at_[0]) < 0.0 ? -n : n, time, middle, apart);
  }

  /// Returns whether, during the whole step, the polygon is farther than the separation on one side
  /// of the origin along a coordinate axis.
  [[nodiscard]] bool is_apart_on_axis() const noexcept {
    const double least = motion_.separation * (1.0 + 0x1p-50);
    for (int axis = 0; axis < 3; ++axis) {
      double low = motion_.corner[0][0][axis];
      double high = low;
      for (const auto& state : motion_.corner) {
        for (int k = 0; k < motion_.corners; ++k) {
          low = std::min(low, state[k][axis]);
          high = std::max(high, state[k][axis]);
        }
      }
      if (low > least || -high > least) return true;
    }
    return false;
  }

 private:
  /// Returns the direction from the origin to the nearest point of the polygon's border. The
  /// direction is made orthogonal to the side that contains the point: if the point is near the
  /// origin, cancellation leaves only few correct digits of the direction.
  [[nodiscard]] Vec3d nearest_of_border() const noexcept {
    Vec3d nearest;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < motion_.corners; ++k) {
      const Vec3d& a = at_[k];
      const Vec3d side = at_[k + 1 == motion_.corners ? 0 : k + 1] - a;
      const double square = side.squared_norm();
      const double s = square > 0.0 ? std::clamp(-a.dot(side) / square, 0.0, 1.0) : 0.0;
      const Vec3d q = a + s * side;
      const double distance = q.squared_norm();
      if (!(distance < least)) continue;
      least = distance;
      const double along = s > 0.0 && s < 1.0 ? q.dot(side) / square : 0.0;
      nearest = q - along * side;
    }
    return nearest;
  }

  bool keeps_apart(const Vec3d& normal, const TimeInterval& time, double middle,
                   TimeInterval& apart) const noexcept {
    const double most = std::max({std::abs(normal[0]), std::abs(normal[1]), std::abs(normal[2])});
    if (!(most > 0.0)) return false;
    const Vec3d n = normal / most;
    double least = kLostByUnderflow;
    for (int axis = 0; axis < 3; ++axis) {
      least += kPlaneError * std::abs(n[axis]) * motion_.reach[axis];
    }
    if (motion_.separation > 0.0) {
      least += motion_.separation * n.norm() * (1.0 + 0x1p-50);
    }
    double f[4];
    for (int k = 0; k < motion_.corners; ++k) {
      f[k] = n.dot(at_[k]);
      if (!(f[k] > least)) return false;
    }
    double before = 1.0;
    double after = 1.0;
    for (int k = 0; k < motion_.corners; ++k) {
      const double start = n.dot(motion_.corner[0][k]);
      const double end = n.dot(motion_.corner[1][k]);
      const double above = f[k] - least;
      before = std::min(before, part_above(above, mix(start, end, time.low) - least));
      after = std::min(after, part_above(above, mix(start, end, time.high) - least));
    }
    apart = time;
    if (before < 1.0) apart.low = middle + before * (time.low - middle);
    if (after < 1.0) apart.high = middle + after * (time.high - middle);
    return true;
  }

  /// Returns the fraction of the interpolation from `above` (positive) to `other` in which the
  /// value is certainly positive.
  static double part_above(double above, double other) noexcept {
    constexpr double kAlmost = 1.0 - 0x1p-20;
    return other > 0.0 ? 1.0 : kAlmost * (above / (above - other));
  }

  const FeatureMotion& motion_;
  Vec3d at_[4];
};

}  // namespace

bool read_motion(FeaturePair kind, const std::array<Vec3d, 4>& start,
                 const std::array<Vec3d, 4>& end, double separation,
                 FeatureMotion& motion) noexcept {
  for (std::size_t k = 0; k < 4; ++k) {
    if (!start[k].all_finite() || !end[k].all_finite()) return false;
  }
  motion.corners = kind == FeaturePair::vertex_face ? 3 : 4;
  motion.separation = separation;
  read_state(kind, start, 0, motion);
  read_state(kind, end, 1, motion);
  double largest = 0.0;
  for_each_number(motion, [&](double& x) { largest = std::max(largest, std::abs(x)); });
  if (!(largest <= std::numeric_limits<double>::max())) return false;
  if (largest > 0.0 && (largest < kMinScaled || largest > kMaxScaled)) scale(motion, largest);
  find_reach(motion);
  return true;
}

FeatureImpact first_impact(const FeatureMotion& motion,
                           const FeatureImpactOptions& options) noexcept {
  PlaneSearch planes(motion);
  if (planes.is_apart_on_axis()) return {};
  const SpannedVolume volume = volume_of(motion);
  const double shortest = std::max(options.tolerance, kShortest);
  // A stack of pending intervals, earliest on top. Each interval pushed is at most half as long as
  // the interval popped before; this bounds the depth.
  TimeInterval open[64];
  int size = 0;
  open[size++] = {0.0, 1.0};
  for (std::uint32_t tested = 0; size != 0; ++tested) {
    TimeInterval time = open[--size];
    if (tested == options.max_intervals) return {true, time.low};
    if (!clip(volume, time)) continue;
    const double middle = time.low + 0.5 * (time.high - time.low);
    TimeInterval apart;
    if (planes.find(time, middle, apart)) {
      if (apart.high < time.high) open[size++] = {apart.high, time.high};
      if (time.low < apart.low) open[size++] = {time.low, apart.low};
    } else if (time.high - time.low <= shortest) {
      return {true, time.low};
    } else {
      open[size++] = {middle, time.high};
      open[size++] = {time.low, middle};
    }
  }
  return {};
}

}  // namespace winnow
