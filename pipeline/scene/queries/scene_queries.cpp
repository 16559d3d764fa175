#include <winnow/pipeline/scene_queries.h>
#include "pipeline/scene/queries/queries.h"

#include <new>

namespace winnow {

SceneQueries::SceneQueries(const Scene& scene, std::pmr::memory_resource* memory)
    : state_(nullptr) {
  void* place = nullptr;
  try {
    place = memory->allocate(sizeof(State), alignof(State));
  } catch (...) {
    // Every question will say so.
    return;
  }
  state_ = new (place) State(scene, memory);
}

SceneQueries::~SceneQueries() {
  if (state_ == nullptr) return;
  std::pmr::memory_resource* const memory = state_->memory;
  state_->~State();
  memory->deallocate(state_, sizeof(State), alignof(State));
}

Footprint SceneQueries::footprint() const noexcept {
  Footprint sum;
  if (state_ == nullptr) return sum;
  sum.structure = {sizeof(State), sizeof(State)};
  for (const Bytes& bytes :
       {state_->boxes.footprint().total(), state_->objects.footprint().total()}) {
    sum.scratch += bytes;
  }
  for (const Bytes& bytes :
       {state_->hits.bytes(), state_->overlaps.bytes(), state_->distances.bytes()}) {
    sum.results += bytes;
  }
  return sum;
}

}  // namespace winnow
