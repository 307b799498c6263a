// Spectra of scene files and their colours in the working space (linear Rec.709, D65).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/math/vec.h"

namespace sightline::pbrt {

/// Piecewise linear over wavelengths in nm (increasing), constant beyond both ends.
struct Spectrum {
  std::vector<std::pair<float, float>> samples;

  float at(float wavelength_nm) const;
};

/// Pairs (wavelength, value) of a list; nothing if the count is odd, a number is not finite or the wavelengths do not increase.
std::optional<Spectrum> spectrum_from_pairs(std::span<const float> pairs);
/// The same from the text of an .spd file: pairs, one a line, '#' comments.
std::optional<Spectrum> spectrum_from_text(std::string_view text);
/// Planck's law, up to a factor.
Spectrum blackbody_spectrum(float temperature_k);
/// "metal-Cu-eta", "glass-BK7", "stdillum-D65", ...
std::optional<Spectrum> named_spectrum(std::string_view name);
/// The standard illuminant D65, 380 to 780 nm.
std::vector<std::pair<float, float>> daylight_d65_samples();
/// All names that named_spectrum knows.
std::vector<std::string> spectrum_names();

/// Colour of a surface (or of a coefficient) with that spectrum under D65; a constant gives itself. May leave the gamut.
Color reflectance_color(const Spectrum& spectrum);
/// Colour of a light of that spectrum, scaled to luminance 1.
Color emission_color(const Spectrum& spectrum);
/// Mean over the visible range, weighted by the eye's sensitivity to D65.
float mean_value(const Spectrum& spectrum);

/// Complex index of refraction a channel, such that the reflectance at normal incidence is the colour of the spectral reflectance
/// under D65.
struct ConductorColors {
  Color eta, k;
};
ConductorColors conductor_colors(const Spectrum& eta, const Spectrum& k);

enum class ColorSpace { srgb, dci_p3, rec2020, aces2065_1 };
std::optional<ColorSpace> parse_color_space(std::string_view name);
/// Linear colour of that space in the working space; white goes to white.
Color to_working_space(ColorSpace space, const Color& color);

}  // namespace sightline::pbrt
