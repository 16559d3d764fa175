#include "bench/recordings/byte_source.h"

#include "bench/recordings/recording.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace winnow::bench {
namespace {

class FileSource final : public ByteSource {
 public:
  explicit FileSource(const std::string& path) : path_(path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) {
      throw RecordingError(path + ": is a folder, not a recording");
    }
    file_.reset(std::fopen(path.c_str(), "rb"));
    if (!file_) throw RecordingError(path + ": cannot be opened: " + std::strerror(errno));
    // A pipe has no size; `size_` then stays empty and reading finds the end.
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (!error) size_ = bytes;
    start_size_ = std::fread(start_.data(), 1, start_.size(), file_.get());
  }

  std::size_t read(std::span<std::byte> out) override {
    const std::size_t ready = std::min(out.size(), start_size_ - start_used_);
    std::memcpy(out.data(), start_.data() + start_used_, ready);
    start_used_ += ready;
    const std::size_t count =
        ready + std::fread(out.data() + ready, 1, out.size() - ready, file_.get());
    if (count < out.size() && std::ferror(file_.get()) != 0) {
      throw RecordingError(path_ + ": cannot be read: " + std::strerror(errno));
    }
    return count;
  }

  [[nodiscard]] std::optional<std::uint64_t> size() const override { return size_; }

  [[nodiscard]] bool looks_like_xz() const {
    return start_size_ == kMagic.size() && start_ == kMagic;
  }

 private:
  static constexpr std::array<unsigned char, 6> kMagic{0xFD, '7', 'z', 'X', 'Z', 0x00};

  struct Closer {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::optional<std::uint64_t> size_;
  // The first bytes are read ahead to detect the file type, since a pipe cannot be rewound.
  std::array<unsigned char, kMagic.size()> start_{};
  std::size_t start_size_ = 0;
  std::size_t start_used_ = 0;
};

}  // namespace

std::unique_ptr<ByteSource> open_bytes(const std::string& path) {
  auto file = std::make_unique<FileSource>(path);
  if (!file->looks_like_xz()) return file;
  return make_xz_source(std::move(file), path);
}

}  // namespace winnow::bench
