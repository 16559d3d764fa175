#pragma once

namespace winnow {

/// Constants that predict the cost of a structure, in nanoseconds of one thread. PredictedCosts
/// (choice/predicted_costs.h) multiplies each by a feature of the scene or of the frame and adds
/// the products.
struct StructureCosts {
  bool has_cells = false;  ///< has cells or strips, which fast objects leave in every frame
  double frame = 0;        ///< per frame
  double keep = 0;         ///< per object that moved: writing it and updating its place
  double object = 0;       ///< query for all pairs after many objects moved, per object
  double level = 0;        ///< as `object`, for each doubling of the number of objects
  double crowd = 0;        ///< as `object`, for each doubling of the crowding
  double square = 0;       ///< brute force: per querying object and per object that it tests
  double pair = 0;         ///< per pair that is written
  double moved = 0;        ///< query for all pairs after few objects moved, per moved object
  double rest = 0;         ///< as `moved`, per object that did not move
  double build = 0;        ///< a build, per object
  double build_level = 0;  ///< as `build`, for each doubling of the number of objects
  /// A refresh after all objects were scattered, per object: replaces `keep` and the build. 0: such
  /// a refresh costs the sum of `keep` and the build.
  double anew = 0;
  double query = 0;        ///< per ray or region; a nearest query counts four times
  double query_level = 0;  ///< as `query`, for each doubling of the number of objects
  double scan = 0;         ///< as `query`, per object, if there is no tree
  double rows = 0;         ///< frame with rays, regions or nearest queries, per object that moved
};

}  // namespace winnow
