#include <winnow/partitions/partition.h>

#include <vector>

int main() {
  const std::vector<winnow::Aabb> boxes{{{0, 0, 0}, {1, 1, 1}}, {{0.5F, 0, 0}, {2, 1, 1}}};
  std::vector<winnow::Key> keys(boxes.size());
  winnow::Partition partition(winnow::linear_bvh());
  winnow::PairBuffer pairs;
  const bool good = partition.insert(boxes, {}, keys) == winnow::Status::ok &&
                    partition.self_pairs(pairs) == winnow::Status::ok;
  return good && pairs.size() == 1 ? 0 : 1;
}
