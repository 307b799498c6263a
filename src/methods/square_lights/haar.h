// Area-weighted Haar wavelets on a cube map: the rival that the method is compared with.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "methods/square_lights/light_cube.h"

namespace sightline::square_lights {

/// Orthonormal non-standard 2D Haar transform of one face of size x size values (a power of two), in place; element 0 becomes the scaling
/// coefficient.
void haar_transform(std::span<float> face, int size);
void haar_inverse(std::span<float> face, int size);
/// Support of each coefficient of a face, in texels.
std::vector<float> haar_support(int size);

/// The terms of a light that are kept, by channel: index of the coefficient (face * size² + element) and its value. Texels were multiplied
/// by the root of their solid angle before the transform, so that with a transport vector treated alike the dot product is the integral.
struct WaveletLight {
  struct Term {
    std::uint32_t index;
    float value;
  };
  std::vector<Term> channel[3];
};

/// The `terms` coefficients of greatest |L_k| times support area in each channel [Ng2003], or of greatest |L_k| alone. 0 = all.
WaveletLight wavelet_light(const LightCube& cube, std::size_t terms, bool area_weighted);

/// Transport of one receiver: values by texel (visibility times BRDF times cosine), transformed in place with the roots of solid angles.
void wavelet_transport(std::span<float> transport, int size);

}  // namespace sightline::square_lights
