#pragma once

#include "pipeline/python/arrays.h"
#include "pipeline/python/init_checks.h"

#include <winnow/core/debug_draw.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::python {

/// Collects a debug drawing as columns.
class Drawing final : public DebugDraw, public EmptyIfZero {
 public:
  void box(const Aabb& box, Colour colour) override;
  void line(const Vec3f& from, const Vec3f& to, Colour colour) override;
  void sphere(const Sphere& sphere, Colour colour) override;
  void text(const Vec3f& at, std::string_view text, Colour colour) override;

  struct Table {
    std::vector<float> numbers;
    std::vector<std::uint8_t> colours;
  };
  Table boxes;
  Table lines;
  Table spheres;
  Table labels;
  std::vector<std::string> texts;
};

void add_drawing(py::module_& module);

}  // namespace winnow::python
