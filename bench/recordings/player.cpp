#include "bench/recordings/recording.h"

namespace winnow::bench {
namespace {

class Player final : public FrameSource {
 public:
  explicit Player(const Recording& recording) : recording_(recording) {}

  [[nodiscard]] std::string name() const override { return recording_.scene; }
  [[nodiscard]] Aabb world() const override { return recording_.world; }
  [[nodiscard]] std::span<const Aabb> boxes() const override { return recording_.frames[frame_]; }

  [[nodiscard]] std::size_t objects() const override { return recording_.objects(); }

  bool advance() override {
    if (frame_ + 1 >= recording_.frames.size()) return false;
    ++frame_;
    return true;
  }

 private:
  const Recording& recording_;
  std::size_t frame_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> play(const Recording& recording) {
  return std::make_unique<Player>(recording);
}

}  // namespace winnow::bench
