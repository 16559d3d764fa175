// Adapter of FCL's narrow phase: calls its solver's functions for each pair of kinds and level, and
// converts the results. It registers itself in registry.h.

#include "bench/contenders/engines.h"
#include "bench/peers/fcl_shapes.h"
#include "bench/peers/narrow_adapter.h"
#include "bench/peers/registry.h"

#include <fcl/narrowphase/detail/gjk_solver_indep.h>
#include <fcl/narrowphase/detail/gjk_solver_libccd.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/triangle_distance.h>
#include <fcl/narrowphase/detail/traversal/collision/intersect.h>

#include <algorithm>
#include <array>
#include <exception>
#include <string>
#include <type_traits>

namespace winnow::bench {
namespace {

using namespace in_fcl;

using Contacts = std::vector<fcl::ContactPoint<double>>;
using TriangleTests = fcl::detail::Intersect<double>;
using TriangleDistances = fcl::detail::TriangleDistance<double>;
using Corners = std::array<Vector, 3>;

/// FCL in double, the type that its library is built for. Calls the solver functions at the end of
/// FCL's collide() and distance(): closed forms if it has them, otherwise GJK and EPA of libccd or
/// of its own. FCL has no GJK for two triangles, so these use its triangle functions, which return
/// no depth. Pairs for which the libccd solver throws count as overlapping.
template <typename Solver>
class FclNarrow final : public NarrowAdapter<FclNarrow<Solver>> {
 public:
  using Self = FclNarrow<Solver>;
  using PairFunction = typename NarrowAdapter<Self>::PairFunction;
  static constexpr bool kLibccd = std::is_same_v<Solver, fcl::detail::GJKSolver_libccd<double>>;

  [[nodiscard]] std::string name() const override { return kLibccd ? "FCL libccd" : "FCL indep"; }

  [[nodiscard]] static PairFunction pair_function(const PairKind& kind, ContactLevel level) {
    using enum ShapeKind;
    // FCL has no tapered capsules and does not support user shapes.
    for (const ShapeKind missing : {tapered_capsule, support}) {
      if (kind.a == missing || kind.b == missing) return nullptr;
    }
    if (kind.a == triangle && kind.b == triangle) {
      return pick(level, &Self::cross, &Self::triangle_gap, &Self::cut);
    }
    return with_geometry(kind.a, [&]<typename A>(A*) -> PairFunction {
      return with_geometry(kind.b, [&]<typename B>(B*) { return function_for<A, B>(level); });
    });
  }

  void start(const PairSet& set) override {
    this->set_kind(set.kind);
    std::vector<Geometry*> hulls(set.pool.tables().count[static_cast<int>(ShapeKind::hull)]);
    for (std::size_t i = 0; i < set.poses.size(); ++i) {
      Body body;
      body.at = transform_of(set.poses[i]);
      const ShapeId id = set.shapes[i];
      const bool shared = id.kind() == ShapeKind::hull && hulls[id.index()] != nullptr;
      if (id.kind() == ShapeKind::triangle) {
        const TriangleShape& triangle = set.pool.tables().triangles[id.index()];
        for (std::size_t k = 0; k < 3; ++k) body.corners[k] = as_eigen(triangle.vertex[k]);
      } else if (shared) {
        body.geometry = hulls[id.index()];
      } else {
        geometries_.push_back(make_geometry(set.pool.tables(), id));
        body.geometry = geometries_.back().get();
        if (id.kind() == ShapeKind::hull) hulls[id.index()] = geometries_.back().get();
      }
      bodies_.push_back(body);
    }
  }

 private:
  struct Body {
    Transform at;
    const Geometry* geometry = nullptr;
    Corners corners;
  };

  static PairFunction pick(ContactLevel level, PairFunction boolean, PairFunction distance,
                           PairFunction manifold) {
    switch (level) {
      case ContactLevel::boolean:
        return boolean;
      case ContactLevel::distance:
        return distance;
      default:
        return manifold;
    }
  }

