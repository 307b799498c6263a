// The layers a frame may hold, declared in one table.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sightline {

/// Arbitrary output variables. kColor is always there.
enum class Aov : std::uint8_t { color, albedo, normal, position, depth, surface, direct, indirect, variance, alpha };
inline constexpr std::size_t kAovCount = 10;
/// Layers that a Frame's light image has.
inline constexpr std::array<Aov, 3> kLightImageLayers{Aov::color, Aov::direct, Aov::indirect};

struct AovInfo {
  Aov id;
  std::string_view name;
  std::string_view help;
  std::vector<std::string_view> channels;  ///< letters of the channels; channel_name() has the whole names
  bool half;                               ///< half floats suffice in files
};

/// A channel's name in files: "albedo.G"; those of colour and alpha have no prefix, as every reader expects R, G, B and A.
std::string channel_name(const AovInfo& info, std::string_view channel);

/// All layers in the order of the enum.
std::span<const AovInfo> aov_table();
const AovInfo& aov_info(Aov aov);

/// A set of layers.
class AovSet {
 public:
  AovSet() { add(Aov::color); }
  void add(Aov aov) { bits_ |= 1u << static_cast<unsigned>(aov); }
  bool has(Aov aov) const { return (bits_ >> static_cast<unsigned>(aov)) & 1u; }
  std::uint32_t bits() const { return bits_; }
  static AovSet from_bits(std::uint32_t bits) {
    AovSet set;
    set.bits_ |= bits;
    return set;
  }

 private:
  std::uint32_t bits_ = 0;
};

/// "albedo,normal" or "all"; "samples" is accepted (it is always written). Throws Error{usage} with the nearest name.
AovSet parse_aovs(std::string_view list);

}  // namespace sightline
