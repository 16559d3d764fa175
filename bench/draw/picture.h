#pragma once

#include "bench/common/json.h"
#include "bench/draw/questions.h"
#include "bench/draw/sketch.h"
#include "bench/draw/stage.h"
#include "bench/recordings/recording.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

struct PictureOptions {
  std::size_t most_objects = 200'000;  ///< limit of drawn objects, evenly selected; objects hit by
                                       ///< a query are always drawn
  int max_depth = 64;
  bool labels = false;
  std::vector<Ray> rays;
  std::vector<Aabb> boxes;
};

/// One frame of a scene in one partition, with everything that the page shows of it.
class Picture {
 public:
  /// `contacts` are the contacts of this frame.
  Picture(std::string scene, const Stage& stage, const PictureOptions& options,
          std::span<const RecordedContact> contacts = {});

  /// Returns the numbers of things in the picture: the tool prints them, and the page must draw as
  /// many.
  [[nodiscard]] Json counts() const;
  /// Returns the whole picture in the form that page/data.js reads.
  [[nodiscard]] Json data() const;

 private:
  void choose_objects(std::size_t most);
  void choose_pairs(const std::vector<Pair>& pairs);
  void draw_contacts(std::span<const RecordedContact> contacts);
  [[nodiscard]] std::string places_of(std::span<const ObjectId> ids) const;
  [[nodiscard]] Json objects_data() const;
  [[nodiscard]] Json structure_data() const;
  [[nodiscard]] Json questions_data() const;

  std::string scene_;
  std::size_t frame_;
  std::string partition_;
  Statistics statistics_;
  std::size_t all_pairs_;
  std::size_t reported_;
  Sketch sketch_;
  std::vector<RayResult> rays_;
  std::vector<BoxResult> boxes_;

  std::vector<ObjectId> drawn_;       // ascending
  std::vector<ClientData> data_;      // of each object in drawn_
  std::vector<std::uint32_t> place_;  // index into drawn_ of each object, or kNotDrawn
  std::vector<std::uint32_t> pairs_;  // two indices into drawn_ per pair
  std::vector<Vec3f> contact_ends_;   // two ends per contact, the contact point first
};

}  // namespace winnow::bench
