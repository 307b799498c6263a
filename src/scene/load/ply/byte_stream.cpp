#include "scene/load/ply/byte_stream.h"

#include <algorithm>
#include <cstring>

namespace sightline {
namespace {

/// Large enough that a read call costs nothing beside parsing, small enough to stay in the L2 cache.
constexpr std::size_t kBlockBytes = std::size_t{1} << 18;

}  // namespace

ByteStream::ByteStream(const std::filesystem::path& path) : name_(path.string()) {
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  if (failure || !std::filesystem::exists(status)) throw input_error("the file does not exist").at(name_);
  if (!std::filesystem::is_regular_file(status)) throw input_error("not a regular file").at(name_);
  size_ = std::filesystem::file_size(path, failure);
  if (failure) throw input_error("its size cannot be read: " + failure.message()).at(name_);
  file_.rdbuf()->pubsetbuf(nullptr, 0);
  file_.open(path, std::ios::binary);
  if (!file_) throw input_error("the file cannot be opened").at(name_).remedy("check its permissions");
}

ByteStream::ByteStream(std::span<const std::byte> memory, std::string name)
    : name_(std::move(name)),
      size_(memory.size()),
      begin_(reinterpret_cast<const char*>(memory.data())),
      cursor_(begin_),
      end_(begin_ + memory.size()) {}

bool ByteStream::refill(std::size_t count) {
  if (!file_.is_open()) return false;
  const std::size_t kept = available();
  const std::uint64_t position = offset();
  const std::uint64_t unread = size_ - position - kept;
  const std::size_t wanted = static_cast<std::size_t>(std::min<std::uint64_t>(std::max(count, kBlockBytes), kept + unread));
  // What has not been consumed moves to the front, then the rest of the buffer is filled.
  if (wanted > capacity_ || !buffer_) {
    const std::size_t grown_capacity = std::max(wanted, kBlockBytes);
    auto grown = std::make_unique_for_overwrite<char[]>(grown_capacity);
    if (kept) std::memcpy(grown.get(), cursor_, kept);
    buffer_ = std::move(grown);
    capacity_ = grown_capacity;
  } else if (kept) {
    std::memmove(buffer_.get(), cursor_, kept);
  }
  const std::size_t missing = wanted - kept;
  file_.read(buffer_.get() + kept, static_cast<std::streamsize>(missing));
  const auto got = static_cast<std::size_t>(file_.gcount());
  if (got < missing) {
    // Truncated by someone else while we read: from here on the file ends here.
    size_ = position + kept + got;
    file_.clear();
  }
  begin_ = cursor_ = buffer_.get();
  end_ = begin_ + kept + got;
  window_offset_ = position;
  return available() >= count;
}

void ByteStream::seek(std::uint64_t offset) {
  offset = std::min(offset, size_);
  const auto window_size = static_cast<std::uint64_t>(end_ - begin_);
  if (offset >= window_offset_ && offset - window_offset_ <= window_size) {
    cursor_ = begin_ + (offset - window_offset_);
    if (cursor_ != end_ || !file_.is_open()) return;
  }
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(offset));
  begin_ = cursor_ = end_ = buffer_.get();
  window_offset_ = offset;
}

std::uint64_t ByteStream::line_at(std::uint64_t target) {
  const std::uint64_t saved = offset();
  std::uint64_t line = 1;
  for (seek(0); offset() < target && ensure(1);) {
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(available(), target - offset()));
    line += static_cast<std::uint64_t>(std::count(cursor_, cursor_ + step, '\n'));
    cursor_ += step;
  }
  seek(saved);
  return line;
}

}  // namespace sightline
