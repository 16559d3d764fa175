#pragma once

#include <winnow/pipeline/scene_queries.h>
#include "pipeline/composites/parts.h"
#include "pipeline/motion/resting_contacts.h"
#include "pipeline/scene/queries/shape_cast.h"

namespace winnow {

/// Where something that moves first meets a convex part: about the part's origin of coordinates,
/// in the axes of the world.
struct SweepMeeting {
  double t = 0.0;
  /// Of shapes: that of a parting plane until `SweptShape::describe` gives the surface's.
  double normal[3] = {0.0, 0.0, 0.0};
  double point[3] = {0.0, 0.0, 0.0};
  bool overlaps_at_start = false;
  /// Of shapes: how high above the part's origin, along the normal, the shape is all of then, and a
  /// little less.
  double height = 0.0;
  /// Of composite shapes that move: which part of them it is.
  std::uint32_t own_part = kWholeShape;
};

/// Of a meeting with what a cast touched: all but normal and point of the surface.
[[nodiscard]] SweepMeeting meeting_of(const CastTouch& touch) noexcept;
/// Fills in normal and point of a meeting of this pair, whose standing shape is the part.
void describe_meeting(const ShapeTables& tables, const CastPair& pair, const ConvexPart& part,
                      SweepMeeting& meeting) noexcept;

/// The two of a pair over the whole of a cast, which ends at `max_t`.
class CastMotions {
 public:
  CastMotions(const CastPair& pair, double max_t) noexcept;

  /// Notes the contact of the two at the start.
  void note(const ShapeTables& tables, impact::RestingContacts& resting) const noexcept;
  /// True if there are contacts at the start along which the two slide, or part.
  [[nodiscard]] bool part(const ShapeTables& tables,
                          const impact::RestingContacts& resting) const noexcept;

 private:
  impact::MovingPart moving_;
  impact::MovingPart standing_;
  bool is_finite_;
};

/// By this much of its coordinates a box is grown before the tests of boxes, which round them.
inline constexpr double kSweptBoxGrowth = 0x1p-47;

/// Neighbours in a mesh have their common corners a few roundings apart, once each is at its place:
/// by less than this. As thick as this they leave nothing through between them.
[[nodiscard]] double corner_doubt(const ConvexPart& part) noexcept;

/// A ray or a shape that moves along a line without turning.
class SweptShape {
 public:
  SweptShape(const SweptShape&) = delete;
  SweptShape& operator=(const SweptShape&) = delete;
  virtual ~SweptShape() = default;

  /// Where it starts, and a box of it about there.
  [[nodiscard]] const double* start() const noexcept { return start_; }
  [[nodiscard]] const PreciseBox& extent() const noexcept { return extent_; }
  [[nodiscard]] const double* direction() const noexcept { return direction_; }
  [[nodiscard]] double max_t() const noexcept { return max_t_; }
  /// Null for a shape.
  [[nodiscard]] virtual const ShapeRay* ray() const noexcept { return nullptr; }
  /// A length by which it may be early.
  [[nodiscard]] double tolerance() const noexcept { return tolerance_; }
  /// False if it does not meet what it touches at the start and slides along, or leaves.
  [[nodiscard]] bool meets_at_start() const noexcept { return meets_at_start_; }
  /// Notes its contact with a part at the start.
  virtual void note_contact(const double from[3], const ConvexPart& part,
                            impact::RestingContacts& resting) const noexcept;

  /// What is known of a body when it is held against one of its parts.
  struct KnownMeetings {
    /// A meeting with another part at the limit, if there is one.
    const SweepMeeting* before = nullptr;
    /// Contacts with the body at the start, if they are no meetings.
    const impact::RestingContacts* resting = nullptr;
  };
  /// True if it meets the part by t = limit, starting at `from`.
  [[nodiscard]] virtual bool meets(const double from[3], const ConvexPart& part, double limit,
                                   const KnownMeetings& known,
                                   SweepMeeting& meeting) const noexcept = 0;
  /// Fills in normal and point of a meeting, which costs more than finding its time: done once, for
  /// the meeting that is shown.
  virtual void describe(const double from[3], const ConvexPart& part,
                        SweepMeeting& meeting) const noexcept = 0;

