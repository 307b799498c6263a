#include "bake/bake_store.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <system_error>

#include "base/core/error.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;

/// On disk where that works, else in memory.
std::shared_ptr<const BakeView> keep_bake(const fs::path& path, const BakeId& id, std::span<const BakeSection> sections,
                                          const Context& context) {
  if (path.empty()) return bake_in_memory(id, sections);
  try {
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) throw resource_error("cannot be made: " + error.message()).at(path.parent_path().string());
    write_bake(path, id, sections);
    return open_bake(path, id);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::bug) throw;
    context.warn(fmt::format("a bake is kept in memory only: {}", error.what()));
    return bake_in_memory(id, sections);
  }
}

std::string open_name(const BakeId& id) { return fmt::format("{}-{}-{}", id.kind, id.version, id.key_text()); }

std::optional<fs::path> absolute_path_in(const char* variable) {
  const char* const value = std::getenv(variable);
  if (value == nullptr || !fs::path(value).is_absolute()) return std::nullopt;
  return fs::path(value);
}

}  // namespace

fs::path BakeStore::path_of(const BakeId& id) const {
  return directory_.empty() ? fs::path() : directory_ / (id.kind + "-" + id.key_text() + ".bake");
}

std::shared_ptr<const BakeView> BakeStore::get(const BakeId& id, const Context& context, const Maker& make) {
  const std::string name = open_name(id);
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = open_.find(name); found != open_.end()) return found->second;
  }

  // Nothing is locked while a bake is read or made: who makes one may need another. Threads that ask for the same one at the same time
  // each make it, and the first is kept.
  const auto start = std::chrono::steady_clock::now();
  Event event{id, Event::What::made, 0, 0, {}};
  std::shared_ptr<const BakeView> bake;
  const fs::path path = path_of(id);
  std::error_code ignored;
  if (!path.empty() && fs::exists(path, ignored)) {
    try {
      bake = open_bake(path, id);
      event.what = Event::What::found;
    } catch (const Error& error) {
      event.what = Event::What::rebuilt;
      event.reason = error.message();
      context.warn(fmt::format("a bake is made anew: {}", error.what()));
    }
  }
  if (!bake) {
    make([&](std::span<const BakeSection> sections) {
      if (bake) throw Error(ErrorCode::bug, "a bake was kept twice").during("making a bake of '" + id.kind + "'");
      bake = keep_bake(path, id, sections, context);
    });
    if (!bake) throw Error(ErrorCode::bug, "nothing was kept").during("making a bake of '" + id.kind + "'");
  }
  event.bytes = bake->bytes();
  event.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const std::lock_guard lock(mutex_);
  events_.push_back(std::move(event));
  return open_.emplace(name, std::move(bake)).first->second;
}

void BakeStore::close(const BakeId& id) {
  std::error_code ignored;
  if (const fs::path path = path_of(id); path.empty() || !fs::exists(path, ignored)) return;
  const std::lock_guard lock(mutex_);
  open_.erase(open_name(id));
}

std::vector<BakeStore::Event> BakeStore::events() const {
  const std::lock_guard lock(mutex_);
  return events_;
}

std::uint64_t BakeStore::open_bytes() const {
  const std::lock_guard lock(mutex_);
  std::uint64_t bytes = 0;
  for (const auto& [name, bake] : open_) bytes += bake->bytes();
  return bytes;
}

fs::path default_bake_directory() {
  if (const auto cache = absolute_path_in("XDG_CACHE_HOME")) return *cache / "sightline" / "bakes";
  if (const auto home = absolute_path_in("HOME")) return *home / ".cache" / "sightline" / "bakes";
  return {};
}

}  // namespace sightline
