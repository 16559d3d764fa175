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
    py::handle contact_margin) {
  PoseInput pose(poses);
  ShapeInput shape(shapes, shape_of, "shape_of");
  Integers<std::uint32_t> pairs(pair_array, "pairs", 2);
  pairs.limit(agree({&pose, &shape}));
  Numbers margin(contact_margin, "contact_margin", {}, Valid::length);
  std::vector<double> margins;
  for (std::size_t i = 0; !margin.is_one() && i < margin.count(); ++i)
    margins.push_back(margin.at(i));
  margin.expect(pairs.count());
  const NarrowOptions options{chosen(kLevels, level, "level"), chosen(kTiers, tier, "tier"),
                              margin.is_one() ? margin.at(0) : 0.0, phase.execution, margins};
  static_assert(sizeof(BodyPair) == 2 * sizeof(std::uint32_t));
  const std::span<const BodyPair> list(reinterpret_cast<const BodyPair*>(pairs.values().data()),
                                       pairs.count());
  auto answers = std::make_shared<NarrowAnswers>();
  answers->result = phase.results->take();
  std::uint32_t bad_body = 0;
  const Status status = shapes.raised.during([&] {
    return changing(phase.mutex, [&] {
      std::vector<Pose> room;
      const std::shared_lock lock(shapes.mutex);
      const Status done = phase.narrow.collide(shapes.pool, {shape.list(), pose.packed(room)}, list,
                                               options, *answers->result);
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
  Class<Answers>(module, "NarrowResult")
      .def("__len__", [](const Answers& a) { return a.result->size(); })
      .property("level", [](const Answers& a) { return name_of(kLevels, a.result->level()); })
      .property("pair", &pair_numbers)
      .property("overlaps", &overlaps)
      .property("distance", [](const Answers& a) { return column(a, a.result->distance()); })
      .property("error_bound", [](const Answers& a) { return column(a, a.result->error_bound()); })
      .property("normal",
                [](const Answers& a) {
                  return vectors([&](int axis) { return a.result->normal(axis); });
                })
      .property(
          "point",
          [](const Answers& a) { return vectors([&](int axis) { return a.result->point(axis); }); })
      .property("contact_first",
                [](const Answers& a) { return column(a, a.result->contact_first()); })
      .property("contact_count",
                [](const Answers& a) { return column(a, a.result->contact_count()); })
      .property("contact_position",
                [span_of](const Answers& a) {
                  const auto& c = a.result->contact_columns().position;
                  return vectors([&](int axis) { return span_of(c[axis]); });
                })
      .property("contact_depth",
                [span_of](const Answers& a) {
                  return column<float>(a, span_of(a.result->contact_columns().depth));
                })
      .property("contact_feature", [span_of](const Answers& a) {
        return column<std::uint64_t>(a, span_of(a.result->contact_columns().feature));
      });
}

}  // namespace

void add_narrow(py::module_& module) {
  add_answers(module);
  using Phase = SharedNarrowPhase;
  Class<Phase>(module, "NarrowPhase")
      .def(py::init([](bool parallel) {
        auto phase = std::make_shared<Phase>();
        if (!parallel) phase->execution = Execution::serial();
        return phase;
      }))
      .def("collide", &collide)
      .def("statistics", [](Phase& phase) {
        const NarrowStatistics s = reading(phase.mutex, [&] { return phase.narrow.statistics(); });
        return narrow_statistics(s);
      });
}

}  // namespace winnow::python
