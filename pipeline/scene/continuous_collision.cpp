#include <winnow/pipeline/continuous_collision.h>

#include "core/hooks/log.h"
#include "core/memory/new_in.h"
#include "core/threads/float_environment.h"
#include "pipeline/scene/continuous_state.h"
#include "pipeline/scene/scene_observer.h"

namespace winnow {
namespace {

/// Finds the impacts; `take` reads the motions.
template <typename Take>
Status find(ContinuousState* state, std::span<const Key> keys, const ContinuousOptions& options,
            Take&& take) {
  if (state == nullptr) return logged(Status::out_of_memory, "ContinuousCollision::find_impacts");
  ContinuousState& s = *state;
  Status status = Status::ok;
  if (!options.bullets.empty() && options.bullets.size() != keys.size()) {
    status = Status::size_mismatch;
  } else if (!(options.tolerance > 0.0 && options.tolerance <= 1.0) ||
             options.pairs > ContinuousPairs::bullets_and_fixed) {
    status = Status::invalid_argument;
  } else {
    status = s.bodies.refresh();
  }
  if (status == Status::ok) status = take();
  if (status == Status::ok) status = s.find_pairs(options);
  if (status == Status::ok) {
    s.order.clear();
    status = options.first_only ? s.find_first(options) : s.find_all(options);
  }
  if (status == Status::ok && !s.show_impacts()) status = Status::out_of_memory;
  if (status == Status::out_of_memory) s.forget();
  if (status != Status::ok && s.bodies.observer != nullptr) s.bodies.observer->fail();
  return logged(status, "ContinuousCollision::find_impacts");
}

[[nodiscard]] bool is_observed(Status status, const ContinuousState* state) noexcept {
  return status == Status::ok && state->bodies.observer != nullptr;
}

}  // namespace

ContinuousCollision::ContinuousCollision(Scene& scene, std::pmr::memory_resource* memory) noexcept
    : memory_(memory), state_(nullptr) {
  if (scene.state_ != nullptr) state_ = new_in<ContinuousState>(memory, *scene.state_, memory);
}

ContinuousCollision::~ContinuousCollision() {
  delete_in(memory_, state_);
}

Status ContinuousCollision::find_impacts(std::span<const Key> keys, const PoseView& ends,
                                         const ContinuousOptions& options) {
  const DefaultFloatEnvironment environment;
  const Status status = find(state_, keys, options, [&] { return state_->take(keys, ends); });
  if (is_observed(status, state_))
    state_->bodies.observer->find_impacts(keys, ends, options, *this);
  return status;
}

Status ContinuousCollision::find_impacts(std::span<const Key> keys,
                                         std::span<const RigidMotion> motions,
                                         const ContinuousOptions& options) {
  const DefaultFloatEnvironment environment;
  const Status status = find(state_, keys, options, [&] { return state_->take(keys, motions); });
  if (is_observed(status, state_))
    state_->bodies.observer->find_impacts(keys, motions, options, *this);
  return status;
}

std::span<const SceneImpact> ContinuousCollision::impacts() const noexcept {
  if (state_ == nullptr) return {};
  return {state_->impacts.data(), state_->impacts.size()};
}

std::span<const std::uint32_t> ContinuousCollision::first() const noexcept {
  if (state_ == nullptr) return {};
  return {state_->first.data(), state_->first.size()};
}

ContinuousStatistics ContinuousCollision::statistics() const noexcept {
  return state_ != nullptr ? state_->statistics : ContinuousStatistics{};
}

Footprint ContinuousCollision::footprint() const noexcept {
  if (state_ == nullptr) return {};
  const ContinuousState& s = *state_;
  Footprint sum;
  sum.structure = {sizeof(ContinuousState), sizeof(ContinuousState)};
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
