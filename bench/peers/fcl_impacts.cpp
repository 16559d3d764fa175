#include "bench/contenders/engines.h"
#include "bench/peers/fcl_shapes.h"
#include "bench/peers/registry.h"

#include <fcl/narrowphase/continuous_collision.h>

#include <exception>
#include <vector>

namespace winnow::bench {
namespace {

using namespace in_fcl;

/// FCL's continuous collision in double, by conservative advancement of linear motions. It uses
/// FCL's own GJK; libccd's is slower here (measured by bench/micro). Motions are given by
/// their ends, so rotations of more than half a turn are not supported. A pair for which FCL throws
/// counts as no hit.
class FclImpacts final : public ImpactAdapter<FclImpacts> {
 public:
  FclImpacts() {
    request_.ccd_motion_type = fcl::CCDM_LINEAR;
    request_.ccd_solver_type = fcl::CCDC_CONSERVATIVE_ADVANCEMENT;
    request_.gjk_solver_type = fcl::GST_INDEP;
  }

  [[nodiscard]] std::string name() const override { return "FCL continuous"; }
  [[nodiscard]] bool takes(const PairKind& kind, PairTurn turn) const override {
    using enum ShapeKind;
    for (const ShapeKind missing : {triangle, half_space, ellipsoid, tapered_capsule, support}) {
      if (kind.a == missing || kind.b == missing) return false;
    }
    return turn != PairTurn::whirl;
  }

  void start(const MovingPairSet& set) override {
    const PairSet& middle = *set.middle;
    for (std::size_t i = 0; i < middle.shapes.size(); ++i) {
      bodies_.push_back({make_geometry(middle.pool.tables(), middle.shapes[i]),
                         transform_of(set.motions[i].at(0.0)),
                         transform_of(set.motions[i].at(1.0))});
      bodies_.back().geometry->computeLocalAABB();
    }
  }

  ImpactAnswer impact(const BodyPair& pair) {
    const Body& a = bodies_[pair.a];
    const Body& b = bodies_[pair.b];
    fcl::ContinuousCollisionResult<double> result;
    try {
      fcl::continuousCollide(a.geometry.get(), a.from, a.to, b.geometry.get(), b.from, b.to,
                             request_, result);
    } catch (const std::exception&) {
      result.is_collide = false;
    }
    return {result.is_collide, result.is_collide ? result.time_of_contact : 1.0};
  }

 private:
  struct Body {
    std::shared_ptr<Geometry> geometry;
    Transform from;
    Transform to;
  };

  fcl::ContinuousCollisionRequest<double> request_;
  std::vector<Body> bodies_;
};

const RegisteredPeer<ImpactEngine, FclImpacts> kFclImpacts;

}  // namespace
}  // namespace winnow::bench
