// Bakes: any bytes end in an opened bake or in an Error. Mutations hardly ever keep checksums, so they are mended first, or nothing behind
// them would be reached. The bytes go through a file in memory, as readers map what they read.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "bake/bake_description.h"
#include "bake/bake_format.h"
#include "base/core/error.h"

namespace {

using namespace sightline;

/// Checksums as the contents want them, where there is room for them.
void mend(std::vector<std::byte>& file) {
  bake_format::BakePrefix prefix;
  if (file.size() < sizeof prefix) return;
  std::memcpy(&prefix, file.data(), sizeof prefix);
  const std::size_t table_end = sizeof prefix + std::size_t{prefix.section_count} * sizeof(bake_format::BakeEntry);
  if (prefix.section_count > bake_format::kMostSections || table_end > file.size()) return;
  for (std::size_t at = sizeof prefix; at < table_end; at += sizeof(bake_format::BakeEntry)) {
    bake_format::BakeEntry entry;
    std::memcpy(&entry, file.data() + at, sizeof entry);
    if (entry.offset > file.size() || entry.bytes > file.size() - entry.offset) continue;
    entry.checksum = bake_format::checksum_of(std::span<const std::byte>(file).subspan(entry.offset, entry.bytes));
    std::memcpy(file.data() + at, &entry, sizeof entry);
  }
  const std::span<const std::byte> header(file.data(), table_end);
  const std::uint64_t checksum = bake_format::checksum_of(header.subspan(bake_format::kChecksummedFrom));
  std::memcpy(file.data() + offsetof(bake_format::BakePrefix, checksum), &checksum, sizeof checksum);
}

void read_all(const std::string& path) {
  try {
    const auto view = open_bake(path);
    unsigned sum = 0;
    for (const std::string& name : view->section_names()) {
      const std::span<const std::byte> bytes = view->section(name);
      // To the end of what may be read.
      for (std::size_t i = 0; i < bytes.size() + bake_format::kSlack; ++i) sum += static_cast<unsigned>(*(bytes.data() + i));
      if (reinterpret_cast<std::uintptr_t>(bytes.data()) % bake_format::kAlignment != 0) __builtin_trap();
    }
    static_cast<void>(*const_cast<volatile unsigned*>(&sum));
    if (!describe_bake(path).damage.empty()) __builtin_trap();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input || error.place().empty()) __builtin_trap();
    if (describe_bake(path).damage.empty()) __builtin_trap();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> file(size);
  if (size > 0) std::memcpy(file.data(), data, size);
  const int descriptor = ::memfd_create("bake", MFD_CLOEXEC);
  if (descriptor < 0) return 0;
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  const auto put = [&] { return ::pwrite(descriptor, file.data(), file.size(), 0) == static_cast<ssize_t>(file.size()); };
  if (put()) read_all(path);
  mend(file);
  if (put()) read_all(path);
  ::close(descriptor);
  return 0;
}
