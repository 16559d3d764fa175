#include "bench/draw/stage.h"

#include "bench/common/need.h"
#include "bench/contenders/partitions.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>

namespace winnow::bench {

Stage::Stage(std::string_view partition, FrameSource& source)
    : source_(source),
      partition_(make_named(partition)),
      boxes_(source.boxes().begin(), source.boxes().end()) {
  insert_new();
  find_pairs();
}

bool Stage::advance() {
  if (!source_.advance()) return false;
  ++frame_;
  const std::span<const Aabb> boxes = source_.boxes();
  std::vector<std::uint32_t> moved;
  for (std::uint32_t i = 0; i < keys_.size(); ++i) {
    if (std::memcmp(&boxes[i], &boxes_[i], sizeof(Aabb)) != 0) moved.push_back(i);
  }
  boxes_.assign(boxes.begin(), boxes.end());
  need(partition_.update(keys_, boxes.first(keys_.size()), IndexSubset::listed(moved)), "update");
  insert_new();
  find_pairs();
  return true;
}

/// Inserts the objects that the last frame did not have.
void Stage::insert_new() {
  const std::size_t known = keys_.size();
  if (boxes_.size() == known) return;
  keys_.resize(boxes_.size());
  std::vector<ClientData> data(boxes_.size() - known);
  std::iota(data.begin(), data.end(), ClientData{known});
  need(partition_.insert(std::span(boxes_).subspan(known), data, std::span(keys_).subspan(known)),
       "insert");
}

void Stage::find_pairs() {
  need(partition_.self_pairs(buffer_), "self_pairs");
  pairs_.clear();
  for (const Pair& pair : buffer_) {
    if (boxes_[pair.first].overlaps(boxes_[pair.second])) pairs_.push_back(pair);
  }
  std::sort(pairs_.begin(), pairs_.end());
}

}  // namespace winnow::bench
