#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/sphere.h>
#include <winnow/core/vec3.h>

#include <cstdint>
#include <string_view>

namespace winnow {

/// Red, green, blue and opacity, each 0..255.
struct Colour {
  std::uint8_t r = 255;  ///< red
  std::uint8_t g = 255;  ///< green
  std::uint8_t b = 255;  ///< blue
  std::uint8_t a = 255;  ///< opacity; 255 is opaque

  /// True if all four components are equal.
  friend constexpr bool operator==(const Colour&, const Colour&) noexcept = default;
};

/// Interface that a caller implements to draw the content of a partition. `Partition::debug_draw`
/// calls it on the calling thread. An implementation should draw boxes and spheres as outlines.
/// Infinite coordinates are passed on unchanged. An exception that leaves an implementation ends
/// the process. The structure comes first, then the objects in ascending order of their ids.
/// partitions/debug_colours.h lists the colours of each kind of item.
class DebugDraw {
 public:
  virtual ~DebugDraw() = default;

  /// Draws the edges of a box, which may extend to infinity.
  virtual void box(const Aabb& box, Colour colour) = 0;
  /// Draws the segment between two points.
  virtual void line(const Vec3f& from, const Vec3f& to, Colour colour) = 0;
  /// Draws a ball, or its outline.
  virtual void sphere(const Sphere& sphere, Colour colour) = 0;
  /// Draws a label at a point; `text` is valid only during the call.
  virtual void text(const Vec3f& at, std::string_view text, Colour colour) = 0;
};

/// Selects what a partition draws.
struct DebugDrawOptions {
  bool objects = true;    ///< the volume of every object
  bool structure = true;  ///< cells, strips, the sweep axis, nodes coloured by depth
  bool labels = false;    ///< client data of every object as text
  int max_depth = 64;     ///< levels of the node tree, counted from the root
};

}  // namespace winnow
