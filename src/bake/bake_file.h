// What a method precomputed, as one file: versioned, checksummed, read through a memory map.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sightline {

/// What a bake is of: equal ids mean equal contents.
struct BakeId {
  std::string kind;           ///< "square-lights.self-visibility": who made it; at most 63 characters of [a-z0-9.-]
  std::uint32_t version = 1;  ///< of the kind's own layout
  std::array<std::uint64_t, 2> key{};
  friend bool operator==(const BakeId&, const BakeId&) = default;
  std::string key_text() const;  ///< 32 hexadecimal digits
};

/// Gathers whatever a bake depends on into a key (XXH3, 128 bits). The order counts; sizes of arrays are hashed with them.
class BakeHash {
 public:
  BakeHash();
  ~BakeHash();
  BakeHash(const BakeHash&) = delete;
  BakeHash& operator=(const BakeHash&) = delete;
  template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  BakeHash& add(T value) {
    return add_bytes(std::as_bytes(std::span(&value, 1)));
  }
  template <class T>
    requires std::is_trivially_copyable_v<T>
  BakeHash& add(std::span<const T> values) {
    add(values.size());
    return add_bytes(std::as_bytes(values));
  }
  BakeHash& add(std::string_view text) { return add(std::span<const char>(text.data(), text.size())); }
  std::array<std::uint64_t, 2> key() const;

 private:
  BakeHash& add_bytes(std::span<const std::byte> bytes);
  struct State;
  std::unique_ptr<State> state_;
};

/// A named array of a bake.
struct BakeSection {
  std::string name;  ///< at most 31 characters
  std::span<const std::byte> bytes;
};
template <class T>
BakeSection bake_section(std::string name, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {std::move(name), std::as_bytes(values)};
}

/// A bake that was opened: immutable, safe to share between threads. Sections start at multiples of 64 bytes and 64 readable bytes follow
/// each of them.
class BakeView {
 public:
  virtual ~BakeView() = default;
  virtual const BakeId& id() const = 0;
  virtual std::vector<std::string> section_names() const = 0;
  /// Empty where there is none of that name.
  virtual std::span<const std::byte> section(std::string_view name) const = 0;
  virtual std::uint64_t bytes() const = 0;
  /// A section as numbers; throws Error{input} if it is missing or its size no multiple of T's.
  template <class T>
  std::span<const T> array(std::string_view name) const {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 64);
    return {static_cast<const T*>(checked(name, sizeof(T))), section(name).size() / sizeof(T)};
  }

 private:
  const void* checked(std::string_view name, std::size_t element) const;
};

/// Writes beside, syncs and renames: the file appears whole or not at all. Throws Error{resource} where it cannot.
void write_bake(const std::filesystem::path& path, const BakeId& id, std::span<const BakeSection> sections);
/// Maps a file and checks header and checksums; throws Error{input} that says what is wrong: not a bake, cut short, damaged, another
/// version of the format. With `expected`, also one that is of something else.
std::shared_ptr<const BakeView> open_bake(const std::filesystem::path& path, const std::optional<BakeId>& expected = {});
/// The same over memory of its own: for those who keep nothing on disk.
std::shared_ptr<const BakeView> bake_in_memory(const BakeId& id, std::span<const BakeSection> sections);

}  // namespace sightline
