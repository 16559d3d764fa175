// The class NarrowPhase: overlaps, distances and contacts of pairs of convex shapes.

#include "pipeline/python/contact_choices.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/pool.h"
#include "pipeline/python/shared_shapes.h"

#include <winnow/pipeline/narrow_phase.h>

#include <utility>

namespace winnow::python {
namespace {

/// A narrow phase with its scratch memory; runs one call at a time.
struct SharedNarrowPhase : NeedsInit {
  std::shared_mutex mutex;
  NarrowPhase narrow;
  Execution execution = Execution::parallel();
  std::shared_ptr<Pool<NarrowResult>> results = std::make_shared<Pool<NarrowResult>>();
};

/// Columns of a result that is not changed any more.
struct NarrowAnswers : NeedsInit {
  std::shared_ptr<NarrowResult> result;
};

[[nodiscard]] std::shared_ptr<NarrowAnswers> collide(
    SharedNarrowPhase& phase, const SharedShapes& shapes, py::handle shape_of, py::handle poses,
    py::handle pair_array, const std::string& level, const std::string& tier,
    double contact_margin) {
  const NarrowOptions options{chosen(kLevels, level, "level"), chosen(kTiers, tier, "tier"),
                              contact_margin, phase.execution};
  const PoseInput pose(poses);
  const ShapeInput shape(shape_of, "shape_of");
  shape.expect(pose.count());
  const Integers<std::uint32_t> pairs(pair_array, "pairs", 2);
  static_assert(sizeof(BodyPair) == 2 * sizeof(std::uint32_t));
  const std::span<const BodyPair> list(reinterpret_cast<const BodyPair*>(pairs.values().data()),
                                       pairs.count());
  auto answers = std::make_shared<NarrowAnswers>();
  answers->result = phase.results->take();
  std::uint32_t bad_body = 0;
  const Status status = shapes.raised.during([&] {
    return changing(phase.mutex, [&] {
      std::vector<ShapeId> ids;
      std::vector<Pose> room;
      const std::shared_lock lock(shapes.mutex);
      const Status done =
          phase.narrow.collide(shapes.pool, {shape.list(pose.count(), ids), pose.packed(room)},
                               list, options, *answers->result);
      bad_body = phase.narrow.bad_body();
      return done;
    });
  });
  accept(status, "collide, body " + std::to_string(bad_body));
  return answers;
}

// --- columns -----------------------------------------------------------------------------------

/// A column of the result.
template <typename T>
[[nodiscard]] py::array column(const NarrowAnswers& answers, std::span<const T> values) {
  return shown(std::shared_ptr<const void>(answers.result), values.data(), values.size());
}

[[nodiscard]] py::array pair_numbers(const NarrowAnswers& answers) {
  std::vector<std::uint32_t> numbers(answers.result->size());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = answers.result->pair_of(i);
  return given(std::move(numbers));
}

[[nodiscard]] py::array overlaps(const NarrowAnswers& answers) {
  auto result = fresh<bool>(answers.result->size());
  for (std::size_t i = 0; i < answers.result->size(); ++i) {
    result.mutable_at(i) = answers.result->overlaps(i);
  }
  return result;
}

void add_answers(py::module_& module) {
  using Answers = NarrowAnswers;
  const auto span_of = [](const auto& c) { return std::span(c.data(), c.size()); };
  py::class_<Answers, std::shared_ptr<Answers>>(
      module, "NarrowResult",
      "Results as columns, sorted by the kinds of shapes. They are read-only views that never "
      "change; vectors are new arrays.")
      .def("__len__", [](const Answers& a) { return a.result->size(); })
      .def_property_readonly(
          "level", [](const Answers& a) { return name_of(kLevels, a.result->level()); },
          "The level of the call.")
      .def_property_readonly("pair", &pair_numbers,
                             "Index of the input pair of each result: (n,) uint32.")
      .def_property_readonly("overlaps", &overlaps, "True if they overlap: (n,) bool.")
      .def_property_readonly(
          "distance", [](const Answers& a) { return column(a, a.result->distance()); },
          "Levels distance and manifold: distance, negative if they overlap. (n,) float64.")
      .def_property_readonly(
          "error_bound", [](const Answers& a) { return column(a, a.result->error_bound()); },
          "The true distance is within distance +- this. (n,) float64.")
      .def_property_readonly(
          "normal",
          [](const Answers& a) {
            return vectors([&](int axis) { return a.result->normal(axis); });
          },
          "Unit vector from a to b, in world axes: (n, 3) float64.")
      .def_property_readonly(
          "point",
          [](const Answers& a) { return vectors([&](int axis) { return a.result->point(axis); }); },
          "Level distance: the closest or deepest point of a, relative to its position; the point "
          "of b is distance * normal farther. (n, 3) float64.")
      .def_property_readonly(
          "contact_first", [](const Answers& a) { return column(a, a.result->contact_first()); },
          "Level manifold: index of the first contact of each result, which has contact_count "
          "contacts. (n,).")
      .def_property_readonly(
          "contact_count", [](const Answers& a) { return column(a, a.result->contact_count()); },
          "Number of contacts, at most 4 each, (n,) uint32.")
      .def_property_readonly(
          "contact_position",
          [span_of](const Answers& a) {
            const auto& c = a.result->contact_columns().position;
            return vectors([&](int axis) { return span_of(c[axis]); });
          },
          "Position halfway between the surfaces, relative to the position of a: (m, 3) "
          "float32.")
      .def_property_readonly(
          "contact_depth",
          [span_of](const Answers& a) {
            return column<float>(a, span_of(a.result->contact_columns().depth));
          },
          "Depth, positive if they overlap: (m,) float32.")
      .def_property_readonly(
          "contact_feature",
          [span_of](const Answers& a) {
            return column<std::uint64_t>(a, span_of(a.result->contact_columns().feature));
          },
          "The features of a and b that made the contact, the same from frame to frame: (m,) "
          "uint64.");
}

}  // namespace

void add_narrow(py::module_& module) {
  using py::arg;
  add_answers(module);
  using Phase = SharedNarrowPhase;
  py::class_<Phase, std::shared_ptr<Phase>>(
      module, "NarrowPhase",
      "Tests pairs of convex shapes for overlaps, distances or contacts. Keeps its scratch memory; "
      "calls from several threads run one at a time.")
      .def(py::init([](bool parallel) {
             auto phase = std::make_shared<Phase>();
             if (!parallel) phase->execution = Execution::serial();
             return phase;
           }),
           py::kw_only(), arg("parallel") = true, "`parallel` uses all cores.")
      .def("collide", &collide, arg("shapes"), arg("shape_of"), arg("poses"), arg("pairs"),
           py::kw_only(), arg("level") = "manifold", arg("tier") = "robust",
           arg("contact_margin") = 0.0,
           "Computes results for pairs (m, 2) uint32 of bodies: body i has the shape shape_of[i], "
           "(n,) or one for all, at poses (n, 7) of x, y, z and a quaternion w, x, y, z, (n, 3), "
           "or a tuple of both. `level`: 'boolean', 'distance' or 'manifold'; `tier`: 'robust' or "
           "'reference'. Pairs at most `contact_margin` apart get contacts too. Contiguous pairs "
           "of uint32 "
           "and poses (n, 7) of double are read in place.")
      .def(
          "statistics",
          [](Phase& phase) {
            const NarrowStatistics s =
                reading(phase.mutex, [&] { return phase.narrow.statistics(); });
            return narrow_statistics(s);
          },
          "Counters of the last call.");
}

}  // namespace winnow::python
