#pragma once

namespace winnow {

/// What a structure is expected to cost, in nanoseconds of one thread: constants of a sum of
/// products, each of a feature of the scene or of what a frame did, and of one of these. See
/// PredictedCosts, which adds them up.
struct StructureCosts {
  bool has_cells = false;  ///< or strips, which objects that are fast leave in every frame
  double frame = 0;        ///< per frame
  double keep = 0;         ///< per object that moved: written, and its place kept up
  double object = 0;       ///< of all pairs after much has moved, per object that asks;
  double level = 0;        ///< the same, for each doubling of the number of objects,
  double crowd = 0;        ///< for each doubling of how much they crowd together,
  double square = 0;       ///< and for each other object that it is tested against
  double pair = 0;         ///< per pair that is written
  double moved = 0;        ///< of all pairs after little has moved, per object that asks
  double rest = 0;         ///< the same, per object that does not
  double build = 0;        ///< of a build, per object
  double build_level = 0;  ///< the same, for each doubling of the number of objects
  /// Of a refresh in which all objects are scattered, per object, in place of keeping their places
  /// and of the build; 0: as much as both.
  double anew = 0;
  double ask = 0;        ///< per ray or region; one for the nearest counts four times
  double ask_level = 0;  ///< the same, for each doubling of the number of objects
  double scan = 0;       ///< the same, per object, where there is no tree
  double rows = 0;       ///< per object that moved, before such a question is answered
};

}  // namespace winnow
