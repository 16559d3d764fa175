#include "bench/contenders/engines.h"
#include "bench/peers/bullet_shapes.h"
#include "bench/peers/registry.h"

#include <BulletCollision/NarrowPhaseCollision/btContinuousConvexCollision.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btSubSimplexConvexCast.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <vector>

namespace winnow::bench {
namespace {

using namespace in_bullet;

/// Bullet's casts of convex shapes, in float and without margins: conservative advancement of both
/// shapes with translation and rotation, or its sub-simplex cast, without rotation. Motions are
/// given by their ends, so rotations of more than half a turn are not supported.
template <typename Cast>
class BulletImpacts final : public ImpactAdapter<BulletImpacts<Cast>> {
 public:
  static constexpr bool kTurns = std::is_same_v<Cast, btContinuousConvexCollision>;

  [[nodiscard]] std::string name() const override {
    return kTurns ? "Bullet continuous" : "Bullet sub-simplex";
  }
  [[nodiscard]] bool takes(const PairKind& kind, PairTurn turn) const override {
    // Bullet casts convex shapes, but has no ellipsoids; only conservative advancement supports
    // planes.
    if (kind.a == ShapeKind::ellipsoid || kind.b == ShapeKind::ellipsoid) return false;
    if (!kTurns && kind.b == ShapeKind::half_space) return false;
    return turn == PairTurn::none || (kTurns && turn == PairTurn::little);
  }

  void start(const MovingPairSet& set) override {
    const PairSet& middle = *set.middle;
    for (std::size_t i = 0; i < middle.shapes.size(); ++i) {
      const ShapeId id = middle.shapes[i];
      const btTransform from = transform_of(set.motions[i].at(0.0));
      const btTransform to = transform_of(set.motions[i].at(1.0));
      const ShapeTables& tables = middle.pool.tables();
      if (id.kind() == ShapeKind::half_space) {
        bodies_.push_back({nullptr, make_plane(tables.half_spaces[id.index()]), from, to});
        continue;
      }
      Body body{make_shape(tables, id, 0.0), nullptr, from, to};
      const bool round = id.kind() == ShapeKind::sphere || id.kind() == ShapeKind::capsule ||
                         id.kind() == ShapeKind::tapered_capsule;
      if (!round) body.shape->setMargin(0);
      bodies_.push_back(std::move(body));
    }
  }

  ImpactAnswer impact(const BodyPair& pair) {
    btConvexCast::CastResult result;
    const bool hit = cast(bodies_[pair.a], bodies_[pair.b], result);
    return {hit, hit ? static_cast<double>(result.m_fraction) : 1.0};
  }

 private:
  /// Either a convex shape or a plane.
  struct Body {
    std::unique_ptr<btConvexShape> shape;
    std::unique_ptr<btStaticPlaneShape> plane;
    btTransform from;
    btTransform to;
  };

  bool cast(const Body& a, const Body& b, btConvexCast::CastResult& result) {
    if constexpr (kTurns) {
      if (b.plane != nullptr) {
        return Cast(a.shape.get(), b.plane.get())
            .calcTimeOfImpact(a.from, a.to, b.from, b.to, result);
      }
      Cast way(a.shape.get(), b.shape.get(), &simplex_, &depth_);
      return way.calcTimeOfImpact(a.from, a.to, b.from, b.to, result);
    } else {
      Cast way(a.shape.get(), b.shape.get(), &simplex_);
      return way.calcTimeOfImpact(a.from, a.to, b.from, b.to, result);
    }
  }

  btVoronoiSimplexSolver simplex_;
  btGjkEpaPenetrationDepthSolver depth_;
  std::vector<Body> bodies_;
};

const RegisteredPeer<ImpactEngine, BulletImpacts<btContinuousConvexCollision>>
    kBulletImpactsContinuous;
const RegisteredPeer<ImpactEngine, BulletImpacts<btSubsimplexConvexCast>> kBulletImpactsSubSimplex;

}  // namespace
}  // namespace winnow::bench
