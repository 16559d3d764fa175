#pragma once

// What a partition asks of a structure. A structure knows rows of bounding volumes and how it put
// them in order; objects, queries, pairs and events are the partition's.

#include <winnow/core/debug_draw.h>
#include <winnow/core/footprint.h>
#include <winnow/partitions/structures.h>
#include "core/memory/bounds_pool.h"
#include "core/memory/new_in.h"
#include "partitions/rows/row_view.h"
#include "partitions/rows/rows.h"
#include "partitions/tree/block_tree.h"
#include "partitions/tree/kd_order.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <string_view>

namespace winnow {

class Chooser;
class Structure;
struct StructureCosts;

/// Of fewer objects the tree alone has the pairs sooner than cells are made for them.
inline constexpr std::size_t kFewestInCells = 256;

/// What a structure is made with: the rows it is about, and the tree over those of them that are
/// regular, which the partition keeps. Both outlive it.
struct StructureInput {
  std::pmr::memory_resource* memory;
  const Rows& rows;
  const BlockTree& regular_tree;
  float parameter;  ///< of the StructureKind
};

/// What is known of a structure before one is made. Each is a constant in a structure's own source.
struct StructureInfo {
  std::string_view name;
  /// Null if memory is refused.
  Structure* (*make)(const StructureInput&) noexcept;
  /// Ends one that `make` made with this resource.
  void (*end)(Structure*, std::pmr::memory_resource*) noexcept;
  /// Its sizeof.
  std::size_t bytes;
  /// What it costs, for the automatic choice; null: it is never chosen.
  const StructureCosts* costs = nullptr;
  /// Makes what goes on choosing the structure; null for all but the automatic one. Null is
  /// returned if memory is refused.
  Chooser* (*make_chooser)(std::pmr::memory_resource*) noexcept = nullptr;
};

template <typename T>
[[nodiscard]] constexpr StructureInfo structure_info(
    std::string_view name, const StructureCosts* costs = nullptr) noexcept {
  return {.name = name,
          .make = [](const StructureInput& input) noexcept -> Structure* {
            return new_in<T>(input.memory, input);
          },
          .end =
              [](Structure* structure, std::pmr::memory_resource* memory) noexcept {
                delete_in(memory, static_cast<T*>(structure));
              },
          .bytes = sizeof(T),
          .costs = costs};
}

/// An object that was moved behind all others, and the row that it stood in before.
struct RowMove {
  std::uint32_t row;
  ObjectId id;
};

/// Which rows a plan is about, and where it writes which go where.
struct RowPlan {
  /// Rows below this, of which so many held objects when the plan was begun. Further ones may come
  /// while it is made.
  std::size_t rows;
  std::size_t objects;
  /// The regular rows in their order; has room for every row. Entries of kNoObject leave places
  /// empty.
  Column<std::uint32_t>& regular;
  /// All other live rows; has room for every row.
  Column<std::uint32_t>& rest;
  /// Scratch for sorting, and by row. They keep what a stage leaves in them until the rows stand in
  /// the planned order.
  Column<std::uint64_t>& items;
  Column<std::uint32_t>& list;
  /// What was moved since the plan was begun, by ascending rows.
  std::span<const RowMove> moves;
};

/// What has to be made ready for a build, at most.
struct BuildRoom {
  std::size_t objects;  ///< all of them live, in as many rows
  Pages pages;
  /// Scratch for sorting: by integers, by row, and by places.
  Column<std::uint64_t>& items;
  Column<std::uint32_t>& list;
  Column<float>& points;
};

/// How a stage of a plan ended.
enum class Planned : std::uint8_t { out_of_memory, goes_on, done };

class Structure {
 public:
  explicit Structure(const StructureInput& input) noexcept
      : rows_(input.rows), regular_tree_(input.regular_tree) {}
  Structure(const Structure&) = delete;
  Structure& operator=(const Structure&) = delete;

  /// True if all rows stay in one unordered regular region.
  [[nodiscard]] virtual bool is_flat() const noexcept { return false; }
  /// True if regular rows are found by the boxes of their blocks: the tree over these is then made
  /// by each build and kept up to date by each refresh.
  [[nodiscard]] virtual bool prunes_rows() const noexcept { return false; }
  /// False if it reports pairs whose volumes do not overlap.
  [[nodiscard]] virtual bool tests_volumes() const noexcept { return true; }

  // Ordering rows.

  /// Makes room for a build of so many objects, wherever they lie, so that it asks for no memory.
  /// False if memory is refused. By default all are cut at medians.
  [[nodiscard]] virtual bool reserve(const BuildRoom& room) noexcept {
    return room.points.reserve(kd_scratch(room.objects), room.pages);
  }
  /// Places at most that a plan leaves empty.
  [[nodiscard]] virtual std::size_t most_holes() const noexcept { return 0; }

