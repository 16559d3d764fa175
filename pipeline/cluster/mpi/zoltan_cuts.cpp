// Cuts of space by Zoltan: see zoltan_cuts.h. Called by cluster_mpi.cpp.

#include "pipeline/cluster/mpi/zoltan_cuts.h"

#include "pipeline/cluster/regions.h"

#include <zoltan.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace winnow {
namespace {

/// Data for Zoltan's callbacks: boxes with their work, and the factors by which centres are scaled.
struct CutRequest {
  const CutWork& work;
  std::array<double, 3> scale;

  static const CutRequest& of(void* data) noexcept { return *static_cast<const CutRequest*>(data); }
};

int count_of(void* data, int* error) {
  *error = ZOLTAN_OK;
  return static_cast<int>(CutRequest::of(data).work.boxes.size());
}

void list_of(void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int, float* weights,
             int* error) {
  const CutWork& work = CutRequest::of(data).work;
  for (std::size_t i = 0; i < work.boxes.size(); ++i) {
    global[i] = local[i] = static_cast<ZOLTAN_ID_TYPE>(i);
    weights[i] = static_cast<float>(work.works[i]);
  }
  *error = ZOLTAN_OK;
}

int dimensions_of(void*, int* error) {
  *error = ZOLTAN_OK;
  return 3;
}

void places_of(void* data, int, int, int count, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int,
               double* places, int* error) {
  const CutRequest& request = CutRequest::of(data);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const Vec3f centre = centre_of(request.work.boxes[local[i]]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      places[3 * i + axis] = double{centre[static_cast<int>(axis)]} * request.scale[axis];
    }
  }
  *error = ZOLTAN_OK;
}

/// Computes 1 / mean extent on each axis; 1 if that is zero or not finite.
Status measure_scale(MPI_Comm communicator, const CutWork& work, std::array<double, 3>& scale) {
  double sums[4] = {0.0, 0.0, 0.0, 0.0};
  for (const Aabb& box : work.boxes) {
    for (int axis = 0; axis < 3; ++axis) {
      const double extent = double{box.max[axis]} - double{box.min[axis]};
      if (std::isfinite(extent)) sums[axis] += extent;
    }
    sums[3] += 1.0;
  }
  if (MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, communicator) != MPI_SUCCESS) {
    return Status::communication_failed;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double inverse = sums[3] / sums[axis];
    scale[axis] = std::isnormal(inverse) ? inverse : 1.0;
  }
  return Status::ok;
}

/// Reconstructs the tree of cuts from the boxes that Zoltan returns for the ranks.
class TreeOfBoxes {
 public:
  struct Box {
    std::array<double, 3> low;
    std::array<double, 3> high;
  };

  TreeOfBoxes(std::vector<Box> boxes, const std::array<double, 3>& scale,
              std::span<SplitPlane> cuts)
      : boxes_(std::move(boxes)), scale_(scale), cuts_(cuts) {}

  /// Separates some ranks by cuts, and sets `side` to the root of these cuts. Returns false if no
  /// plane separates the ranks.
  bool cut(std::span<std::uint32_t> ranks, std::int32_t& side) {
    if (ranks.size() == 1) {
      side = ~static_cast<std::int32_t>(ranks.front());
      return true;
    }
    SplitPlane cut;
    std::size_t below = 0;
    for (std::uint32_t axis = 0; axis < 3 && below == 0; ++axis) {
      below = first_below(ranks, axis, cut);
    }
    if (below == 0) return false;
    side = static_cast<std::int32_t>(made_++);
    const bool done = this->cut(ranks.first(below), cut.sides[0]) &&
                      this->cut(ranks.subspan(below), cut.sides[1]);
    cuts_[static_cast<std::size_t>(side)] = cut;
    return done;
  }

