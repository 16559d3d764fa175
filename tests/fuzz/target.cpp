// What runs a target: libFuzzer, or a plain program that replays files and the target's own seeds.

#include "tests/fuzz/target.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// One file each, named by number.
void write_seeds(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::size_t number = 0;
  for (const std::string& seed : fuzz_seeds()) {
    std::ofstream(folder / ("seed_" + std::to_string(number++)), std::ios::binary) << seed;
  }
}

[[maybe_unused]] void replay_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  fuzz(bytes_of({std::istreambuf_iterator<char>(file), {}}));
}

/// Every file of a folder, by name, or one file.
[[maybe_unused]] std::size_t replay(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) {
    replay_file(path);
    return 1;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(path)) files.push_back(entry);
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) replay_file(file);
  return files.size();
}

}  // namespace

std::vector<std::string> random_seeds(std::size_t count, std::size_t length) {
  Random random(count + length);
  std::vector<std::string> seeds(scaled(count));
  for (std::string& seed : seeds) {
    seed.resize(1 + random.below(length));
    for (char& c : seed) c = static_cast<char>(random.bits());
  }
  return seeds;
}

ScratchFile::ScratchFile(std::span<const std::uint8_t> bytes, const std::string& ending)
    : path_((std::filesystem::exists("/dev/shm") ? std::filesystem::path("/dev/shm")
                                                 : std::filesystem::temp_directory_path()) /
            ("winnow_fuzz_" + std::to_string(::getpid()) + ending)) {
  std::ofstream(path_, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void does_not_hold(const char* file, int line, const std::string& what) {
  std::fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, what.c_str());
  std::abort();
}

}  // namespace winnow::test

#if WINNOW_LIBFUZZER

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  testing::GTEST_FLAG(break_on_failure) = true;
  if (*argc == 3 && std::string((*argv)[1]) == "--write-seeds") {
    winnow::test::write_seeds((*argv)[2]);
    std::exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  winnow::test::fuzz({data, size});
  return 0;
}

#else

int main(int argc, char** argv) {
  testing::GTEST_FLAG(break_on_failure) = true;
  if (argc == 3 && std::string(argv[1]) == "--write-seeds") {
    winnow::test::write_seeds(argv[2]);
    return 0;
  }
  std::size_t inputs = 0;
  for (int i = 1; i < argc; ++i) inputs += winnow::test::replay(argv[i]);
  for (const std::string& seed : winnow::test::fuzz_seeds()) {
    winnow::test::fuzz(winnow::test::bytes_of(seed));
    ++inputs;
  }
  std::printf("%zu inputs hold\n", inputs);
}

#endif
