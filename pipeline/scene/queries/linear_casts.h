#pragma once

// Rays and shapes that move along a line without turning, tested against the parts of one body.
// cast_query.cpp calls BodyContact::find for each candidate body.

#include <winnow/pipeline/scene_queries.h>
#include "pipeline/composites/part_tables.h"
#include "pipeline/composites/shape_cast.h"
#include "pipeline/motion/resting_contacts.h"

namespace winnow {

/// The first contact of a moving shape with a convex part, in the part's coordinates: world axes,
/// relative to the body's position.
struct CastContact {
  double t = 0.0;
  /// For shapes: the normal of a separating plane, until `LinearCast::describe` replaces it with
  /// the surface normal.
  Vec3d normal{};
  Vec3d point{};
  bool overlaps_at_start = false;
  /// For shapes: a lower bound on the shape's height above the origin at time t, along the normal.
  double height = 0.0;
  /// For composite shapes that move: the part of them that touches.
  std::uint32_t own_part = kWholeShape;
};

/// Converts the result of a cast. `describe` computes normal and point of the surface later.
[[nodiscard]] CastContact contact_of(const CastTouch& touch) noexcept;
/// Computes normal and point of a contact of this pair, whose fixed shape is the part.
void describe_contact(const ShapeTables& tables, const CastPair& pair, const SubShape& part,
                      CastContact& contact) noexcept;

/// The motions of a pair over the whole cast, which ends at `max_t`.
class CastMotions {
 public:
  CastMotions(const CastPair& pair, double max_t) noexcept;

  /// Records the contact of the two at the start.
  void record(const ShapeTables& tables, impact::RestingContacts& resting) const noexcept;
  /// True if the pair has contacts at the start along which it slides or separates.
  [[nodiscard]] bool part(const ShapeTables& tables,
                          const impact::RestingContacts& resting) const noexcept;

 private:
  impact::MovingPart moving_;
  impact::MovingPart stationary_;
  bool is_finite_;
};

/// Boxes are grown by this share of their coordinates before box tests, which round.
inline constexpr double kCastBoxGrowth = 0x1p-47;

/// A ray, or a shape that moves along a line without turning.
class LinearCast {
 public:
  LinearCast(const LinearCast&) = delete;
  LinearCast& operator=(const LinearCast&) = delete;
  virtual ~LinearCast() = default;

  /// Start position, and a box around the shape relative to it.
  [[nodiscard]] const double* start() const noexcept { return start_; }
  [[nodiscard]] const mid::Box3& extent() const noexcept { return extent_; }
  [[nodiscard]] const double* direction() const noexcept { return direction_; }
  [[nodiscard]] double max_t() const noexcept { return max_t_; }
  /// Null for a shape.
  [[nodiscard]] virtual const ShapeRay* ray() const noexcept { return nullptr; }
  /// The contact may be early by this length.
  [[nodiscard]] double tolerance() const noexcept { return tolerance_; }
  /// False if contacts at the start, along which it slides or separates, are not hits.
  [[nodiscard]] bool hits_at_start() const noexcept { return hits_at_start_; }
  /// Records the contact of this shape with a part at the start.
  virtual void note_contact(const double from[3], const SubShape& part,
                            impact::RestingContacts& resting) const noexcept;

  /// Earlier results for the body whose parts are tested.
  struct EarlierContacts {
    /// A contact with another part at the limit, or null.
    const CastContact* before = nullptr;
    /// Contacts with the body at the start if they are not hits, else null.
    const impact::RestingContacts* resting = nullptr;
  };
  /// True if the shape or ray touches the part by t = limit, starting at `from`.
  [[nodiscard]] virtual bool find_contact(const double from[3], const SubShape& part, double limit,
                                          const EarlierContacts& known,
                                          CastContact& contact) const noexcept = 0;
  /// Computes normal and point of a contact. This takes longer than finding the time of the
  /// contact, so it is done only for the contact that is returned.
  virtual void describe(const double from[3], const SubShape& part,
                        CastContact& contact) const noexcept = 0;

 protected:
  LinearCast(const mid::Box3& extent, const ShapeCast& cast, double tolerance) noexcept
      : extent_(extent),
        start_(cast.pose.position.data()),
        direction_(cast.direction.data()),
        max_t_(cast.max_t),
        tolerance_(tolerance),
        hits_at_start_(cast.touching) {}
  explicit LinearCast(const ShapeRay& ray) noexcept
      : extent_{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()},
        start_(ray.origin.data()),
        direction_(ray.direction.data()),
        max_t_(ray.max_t) {}

