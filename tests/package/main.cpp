// A program outside of winnow: three boxes, and which of them touch.

#include <winnow/winnow.h>

#include <cstdio>

int main() {
  const winnow::Aabb boxes[] = {
      {{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}, {{5, 5, 5}, {6, 6, 6}}};
  const winnow::ClientData names[] = {10, 20, 30};
  winnow::Key keys[3];
  winnow::LinearBvh partition;
  winnow::PairBuffer pairs;
  if (partition.insert(boxes, names, keys) != winnow::Status::ok ||
      partition.self_pairs(pairs) != winnow::Status::ok) {
    return 1;
  }
  for (const auto& [first, second] : pairs) {
    std::printf("%u touches %u\n", static_cast<unsigned>(partition.client_data_of(first)),
                static_cast<unsigned>(partition.client_data_of(second)));
  }
}
