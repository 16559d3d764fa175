#pragma once

#include <winnow/pipeline/scene/queries_parts.h>
#include <winnow/pipeline/scene_queries.h>

namespace winnow {

/// Where something that moves first meets a convex part: all in the part's axes and about its
/// origin of coordinates.
struct Meeting {
  double t = 0.0;
  double normal[3] = {0.0, 0.0, 0.0};
  double point[3] = {0.0, 0.0, 0.0};
};

/// A ray or a convex shape that moves.
class Mover {
 public:
  Mover(const Mover&) = delete;
  Mover& operator=(const Mover&) = delete;
  virtual ~Mover() = default;

  /// Where it starts, and a box of it about there.
  [[nodiscard]] const double* start() const noexcept { return start_; }
  [[nodiscard]] const PreciseBox& extent() const noexcept { return extent_; }
  [[nodiscard]] const double* direction() const noexcept { return direction_; }
  [[nodiscard]] double max_t() const noexcept { return max_t_; }

  /// True if it meets the part by t = limit, starting at `from`.
  [[nodiscard]] virtual bool meets(const double from[3], const ConvexPart& part, double limit,
                                   Meeting& meeting) const noexcept = 0;

 protected:
  Mover(const PreciseBox& extent, const double* start, const double* direction,
        double max_t) noexcept
      : extent_(extent), start_(start), direction_(direction), max_t_(max_t) {}

 private:
  PreciseBox extent_;
  const double* start_;
  const double* direction_;
  double max_t_;
};

/// The ray must outlive it.
class RayMover final : public Mover {
 public:
  RayMover(const ShapePool& shapes, const ShapeRay& ray) noexcept;
  [[nodiscard]] bool meets(const double from[3], const ConvexPart& part, double limit,
                           Meeting& meeting) const noexcept override;

 private:
  [[nodiscard]] bool enters(const ShapeRay& ray, const ConvexPart& part,
                            Meeting& meeting) const noexcept;

  const ShapePool& shapes_;
  const ShapeRay& ray_;
};

/// The cast must outlive it.
class ShapeMover final : public Mover {
 public:
  ShapeMover(const PartWalk& walk, const ShapeCast& cast, double tolerance) noexcept;
  [[nodiscard]] bool meets(const double from[3], const ConvexPart& part, double limit,
                           Meeting& meeting) const noexcept override;

 private:
  const ShapePool& shapes_;
  const ShapeCast& cast_;
  const double tolerance_;
};

/// The mover's first meeting with a body by t = limit, of equal ones that with the least part. With
/// `any`, the first that is found.
[[nodiscard]] bool first_meeting(const PartWalk& walk, const Mover& mover, const PlacedShape& body,
                                 double limit, bool any, SceneHit& hit) noexcept;

}  // namespace winnow
