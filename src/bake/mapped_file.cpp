#include "bake/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "base/core/error.h"

namespace sightline {

MappedFile::MappedFile(const std::filesystem::path& path) {
  const auto reason = [] { return std::generic_category().message(errno); };
  // Opening a pipe would wait for its other end.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) throw input_error("cannot be read: " + reason());
  struct stat status{};
  std::string why;
  if (::fstat(descriptor, &status) != 0) {
    why = reason();
  } else if (!S_ISREG(status.st_mode)) {
    why = "it is not a file";
  } else if (status.st_size > 0) {
    size_ = static_cast<std::size_t>(status.st_size);
    data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (data_ == MAP_FAILED) why = reason();
  }
  ::close(descriptor);
  if (!why.empty()) throw input_error("cannot be read: " + why);
}

MappedFile::~MappedFile() {
  if (size_ > 0) ::munmap(data_, size_);
}

}  // namespace sightline
