// Bakes out to files, in a way that a crash or a full disk leaves either the old file or the new one.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <string>
#include <system_error>

#include "bake/bake_format.h"
#include "base/core/error.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;

/// A file under a name of its own beside the one it is to become; gone again unless it was put in place.
class PartFile {
 public:
  explicit PartFile(const fs::path& target) : target_(target) {
    static std::atomic<unsigned> serial{0};
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    do {
      part_ = folder / ("." + target.filename().string() + "." + std::to_string(::getpid()) + "-" +
                        std::to_string(serial.fetch_add(1, std::memory_order_relaxed)) + ".part");
      descriptor_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) throw failure(errno);
  }
  ~PartFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!in_place_) ::unlink(part_.c_str());
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  void write(std::span<const std::byte> bytes) {
    // Some systems refuse or cut calls of 2 GiB and more.
    constexpr std::size_t largest_piece = std::size_t{1} << 30;
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), std::min(bytes.size(), largest_piece));
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) throw failure(errno);
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }
  void put_in_place() {
    if (::fsync(descriptor_) != 0) throw failure(errno);
    // Some file systems report a full disk only here.
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) throw failure(errno);
    if (::rename(part_.c_str(), target_.c_str()) != 0) throw failure(errno);
    in_place_ = true;
    // Makes the rename itself durable. Not every file system can, and the data are safe already, so failures are ignored.
    const int folder = ::open(target_.has_parent_path() ? target_.parent_path().c_str() : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) ::fsync(folder), ::close(folder);
  }

 private:
  Error failure(int error_number) const {
    return resource_error("cannot be written: " + std::generic_category().message(error_number)).at(target_.string());
  }

  fs::path target_, part_;
  int descriptor_ = -1;
  bool in_place_ = false;
};

}  // namespace

void write_bake(const fs::path& path, const BakeId& id, std::span<const BakeSection> sections) {
  const std::vector<std::byte> header = bake_format::encode_header(id, sections);
  PartFile file(path);
  file.write(header);
  constexpr std::array<std::byte, bake_format::kAlignment + bake_format::kSlack> zeros{};
  std::uint64_t at = header.size();
  for (const BakeSection& section : sections) {
    file.write(section.bytes);
    const std::uint64_t padding = bake_format::padding_after(at + section.bytes.size());
    file.write(std::span(zeros).first(static_cast<std::size_t>(padding)));
    at += section.bytes.size() + padding;
  }
  file.put_in_place();
}

}  // namespace sightline
