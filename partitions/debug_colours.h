#pragma once

#include <winnow/core/debug_draw.h>

#include <array>
#include <cstddef>

namespace winnow {

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