 private:
  /// Sorts ranks along an axis. Returns how many are below the first plane that separates them, or
  /// 0 if there is none.
  std::size_t first_below(std::span<std::uint32_t> ranks, std::uint32_t axis,
                          SplitPlane& cut) const {
    std::sort(ranks.begin(), ranks.end(), [&](std::uint32_t a, std::uint32_t b) {
      return boxes_[a].low[axis] != boxes_[b].low[axis]
                 ? boxes_[a].low[axis] < boxes_[b].low[axis]
                 : boxes_[a].high[axis] < boxes_[b].high[axis];
    });
    double high = std::numeric_limits<double>::lowest();
    for (std::size_t i = 1; i < ranks.size(); ++i) {
      high = std::max(high, boxes_[ranks[i - 1]].high[axis]);
      if (boxes_[ranks[i]].low[axis] < high) continue;
      constexpr double kMaxFloat = std::numeric_limits<float>::max();
      cut.axis = axis;
      cut.at = static_cast<float>(std::clamp(high / scale_[axis], -kMaxFloat, kMaxFloat));
      return i;
    }
    return 0;
  }

  std::vector<Box> boxes_;
  std::array<double, 3> scale_;
  std::span<SplitPlane> cuts_;
  std::size_t made_ = 0;
};

/// Owns Zoltan's state.
class Zoltan {
 public:
  explicit Zoltan(MPI_Comm communicator) : state_(Zoltan_Create(communicator)) {}
  ~Zoltan() { Zoltan_Destroy(&state_); }
  Zoltan(const Zoltan&) = delete;
  Zoltan& operator=(const Zoltan&) = delete;

  [[nodiscard]] Zoltan_Struct* state() const noexcept { return state_; }

  [[nodiscard]] bool cut(CutRequest& request) {
    if (state_ == nullptr) return false;
    constexpr const char* kParameters[][2] = {{"DEBUG_LEVEL", "0"},     {"LB_METHOD", "RCB"},
                                              {"KEEP_CUTS", "1"},       {"OBJ_WEIGHT_DIM", "1"},
                                              {"RETURN_LISTS", "NONE"}, {"RCB_OUTPUT_LEVEL", "0"}};
    for (const auto& one : kParameters) Zoltan_Set_Param(state_, one[0], one[1]);
    Zoltan_Set_Num_Obj_Fn(state_, count_of, &request);
    Zoltan_Set_Obj_List_Fn(state_, list_of, &request);
    Zoltan_Set_Num_Geom_Fn(state_, dimensions_of, &request);
    Zoltan_Set_Geom_Multi_Fn(state_, places_of, &request);
    int changed, global_entries, local_entries, imports, exports;
    ZOLTAN_ID_PTR ids[4];
    int* lists[4];
    const int done = Zoltan_LB_Partition(state_, &changed, &global_entries, &local_entries,
                                         &imports, &ids[0], &ids[1], &lists[0], &lists[1], &exports,
                                         &ids[2], &ids[3], &lists[2], &lists[3]);
    return done == ZOLTAN_OK || done == ZOLTAN_WARN;
  }

 private:
  Zoltan_Struct* state_;
};

}  // namespace

Status cut_by_zoltan(MPI_Comm communicator, const CutWork& work, std::span<SplitPlane> cuts) {
  CutRequest request{work, {}};
  const Status measured = measure_scale(communicator, work, request.scale);
  if (measured != Status::ok) return measured;
  Zoltan zoltan(communicator);
  if (!zoltan.cut(request)) return Status::communication_failed;
  std::vector<TreeOfBoxes::Box> boxes(cuts.size() + 1);
  for (std::size_t rank = 0; rank < boxes.size(); ++rank) {
    int dimensions = 0;
    auto& [low, high] = boxes[rank];
    if (Zoltan_RCB_Box(zoltan.state(), static_cast<int>(rank), &dimensions, &low[0], &low[1],
                       &low[2], &high[0], &high[1], &high[2]) != ZOLTAN_OK) {
      return Status::communication_failed;
    }
  }
  std::vector<std::uint32_t> ranks(boxes.size());
  std::iota(ranks.begin(), ranks.end(), 0U);
  std::int32_t root = 0;
  TreeOfBoxes tree(std::move(boxes), request.scale, cuts);
  return tree.cut(ranks, root) ? Status::ok : Status::communication_failed;
}

}  // namespace winnow