 private:
  mid::Box3 extent_;
  const double* start_;
  const double* direction_;
  double max_t_;
  double tolerance_ = 0.0;
  bool hits_at_start_ = true;
};

/// Returns the moving box of a cast that starts at `from`, grown by `more` in all directions, up to
/// t = limit.
[[nodiscard]] MovingBox moving_box_from(const LinearCast& linear_cast, const double from[3],
                                        double limit, double more = 0.0) noexcept;

/// A ray, which must outlive this object.
class RayCast final : public LinearCast {
 public:
  RayCast(const ShapePool& shapes, const ShapeRay& ray) noexcept;
  [[nodiscard]] const ShapeRay* ray() const noexcept override { return &ray_; }
  [[nodiscard]] bool find_contact(const double from[3], const SubShape& part, double limit,
                                  const EarlierContacts& known,
                                  CastContact& contact) const noexcept override;
  void describe(const double from[3], const SubShape& part,
                CastContact& contact) const noexcept override;

 private:
  const ShapePool& shapes_;
  const ShapeRay& ray_;
};

/// A convex shape. The cast must outlive this object.
class ConvexCast final : public LinearCast {
 public:
  ConvexCast(const SubShapeQuery& parts, const ShapeCast& cast, double tolerance) noexcept;
  void note_contact(const double from[3], const SubShape& part,
                    impact::RestingContacts& resting) const noexcept override;
  [[nodiscard]] bool find_contact(const double from[3], const SubShape& part, double limit,
                                  const EarlierContacts& known,
                                  CastContact& contact) const noexcept override;
  void describe(const double from[3], const SubShape& part,
                CastContact& contact) const noexcept override;

 private:
  /// True if a plane proves that the shape does not reach the triangle by t = limit. If false, may
  /// raise `free_until`, a time until which they do not touch.
  [[nodiscard]] bool passes_by(const double from[3], const SubShape& part, double limit,
                               double& free_until) const noexcept;
  /// As passes_by, with the plane of a contact with another part at t = limit.
  [[nodiscard]] bool is_beyond(const SubShape& part, const CastContact& before) const noexcept;
  /// As passes_by, with the plane between the shape's centre and the triangle.
  [[nodiscard]] bool is_beside(const double from[3], const SubShape& part,
                               double limit) const noexcept;
  void set_height(const double from[3], CastContact& contact) const noexcept;
  /// The box of the shape at its start.
  [[nodiscard]] mid::Box3 box_at(const double from[3]) const noexcept;
  [[nodiscard]] CastPair pair(PartTables& tables, const double from[3],
                              const SubShape& part) const noexcept;

  const ShapePool& shapes_;
  const ShapeCast& cast_;
  /// Rotates world axes to the axes of the shape.
  Eigen::Matrix3d to_shape_;
  /// Centre of its box, relative to the start.
  Eigen::Vector3d middle_;
};

/// A contact with a body, with the data to describe it.
class BodyContact {
 public:
  /// Finds the cast's first contact with the body by t = limit; if times are equal, the one
  /// with the smallest part number. With `any`, the contact that is found first. Returns false if
  /// there is none.
  [[nodiscard]] bool find(const SubShapeQuery& parts, const LinearCast& linear_cast,
                          const PlacedShape& body, double limit, bool any) noexcept;

  [[nodiscard]] double t() const noexcept { return contact_.t; }
  [[nodiscard]] std::uint32_t part() const noexcept { return part_.part; }
  /// Returns the hit without the body's key and data.
  [[nodiscard]] SceneHit hit(const LinearCast& linear_cast) const noexcept;

 private:
  /// As above, for a ray and a composite body.
  [[nodiscard]] bool find(const SubShapeQuery& parts, const ShapeRay& ray, const PlacedShape& body,
                          double limit, bool any) noexcept;
  void take(const SubShape& part, const CastContact& contact) noexcept;
  /// Records the contacts with a composite body at the start.
  void note_contacts(const SubShapeQuery& parts, const LinearCast& linear_cast,
                     const PlacedShape& placed, impact::RestingContacts& resting) const noexcept;

  CastContact contact_;
  SubShape part_;
  TriangleShape triangle_;
  /// Start of the cast, relative to the body's position; and the body's position in the world.
  Vec3d from_{};
  Vec3d base_{};
};

}  // namespace winnow
