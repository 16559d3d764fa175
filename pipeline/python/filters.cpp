// The class Filter, with Python functions as predicates.

#include "pipeline/python/filters.h"

#include "pipeline/python/arrays.h"
#include "pipeline/python/refusal.h"

#include <cstring>
#include <string>

namespace winnow::python {

const Filter& FilterOfCall::of(const PythonFilter* input) {
  if (input == nullptr) return filter_;
  filter_ = input->filter;
  if (input->accept && !input->accept.is_none()) {
    accept_.emplace(input->accept, "accept");
    filter_.predicate = {[](void* context, Key key, ClientData data) {
                           std::uint64_t number = 0;
                           static_assert(sizeof key == sizeof number);
                           std::memcpy(&number, &key, sizeof number);
                           return static_cast<Predicate*>(context)->passes(number, data);
                         },
                         &*accept_};
  }
  if (!input->layer) return filter_;
  if (scene_ == nullptr) {
    throw Refusal(Status::unsupported, "filter: layers beyond 32 are those of scenes");
  }
  layer_.emplace(LayerFilter{*scene_, *input->layer, filter_});
  filter_ = layer_->filter();
  return filter_;
}

namespace {

[[nodiscard]] PythonFilter make_filter(std::uint32_t layers, std::uint32_t mask,
                                       std::uint32_t environment, const py::object& accept,
                                       std::optional<std::uint16_t> layer) {
  if (layer.value_or(0) >= kSceneLayers) {
    throw Refusal(Status::invalid_argument, "layer: it is out of range");
  }
  if (!accept.is_none()) static_cast<void>(PythonFunction(accept, "accept"));
  return {{}, {layers, mask, environment, {}}, accept, layer};
}

}  // namespace

void add_filters(py::module_& module) {
  Class<PythonFilter>(module, "Filter")
      .def(py::init(&make_filter))
      .property("layers", [](const PythonFilter& f) { return f.filter.layers; })
      .property("mask", [](const PythonFilter& f) { return f.filter.mask; })
      .property("environment", [](const PythonFilter& f) { return f.filter.environment; })
      .property("layer", [](const PythonFilter& f) { return f.layer; })
      .property("accept", [](const PythonFilter& f) { return f.accept; });
}

}  // namespace winnow::python
