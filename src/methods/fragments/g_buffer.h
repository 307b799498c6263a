// What the camera sees at every pixel, as a structure of arrays over the whole picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/core/aligned.h"
#include "base/math/frame.h"
#include "base/math/vec.h"
#include "shade/analytic/analytic_bsdf.h"
#include "shade/bsdf.h"

namespace sightline {

/// The picture is worked off in root tiles of 128 x 128 pixels: fragments of the coarsest level, whose buffers stay in the L2 cache.
inline constexpr int kRootSize = 128;
inline constexpr int kRootLevel = 7;

/// Pixels [x0, x1) x [y0, y1); x0 and y0 are multiples of kRootSize, x1 and y1 are cut off at the picture's edge.
struct RootTile {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// What lies under a pixel, as far as this method has to know.
enum class PixelKind : std::uint8_t {
  background,  ///< nothing was hit
  emitter,     ///< a surface that emits: shows its radiance alone
  dark,        ///< a surface that reflects no direct light: mirrors, glass
  diffuse,     ///< Lambert: albedo says all
  analytic,    ///< Lambert plus a lobe that linearly transformed cosines describe
  general,     ///< any other material: always sampled, never interpolated
};

/// A shading point with more to it than Lambert's law.
struct GlossyPoint {
  Bsdf bsdf;
  AnalyticBsdf form;
  Frame3 frame;
  Vec3 wo{0};  ///< unit, towards the camera
};

/// Row-major with `stride` elements a row; stride and rows are multiples of kRootSize, and what lies outside the picture is background.
/// Normals are on the viewer's side.
struct GBuffer {
  int width = 0, height = 0, stride = 0, rows = 0;
  Vec3Batch position, geometric_normal, shading_normal;
  AlignedVector<float> error;  ///< bound on the error of `position`, per component
  AlignedVector<float> depth;  ///< distance from the camera; +infinity for background
  Vec3Batch albedo;            ///< of the whole BSDF
  AlignedVector<PixelKind> kind;
  AlignedVector<std::uint8_t> back;  ///< 1: seen from behind, normals were turned
  /// 1: next to nothing changes from the pixel to its right and lower neighbours. May be empty: not known.
  AlignedVector<std::uint8_t> flat;
  AlignedVector<std::uint32_t> glossy_index;     ///< of `analytic` pixels: into their root tile's list
  std::vector<std::vector<GlossyPoint>> glossy;  ///< by root tile

  void set_size(int picture_width, int picture_height) {
    width = picture_width, height = picture_height;
    stride = (width + kRootSize - 1) / kRootSize * kRootSize, rows = (height + kRootSize - 1) / kRootSize * kRootSize;
    glossy.resize(root_count());
  }
  std::size_t element_count() const { return static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows); }
  /// What arrays are sized for: vectors of neighbours read a group of lanes past the end.
  std::size_t padded_count() const { return element_count() + kLanes; }
  void resize(int picture_width, int picture_height) {
    set_size(picture_width, picture_height);
    for (AlignedVector<float>* array : arrays()) array->resize(padded_count());
    kind.resize(padded_count()), back.resize(padded_count()), glossy_index.resize(padded_count());
  }
  std::vector<AlignedVector<float>*> arrays() {
    std::vector<AlignedVector<float>*> all = {&error, &depth};
    for (Vec3Batch* batch : {&position, &geometric_normal, &shading_normal, &albedo})
      all.insert(all.end(), {&batch->x, &batch->y, &batch->z});
    return all;
  }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride) + static_cast<std::size_t>(x);
  }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  std::size_t root_count() const { return static_cast<std::size_t>(stride / kRootSize) * static_cast<std::size_t>(rows / kRootSize); }
  std::size_t root_of(int x, int y) const {
    return static_cast<std::size_t>(y / kRootSize) * static_cast<std::size_t>(stride / kRootSize) + static_cast<std::size_t>(x / kRootSize);
  }
  const GlossyPoint& glossy_at(int x, int y) const { return glossy[root_of(x, y)][glossy_index[at(x, y)]]; }
  RootTile root(std::size_t index) const {
    const int columns = stride / kRootSize, i = static_cast<int>(index);
    const int x0 = i % columns * kRootSize, y0 = i / columns * kRootSize;
    return {x0, y0, x0 + kRootSize < width ? x0 + kRootSize : width, y0 + kRootSize < height ? y0 + kRootSize : height};
  }
};

}  // namespace sightline
