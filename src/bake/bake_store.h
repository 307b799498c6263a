// Where bakes are kept between runs and frames.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "bake/bake_file.h"
#include "bake/recent_values.h"
#include "base/core/context.h"

namespace sightline {

/// A folder of bakes, one file each, named by kind and key, and those of them that are open. Thread-safe; bakes made at the same time by
/// two processes are made twice and the later file wins, since both are alike.
class BakeStore {
 public:
  /// What became of a request, for statistics and tests.
  struct Event {
    BakeId id;
    enum class What { found, made, rebuilt } what;
    std::uint64_t bytes;
    double seconds;
    std::string reason;  ///< why a file was rejected
  };

  /// An empty path keeps bakes in memory alone. The folder is made when something is first written.
  explicit BakeStore(std::filesystem::path directory = {}) : directory_(std::move(directory)) {}
  const std::filesystem::path& directory() const { return directory_; }
  std::filesystem::path path_of(const BakeId& id) const;

  /// Makes the sections' bytes and hands them to `keep`, which copies or writes them; they need not outlive the call.
  using Maker = std::function<void(const std::function<void(std::span<const BakeSection>)>& keep)>;
  /// The bake of `id`: open already, read from the folder, or made. A file that is stale, cut short, damaged or foreign is named in a
  /// warning with the reason, and replaced. Where the folder cannot be written the bake stays in memory, with a warning.
  std::shared_ptr<const BakeView> get(const BakeId& id, const Context& context, const Maker& make);

  /// Closes a bake that has a file, once nothing else holds it: what something smaller was made from need not stay in memory.
  void close(const BakeId& id);
  /// What is not worth a file, kept over frames.
  RecentValues& recent() { return recent_; }

  std::vector<Event> events() const;
  /// Bytes of all bakes that are open.
  std::uint64_t open_bytes() const;

 private:
  std::filesystem::path directory_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const BakeView>> open_;
  std::vector<Event> events_;
  RecentValues recent_;
};

/// $XDG_CACHE_HOME/sightline/bakes, or ~/.cache/sightline/bakes; empty where neither is known.
std::filesystem::path default_bake_directory();

}  // namespace sightline
