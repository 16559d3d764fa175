#pragma once

namespace winnow {

/// Constants that predict the cost of a structure, in nanoseconds of one thread. PredictedCosts
/// (choice/predicted_costs.h) multiplies each by a feature of the scene or of the frame and adds
/// the products.
struct StructureCosts {
  bool has_cells = false;  ///< cells or strips, which fast objects leave in every frame
  double frame = 0;        ///< per frame
  double keep = 0;         ///< per object that moved: writing it and updating its place
  double object = 0;       ///< all pairs after much has moved, per object
  double level = 0;        ///< as `object`, for each doubling of the number of objects
  double crowd = 0;        ///< as `object`, for each doubling of the crowding
  double square = 0;       ///< as `object`, per other object that is tested
  double pair = 0;         ///< per pair that is written
  double moved = 0;        ///< all pairs after little has moved, per moved object
  double rest = 0;         ///< as `moved`, per object that did not move
  double build = 0;        ///< a build, per object
  double build_level = 0;  ///< as `build`, for each doubling of the number of objects
  /// A refresh that scatters all objects, per object, including the build; replaces `keep`. 0: the
  /// sum of both.
  double anew = 0;
  double query = 0;        ///< per ray or region; a nearest query counts four times
  double query_level = 0;  ///< such a query, for each doubling of the number of objects
  double scan = 0;         ///< such a query, per object, if there is no tree
  double rows = 0;         ///< a frame with such queries, per object that moved
};

}  // namespace winnow
