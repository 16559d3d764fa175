#include "pipeline/cluster/checkpoint.h"
#include <winnow/core/memory.h>

#include "core/memory/byte_stream.h"
#include "pipeline/shapes/pair_order.h"

#include <algorithm>
#include <iterator>

namespace winnow {
namespace {

constexpr std::uint64_t kCheckpoint = 0x3130545352435257ULL;  // "WRCRST01"
/// Size of the header: the constant above, and the number of bytes that follow.
constexpr std::size_t kHeader = 2 * sizeof(std::uint64_t);

[[nodiscard]] std::uint64_t checksum_of(std::span<const std::byte> bytes) noexcept {
  Digest digest;
  digest.add(bytes);
  return digest.value();
}

[[nodiscard]] bool is_good(const BodyRecord& body) noexcept {
  const auto is_zero = [](std::uint8_t byte) { return byte == 0; };
  return body.state <= BodyState::dynamic && body.is_new <= 1 &&
         std::all_of(std::begin(body.spare), std::end(body.spare), is_zero);
}

[[nodiscard]] bool is_good(const TouchingPair& pair) noexcept {
  return pair.code < KindPairs::kCount && pair.a != pair.b;
}

/// Reads the columns of one checkpoint and appends them to the batch.
[[nodiscard]] Status take_columns(std::span<const std::byte> columns, RecordBatch& batch) {
  Column<BodyName> names(default_memory());
  Column<BodyRecord> bodies(default_memory());
  Column<TouchingPair> touching(default_memory());
  ByteReader reader(columns);
  if (!reader.get_array(names) || !reader.get_array(bodies) || !reader.get_array(touching) ||
      !reader.rest().empty() || names.size() != bodies.size()) {
    return Status::invalid_argument;
  }
  const auto good_body = [](const BodyRecord& body) { return is_good(body); };
  const auto good_pair = [](const TouchingPair& pair) { return is_good(pair); };
  const auto does_not_ascend = [](const auto& a, const auto& b) { return !(a < b); };
  if (!std::all_of(bodies.begin(), bodies.end(), good_body) ||
      !std::all_of(touching.begin(), touching.end(), good_pair) ||
      std::adjacent_find(touching.begin(), touching.end(), does_not_ascend) != touching.end()) {
    return Status::invalid_argument;
  }
  batch.names.insert(batch.names.end(), names.begin(), names.end());
  batch.bodies.insert(batch.bodies.end(), bodies.begin(), bodies.end());
  batch.touching.insert(batch.touching.end(), touching.begin(), touching.end());
  return Status::ok;
}

}  // namespace

std::vector<BodyDefinition> definitions_of(std::span<const BodyName> names,
                                           std::span<const BodyRecord> bodies) {
  std::vector<BodyDefinition> definitions;
  for (std::size_t i = 0; i < names.size(); ++i) {
    definitions.push_back(bodies[i].definition(names[i]));
  }
  return definitions;
}

std::vector<BodyRecord> records_of(std::span<const BodyDefinition> bodies) {
  std::vector<BodyRecord> records;
  for (const BodyDefinition& body : bodies) {
    records.push_back({body.pose, body.shape, body.filter, body.state, 1});
  }
  return records;
}

std::uint64_t digest_of_batch(const ClusterSceneBatch& batch) noexcept {
  Digest digest;
  digest.add_array(batch.names);
  for (const BodyDefinition& body : batch.bodies) {
    for (const double number : body.pose.position) digest.add(number);
    for (const double number : body.pose.orientation) digest.add(number);
    for (const std::uint32_t number :
         {body.shape.bits, static_cast<std::uint32_t>(body.state), body.filter.layers,
          body.filter.mask, body.filter.environment}) {
      digest.add(std::uint64_t{number});
    }
  }
  return digest.value();
}

Status write_checkpoint(std::span<const BodyName> names, std::span<const BodyRecord> bodies,
                        std::span<const TouchingPair> touching, std::vector<std::byte>& bytes) {
  Column<std::byte> columns(default_memory());
  ByteWriter writer(columns);
  writer.put_array(names);
  writer.put_array(bodies);
  writer.put_array(touching);
  writer.put(checksum_of({columns.data(), columns.size()}));
  const std::uint64_t header[] = {kCheckpoint, columns.size()};
  if (!writer.ok()) return Status::out_of_memory;
  bytes.reserve(bytes.size() + kHeader + columns.size());
  const auto start = std::as_bytes(std::span(header));
  bytes.insert(bytes.end(), start.begin(), start.end());
  bytes.insert(bytes.end(), columns.begin(), columns.end());
  return Status::ok;
}

Status read_checkpoints(std::span<const std::byte> bytes, RecordBatch& batch) {
  while (!bytes.empty()) {
    ByteReader header(bytes);
    const auto kind = header.get<std::uint64_t>();
    const auto size = header.get<std::uint64_t>();
    constexpr std::size_t kChecksum = sizeof(std::uint64_t);
    if (bytes.size() < kHeader || kind != kCheckpoint || size < kChecksum ||
        size > bytes.size() - kHeader) {
      return Status::invalid_argument;
    }
    const auto columns = bytes.subspan(kHeader, static_cast<std::size_t>(size) - kChecksum);
    ByteReader end(bytes.subspan(kHeader + columns.size(), kChecksum));
    if (end.get<std::uint64_t>() != checksum_of(columns)) return Status::invalid_argument;
    const Status status = take_columns(columns, batch);
    if (status != Status::ok) return status;
    bytes = bytes.subspan(kHeader + static_cast<std::size_t>(size));
  }
  std::sort(batch.touching.begin(), batch.touching.end());
  return Status::ok;
}

}  // namespace winnow
