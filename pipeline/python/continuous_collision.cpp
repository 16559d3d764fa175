// Continuous collision detection of a scene: impacts of moving bodies between two frames.

#include "pipeline/python/bodies.h"
#include "pipeline/python/entry_columns.h"
#include "pipeline/python/motions.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace winnow::python {
namespace {

constexpr Choices<ContinuousPairs, 4> kContinuousPairs{
    {{"all", ContinuousPairs::all},
     {"fixed", ContinuousPairs::fixed},
     {"bullets", ContinuousPairs::bullets},
     {"bullets_and_fixed", ContinuousPairs::bullets_and_fixed}}};

/// Options with the arrays that they point to.
class ContinuousInput {
 public:
  /// `count` is the number of moving bodies.
  ContinuousInput(std::size_t count, const std::string& pairs, py::handle bullets, double tolerance,
                  bool touching, bool first_only)
      : options_{chosen(kContinuousPairs, pairs, "pairs"), {}, tolerance, touching, first_only} {
    if (bullets.is_none()) return;
    const py::array flags = py::array::ensure(bullets);
    if (!flags || flags.dtype().kind() != 'b') {
      throw py::type_error("bullets: expected (n,) bool");
    }
    bullets_.emplace(flags.attr("astype")("u1"), "bullets");
    bullets_->expect(count);
    options_.bullets = bullets_->values();
  }
  [[nodiscard]] const ContinuousOptions& options() const noexcept { return options_; }

 private:
  std::optional<Integers<std::uint8_t>> bullets_;
  ContinuousOptions options_;
};

[[nodiscard]] py::object shown_impacts(std::vector<SceneImpact>&& impacts,
                                       std::vector<std::uint32_t>&& first) {
  const auto columns = columns_of(std::move(impacts));
  using I = SceneImpact;
  return columns.table("SceneImpacts", &I::a, &I::b, &I::data_a, &I::data_b, &I::part_a, &I::part_b,
                       &I::time, &I::gap, &I::error_bound, &I::normal, &I::point,
                       given(std::move(first)));
}

/// Returns the impacts that run(ccd) finds.
template <typename Run>
[[nodiscard]] py::object impacts_of_call(SharedScene& s, const char* call, Run&& run) {
  std::vector<SceneImpact> impacts;
  std::vector<std::uint32_t> first;
  const auto work = [&] {
    if (!s.ccd) s.ccd.emplace(s.scene);
    const Status status = run(*s.ccd);
    if (status != Status::ok) return status;
    impacts.assign(s.ccd->impacts().begin(), s.ccd->impacts().end());
    first.assign(s.ccd->first().begin(), s.ccd->first().end());
    return status;
  };
  accept(s.working(work), call);
  return shown_impacts(std::move(impacts), std::move(first));
}

[[nodiscard]] py::object find_impacts(SharedScene& s, py::handle key_array, py::handle ends,
                                      const std::string& pairs, py::handle bullets,
                                      double tolerance, bool touching, bool first_only) {
  const KeyInput keys(s, key_array);
  PoseInput end(ends, "ends");
  end.expect(keys.count());
  const ContinuousInput input(keys.count(), pairs, bullets, tolerance, touching, first_only);
  std::vector<Pose> room;
  return impacts_of_call(s, "find_impacts", [&](ContinuousCollision& ccd) {
    return ccd.find_impacts(keys.keys(), end.view(room), input.options());
  });
}

[[nodiscard]] py::object find_impacts_of_motions(SharedScene& s, py::handle key_array,
                                                 py::handle motions, const std::string& pairs,
                                                 py::handle bullets, double tolerance,
                                                 bool touching, bool first_only) {
  const KeyInput keys(s, key_array);
  RigidMotionInput motion(motions);
  motion.expect(keys.count());
  const ContinuousInput input(keys.count(), pairs, bullets, tolerance, touching, first_only);
  std::vector<RigidMotion> room;
  return impacts_of_call(s, "find_impacts_of_motions", [&](ContinuousCollision& ccd) {
    return ccd.find_impacts(keys.keys(), motion.packed(room), input.options());
  });
}

}  // namespace

void add_continuous_collision(py::module_& module, SceneClass& scene) {
  module.attr("NO_IMPACT") = kNoImpact;
  scene.def("find_impacts", &find_impacts).def("find_impacts_of_motions", &find_impacts_of_motions);
}

}  // namespace winnow::python
