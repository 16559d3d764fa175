// Boxes in the program's own columns: pairs that begin and end from frame to frame.

#include <winnow/winnow.h>

#include <cmath>
#include <cstdio>
#include <vector>

/// The program's own boxes, a column for each coordinate.
struct Boxes {
  std::vector<float> low[3];
  std::vector<float> high[3];

  void place(std::size_t i, float x, float y) {
    const float corner[3] = {x, y, 0.0F};
    for (int axis = 0; axis < 3; ++axis) {
      low[axis][i] = corner[axis];
      high[axis][i] = corner[axis] + 1.0F;
    }
  }
};

int main() {
  constexpr std::size_t kBoxes = 10'000;
  Boxes boxes;
  for (auto* columns : {&boxes.low, &boxes.high}) {
    for (std::vector<float>& column : *columns) column.resize(kBoxes);
  }
  const auto move_to = [&](float time) {
    for (std::size_t i = 0; i < kBoxes; ++i) {
      const auto n = static_cast<float>(i);
      boxes.place(i, 100.0F * std::sin(0.7F * n + time), 100.0F * std::cos(1.3F * n + 0.5F * time));
    }
  };
  const winnow::BoxView view({boxes.low[0].data(), boxes.low[1].data(), boxes.low[2].data()},
                             {boxes.high[0].data(), boxes.high[1].data(), boxes.high[2].data()},
                             kBoxes);

  move_to(0.0F);
  winnow::Partition partition(winnow::linear_bvh());
  const std::vector<winnow::ClientData> data(kBoxes);
  std::vector<winnow::Key> keys(kBoxes);
  if (partition.insert(view, data, keys) != winnow::Status::ok) return 1;
  winnow::PairBuffer pairs;
  winnow::PairEvents events;
  std::size_t begun = 0;
  std::size_t ended = 0;
  for (int frame = 1; frame <= 10; ++frame) {
    move_to(0.01F * static_cast<float>(frame));
    if (partition.update(keys, view) != winnow::Status::ok) return 1;
    if (partition.self_pairs(pairs, events) != winnow::Status::ok) return 1;
    begun += events.begun().size();
    ended += events.ended().size();
  }
  std::printf("%zu pairs; %zu began, %zu ended\n", pairs.size(), begun, ended);
  return begun - ended == pairs.size() && ended > 0 ? 0 : 1;
}