 protected:
  SweptShape(const PreciseBox& extent, const ShapeCast& cast, double tolerance) noexcept
      : extent_(extent),
        start_(cast.pose.position),
        direction_(cast.direction),
        max_t_(cast.max_t),
        tolerance_(tolerance),
        meets_at_start_(cast.touching) {}
  explicit SweptShape(const ShapeRay& ray) noexcept
      : extent_{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()},
        start_(ray.origin),
        direction_(ray.direction),
        max_t_(ray.max_t) {}

 private:
  PreciseBox extent_;
  const double* start_;
  const double* direction_;
  double max_t_;
  double tolerance_ = 0.0;
  bool meets_at_start_ = true;
};

/// The ray must outlive it.
class RaySweep final : public SweptShape {
 public:
  RaySweep(const ShapePool& shapes, const ShapeRay& ray) noexcept;
  [[nodiscard]] const ShapeRay* ray() const noexcept override { return &ray_; }
  [[nodiscard]] bool meets(const double from[3], const ConvexPart& part, double limit,
                           const KnownMeetings& known,
                           SweepMeeting& meeting) const noexcept override;
  void describe(const double from[3], const ConvexPart& part,
                SweepMeeting& meeting) const noexcept override;

 private:
  [[nodiscard]] bool enters(const ShapeRay& ray, const ConvexPart& part,
                            SweepMeeting& meeting) const noexcept;

  const ShapePool& shapes_;
  const ShapeRay& ray_;
};

/// A convex shape. The cast must outlive it.
class ShapeSweep final : public SweptShape {
 public:
  ShapeSweep(const PartTraversal& parts, const ShapeCast& cast, double tolerance) noexcept;
  void note_contact(const double from[3], const ConvexPart& part,
                    impact::RestingContacts& resting) const noexcept override;
  [[nodiscard]] bool meets(const double from[3], const ConvexPart& part, double limit,
                           const KnownMeetings& known,
                           SweepMeeting& meeting) const noexcept override;
  void describe(const double from[3], const ConvexPart& part,
                SweepMeeting& meeting) const noexcept override;

 private:
  /// True if a plane shows that the shape does not come to the triangle by t = limit; or else
  /// perhaps that it does not before `free_until`.
  [[nodiscard]] bool passes_by(const double from[3], const ConvexPart& part, double limit,
                               double& free_until) const noexcept;
  /// The same, of a meeting with another part at t = limit, by its plane.
  [[nodiscard]] bool is_beyond(const ConvexPart& part, const SweepMeeting& before) const noexcept;
  /// And by the plane between the shape's middle and the triangle.
  [[nodiscard]] bool is_beside(const double from[3], const ConvexPart& part,
                               double limit) const noexcept;
  void set_height(const double from[3], SweepMeeting& meeting) const noexcept;
  /// About it where it starts.
  [[nodiscard]] PreciseBox box_at(const double from[3]) const noexcept;
  [[nodiscard]] CastPair pair(PartTables& tables, const double from[3],
                              const ConvexPart& part) const noexcept;

  const ShapePool& shapes_;
  const ShapeCast& cast_;
  /// From the axes of the world to those of the shape.
  Eigen::Matrix3d to_shape_;
  /// Of its box, about where it starts.
  Eigen::Vector3d middle_;
};

/// A meeting with a body, and all that it takes to describe it.
class BodyMeeting {
 public:
  /// Looks for the swept shape's first meeting with the body by t = limit, of equal ones that with
  /// the least part; with `any`, for whichever is found first. False if there is none.
  [[nodiscard]] bool find(const PartTraversal& parts, const SweptShape& swept,
                          const PlacedShape& body, double limit, bool any) noexcept;

  [[nodiscard]] double t() const noexcept { return meeting_.t; }
  [[nodiscard]] std::uint32_t part() const noexcept { return part_.part; }
  /// All but the body's key and data.
  [[nodiscard]] SceneHit hit(const SweptShape& swept) const noexcept;

 private:
  void take(const ConvexPart& part, const SweepMeeting& meeting) noexcept;
  /// Notes the contacts with a composite body at the start.
  void note_contacts(const PartTraversal& parts, const SweptShape& swept, const PlacedShape& placed,
                     impact::RestingContacts& resting) const noexcept;

  SweepMeeting meeting_;
  ConvexPart part_;
  TriangleShape triangle_;
  /// Where the sweep starts, and the world's origin lies, in the part's coordinates.
  double from_[3] = {0.0, 0.0, 0.0};
  double base_[3] = {0.0, 0.0, 0.0};
};

}  // namespace winnow
