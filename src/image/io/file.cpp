// Whole files in and out, in a way that a crash or a full disk cannot leave half a picture behind.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "base/core/error.h"
#include "image/io/image_io.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;

class FileDescriptor {
 public:
  explicit FileDescriptor(int descriptor) : descriptor_(descriptor) {}
  ~FileDescriptor() { close(); }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int get() const { return descriptor_; }
  bool is_open() const { return descriptor_ >= 0; }
  /// 0, or -1 with errno: some file systems report a full disk only here.
  int close() {
    const int result = descriptor_ >= 0 ? ::close(descriptor_) : 0;
    descriptor_ = -1;
    return result;
  }

 private:
  int descriptor_;
};

std::string reason(int error_number) { return std::generic_category().message(error_number); }

Error write_failure(const fs::path& path, int error_number) {
  return resource_error("cannot be written: " + reason(error_number)).at(path.string());
}

/// 0, or errno of the first failure.
int write_all(int descriptor, std::span<const std::byte> bytes) {
  // Some systems refuse or cut calls of 2 GiB and more.
  constexpr std::size_t largest_piece = std::size_t{1} << 30;
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), std::min(bytes.size(), largest_piece));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

/// What stands at the end of a chain of links: a rename must replace the file, not the link to it.
fs::path resolved(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_symlink(path, ignored)) return path;
  const fs::path target = fs::weakly_canonical(path, ignored);
  return ignored || target.empty() ? path : target;
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

/// A device or pipe takes the bytes themselves: there is nothing to rename.
bool is_device(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

void write_to_device(const fs::path& path, std::span<const std::byte> bytes) {
  FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.is_open()) throw write_failure(path, errno);
  if (const int error_number = write_all(file.get(), bytes)) throw write_failure(path, error_number);
  if (file.close() != 0) throw write_failure(path, errno);
}

/// A new file beside `path` under a name that no other thread or process uses.
FileDescriptor create_beside(const fs::path& path, fs::path& temporary) {
  static std::atomic<unsigned> serial{0};
  for (int attempt = 0; attempt < 100; ++attempt) {
    temporary = folder_of(path) / ("." + path.filename().string() + "." + std::to_string(::getpid()) + "-" +
                                   std::to_string(serial.fetch_add(1, std::memory_order_relaxed)) + ".part");
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) return FileDescriptor(descriptor);
    if (errno != EEXIST) throw write_failure(path, errno);
  }
  throw write_failure(path, EEXIST);
}

/// Makes the rename itself durable. Not every file system can, and the data are safe already, so failures are ignored.
void sync_folder(const fs::path& folder) {
  const FileDescriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.is_open()) ::fsync(directory.get());
}

}  // namespace

void write_file(const fs::path& path, std::span<const std::byte> bytes) {
  if (path == "-") {
    if (const int error_number = write_all(STDOUT_FILENO, bytes)) throw write_failure("standard output", error_number);
    return;
  }
  check_writable(path);
  const fs::path target = resolved(path);
  if (is_device(target)) {
    write_to_device(target, bytes);
    return;
  }

  fs::path temporary;
  FileDescriptor file = create_beside(target, temporary);
  int error_number = write_all(file.get(), bytes);
  if (error_number == 0 && ::fsync(file.get()) != 0) error_number = errno;
  if (file.close() != 0 && error_number == 0) error_number = errno;
  if (error_number == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error_number = errno;
  if (error_number != 0) {
    ::unlink(temporary.c_str());
    throw write_failure(path, error_number);
  }
  sync_folder(folder_of(target));
}

void check_writable(const fs::path& path) {
  if (path == "-") return;
  if (path.empty() || !path.has_filename()) throw usage_error("an output needs a file name").at(path.string());
  std::error_code error;
  const fs::path target = resolved(path);
  const fs::file_status status = fs::status(target, error);
  if (fs::is_directory(status)) throw usage_error("cannot be written: it is a folder").at(path.string());
  if (fs::exists(status)) {
    if (::access(target.c_str(), W_OK) != 0) throw write_failure(path, errno);
    if (!fs::is_regular_file(status)) return;
  }
  const fs::path folder = folder_of(target);
  if (!fs::is_directory(folder, error))
    throw usage_error("cannot be written: the folder '" + folder.string() + "' does not exist")
        .at(path.string())
        .remedy("create the folder first");
  if (::access(folder.c_str(), W_OK | X_OK) != 0) throw write_failure(path, errno);
}

std::vector<std::byte> read_file(const fs::path& path, std::uint64_t limit_bytes) {
  const auto failure = [&path](const std::string& text) { return input_error("cannot be read: " + text).at(path.string()); };
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) throw failure(reason(errno));
  struct stat status{};
  if (::fstat(file.get(), &status) != 0) throw failure(reason(errno));
  if (S_ISDIR(status.st_mode)) throw failure("it is a folder");
  const auto too_large = [&] { return failure("it is larger than " + std::to_string(limit_bytes) + " bytes"); };
  const std::uint64_t expected = S_ISREG(status.st_mode) ? static_cast<std::uint64_t>(status.st_size) : 0;
  if (expected > limit_bytes) throw too_large();

  // The size is only a hint: pipes have none, and a file may grow while it is read. One byte beyond it shows the end without another round.
  constexpr std::size_t piece = std::size_t{1} << 16;
  std::vector<std::byte> bytes(expected > 0 ? static_cast<std::size_t>(expected) + 1 : piece);
  std::size_t filled = 0;
  for (;;) {
    if (filled == bytes.size()) bytes.resize(bytes.size() * 2);
    const ssize_t got = ::read(file.get(), bytes.data() + filled, std::min(bytes.size() - filled, std::size_t{1} << 30));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw failure(reason(errno));
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
    if (filled > limit_bytes) throw too_large();
  }
  bytes.resize(filled);
  return bytes;
}

}  // namespace sightline
