// Keys of many ends at once: the vector versions of quantizer.h and of the parts of hash.h, equal to them bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>

#include "visibility/cached/key.h"
#include "visibility/cached/quantizer.h"

namespace sightline {

/// GridPoint of many ends.
struct GridPoints {
  AlignedVector<float> x, y, z, log_area;
  AlignedVector<std::uint32_t> bins;
  void resize(std::size_t n) {
    for (AlignedVector<float>* array : {&x, &y, &z, &log_area}) {
      if (array->size() < padded(n)) array->resize(padded(n));
    }
    if (bins.size() < padded(n)) bins.resize(padded(n));
  }
};

/// Kinds of keys: words for the paper's hashes and the search around both ends, parts for the separable hash.
struct KeyFormat {
  bool parts = true;
  CacheSalt salt;  ///< mixed into the parts of light ends
};

/// Quantizer::locate of all ends.
void locate_lanes(const GridConstants& grid, const QueryEnds& ends, GridPoints& points);

/// Keys of eye ends [begin, end) (begin a multiple of kLanes).
void eye_key_lanes(const GridConstants& grid, const GridPoints& points, std::size_t begin, std::size_t end, float offset, bool parts,
                   EndKeys& keys);

/// Keys of all light ends. Returns the semantics present: bit 1 << QuerySemantic.
std::uint32_t light_key_lanes(const GridConstants& grid, const QueryEnds& ends, const std::uint8_t* semantic, float shift,
                              const KeyFormat& format, EndKeys& keys);

/// Keys of both ends of each query of [0, count): Quantizer::connection. `offset_of` holds eye_offset and symmetric_offset of the C_E of
/// each semantic.
struct ConnectionEnds {
  const GridPoints* eye;
  const GridPoints* light;
  const EndKeys* light_words;  ///< words of the light ends that are no surfaces
  const std::uint8_t* semantic;
  const std::uint32_t* eye_of;
  const std::uint32_t* light_of;  ///< kNoQuery where there is no query
  float eye_offset[4];
  float symmetric_offset;
};
void connection_key_lanes(const GridConstants& grid, const ConnectionEnds& ends, std::size_t count, const KeyFormat& format, EndKeys& eye,
                          EndKeys& light);

}  // namespace sightline
