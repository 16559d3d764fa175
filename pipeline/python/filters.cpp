// The class Filter, with Python functions as predicates.

#include "pipeline/python/filters.h"

#include "pipeline/python/arrays.h"
#include "pipeline/python/refusal.h"

#include <cstring>
#include <string>

namespace winnow::python {

const Filter& FilterOfCall::of(const PythonFilter& input) {
  filter_ = input.filter;
  if (input.accept && !input.accept.is_none()) {
    accept_.emplace(input.accept, "accept");
    filter_.predicate = {[](void* context, Key key, ClientData data) {
                           std::uint64_t number = 0;
                           static_assert(sizeof key == sizeof number);
                           std::memcpy(&number, &key, sizeof number);
                           return static_cast<Predicate*>(context)->passes(number, data);
                         },
                         &*accept_};
  }
  if (!input.layer) return filter_;
  if (scene_ == nullptr) {
    throw Refusal(Status::unsupported, "filter: layers beyond 32 are those of scenes");
  }
  layer_.emplace(LayerFilter{*scene_, *input.layer, filter_});
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

[[nodiscard]] std::string text_of(const PythonFilter& f) {
  std::string text = "Filter(layers=" + std::to_string(f.filter.layers) +
                     ", mask=" + std::to_string(f.filter.mask) +
                     ", environment=" + std::to_string(f.filter.environment);
  if (f.layer) text += ", layer=" + std::to_string(*f.layer);
  if (!f.accept.is_none()) text += ", accept=" + py::cast<std::string>(py::repr(f.accept));
  return text + ")";
}

}  // namespace

void add_filters(py::module_& module) {
  using py::arg;
  constexpr std::uint32_t every = ~0U;
  py::class_<PythonFilter>(module, "Filter", "Selects the objects that a query may find.")
      .def(py::init(&make_filter), arg("layers") = every, arg("mask") = every,
           arg("environment") = every, py::kw_only(), arg("accept") = py::none(),
           arg("layer") = py::none(),
           "`layers`: layers of the query; `mask`: layers that it may find; `environment`: as in "
           "`Partition.set_filter`. `accept(key, data)` is called for each object that passes the "
           "other conditions. Calls come from any working thread, one at a time, because each "
           "needs the GIL: some microseconds a call. It must return the same result each time and "
           "must not call winnow (unsupported); the query raises its exceptions. `layer`, for "
           "queries of a scene: finds bodies in layers that collide with this layer, see "
           "Scene.set_layers_collide.")
      .def_property_readonly("layers", [](const PythonFilter& f) { return f.filter.layers; })
      .def_property_readonly("mask", [](const PythonFilter& f) { return f.filter.mask; })
      .def_property_readonly("environment",
                             [](const PythonFilter& f) { return f.filter.environment; })
      .def_property_readonly("layer", [](const PythonFilter& f) { return f.layer; })
      .def_property_readonly("accept", [](const PythonFilter& f) { return f.accept; })
      .def("__repr__", &text_of);
}

}  // namespace winnow::python
