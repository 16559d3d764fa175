#include "bench/recordings/byte_source.h"
#include "bench/recordings/recording.h"

#include <array>

#if WINNOW_HAVE_LZMA
#include <lzma.h>
#endif

namespace winnow::bench {

#if WINNOW_HAVE_LZMA
namespace {

class XzSource final : public ByteSource {
 public:
  XzSource(std::unique_ptr<ByteSource> compressed, std::string path)
      : compressed_(std::move(compressed)), path_(std::move(path)) {
    if (lzma_stream_decoder(&stream_, UINT64_MAX, LZMA_CONCATENATED) != LZMA_OK) {
      throw RecordingError(path_ + ": no memory to decompress it");
    }
  }
  ~XzSource() override { lzma_end(&stream_); }

  std::size_t read(std::span<std::byte> out) override {
    stream_.next_out = reinterpret_cast<std::uint8_t*>(out.data());
    stream_.avail_out = out.size();
    while (stream_.avail_out != 0 && !ended_) {
      if (stream_.avail_in == 0 && !drained_) refill();
      const lzma_ret result = lzma_code(&stream_, drained_ ? LZMA_FINISH : LZMA_RUN);
      if (result == LZMA_STREAM_END) {
        ended_ = true;
      } else if (result != LZMA_OK) {
        throw RecordingError(path_ + ": the xz data " + what_of(result) + " at compressed byte " +
                             std::to_string(stream_.total_in));
      }
    }
    return out.size() - stream_.avail_out;
  }

  [[nodiscard]] std::optional<std::uint64_t> size() const override { return std::nullopt; }

 private:
  static const char* what_of(lzma_ret result) noexcept {
    if (result == LZMA_BUF_ERROR) return "is cut off";
    return result == LZMA_MEM_ERROR ? "needs more memory than there is" : "is damaged";
  }

  void refill() {
    stream_.next_in = reinterpret_cast<const std::uint8_t*>(input_.data());
    stream_.avail_in = compressed_->read(input_);
    drained_ = stream_.avail_in < input_.size();
  }

  std::unique_ptr<ByteSource> compressed_;
  std::string path_;
  lzma_stream stream_ = LZMA_STREAM_INIT;
  std::array<std::byte, 65536> input_{};
  bool drained_ = false;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<ByteSource> make_xz_source(std::unique_ptr<ByteSource> compressed,
                                           const std::string& path) {
  return std::make_unique<XzSource>(std::move(compressed), path);
}

#else

std::unique_ptr<ByteSource> make_xz_source(std::unique_ptr<ByteSource> /*compressed*/,
                                           const std::string& path) {
  throw RecordingError(path + ": is compressed, and this tool was built without liblzma; " +
                       "decompress it first: xz -dk " + path);
}

#endif

}  // namespace winnow::bench
