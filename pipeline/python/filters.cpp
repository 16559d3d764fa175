// The class Filter, with Python functions as predicates.

#include "pipeline/python/filters.h"

#include "pipeline/python/arrays.h"
#include "pipeline/python/refusal.h"

#include <bit>
#include <cstdint>
#include <memory>
#include <optional>

namespace winnow::python {

void FilterOfCall::take(const PythonFilter& input) {
  filter_ = input.filter;
  if (!input.accept || input.accept.is_none()) return;
  accept_.emplace(input.accept, "accept");
  filter_.predicate = {[](void* context, Key key, ClientData data) {
                         return static_cast<Predicate*>(context)->passes(
                             std::bit_cast<std::uint64_t>(key), data);
                       },
                       &*accept_};
}

const Filter& FilterOfCall::in_partition() {
  if (filter_.layer != kEveryLayer || filter_.ignored != Key{}) {
    throw Refusal(Status::unsupported, "filter: `layer` and `ignored` are for queries of scenes");
  }
  in_partition_ = {filter_.layers, filter_.mask, filter_.environment, filter_.predicate};
  return in_partition_;
}

namespace {

[[nodiscard]] std::shared_ptr<PythonFilter> make_filter(std::uint32_t layers, std::uint32_t mask,
                                                        std::uint32_t environment,
                                                        const py::object& accept,
                                                        std::optional<std::uint16_t> layer,
                                                        std::optional<std::uint64_t> ignored) {
  if (layer.value_or(0) >= kSceneLayers) {
    throw Refusal(Status::invalid_argument, "layer: it is out of range");
  }
  if (!accept.is_none()) static_cast<void>(PythonFunction(accept, "accept"));
  auto made = std::make_shared<PythonFilter>();
  made->filter = {.layers = layers,
                  .mask = mask,
                  .environment = environment,
                  .layer = layer.value_or(kEveryLayer)};
  if (ignored) made->filter.ignored = std::bit_cast<Key>(*ignored);
  made->accept = accept;
  return made;
}

[[nodiscard]] std::optional<std::uint16_t> layer_of(const PythonFilter& f) {
  if (f.filter.layer == kEveryLayer) return std::nullopt;
  return f.filter.layer;
}

[[nodiscard]] std::optional<std::uint64_t> ignored_by(const PythonFilter& f) {
  if (f.filter.ignored == Key{}) return std::nullopt;
  return std::bit_cast<std::uint64_t>(f.filter.ignored);
}

}  // namespace

void add_filters(py::module_& module) {
  Class<PythonFilter>(module, "Filter")
      .def(py::init(&make_filter))
      .property("layers", [](const PythonFilter& f) { return f.filter.layers; })
      .property("mask", [](const PythonFilter& f) { return f.filter.mask; })
      .property("environment", [](const PythonFilter& f) { return f.filter.environment; })
      .property("layer", &layer_of)
      .property("ignored", &ignored_by)
      .property("accept", [](const PythonFilter& f) { return f.accept; });
}

}  // namespace winnow::python
