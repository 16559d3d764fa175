// What bodies of a scene meet on their way from frame to frame.

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

constexpr Choices<SweepPairs, 4> kSweepPairs{
    {{"all", SweepPairs::all},
     {"fixed", SweepPairs::fixed},
     {"bullets", SweepPairs::bullets},
     {"bullets_and_fixed", SweepPairs::bullets_and_fixed}}};

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

/// Options as Python has them, with what they point to.
class SweepInput {
 public:
  /// Of `count` bodies that move.
  SweepInput(std::size_t count, const std::string& pairs, py::handle bullets, double tolerance,
             bool touching, bool first_only)
      : options_{chosen(kSweepPairs, pairs, "pairs"), {}, tolerance, touching, first_only} {
    if (bullets.is_none()) return;
    const py::array flags = py::array::ensure(bullets);
    if (!flags || flags.dtype().kind() != 'b') {
      throw py::type_error("bullets: (n,) bool is wanted");
    }
    bullets_.emplace(flags.attr("astype")("u1"), "bullets");
    if (bullets_->count() != count) {
      throw Refusal(Status::size_mismatch, "bullets: one flag for each key is wanted");
    }
    options_.bullets = bullets_->values();
  }
  [[nodiscard]] const SweepOptions& options() const noexcept { return options_; }

 private:
  std::optional<Integers<std::uint8_t>> bullets_;
  SweepOptions options_;
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

/// The impacts of a sweep that ask(sweep) makes.
template <typename Ask>
[[nodiscard]] ImpactTable swept(SharedScene& s, const char* call, Ask&& ask) {
  std::vector<SceneImpact> impacts;
  std::vector<std::uint32_t> first;
  const auto sweep = [&] {
    if (!s.sweep) s.sweep.emplace(s.scene);
    const Status status = ask(*s.sweep);
    if (status != Status::ok) return status;
    impacts.assign((*s.sweep)->impacts().begin(), (*s.sweep)->impacts().end());
    first.assign((*s.sweep)->first().begin(), (*s.sweep)->first().end());
    return status;
  };
  accept(s.working(sweep), call);
  return shown_impacts(std::move(impacts), std::move(first));
}

[[nodiscard]] ImpactTable sweep(SharedScene& s, py::handle key_array, py::handle ends,
                                const std::string& pairs, py::handle bullets, double tolerance,
                                bool touching, bool first_only) {
  const KeyInput keys(key_array);
  const PoseInput end(ends);
  const SweepInput input(keys.count(), pairs, bullets, tolerance, touching, first_only);
  std::vector<Pose> room;
  return swept(s, "sweep", [&](RecordableSweep& sweep) {
    return sweep.sweep(keys.keys(), end.view(room), input.options());
  });
}

[[nodiscard]] ImpactTable sweep_motions(SharedScene& s, py::handle key_array, py::handle motions,
                                        const std::string& pairs, py::handle bullets,
                                        double tolerance, bool touching, bool first_only) {
  const KeyInput keys(key_array);
  const RigidMotionInput motion(motions);
  const SweepInput input(keys.count(), pairs, bullets, tolerance, touching, first_only);
  std::vector<RigidMotion> room;
  return swept(s, "sweep_motions", [&](RecordableSweep& sweep) {
    return sweep.sweep(keys.keys(), motion.packed(room), input.options());
  });
}

void add_table(py::module_& module) {
  using Table = ImpactTable;
  py::class_<Table>(module, "SceneImpacts",
                    "Bodies that meet on their way, by time, then by the ids of a and b.")
      .def_readonly("a", &Table::a, "Keys of the bodies with the smaller ids, (m,) uint64.")
      .def_readonly("b", &Table::b, "Keys of the others, (m,) uint64.")
      .def_readonly("data_a", &Table::data_a, "Client data of a, (m,) uint64.")
      .def_readonly("data_b", &Table::data_b, "Client data of b, (m,) uint64.")
      .def_readonly("part_a", &Table::part_a,
                    "Triangle or child of a, WHOLE_SHAPE of convex bodies: (m,) uint32.")
      .def_readonly("part_b", &Table::part_b, "The same of b.")
      .def_readonly("time", &Table::time,
                    "In [0, 1], never late: before it the two are apart. (m,) float64.")
      .def_readonly("gap", &Table::gap,
                    "At that time; negative by the depth of bodies that overlap at the start: "
                    "(m,) float64.")
      .def_readonly("error_bound", &Table::error_bound, "Of the gap, (m,) float64.")
      .def_readonly("normal", &Table::normal, "Unit, from a to b, at that time: (m, 3) float64.")
      .def_readonly("point", &Table::point, "Of a at that time, in the world: (m, 3) float64.")
      .def_readonly("first", &Table::first,
                    "By moving body, the number of its first impact, or NO_IMPACT: (n,) uint32.");
}

}  // namespace

void add_sweeps(py::module_& module, SceneClass& scene) {
  using py::arg;
  module.attr("NO_IMPACT") = kNoImpact;
  add_table(module);
  scene
      .def("sweep", &sweep, arg("keys"), arg("ends"), py::kw_only(), arg("pairs") = "all",
           arg("bullets") = py::none(), arg("tolerance") = 1e-6, arg("touching") = true,
           arg("first_only") = false,
           "What bodies (n,) meet on their way from where they are to their ends, poses as in "
           "`add`, turning by the shorter way; positions (n, 3) alone do not turn. All others "
           "stand, and nothing is moved: SceneImpacts, the first of each pair of bodies. `pairs`: "
           "'all', 'fixed' (with fixed bodies), 'bullets' (of those, (n,) bool, with all), or "
           "'bullets_and_fixed'. `tolerance` as in `time_of_impact`. `touching` false leaves out "
           "bodies that share a point at the start; `first_only` looks for the first impact of "
           "each moving body alone. size_mismatch; invalid_key, also for a key that occurs twice; "
           "invalid_pose for an end that is none or too far away; invalid_argument for bad "
           "options. O(n log n) and about log of all bodies for each, and `time_of_impact` for "
           "each pair whose boxes meet.")
      .def("sweep_motions", &sweep_motions, arg("keys"), arg("motions"), py::kw_only(),
           arg("pairs") = "all", arg("bullets") = py::none(), arg("tolerance") = 1e-6,
           arg("touching") = true, arg("first_only") = false,
           "The same of any motions (n, 13), such as `motions_by_velocities` gives; each starts "
           "where it says.");
}

}  // namespace winnow::python
