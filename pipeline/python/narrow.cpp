// Pairs of convex shapes: overlaps, distances, contacts.

#include "pipeline/python/contact_choices.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/pool.h"
#include "pipeline/python/shared_shapes.h"

#include <winnow/pipeline/narrow_phase.h>

#include <utility>

namespace winnow::python {
namespace {

/// A narrow phase with its scratch memory, for one call at a time.
struct SharedNarrowPhase : NeedsInit {
  std::shared_mutex mutex;
  NarrowPhase narrow;
  Execution execution = Execution::parallel();
  std::shared_ptr<Pool<NarrowResult>> results = std::make_shared<Pool<NarrowResult>>();
};

/// Columns of a result that nobody writes to any more.
struct NarrowAnswers : NeedsInit {
  std::shared_ptr<NarrowResult> result;
};

[[nodiscard]] std::shared_ptr<NarrowAnswers> collide(
    SharedNarrowPhase& phase, const SharedShapes& shapes, py::handle shape_of, py::handle poses,
    py::handle pair_array, const std::string& level, const std::string& tier, double margin) {
  const NarrowOptions options{chosen(kLevels, level, "level"), chosen(kTiers, tier, "tier"), margin,
                              phase.execution};
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
      "Answers as columns, sorted by the kinds of shapes. They show what winnow wrote, to be read, "
      "and never change. Vectors are tuples of an array for each axis: numpy.stack(v, axis=1) "
      "makes rows of them.")
      .def("__len__", [](const Answers& a) { return a.result->size(); })
      .def_property_readonly(
          "level", [](const Answers& a) { return name_of(kLevels, a.result->level()); },
          "What was asked.")
      .def_property_readonly("pair", &pair_numbers,
                             "Which pair of the input each answer is about: (n,) uint32.")
      .def_property_readonly("overlaps", &overlaps, "Whether they share a point: (n,) bool.")
      .def_property_readonly(
          "distance", [](const Answers& a) { return column(a, a.result->distance()); },
          "Levels distance and manifold: negative by the depth. (n,) float64.")
      .def_property_readonly(
          "error_bound", [](const Answers& a) { return column(a, a.result->error_bound()); },
          "The true distance is within distance +- this. (n,) float64.")
      .def_property_readonly(
          "normal",
          [](const Answers& a) {
            return py::make_tuple(column(a, a.result->normal(0)), column(a, a.result->normal(1)),
                                  column(a, a.result->normal(2)));
          },
          "Unit, from a to b, in the axes of the world: three (n,) float64.")
      .def_property_readonly(
          "point",
          [](const Answers& a) {
            return py::make_tuple(column(a, a.result->point(0)), column(a, a.result->point(1)),
                                  column(a, a.result->point(2)));
          },
          "Level distance: the closest or deepest point of a, relative to its "
          "position; that of b is distance * normal farther. Three (n,).")
      .def_property_readonly(
          "contact_first", [](const Answers& a) { return column(a, a.result->contact_first()); },
          "Level manifold: contacts of answer i are contact_first[i], + contact_count[i]. (n,).")
      .def_property_readonly(
          "contact_count", [](const Answers& a) { return column(a, a.result->contact_count()); },
          "At most 4 each, (n,) uint32.")
      .def_property_readonly(
          "contact_position",
          [span_of](const Answers& a) {
            const auto& c = a.result->contact_columns().position;
            return py::make_tuple(column<float>(a, span_of(c[0])), column<float>(a, span_of(c[1])),
                                  column<float>(a, span_of(c[2])));
          },
          "Halfway between the surfaces, relative to the position of a: three "
          "(m,) float32.")
      .def_property_readonly(
          "contact_depth",
          [span_of](const Answers& a) {
            return column<float>(a, span_of(a.result->contact_columns().depth));
          },
          "Positive where they overlap: (m,) float32.")
      .def_property_readonly(
          "contact_feature",
          [span_of](const Answers& a) {
            return column<std::uint64_t>(a, span_of(a.result->contact_columns().feature));
          },
          "Which features of a and b made it, the same from frame to frame: "
          "(m,) uint64.");
}

}  // namespace

void add_narrow(py::module_& module) {
  using py::arg;
  add_answers(module);
  using Phase = SharedNarrowPhase;
  py::class_<Phase, std::shared_ptr<Phase>>(
      module, "NarrowPhase",
      "Pairs of convex shapes to overlaps, distances or contacts. Keeps its scratch memory; calls "
      "of several threads wait for each other.")
      .def(py::init([](bool parallel) {
             auto phase = std::make_shared<Phase>();
             if (!parallel) phase->execution = Execution::serial();
             return phase;
           }),
           py::kw_only(), arg("parallel") = true, "`parallel` uses all cores.")
      .def("collide", &collide, arg("shapes"), arg("shape_of"), arg("poses"), arg("pairs"),
           py::kw_only(), arg("level") = "manifold", arg("tier") = "robust", arg("margin") = 0.0,
           "Answers pairs (m, 2) uint32 of bodies: body i has the shape shape_of[i], (n,) or one "
           "for all, at poses (n, 7) of x, y, z and a quaternion w, x, y, z, (n, 3), or a tuple of "
           "both. `level`: 'boolean', 'distance' or 'manifold'; `tier`: 'robust' or "
           "'reference'. Pairs no farther apart than `margin` get contacts, too. Pairs of uint32 "
           "and poses (n, 7) of double in one piece are read where they lie.")
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
