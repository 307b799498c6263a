// Reads measured reflectance from files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scene/material.h"
#include "shade/scattered_reflectance.h"

namespace sightline {

/// Measurements of an isotropic surface as the Cornell program of computer graphics publishes them: text with '#' comments; the number of
/// wavelengths, the wavelengths in nm, then one line a measurement: theta_i, phi_i, theta_o, phi_o in radians and one value of f a
/// wavelength. Colours are those under D65, so that a flat spectrum of 0.5 is (0.5, 0.5, 0.5); what lies outside the gamut is cut.
/// Throws Error{input} with name and line.
std::vector<ReflectanceSample> parse_cornell_brdf(std::string_view text, const std::string& name);

/// A material of such a file (.brdf). Throws Error{input}.
MeasuredMaterial load_measured_material(const std::filesystem::path& path);

}  // namespace sightline
