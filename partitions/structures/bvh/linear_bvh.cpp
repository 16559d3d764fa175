#include "partitions/structures/bvh/linear_bvh.h"

namespace winnow {

LinearBvh::LinearBvh(const PartitionOptions& options) : RowPartition(options, options.volume) {}

}  // namespace winnow
