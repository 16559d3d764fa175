#pragma once

#include <winnow/c/volumes.h>
#include <winnow/core/debug_draw.h>

#include <string_view>

namespace winnow::c {

/// Draws with the callbacks of a winnow_debug_draw.
class CallbackDraw final : public DebugDraw {
 public:
  explicit CallbackDraw(const winnow_debug_draw& draw) noexcept;

  void box(const Aabb& box, Colour colour) override;
  void line(const Vec3f& from, const Vec3f& to, Colour colour) override;
  void sphere(const Sphere& sphere, Colour colour) override;
  void text(const Vec3f& at, std::string_view text, Colour colour) override;

 private:
  [[nodiscard]] static winnow_colour of(Colour colour) noexcept {
    return {colour.r, colour.g, colour.b, colour.a};
  }

  const winnow_debug_draw& draw_;
};

}  // namespace winnow::c
