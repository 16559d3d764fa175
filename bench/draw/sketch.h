#pragma once

#include <winnow/core/debug_draw.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Boxes and lines of one colour, which the page shows or hides together.
struct SketchLayer {
  std::string name;
  Colour colour;
  std::vector<Aabb> boxes;
  std::vector<Vec3f> line_ends;  ///< two per line
};

struct SketchText {
  Vec3f at;
  std::string text;
  Colour colour;
};

/// A DebugDraw that stores what a partition draws, sorted into layers by colour.
class Sketch final : public DebugDraw {
 public:
  Sketch();

  void box(const Aabb& box, Colour colour) override;
  void line(const Vec3f& from, const Vec3f& to, Colour colour) override;
  /// Drawn as its bounding box.
  void sphere(const Sphere& sphere, Colour colour) override;
  void text(const Vec3f& at, std::string_view text, Colour colour) override;

  /// The boxes of objects, in the order in which they were drawn.
  [[nodiscard]] std::span<const Aabb> objects() const noexcept { return objects_; }
  /// Returns the layers that are not empty, in a fixed order.
  [[nodiscard]] std::vector<const SketchLayer*> structure() const;
  [[nodiscard]] std::span<const SketchText> texts() const noexcept { return texts_; }

 private:
  SketchLayer& layer_of(Colour colour);

  std::vector<Aabb> objects_;
  std::vector<SketchLayer> layers_;  // the last one takes unknown colours
  std::vector<SketchText> texts_;
};

}  // namespace winnow::bench
