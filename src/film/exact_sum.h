// Sums of floats that do not depend on the order of the summands.
#pragma once

#include <bit>
#include <cstdint>

namespace sightline {

__extension__ typedef __int128 Int128;

/// 128-bit fixed point with unit 2⁻⁶⁴: every float in [2⁻⁴⁰, 2⁴⁰) is added without any rounding of its leading 24 bits, so passes, threads,
/// sample ranges and processes may add in any order and reach the same bits. Smaller parts are cut off, larger values saturate.
struct ExactSum {
  Int128 value = 0;

  /// Adds v; false (and v is clamped to ±2⁴⁰) if it saturates. v must be finite.
  bool add(float v) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(v);
    const int exponent = static_cast<int>((bits >> 23) & 0xff);
    if (exponent < 150 - 64 - 23) return true;  // below 2⁻⁶⁴
    const bool in_range = exponent < 127 + 40;
    const Int128 mantissa = in_range ? Int128((bits & 0x7fffffu) | 0x800000u) : Int128(0x800000u);
    const int shift = (in_range ? exponent : 127 + 40) - 150 + 64;
    const Int128 magnitude = shift >= 0 ? mantissa << shift : mantissa >> -shift;
    value += (bits >> 31) != 0 ? -magnitude : magnitude;
    return in_range;
  }
  double to_double() const { return static_cast<double>(value) * 0x1p-64; }
  friend bool operator==(const ExactSum&, const ExactSum&) = default;
};

}  // namespace sightline
