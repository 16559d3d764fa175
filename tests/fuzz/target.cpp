// The main program of a fuzz target: libFuzzer, or a program that replays files and the target's
// own seeds. A file whose name ends in .inputs contains many inputs, one after the other: the size
// of each in four bytes, the lowest first, then its bytes.

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

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns the inputs of a folder, sorted by name, of an .inputs file, or of one file.
std::vector<std::string> inputs_of(const std::filesystem::path& path) {
  std::vector<std::string> inputs;
  if (std::filesystem::is_directory(path)) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(path)) files.push_back(entry);
    std::sort(files.begin(), files.end());
    for (const std::filesystem::path& file : files) inputs.push_back(content_of(file));
    return inputs;
  }
  const std::string content = content_of(path);
  if (path.extension() != ".inputs") return {content};
  for (std::size_t at = 0; at + 4 <= content.size();) {
    std::size_t size = 0;
    for (std::size_t i = 4; i-- > 0;) size = size << 8U | bytes_of(content)[at + i];
    inputs.push_back(content.substr(at + 4, size));
    at += 4 + size;
  }
  return inputs;
}

/// Writes one file for each input, named by number.
void write_each(const std::vector<std::string>& inputs, const std::filesystem::path& folder,
                const std::string& name) {
  std::filesystem::create_directories(folder);
  std::size_t number = 0;
  for (const std::string& input : inputs) {
    std::ofstream(folder / (name + std::to_string(number++)), std::ios::binary) << input;
  }
}

void write_together(const std::vector<std::string>& inputs, const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  for (const std::string& input : inputs) {
    for (unsigned byte = 0; byte < 4; ++byte) {
      file.put(static_cast<char>(input.size() >> 8 * byte & 0xFFU));
    }
    file << input;
  }
}

/// Handles the options that write or pack files; returns false if there is no such option.
bool handle_files(int argc, char** argv) {
  const std::string option = argc > 1 ? argv[1] : "";
  if (option == "--write-seeds" && argc == 3) {
    write_each(fuzz_seeds(), argv[2], "seed_");
  } else if (option == "--unpack" && argc == 4) {
    write_each(inputs_of(argv[2]), argv[3], "kept_");
  } else if (option == "--pack" && argc == 4) {
    write_together(inputs_of(argv[2]), argv[3]);
  } else {
    return false;
  }
  return true;
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
  if (winnow::test::handle_files(*argc, *argv)) std::exit(0);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  winnow::test::fuzz({data, size});
  return 0;
}

#else

int main(int argc, char** argv) {
  testing::GTEST_FLAG(break_on_failure) = true;
  if (winnow::test::handle_files(argc, argv)) return 0;
  std::vector<std::string> inputs = winnow::test::fuzz_seeds();
  for (int i = 1; i < argc; ++i) {
    for (std::string& input : winnow::test::inputs_of(argv[i])) inputs.push_back(std::move(input));
  }
  for (const std::string& input : inputs) winnow::test::fuzz(winnow::test::bytes_of(input));
  std::printf("%zu inputs hold\n", inputs.size());
}

#endif
