#pragma once

// Drawing of partitions: the interface that a caller implements, and the colours of each kind of
// item.

#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>

#include <array>
#include <cstddef>
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
/// The colours of each kind of item are below.
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

// Colours of the debug drawing, one for each kind of element, so that a DebugDraw can tell elements
// apart. All are distinct for people of any colour vision, on light and dark backgrounds: the
// colours of cells, contents and axes are from Okabe and Ito, "Color Universal Design", 2008; node
// depth uses the viridis map (van der Walt and Smith, 2015), whose lightness falls steadily.

inline constexpr Colour kObjectColour{160, 168, 178, 255};  ///< the volume of an object
inline constexpr Colour kLabelColour{232, 232, 232, 255};   ///< text
inline constexpr Colour kCellColour{86, 180, 233, 255};     ///< a cell or strip that has objects
inline constexpr Colour kContentsColour{0, 114, 178, 255};  ///< box around the contents of a cell
inline constexpr Colour kAxisColour{240, 228, 66, 255};  ///< the axis that is swept or runs fastest

/// Colours of nodes by depth, the root first. Trees are shallow (four levels for a million
/// objects), so successive colours differ much.
inline constexpr std::array<Colour, 8> kNodeColours{{{253, 231, 37, 255},
                                                     {94, 201, 98, 255},
                                                     {33, 145, 140, 255},
                                                     {49, 104, 142, 255},
                                                     {62, 74, 137, 255},
                                                     {71, 45, 123, 255},
                                                     {72, 24, 106, 255},
                                                     {68, 1, 84, 255}}};

/// Returns the colour of nodes at a depth >= 0; all greater depths have the last colour.
[[nodiscard]] constexpr Colour node_colour(std::size_t depth) noexcept {
  return kNodeColours[depth < kNodeColours.size() ? depth : kNodeColours.size() - 1];
}

}  // namespace winnow
