#include "bench/draw/stage.h"

#include "bench/contenders/partitions.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string>

namespace winnow::bench {
namespace {

bool same_floats(const Aabb& a, const Aabb& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

void require_ok(Status status, const char* call) {
  if (status != Status::ok) throw std::runtime_error(std::string(call) + ": " + to_string(status));
}

Stage::Stage(std::string_view partition, FrameSource& source)
    : source_(source),
      partition_(make_named(partition)),
      keys_(source.boxes().size()),
      boxes_(source.boxes().begin(), source.boxes().end()) {
  std::vector<ClientData> data(boxes_.size());
  std::iota(data.begin(), data.end(), ClientData{0});
  require_ok(partition_.insert(boxes_, data, keys_), "insert");
  find_pairs();
}

bool Stage::advance() {
  if (!source_.advance()) return false;
  ++frame_;
  step(source_.boxes());
  find_pairs();
  return true;
}

void Stage::find_pairs() {
  require_ok(partition_.self_pairs(buffer_), "self_pairs");
  reported_ = buffer_.size();
  pairs_.clear();
  for (const Pair& pair : buffer_) {
    if (boxes_[pair.first].overlaps(boxes_[pair.second])) pairs_.push_back(pair);
  }
  std::sort(pairs_.begin(), pairs_.end());
}

void Stage::step(std::span<const Aabb> boxes) {
  std::vector<Key> moved;
  std::vector<Aabb> places;
  const std::size_t known = boxes_.size();
  for (std::size_t i = 0; i < known; ++i) {
    if (same_floats(boxes[i], boxes_[i])) continue;
    moved.push_back(keys_[i]);
    places.push_back(boxes[i]);
  }
  boxes_.assign(boxes.begin(), boxes.end());
  require_ok(partition_.update(moved, places), "update");
  if (boxes_.size() == known) return;
  keys_.resize(boxes_.size());
  std::vector<ClientData> data(boxes_.size() - known);
  std::iota(data.begin(), data.end(), ClientData{known});
  const auto fresh = [&](auto& all) { return std::span(all).subspan(known); };
  require_ok(partition_.insert(fresh(boxes_), data, fresh(keys_)), "insert");
}

}  // namespace winnow::bench
