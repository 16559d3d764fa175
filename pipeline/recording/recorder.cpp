#include "pipeline/recording/recorder_state.h"

namespace winnow {
namespace {

/// A block of at least this size is written before its frame ends.
constexpr std::size_t kBlockBytes = std::size_t{1} << 18U;

}  // namespace

void RecorderState::write(std::span<const std::byte> data) noexcept {
  if (status != Status::ok) return;
  const bool taken = file != nullptr ? std::fwrite(data.data(), 1, data.size(), file) == data.size()
                                     : sink.write != nullptr && sink.write(sink.context, data);
  if (!taken) return fail(Status::out_of_memory);
  bytes += data.size();
}

void RecorderState::begin() noexcept {
  std::byte header[kRecordingHeader] = {};
  std::memcpy(header, kRecordingMagic.data(), kRecordingMagic.size());
  std::memcpy(header + kRecordingMagic.size(), &kRecordingVersion, sizeof kRecordingVersion);
  write(header);
}

void RecorderState::flush() noexcept {
  if (block.empty()) return;
  Digest digest;
  digest.add(std::span<const std::byte>(block.data(), block.size()));
  const std::uint64_t header[2] = {block.size(), digest.value()};
  static_assert(sizeof header == kBlockHeader);
  write(std::as_bytes(std::span(header)));
  write({block.data(), block.size()});
  block.clear();
  if (file != nullptr && status == Status::ok && std::fflush(file) != 0) {
    fail(Status::out_of_memory);
  }
}

void RecorderState::close() noexcept {
  if (closed) return;
  closed = true;
  flush();
  const std::uint64_t end[2] = {0, calls};
  write(std::as_bytes(std::span(end)));
  if (file != nullptr && std::fclose(file) != 0) fail(Status::out_of_memory);
  file = nullptr;
}

CallWriter::CallWriter(RecorderState& state, RecordedCall call, std::uint32_t world) noexcept
    : state_(state), lock_(state.mutex) {
  if (state_.status != Status::ok || state_.closed) return;
  begin_ = state_.block.size();
  writer_.emplace(state_.block);
  put(call).put(world);
}

CallWriter::~CallWriter() {
  if (!is_open()) return;
  if (!writer_->ok()) {
    give_up(Status::out_of_memory);
    return;
  }
  ++state_.calls;
  if (state_.block.size() >= kBlockBytes) state_.flush();
}

void CallWriter::give_up(Status why) noexcept {
  if (!is_open()) return;
  writer_.reset();
  state_.block.set_size(begin_);
  state_.fail(why);
}

CallWriter& CallWriter::put_ids(std::span<const Key> keys) noexcept {
  put(std::uint64_t{keys.size()});
  for (const Key& key : keys) put(key.id);
  return *this;
}

Recorder::Recorder(const char* path, std::pmr::memory_resource* memory) noexcept
    : memory_(memory), state_(new_in<RecorderState>(memory, memory)) {
  if (state_ == nullptr) return;
  state_->file = path == nullptr ? nullptr : std::fopen(path, "wb");
  if (state_->file == nullptr) state_->fail(Status::invalid_argument);
  state_->begin();
}

Recorder::Recorder(const RecordingSink& sink, std::pmr::memory_resource* memory) noexcept
    : memory_(memory), state_(new_in<RecorderState>(memory, memory)) {
  if (state_ == nullptr) return;
  state_->sink = sink;
  state_->begin();
}

Recorder::~Recorder() {
  (void)close();
  delete_in(memory_, state_);
}

void Recorder::end_frame() noexcept {
  if (state_ == nullptr) return;
  (void)CallWriter(*state_, RecordedCall::end_frame, kNoWorld);
  const Lock lock(state_->mutex);
  state_->flush();
}

Status Recorder::close() noexcept {
  if (state_ == nullptr) return Status::out_of_memory;
  const Lock lock(state_->mutex);
  state_->close();
  return state_->status;
}

Status Recorder::status() const noexcept {
  if (state_ == nullptr) return Status::out_of_memory;
  const Lock lock(state_->mutex);
  return state_->status;
}

std::uint64_t Recorder::bytes() const noexcept {
  if (state_ == nullptr) return 0;
  const Lock lock(state_->mutex);
  return state_->bytes;
}

std::uint64_t Recorder::calls() const noexcept {
  if (state_ == nullptr) return 0;
  const Lock lock(state_->mutex);
  return state_->calls;
}

}  // namespace winnow
