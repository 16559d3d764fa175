#pragma once

#include "pipeline/python/arrays.h"

#include <winnow/core/debug_draw.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::python {

/// Collects a debug drawing as columns.
class Drawing final : public DebugDraw {
 public:
  void box(const Aabb& box, Colour colour) override;
  void line(const Vec3f& from, const Vec3f& to, Colour colour) override;
  void sphere(const Sphere& sphere, Colour colour) override;
  void text(const Vec3f& at, std::string_view text, Colour colour) override;

  /// Returns the table `Drawing`.
  [[nodiscard]] py::object shown();

 private:
  struct Rows {
    void put(std::initializer_list<float> values, Colour colour);

    std::vector<float> numbers;
    std::vector<std::uint8_t> colours;
  };
  Rows boxes;
  Rows lines;
  Rows spheres;
  Rows labels;
  std::vector<std::string> texts;
};

}  // namespace winnow::python
