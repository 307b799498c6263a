// Indices into a Scene's arrays, one type each, so that one cannot be passed for another.
#pragma once

#include <compare>
#include <cstdint>

namespace sightline {

template <class Tag>
struct Id {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t index = kNone;

  constexpr Id() = default;
  constexpr explicit Id(std::size_t i) : index(static_cast<std::uint32_t>(i)) {}
  constexpr bool valid() const { return index != kNone; }
  friend constexpr auto operator<=>(const Id&, const Id&) = default;
};

using ImageId = Id<struct ImageTag>;
using TextureId = Id<struct TextureTag>;
using MaterialId = Id<struct MaterialTag>;
using MeshId = Id<struct MeshTag>;
using InstanceId = Id<struct InstanceTag>;
using NodeId = Id<struct NodeTag>;
using MediumId = Id<struct MediumTag>;
using SkinId = Id<struct SkinTag>;

}  // namespace sightline
