#include <winnow/pipeline/scene_sweep.h>

#include "core/hooks/log.h"
#include "core/memory/new_in.h"
#include "core/threads/float_environment.h"
#include "pipeline/scene/sweep_state.h"

namespace winnow {

SceneSweep::SceneSweep(Scene& scene, std::pmr::memory_resource* memory) noexcept
    : memory_(memory), state_(nullptr) {
  if (scene.state_ != nullptr) state_ = new_in<SweepState>(memory, scene, *scene.state_, memory);
}

SceneSweep::~SceneSweep() {
  delete_in(memory_, state_);
}

Status SceneSweep::sweep(std::span<const Key> keys, const PoseView& ends,
                         const SweepOptions& options) {
  const DefaultEnvironment environment;
  return run(keys, options, [&] { return state_->take(keys, ends); });
}

Status SceneSweep::sweep(std::span<const Key> keys, std::span<const RigidMotion> motions,
                         const SweepOptions& options) {
  const DefaultEnvironment environment;
  return run(keys, options, [&] { return state_->take(keys, motions); });
}

template <typename Take>
Status SceneSweep::run(std::span<const Key> keys, const SweepOptions& options, Take&& take) {
  if (state_ == nullptr) return logged(Status::out_of_memory, "SceneSweep::sweep");
  SweepState& s = *state_;
  Status status = Status::ok;
  if (!options.bullets.empty() && options.bullets.size() != keys.size()) {
    status = Status::size_mismatch;
  } else if (!(options.tolerance > 0.0 && options.tolerance <= 1.0) ||
             options.pairs > SweepPairs::bullets_and_fixed) {
    status = Status::invalid_argument;
  } else {
    status = s.scene.refresh();
  }
  if (status == Status::ok) status = take();
  if (status == Status::ok) status = s.find_pairs(options);
  if (status == Status::ok) {
    s.order.clear();
    status = options.first_only ? s.find_first(options) : s.find_all(options);
  }
  if (status == Status::ok && !s.show_impacts()) status = Status::out_of_memory;
  if (status == Status::out_of_memory) s.forget();
  return logged(status, "SceneSweep::sweep");
}

std::span<const SceneImpact> SceneSweep::impacts() const noexcept {
  if (state_ == nullptr) return {};
  return {state_->impacts.data(), state_->impacts.size()};
}

std::span<const std::uint32_t> SceneSweep::first() const noexcept {
  if (state_ == nullptr) return {};
  return {state_->first.data(), state_->first.size()};
}

SweepStatistics SceneSweep::statistics() const noexcept {
  return state_ != nullptr ? state_->statistics : SweepStatistics{};
}

Footprint SceneSweep::footprint() const noexcept {
  if (state_ == nullptr) return {};
  const SweepState& s = *state_;
  Footprint sum;
  sum.structure = {sizeof(SweepState), sizeof(SweepState)};
  for (const Bytes& bytes : {s.ways.footprint().total(),
                             s.motions.bytes(),
                             s.movers.bytes(),
                             s.balls.bytes(),
                             s.mover_of.bytes(),
                             s.along_axis.bytes(),
                             s.first_piece.bytes(),
                             s.boxes.bytes(),
                             s.piece_keys.bytes(),
                             s.pieces.bytes(),
                             s.pairs.footprint().total(),
                             s.candidates.bytes(),
                             s.spare.bytes(),
                             s.chances.bytes(),
                             s.round.bytes(),
                             s.listed.bytes(),
                             s.answers.bytes(),
                             s.hits.bytes(),
                             s.found.bytes(),
                             s.first_time.bytes(),
                             s.order.bytes()}) {
    sum.scratch += bytes;
  }
  sum.results += s.impacts.bytes();
  sum.results += s.first.bytes();
  return sum;
}

}  // namespace winnow
