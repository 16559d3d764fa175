#include "pipeline/python/drawing.h"

#include <cstddef>
#include <utility>

namespace winnow::python {
void Drawing::Rows::put(std::initializer_list<float> values, Colour colour) {
  numbers.insert(numbers.end(), values);
  colours.insert(colours.end(), {colour.r, colour.g, colour.b, colour.a});
}

void Drawing::box(const Aabb& box, Colour colour) {
  boxes.put({box.min.x(), box.min.y(), box.min.z(), box.max.x(), box.max.y(), box.max.z()}, colour);
}
void Drawing::line(const Vec3f& from, const Vec3f& to, Colour colour) {
  lines.put({from.x(), from.y(), from.z(), to.x(), to.y(), to.z()}, colour);
}
void Drawing::sphere(const Sphere& sphere, Colour colour) {
  spheres.put({sphere.center.x(), sphere.center.y(), sphere.center.z(), sphere.radius}, colour);
}
void Drawing::text(const Vec3f& at, std::string_view text, Colour colour) {
  labels.put({at.x(), at.y(), at.z()}, colour);
  texts.emplace_back(text);
}

py::object Drawing::shown() {
  const auto numbers = [](Rows& rows, std::size_t columns) {
    return given(std::move(rows.numbers), columns);
  };
  const auto colours = [](Rows& rows) { return given(std::move(rows.colours), 4); };
  return table("Drawing", numbers(boxes, 6), colours(boxes), numbers(lines, 6), colours(lines),
               numbers(spheres, 4), colours(spheres), numbers(labels, 3), colours(labels), texts);
}

}  // namespace winnow::python
