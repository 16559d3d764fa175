#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/cast.h>
#include <winnow/core/frustum.h>
#include <winnow/core/ray.h>
#include <winnow/core/sphere.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace winnow::bench {

/// What is wanted of each question of a set.
enum class Want {
  closest,  ///< of a ray or a swept volume: the first object on its way
  any,      ///< of a ray: whether there is an object on its way
  all,      ///< of a ray: all objects on its way, in their order
  overlap,  ///< of a box, a ball or a frustum: all objects that meet it
  nearest,  ///< of a point: the `count` nearest objects
};

/// Questions of one kind about the same objects.
struct QuestionSet {
  std::string name;
  Want want = Want::closest;
  std::vector<Ray> rays;
  std::vector<Aabb> boxes;  ///< also the points of `nearest`, as boxes of no extent
  std::vector<std::variant<Sphere, Frustum>> regions;
  std::vector<std::variant<BoxCast, SphereCast>> casts;
  std::size_t count = 0;  ///< objects wanted by each question of `nearest`

  /// Exactly one of the columns holds the questions.
  [[nodiscard]] std::size_t size() const noexcept {
    return rays.size() + boxes.size() + regions.size() + casts.size();
  }
};

/// An object that was found; t is where a ray meets it or how far it is, 0 for an overlap.
struct Found {
  std::uint32_t row = 0;
  float t = 0.0F;

  friend bool operator==(const Found&, const Found&) noexcept = default;
};

/// What was found by a run of questions.
class Answers {
 public:
  [[nodiscard]] std::size_t questions() const noexcept { return start_.size() - 1; }
  [[nodiscard]] std::span<const Found> of(std::size_t question) const noexcept {
    return std::span(found_).subspan(start_[question], start_[question + 1] - start_[question]);
  }

  void add(Found found) { found_.push_back(found); }
  /// Ends the question that was added to.
  void next() { start_.push_back(found_.size()); }

 private:
  std::vector<Found> found_;
  std::vector<std::size_t> start_{0};
};

/// Names of the sets of questions, in the order in which reports list them.
[[nodiscard]] std::span<const std::string_view> question_set_names() noexcept;

/// The sets of these names (all, if there are none) about these boxes; the same seed gives the same
/// questions. Rays start uniformly in the world that the boxes span and have uniform directions of
/// unit length; everything else is put uniformly in the world as well. Sizes and reaches are in
/// mean edges of the boxes. `rays` is the number of rays of a set, >= 1; dearer questions are
/// fewer.
[[nodiscard]] std::vector<QuestionSet> make_question_sets(std::span<const Aabb> boxes,
                                                          std::size_t rays, std::uint64_t seed,
                                                          std::span<const std::string> names = {});

}  // namespace winnow::bench