  /// Chooses the rows of the regular region and their order, a stage with each call: the first has
  /// number 0, and each takes about as long as going over all rows once. By default every live row
  /// is part of the rest.
  ///
  /// Between two stages objects may move, and rows become empty, but no row becomes another
  /// object's. What a plan decides may be out of date when it is done: rows that no longer fit are
  /// found then. Until `finish_build` the structure answers for the rows as the last build left
  /// them. A plan that is left unfinished, or that memory is refused for, is forgotten.
  [[nodiscard]] virtual Planned plan(const RowPlan& plan, unsigned) noexcept {
    leave_all(plan);
    return Planned::done;
  }
  /// Makes every live row part of the rest.
  void leave_all(const RowPlan& plan) const noexcept;
  /// Where the object stands now that stood in a row when the plan was begun; the row itself if it
  /// is gone. O(log moves) for rows that have become empty.
  [[nodiscard]] std::size_t row_now(const RowPlan& plan, std::size_t row) const noexcept;
  /// Appends rows to `order` in the order in which the tree's blocks of 16 are to hold them; no
  /// environments are in use. It may reorder `rest`. `Order::none` leaves that to the partition,
  /// which cuts at medians.
  enum class Ordered : std::uint8_t { none, done, out_of_memory };
  [[nodiscard]] virtual Ordered order_rest(std::span<std::uint32_t>,
                                           Column<std::uint32_t>&) noexcept {
    return Ordered::none;
  }
  /// How the order of the rest is found by a first build, if nobody asks for rays or regions.
  [[nodiscard]] virtual KdParts first_parts() const noexcept { return KdParts::tiles; }
  /// What a build costs in tests of 16 volumes per object. The default was measured on both sides
  /// of the decision to build anew.
  [[nodiscard]] virtual std::uint64_t build_price() const noexcept { return 12; }
  /// About how many passes over all rows a plan takes, the order of the rest included.
  [[nodiscard]] virtual std::size_t plan_passes() const noexcept { return 4; }
  /// Called when the rows stand in the planned order. `moved` says that objects may have moved
  /// since the plan was begun.
  virtual void finish_build(const RowPlan&, bool /*moved*/) noexcept {}

  // What no longer fits.

  /// A box, or where one is expected to be.
  struct Place {
    std::array<float, 3> low;
    std::array<float, 3> high;
  };
  [[nodiscard]] Place place_of(std::size_t row) const noexcept {
    Place place;
    for (std::size_t a = 0; a < 3; ++a) {
      place.low[a] = pool().column(a)[row];
      place.high[a] = pool().column(3 + a)[row];
    }
    return place;
  }
  /// True if the object in this regular row would still fit where the build put it if it were at a
  /// place.
  [[nodiscard]] virtual bool fits(std::size_t, const Place&) const noexcept { return true; }
  /// Appends the regular rows that no longer fit; any may have changed. `room` is for as many as
  /// there are regular rows. False, and nothing appended, where they are more than `most`, or a
  /// sample of them promises it.
  virtual bool find_misfits(std::uint32_t* /*room*/, Column<std::uint32_t>&,
                            std::size_t /*most*/) noexcept {
    return true;
  }

  // Pairs.

  /// Pairs within the regular region, in independent tasks. False if the sink could not grow.
  [[nodiscard]] virtual std::size_t pair_tasks() const noexcept { return 0; }
  virtual bool run_pair_task(std::size_t, PairSink&) const noexcept { return true; }
  /// Hits of boxes in the regular region.
  virtual bool query(const QueryBatch&, PairSink&) const noexcept { return true; }

  // Looking at it.

  /// Draws cells, strips or whatever the regular region has.
  virtual void draw(DebugDraw&) const {}
  /// Cells, strips or nodes of the regular region; 0 if leaf blocks are all there is.
  [[nodiscard]] virtual std::size_t cells() const noexcept { return 0; }
  [[nodiscard]] virtual std::size_t levels() const noexcept { return 0; }
  /// Gives back what only builds need.
  virtual void release_scratch() noexcept {}
  /// Gives back what an empty structure holds.
  virtual void release_memory() noexcept {}
  virtual void add_bytes(Footprint&) const noexcept {}

 protected:
  ~Structure() = default;

  [[nodiscard]] const BoundsPool& pool() const noexcept { return rows_.pool(); }
  [[nodiscard]] const Execution& execution() const noexcept { return rows_.execution(); }
  [[nodiscard]] std::size_t objects() const noexcept { return rows_.size(); }
  [[nodiscard]] std::size_t regular_rows() const noexcept { return rows_.regions().regular; }
  [[nodiscard]] RowView row_view() const noexcept { return rows_.view(); }
  /// Over the regular rows: boxes where `prunes_rows`, and what filters have between them where
  /// filters are in use.
  [[nodiscard]] TreeView regular_tree() const noexcept { return regular_tree_.view(row_view()); }

 private:
  const Rows& rows_;
  const BlockTree& regular_tree_;
};

}  // namespace winnow