  /// Calls `visit` with a null pointer to FCL's type for a kind; the type of a triangle is Corners.
  template <typename Visit>
  static PairFunction with_geometry(ShapeKind kind, Visit&& visit) {
    switch (kind) {
      case ShapeKind::sphere:
        return visit(static_cast<SphereGeometry*>(nullptr));
      case ShapeKind::capsule:
        return visit(static_cast<CapsuleGeometry*>(nullptr));
      case ShapeKind::box:
        return visit(static_cast<BoxGeometry*>(nullptr));
      case ShapeKind::cylinder:
        return visit(static_cast<CylinderGeometry*>(nullptr));
      case ShapeKind::cone:
        return visit(static_cast<ConeGeometry*>(nullptr));
      case ShapeKind::hull:
        return visit(static_cast<HullGeometry*>(nullptr));
      case ShapeKind::ellipsoid:
        return visit(static_cast<EllipsoidGeometry*>(nullptr));
      case ShapeKind::triangle:
        return visit(static_cast<Corners*>(nullptr));
      default:
        return visit(static_cast<HalfSpaceGeometry*>(nullptr));
    }
  }

  /// Triangles and half-spaces are second, except for a triangle over a half-space.
  template <typename A, typename B>
  static PairFunction function_for(ContactLevel level) {
    constexpr bool kOverPlane = std::is_same_v<B, HalfSpaceGeometry>;
    if constexpr (std::is_same_v<A, HalfSpaceGeometry> ||
                  (std::is_same_v<A, Corners> && !kOverPlane)) {
      return nullptr;
    } else if constexpr (kOverPlane) {  // FCL has no distances from half-spaces
      return pick(level, &Self::template verdict<A, B>, nullptr, &Self::template contacts<A, B>);
    } else {
      return pick(level, &Self::template verdict<A, B>, &Self::template distance<A, B>,
                  &Self::template contacts<A, B>);
    }
  }

  template <typename Shape>
  static const Shape& shape_of(const Body& body) {
    return *static_cast<const Shape*>(body.geometry);
  }

  /// Calls a solver function that returns a verdict; true if it throws.
  template <typename Question>
  static bool call_solver(Question&& question) {
    try {
      return question();
    } catch (const std::exception&) {
      return true;
    }
  }

  static void write_points(const Vector& a, const Vector& b, double distance,
                           NarrowAnswer& answer) {
    answer.overlap = distance <= 0.0;
    answer.distance = distance;
    answer.point = a;
    answer.normal = (b - a) / distance;
  }

  /// EPA of the solver "indep" returns negative depths, and normals in the axes of a.
  static void normalize_contact(fcl::ContactPoint<double>& contact, const Transform& a) {
    if (contact.penetration_depth >= 0.0) return;
    contact.penetration_depth = -contact.penetration_depth;
    contact.normal = a.linear() * contact.normal;
  }

  void write_contacts(bool overlap, const Body& a, NarrowAnswer& answer) {
    answer = {};
    for (auto& contact : contacts_) normalize_contact(contact, a.at);
    answer.overlap = overlap;
    answer.contacts = static_cast<std::uint32_t>(contacts_.size());
    if (contacts_.empty()) return;
    const auto* deepest = &contacts_.front();
    for (const auto& contact : contacts_) {
      if (contact.penetration_depth > deepest->penetration_depth) deepest = &contact;
    }
    answer.distance = -deepest->penetration_depth;
    answer.normal = deepest->normal;
    answer.point = deepest->pos;
  }

  template <typename Shape>
  bool overlaps_triangle(const Body& body, const Body& triangle, Contacts* contacts) {
    const auto& at = triangle.corners;
    fcl::ContactPoint<double> contact;
    const bool needs_contact = contacts != nullptr;
    const bool overlap = call_solver([&] {
      return solver_.shapeTriangleIntersect(shape_of<Shape>(body), body.at, at[0], at[1], at[2],
                                            triangle.at, needs_contact ? &contact.pos : nullptr,
                                            needs_contact ? &contact.penetration_depth : nullptr,
                                            needs_contact ? &contact.normal : nullptr);
    });
    if (!needs_contact || !overlap) return overlap;
    // EPA's normals of triangles point from b to a.
    if (contact.penetration_depth < 0.0) contact.normal = -contact.normal;
    contacts->push_back(contact);
    return true;
  }

  // Calls the solver's function for two shapes, or for a shape and a triangle; the triangle's type
  // is Corners.

