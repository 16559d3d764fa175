#include <winnow/partitions/partition.h>

#include "core/hooks/log.h"
#include "core/memory/new_in.h"
#include "core/memory/saved_keys.h"
#include "core/memory/snapshot_frame.h"
#include "core/memory/volume_columns.h"
#include "core/threads/float_environment.h"
#include "partitions/rows/row_input.h"
#include "partitions/state/partition_observer.h"
#include "partitions/state/partition_state.h"

#include <utility>

namespace winnow {
namespace {

constexpr std::string_view kPartitionMagic = "WINNOWPT";
constexpr std::uint32_t kPartitionVersion = 1;

void put_options(ByteWriter& out, const PartitionState& state) {
  out.put_text(state.structure.name());
  out.put(state.structure.parameter());
  out.put(state.rows.pool().volume());
  out.put(state.rows.fat_margin().distance);
  out.put(state.rows.fat_margin().share);
  out.put(std::uint64_t{state.index.planner().build_budget()});
}

void put_rows(ByteWriter& out, const Rows& rows) {
  const KeyTable& keys = rows.keys();
  out.put(std::uint64_t{rows.size() * rows.pool().columns()});
  for (std::size_t c = 0; c < rows.pool().columns(); ++c) {
    const float* const column = rows.pool().column(c);
    for_live(keys.stamps(), [&](ObjectId id) { out.put(column[keys.row_of(id)]); });
  }
  const bool filtered = rows.filters().in_use();
  out.put(std::uint64_t{filtered ? rows.size() : 0});
  if (!filtered) return;
  for_live(keys.stamps(), [&](ObjectId id) {
    const ObjectFilter filter = rows.filters().of(id);
    out.put_bytes(&filter, sizeof filter);
  });
}

/// The content of a snapshot, read before anything is changed.
struct ReadPartition {
  explicit ReadPartition(std::pmr::memory_resource* memory) noexcept
      : keys(memory), columns(memory), filters(memory) {}

  [[nodiscard]] StructureKind read(ByteReader& in, PartitionOptions& options) {
    const StructureKind named = structure_named(in.get_text());
    const auto parameter = in.get<float>();
    options.volume = in.get_enum(Volume::kdop26);
    options.fat_margin.distance = in.get<float>();
    options.fat_margin.share = in.get<float>();
    options.build_budget = static_cast<std::size_t>(in.get<std::uint64_t>());
    keys.read(in);
    (void)in.get_array(columns);
    (void)in.get_array(filters);
    if (named.info() == nullptr || !in.rest().empty()) in.fail();
    return in.ok() ? StructureKind(*named.info(), parameter) : StructureKind{};
  }

  [[nodiscard]] SavedRows rows(Volume volume) const noexcept {
    SavedRows saved;
    saved.keys = keys.saved();
    saved.objects = columns.size() / column_count(volume);
    saved.columns = {columns.data(), columns.size()};
    saved.filters = {filters.data(), filters.size()};
    return saved;
  }

  ReadKeys keys;
  Column<float> columns;
  Column<ObjectFilter> filters;
};

Status load_into(PartitionState*& state, std::span<const std::byte> saved) {
  ByteReader in = open_snapshot(saved, kPartitionMagic, kPartitionVersion);
  ReadPartition read(state->memory);
  PartitionOptions options{.memory = state->memory, .execution = state->rows.execution()};
  const StructureKind structure = read.read(in, options);
  if (!in.ok()) return status_of(in);
  PartitionState* fresh =
      PartitionState::make(structure, options, *RowInput::of(options.volume, options.fat_margin));
  if (fresh == nullptr) return Status::out_of_memory;
  const Status status = fresh->restore(read.rows(options.volume), *state);
  if (status == Status::ok) {
    fresh->observer = std::exchange(state->observer, nullptr);
    std::swap(state, fresh);
  }
  delete_in(state->memory, fresh);
  return status;
}

}  // namespace

Status Partition::save(Column<std::byte>& out) const {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(status_, "Partition::save");
  state_->write_deferred();
  const Status status =
      write_snapshot(out, kPartitionMagic, kPartitionVersion, [&](ByteWriter& writer) {
        put_options(writer, *state_);
        put_keys(writer, state_->rows.keys());
        put_rows(writer, state_->rows);
      });
  return logged(status, "Partition::save");
}

Status Partition::load(std::span<const std::byte> saved) {
  const DefaultFloatEnvironment environment;
  const Status status = state_ == nullptr ? status_ : load_into(state_, saved);
  if (is_observed(status, state_)) state_->observer->give_up();
  return logged(status, "Partition::load");
}

}  // namespace winnow
