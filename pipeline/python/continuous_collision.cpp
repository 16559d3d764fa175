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

struct ImpactTable : EmptyIfZero {
  py::array a;
  py::array b;
  py::array data_a;
  py::array data_b;
  py::array part_a;
  py::array part_b;
  py::array time;
  py::array gap;
  py::array error_bound;
  py::array normal;
  py::array point;
  py::array first;
};

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
    if (bullets_->count() != count) {
      throw Refusal(Status::size_mismatch, "bullets: expected one flag for each key");
    }
    options_.bullets = bullets_->values();
  }
  [[nodiscard]] const ContinuousOptions& options() const noexcept { return options_; }

 private:
  std::optional<Integers<std::uint8_t>> bullets_;
  ContinuousOptions options_;
};

[[nodiscard]] ImpactTable shown_impacts(std::vector<SceneImpact>&& impacts,
                                        std::vector<std::uint32_t>&& first) {
  const auto columns = columns_of(std::move(impacts));
  using I = SceneImpact;
  return {{},
          columns.column<std::uint64_t>(offsetof(I, a)),
          columns.column<std::uint64_t>(offsetof(I, b)),
          columns.column<std::uint64_t>(offsetof(I, data_a)),
          columns.column<std::uint64_t>(offsetof(I, data_b)),
          columns.column<std::uint32_t>(offsetof(I, part_a)),
          columns.column<std::uint32_t>(offsetof(I, part_b)),
          columns.column<double>(offsetof(I, time)),
          columns.column<double>(offsetof(I, gap)),
          columns.column<double>(offsetof(I, error_bound)),
          columns.rows<double>(offsetof(I, normal), 3),
          columns.rows<double>(offsetof(I, point), 3),
          given(std::move(first))};
}

/// Returns the impacts that run(ccd) finds.
template <typename Run>
[[nodiscard]] ImpactTable impacts_of_call(SharedScene& s, const char* call, Run&& run) {
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

[[nodiscard]] ImpactTable find_impacts(SharedScene& s, py::handle key_array, py::handle ends,
                                       const std::string& pairs, py::handle bullets,
                                       double tolerance, bool touching, bool first_only) {
  const KeyInput keys(key_array);
  const PoseInput end(ends);
  const ContinuousInput input(keys.count(), pairs, bullets, tolerance, touching, first_only);
  std::vector<Pose> room;
  return impacts_of_call(s, "find_impacts", [&](ContinuousCollision& ccd) {
    return ccd.find_impacts(keys.keys(), end.view(room), input.options());
  });
}

[[nodiscard]] ImpactTable find_impacts_of_motions(SharedScene& s, py::handle key_array,
                                                  py::handle motions, const std::string& pairs,
                                                  py::handle bullets, double tolerance,
                                                  bool touching, bool first_only) {
  const KeyInput keys(key_array);
  const RigidMotionInput motion(motions);
  const ContinuousInput input(keys.count(), pairs, bullets, tolerance, touching, first_only);
  std::vector<RigidMotion> room;
  return impacts_of_call(s, "find_impacts_of_motions", [&](ContinuousCollision& ccd) {
    return ccd.find_impacts(keys.keys(), motion.packed(room), input.options());
  });
}

void add_table(py::module_& module) {
  using Table = ImpactTable;
  py::class_<Table>(module, "SceneImpacts",
                    "Impacts of moving bodies, sorted by time, then by the ids of a and b.")
      .def_readonly("a", &Table::a, "Keys of the bodies with the smaller ids, (m,) uint64.")
      .def_readonly("b", &Table::b, "Keys of the others, (m,) uint64.")
      .def_readonly("data_a", &Table::data_a, "Client data of a, (m,) uint64.")
      .def_readonly("data_b", &Table::data_b, "Client data of b, (m,) uint64.")
      .def_readonly("part_a", &Table::part_a,
                    "Triangle or child of a, WHOLE_SHAPE for convex bodies: (m,) uint32.")
      .def_readonly("part_b", &Table::part_b, "Triangle or child of b, as part_a.")
      .def_readonly("time", &Table::time,
                    "Time in [0, 1], never late: before it the two are apart. (m,) float64.")
      .def_readonly("gap", &Table::gap,
                    "Gap at that time; negative if the bodies overlap at the start: (m,) float64.")
      .def_readonly("error_bound", &Table::error_bound, "Error bound of the gap, (m,) float64.")
      .def_readonly("normal", &Table::normal,
                    "Unit vector from a to b, at that time: (m, 3) float64.")
      .def_readonly("point", &Table::point,
                    "Point on a at that time, in the world: (m, 3) float64.")
      .def_readonly("first", &Table::first,
                    "By moving body, the number of its first impact, or NO_IMPACT: (n,) uint32.");
}

}  // namespace

void add_continuous_collision(py::module_& module, SceneClass& scene) {
  using py::arg;
  module.attr("NO_IMPACT") = kNoImpact;
  add_table(module);
  scene
      .def("find_impacts", &find_impacts, arg("keys"), arg("ends"), py::kw_only(),
           arg("pairs") = "all", arg("bullets") = py::none(), arg("tolerance") = 1e-6,
           arg("touching") = true, arg("first_only") = false,
           "Finds the impacts of bodies (n,) that move from their poses to `ends`, poses as in "
           "`add`, by the shorter rotation; with positions (n, 3) only they do not turn. All other "
           "bodies stay in place, and the scene does not change. Returns SceneImpacts: the first "
           "impact of each pair of bodies. `pairs`: 'all', 'fixed' (with fixed bodies), 'bullets' "
           "(of these, (n,) bool, with all), or 'bullets_and_fixed'. `tolerance` as in "
           "`time_of_impact`. `touching` false leaves out bodies that touch at the start; "
           "`first_only` finds only the first impact of each moving body. size_mismatch; "
           "invalid_key, also for a key that is given twice; invalid_pose for an end that is "
           "invalid or too far away; invalid_argument for bad options. O(n log n) and about log of "
           "all bodies for each, and `time_of_impact` for each pair whose boxes overlap.")
      .def("find_impacts_of_motions", &find_impacts_of_motions, arg("keys"), arg("motions"),
           py::kw_only(), arg("pairs") = "all", arg("bullets") = py::none(),
           arg("tolerance") = 1e-6, arg("touching") = true, arg("first_only") = false,
           "As `find_impacts`, for any motions (n, 13), such as those of `motions_by_velocities`; "
           "each "
           "starts at its own pose.");
}

}  // namespace winnow::python