  template <typename A, typename B>
  bool intersect(const Body& a, const Body& b, Contacts* contacts) {
    if constexpr (std::is_same_v<B, Corners>) {
      return overlaps_triangle<A>(a, b, contacts);
    } else if constexpr (std::is_same_v<A, Corners>) {
      const bool overlap = overlaps_triangle<B>(b, a, contacts);
      if (overlap && contacts != nullptr) contacts->back().normal = -contacts->back().normal;
      return overlap;
    } else {
      return call_solver([&] {
        return solver_.shapeIntersect(shape_of<A>(a), a.at, shape_of<B>(b), b.at, contacts);
      });
    }
  }

  template <typename A, typename B>
  bool are_apart(const Body& a, const Body& b, double& distance, Vector& on_a, Vector& on_b) {
    if constexpr (std::is_same_v<B, Corners>) {
      const auto& [p, q, r] = b.corners;
      return solver_.shapeTriangleDistance(shape_of<A>(a), a.at, p, q, r, b.at, &distance, &on_a,
                                           &on_b);
    } else {
      return solver_.shapeDistance(shape_of<A>(a), a.at, shape_of<B>(b), b.at, &distance, &on_a,
                                   &on_b);
    }
  }

  template <typename A, typename B>
  void verdict(const BodyPair& pair, NarrowAnswer& answer) {
    answer.overlap = intersect<A, B>(bodies_[pair.a], bodies_[pair.b], no_contacts_);
  }

  template <typename A, typename B>
  void contacts(const BodyPair& pair, NarrowAnswer& answer) {
    contacts_.clear();
    const bool overlap = intersect<A, B>(bodies_[pair.a], bodies_[pair.b], &contacts_);
    write_contacts(overlap, bodies_[pair.a], answer);
  }

  template <typename A, typename B>
  void distance(const BodyPair& pair, NarrowAnswer& answer) {
    double distance = 0.0;
    Vector on_a;
    Vector on_b;
    const bool apart = are_apart<A, B>(bodies_[pair.a], bodies_[pair.b], distance, on_a, on_b);
    if (apart && distance > 0.0) {
      write_points(on_a, on_b, distance, answer);
    } else {
      contacts<A, B>(pair, answer);
      answer.overlap = true;
    }
  }

  static Transform relative(const Body& a, const Body& b) {
    return a.at.inverse(Eigen::Isometry) * b.at;
  }

  void cross(const BodyPair& pair, NarrowAnswer& answer) {
    const Body& a = bodies_[pair.a];
    const Body& b = bodies_[pair.b];
    const auto& [p, q, r] = a.corners;
    const auto& [s, t, u] = b.corners;
    answer.overlap = TriangleTests::intersect_Triangle(p, q, r, s, t, u, relative(a, b));
  }

  void cut(const BodyPair& pair, NarrowAnswer& answer) {
    const Body& a = bodies_[pair.a];
    const Body& b = bodies_[pair.b];
    const auto& [p, q, r] = a.corners;
    const auto& [s, t, u] = b.corners;
    Vector points[8];
    unsigned int count = 0;
    double depth = 0.0;
    Vector normal;
    answer = {};
    answer.overlap = TriangleTests::intersect_Triangle(p, q, r, s, t, u, relative(a, b), points,
                                                       &count, &depth, &normal);
    answer.contacts = count;
  }

  void triangle_gap(const BodyPair& pair, NarrowAnswer& answer) {
    const Body& a = bodies_[pair.a];
    const Body& b = bodies_[pair.b];
    Vector on_a;
    Vector on_b;
    const double distance = TriangleDistances::triDistance(a.corners.data(), b.corners.data(),
                                                           relative(a, b), on_a, on_b);
    if (distance > 0.0) {
      write_points(a.at * on_a, a.at * on_b, distance, answer);
    } else {
      answer = {};
      answer.overlap = true;
    }
  }

  Solver solver_;
  std::vector<std::shared_ptr<Geometry>> geometries_;
  std::vector<Body> bodies_;
  Contacts contacts_;
  /// Always null. If the compiler could see that, it would warn about unreachable code of FCL.
  Contacts* no_contacts_ = nullptr;
};

const RegisteredPeer<NarrowEngine, FclNarrow<fcl::detail::GJKSolver_libccd<double>>>
    kFclNarrowLibccd;
const RegisteredPeer<NarrowEngine, FclNarrow<fcl::detail::GJKSolver_indep<double>>> kFclNarrowIndep;

}  // namespace
}  // namespace winnow::bench
