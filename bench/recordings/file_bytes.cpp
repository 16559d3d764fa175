#include "bench/recordings/file_bytes.h"

#include "bench/recordings/recording.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#if WINNOW_HAVE_LZMA
#include <lzma.h>
#endif

namespace winnow::bench {
namespace {

constexpr std::size_t kPortion = std::size_t{1} << 20U;

bool is_xz(const std::vector<std::byte>& bytes) {
  constexpr std::array<unsigned char, 6> kMagic{0xFD, '7', 'z', 'X', 'Z', 0x00};
  return bytes.size() >= kMagic.size() &&
         std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) == 0;
}

#if WINNOW_HAVE_LZMA

std::vector<std::byte> decompressed(const std::vector<std::byte>& xz, const std::string& path) {
  lzma_stream stream = LZMA_STREAM_INIT;
  if (lzma_stream_decoder(&stream, UINT64_MAX, LZMA_CONCATENATED) != LZMA_OK) {
    throw RecordingError(path + ": no memory to decompress it");
  }
  const std::unique_ptr<lzma_stream, decltype(&lzma_end)> end(&stream, lzma_end);
  stream.next_in = reinterpret_cast<const std::uint8_t*>(xz.data());
  stream.avail_in = xz.size();
  std::vector<std::byte> bytes;
  for (lzma_ret result = LZMA_OK; result != LZMA_STREAM_END;) {
    bytes.resize(bytes.size() + kPortion);
    stream.next_out = reinterpret_cast<std::uint8_t*>(bytes.data() + bytes.size() - kPortion);
    stream.avail_out = kPortion;
    while (stream.avail_out != 0 && result == LZMA_OK) result = lzma_code(&stream, LZMA_FINISH);
    bytes.resize(bytes.size() - stream.avail_out);
    if (result == LZMA_OK || result == LZMA_STREAM_END) continue;
    const char* const what = result == LZMA_BUF_ERROR   ? "is cut off"
                             : result == LZMA_MEM_ERROR ? "needs more memory than there is"
                                                        : "is damaged";
    throw RecordingError(path + ": the xz data " + what + " at compressed byte " +
                         std::to_string(stream.total_in));
  }
  return bytes;
}

#else

std::vector<std::byte> decompressed(const std::vector<std::byte>&, const std::string& path) {
  throw RecordingError(path + ": is compressed, and this tool was built without liblzma; " +
                       "decompress it first: xz -dk " + path);
}

#endif

}  // namespace

std::vector<std::byte> read_bytes(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw RecordingError(path + ": is a folder, not a recording");
  }
  const std::unique_ptr<std::FILE, decltype(&std::fclose)> file(std::fopen(path.c_str(), "rb"),
                                                                std::fclose);
  if (file == nullptr) throw RecordingError(path + ": cannot be opened: " + std::strerror(errno));
  std::vector<std::byte> bytes;
  for (std::size_t count = kPortion; count == kPortion;) {
    const std::size_t size = bytes.size();
    bytes.resize(size + kPortion);
    count = std::fread(bytes.data() + size, 1, kPortion, file.get());
    bytes.resize(size + count);
  }
  if (std::ferror(file.get()) != 0) {
    throw RecordingError(path + ": cannot be read: " + std::strerror(errno));
  }
  return is_xz(bytes) ? decompressed(bytes, path) : bytes;
}

}  // namespace winnow::bench
