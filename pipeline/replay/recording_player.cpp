// RecordingPlayer: checks a recording, and dispatches its calls to the play_*.cpp files.

#include "core/memory/new_in.h"
#include "pipeline/replay/replay_state.h"

namespace winnow {
namespace {

struct BlockHead {
  std::uint64_t size = 0;
  std::uint64_t digest = 0;
};

/// Returns false if the header is incomplete.
bool read_head(std::span<const std::byte> bytes, BlockHead& head) noexcept {
  if (bytes.size() < kBlockHeader) return false;
  std::memcpy(&head.size, bytes.data(), sizeof head.size);
  std::memcpy(&head.digest, bytes.data() + sizeof head.size, sizeof head.digest);
  return true;
}

}  // namespace

ReplayState::ReplayState(std::span<const std::byte> bytes, const ReplayOptions& given) noexcept
    : options(given),
      rest(bytes),
      in({}),
      worlds(given.memory),
      ids(given.memory),
      keys(given.memory),
      others(given.memory),
      data(given.memory),
      floats(given.memory),
      doubles(given.memory),
      filters(given.memory),
      recorded_bodies(given.memory),
      bodies(given.memory),
      key_pairs(given.memory),
      rays(given.memory),
      shape_rays(given.memory),
      planes(given.memory),
      motions(given.memory),
      flags(given.memory),
      filter(given.memory) {
  status = check();
}

ReplayState::~ReplayState() {
  for (ReplayedWorld* const one : worlds) delete_in(options.memory, one);
}

/// Checks the header, and the digest of every complete block. If a program ended before its
/// recording was closed, the recording ends with a complete or an incomplete block.
Status ReplayState::check() noexcept {
  ByteReader header(rest);
  char magic[8] = {};
  (void)header.get_bytes(magic, sizeof magic);
  const auto version = header.get<std::uint32_t>();
  const auto unused = header.get<std::uint32_t>();
  const std::optional<RecordedCall> last = last_call_of(version);
  const bool known = header.ok() && std::string_view(magic, sizeof magic) == kRecordingMagic &&
                     last && unused == 0;
  if (!known) return Status::invalid_argument;
  last_call = *last;
  rest = header.rest();
  std::size_t good = 0;
  BlockHead head;
  while (read_head(rest.subspan(good), head)) {
    const std::span<const std::byte> behind = rest.subspan(good + kBlockHeader);
    if (head.size == 0) {
      is_whole = behind.empty();
      if (!is_whole) return Status::invalid_argument;
      break;
    }
    if (head.size > behind.size()) break;
    Digest digest;
    digest.add(behind.first(static_cast<std::size_t>(head.size)));
    if (digest.value() != head.digest) return Status::invalid_argument;
    good += kBlockHeader + static_cast<std::size_t>(head.size);
  }
  rest = rest.first(good);
  return Status::ok;
}

bool ReplayState::next_block() noexcept {
  BlockHead head;
  if (!read_head(rest, head)) return false;
  in = ByteReader(rest.subspan(kBlockHeader, static_cast<std::size_t>(head.size)));
  rest = rest.subspan(kBlockHeader + static_cast<std::size_t>(head.size));
  return true;
}

Played ReplayState::step() noexcept {
  if (status != Status::ok || (in.rest().empty() && !next_block())) return Played::end;
  const auto call = in.get_enum(last_call);
  const auto number = in.get<std::uint32_t>();
  CallOutcome outcome = CallOutcome::changed;
  const std::uint64_t before = queries;
  status = in.ok() ? play(call, number, outcome) : Status::invalid_argument;
  if (status != Status::ok) return Played::end;
  ++calls;
  if (outcome == CallOutcome::frame) return Played::frame;
  if (queries == before) return Played::change;
  const bool all = call == RecordedCall::self_pairs || call == RecordedCall::collide;
  return all ? Played::pairs : Played::question;
}

Status ReplayState::play(RecordedCall call, std::uint32_t number, CallOutcome& outcome) {
  if (call == RecordedCall::end_frame) {
    outcome = CallOutcome::frame;
    ++frames;
    return number == kNoWorld ? Status::ok : Status::invalid_argument;
  }
  return play_world(call, number);
}

Status ReplayState::play_world(RecordedCall call, std::uint32_t number) {
  const bool makes = call == RecordedCall::make_partition || call == RecordedCall::make_scene;
  ReplayedWorld* const of = makes ? add_world(number) : world(number);
  if (of == nullptr)
    return makes && number < kNoWorld ? Status::out_of_memory : Status::invalid_argument;
  if (call == RecordedCall::end_world) {
    delete_in(options.memory, of);
    worlds[number] = nullptr;
    return Status::ok;
  }
  if (call == RecordedCall::make_scene) return make_scene(*this, *of);
  if (call > RecordedCall::make_scene) {
    if (!of->scene) return Status::invalid_argument;
    if (call >= RecordedCall::query_distance_by_rules) return query_scene(*this, call, *of);
    if (call >= RecordedCall::find_impacts) return find_impacts(*this, call, *of);
    if (call >= RecordedCall::make_sensors) return play_sensors(*this, call, *of);
    const bool is_query = call >= RecordedCall::query_ray && call < RecordedCall::load_scene;
    return is_query ? query_scene(*this, call, *of) : change_scene(*this, call, *of);
  }
  if (call != RecordedCall::make_partition && !of->partition) return Status::invalid_argument;
  return change_partition(*this, call, *of);
}

// Reads of arguments that several groups of calls have.

bool ReplayState::read_poses(std::size_t count, PoseView& poses) {
  const bool turns = in.get_bool();
  if (!in.get_array(doubles)) return false;
  const std::size_t width = turns ? 7 : 3;
  if (doubles.size() != count * width) return in.fail();
  const double* const at = doubles.data();
  poses = {};
  poses.count = count;
  poses.position_stride = poses.orientation_stride = width * sizeof(double);
  if (at == nullptr) return true;
  poses.position = {at, at + 1, at + 2};
  if (turns) poses.orientation = {at + 3, at + 4, at + 5, at + 6};
  return true;
}

/// Reads the filter at the end of a query; false if it is incomplete.
bool ReplayState::read_query_filter() noexcept {
  filter.read_filter(in);
  filter.read_passed_objects(in);
  return in.ok();
}

bool ReplayState::read_shape(const ReplayedWorld& of, ShapeId& id) noexcept {
  const auto number = in.get<std::uint32_t>();
  if (!in.ok() || number >= of.shape_ids.size()) return in.fail();
  id = of.shape_ids[number];
  return true;
}

bool ReplayState::read_sets(ReplayedWorld& of) {
  if (!read_keys(*of.scene)) return false;
  keys.swap(others);
  return read_keys(*of.scene);
}

/// Worlds are created in the order of their numbers, with two exceptions: partitions that could not
/// be created are not recorded, and two threads may record their new worlds in the other order.
ReplayedWorld* ReplayState::add_world(std::uint32_t number) noexcept {
  constexpr std::size_t kMaxNumberGap = 4096;
  if (number >= worlds.size() + kMaxNumberGap || world(number) != nullptr) return nullptr;
  while (worlds.size() <= number) {
    if (!worlds.push_back(nullptr)) return nullptr;
  }
  worlds[number] = new_in<ReplayedWorld>(options.memory, options.memory);
  return worlds[number];
}

RecordingPlayer::RecordingPlayer(std::span<const std::byte> recording,
                                 const ReplayOptions& options) noexcept
    : memory_(options.memory), state_(new_in<ReplayState>(options.memory, recording, options)) {}

RecordingPlayer::~RecordingPlayer() {
  delete_in(memory_, state_);
}

Status RecordingPlayer::status() const noexcept {
  return state_ == nullptr ? Status::out_of_memory : state_->status;
}

bool RecordingPlayer::is_whole() const noexcept {
  return state_ != nullptr && state_->is_whole;
}

Played RecordingPlayer::step() noexcept {
  return state_ == nullptr ? Played::end : state_->step();
}

Status RecordingPlayer::play_all() noexcept {
  while (step() != Played::end) {
  }
  return status();
}

PlayedCounts RecordingPlayer::counts() const noexcept {
  if (state_ == nullptr) return {};
  return {state_->calls, state_->frames, state_->queries, state_->differences};
}

std::size_t RecordingPlayer::worlds() const noexcept {
  return state_ == nullptr ? 0 : state_->worlds.size();
}

PlayedWorld RecordingPlayer::world(std::size_t number) const noexcept {
  const ReplayedWorld* const one = number < worlds() ? state_->worlds[number] : nullptr;
  if (one == nullptr) return {};
  const auto if_any = [](const auto& object) { return object ? &*object : nullptr; };
  return {if_any(one->partition), if_any(one->scene), if_any(one->shapes), if_any(one->composites),
          one->scene ? &one->contacts : nullptr};
}

}  // namespace winnow
