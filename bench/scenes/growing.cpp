#include "bench/scenes/growing.h"

#include "bench/common/exact_math.h"
#include "bench/scenes/bodies.h"

#include <algorithm>
#include <utility>

namespace winnow::bench {
namespace {

/// A scene whose bodies move in straight lines from the frame in which they are added.
class Growing final : public BodyScene {
 public:
  Growing(const Walls& walls, std::vector<Body> bodies, std::uint64_t seed)
      : BodyScene("growth", walls, std::move(bodies), seed),
        first_(std::max<std::size_t>(1, bodies_.size() / 1000)),
        present_(first_) {}

  [[nodiscard]] std::span<const Aabb> boxes() const override {
    return std::span(boxes_).first(present_);
  }
  [[nodiscard]] std::size_t objects() const override { return bodies_.size(); }

  bool advance() override {
    for (std::size_t i = 0; i < present_; ++i) {
      drift(bodies_[i], walls_);
      place(i);
    }
    if (present_ < bodies_.size()) present_ = present_in(++frame_);
    return true;
  }

 private:
  static constexpr std::size_t kFrames = 60;  // until all bodies are added

  [[nodiscard]] std::size_t present_in(std::size_t frame) const noexcept {
    if (frame >= kFrames) return bodies_.size();
    const auto first = static_cast<double>(first_);
    const double times = static_cast<double>(bodies_.size()) / first;
    const double share = static_cast<double>(frame) / static_cast<double>(kFrames);
    return std::min(bodies_.size(), static_cast<std::size_t>(first * power(times, share)));
  }

  std::size_t first_;
  std::size_t present_;
  std::size_t frame_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> make_growth(std::size_t objects, std::uint64_t seed) {
  const Walls walls = uniform_walls(objects);
  return std::make_unique<Growing>(walls, uniform_bodies(objects, seed, walls), seed);
}

}  // namespace winnow::bench
