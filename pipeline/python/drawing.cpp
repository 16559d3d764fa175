#include "pipeline/python/drawing.h"

#include <cstddef>
#include <initializer_list>

namespace winnow::python {
namespace {

void put(Drawing::Table& table, std::initializer_list<float> numbers, Colour colour) {
  table.numbers.insert(table.numbers.end(), numbers);
  table.colours.insert(table.colours.end(), {colour.r, colour.g, colour.b, colour.a});
}

/// Returns a copy, so later drawing does not change the array.
template <typename T>
[[nodiscard]] py::array rows(const std::vector<T>& values, std::size_t columns) {
  return given(std::vector<T>(values), columns);
}

}  // namespace

void Drawing::box(const Aabb& box, Colour colour) {
  put(boxes, {box.min.x(), box.min.y(), box.min.z(), box.max.x(), box.max.y(), box.max.z()},
      colour);
}
void Drawing::line(const Vec3f& from, const Vec3f& to, Colour colour) {
  put(lines, {from.x(), from.y(), from.z(), to.x(), to.y(), to.z()}, colour);
}
void Drawing::sphere(const Sphere& sphere, Colour colour) {
  put(spheres, {sphere.center.x(), sphere.center.y(), sphere.center.z(), sphere.radius}, colour);
}
void Drawing::text(const Vec3f& at, std::string_view text, Colour colour) {
  put(labels, {at.x(), at.y(), at.z()}, colour);
  texts.emplace_back(text);
}

void add_drawing(py::module_& module) {
  const auto property = [](auto& type, const char* name, auto member, std::size_t columns,
                           const char* doc) {
    type.def_property_readonly(
        name, [member, columns](const Drawing& d) { return rows((d.*member).numbers, columns); },
        doc);
  };
  const auto colours = [](auto& type, const char* name, auto member) {
    type.def_property_readonly(
        name, [member](const Drawing& d) { return rows((d.*member).colours, 4); },
        "Red, green, blue and opacity of each, (n, 4) uint8.");
  };
  py::class_<Drawing> drawing(module, "Drawing", "What `debug_draw` shows, as arrays.");
  property(drawing, "boxes", &Drawing::boxes, 6, "Lower and upper corners, (n, 6) float32.");
  colours(drawing, "box_colours", &Drawing::boxes);
  property(drawing, "lines", &Drawing::lines, 6, "Both ends, (n, 6) float32.");
  colours(drawing, "line_colours", &Drawing::lines);
  property(drawing, "spheres", &Drawing::spheres, 4, "Centres and radii, (n, 4) float32.");
  colours(drawing, "sphere_colours", &Drawing::spheres);
  property(drawing, "text_places", &Drawing::labels, 3, "Positions of texts, (n, 3) float32.");
  colours(drawing, "text_colours", &Drawing::labels);
  drawing.def_property_readonly(
      "texts", [](const Drawing& d) { return d.texts; }, "The texts.");
}

}  // namespace winnow::python
