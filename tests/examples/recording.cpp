// A program records its calls and replays them; it also saves its objects and loads them again.

#include <winnow/pipeline/recording.h>

#include <cstddef>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/examples/check.h"

namespace {

std::string read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

int main() {
  const std::string path = "winnow_example_recording.winnow";
  const char* const file = path.c_str();
  std::vector<winnow::Aabb> boxes(2, winnow::Aabb{{0, 0, 0}, {1, 1, 1}});
  std::vector<winnow::Key> keys(boxes.size());
  const std::vector<winnow::ClientData> names(boxes.size(), 7);
  winnow::PairBuffer pairs;
  {
    // [recording]
    winnow::Recorder recorder(file);
    winnow::Partition partition(winnow::linear_bvh(), {.recorder = &recorder});
    must(partition.insert(boxes, names, keys));
    must(partition.self_pairs(pairs));
    recorder.end_frame();
    // [end]
    check(pairs.size() == 1, "the two boxes overlap");
    check(recorder.status() == winnow::Status::ok, "it is recorded");
  }
  const std::string bytes = read(file);
  // [replay]
  winnow::RecordingPlayer player(std::as_bytes(std::span(bytes)));
  must(player.play_all());
  std::printf("%llu answers differ\n",
              static_cast<unsigned long long>(player.counts().differences));
  // [end]
  check(player.is_whole() && player.counts().questions == 1 && player.counts().differences == 0,
        "the answer is the recorded one");
  std::remove(file);

  winnow::Partition partition(winnow::linear_bvh());
  must(partition.insert(boxes, names, keys));
  // [snapshot]
  winnow::Column<std::byte> saved(std::pmr::get_default_resource());
  must(partition.save(saved));
  must(partition.remove(keys[0]));
  must(partition.load(
      {saved.data(), saved.size()}));  // here or in another process; restores keys[0]
  // [end]
  check(partition.contains(keys[0]), "the key is that of the same object again");
}
