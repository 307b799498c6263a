// The parameters of --material, a settings struct a model.
#pragma once

#include <filesystem>
#include <string>

#include "scene/material.h"

namespace sightline::material_choice {

/// R:G:B or one number; each within [0, most]. Throws Error{usage} naming `key`.
Color parse_color(const std::string& key, const std::string& text, float most = 1);

struct Diffuse {
  std::string reflectance = "0.7";
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("reflectance", &Diffuse::reflectance, {.help = "colour, R:G:B or one number"});
  }
  SurfaceModel model(const std::filesystem::path&) const { return DiffuseMaterial{parse_color("reflectance", reflectance)}; }
};

struct MetallicRoughness {
  std::string base_color = "0.8";
  float metallic = 0, roughness = 0.5f;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("base_color", &MetallicRoughness::base_color, {.help = "colour of the paint or the metal"});
    visit("metallic", &MetallicRoughness::metallic, {.help = "0 = paint, 1 = metal", .minimum = 0, .maximum = 1});
    visit("roughness", &MetallicRoughness::roughness, {.help = "root of the GGX slope alpha", .minimum = 0, .maximum = 1});
  }
  SurfaceModel model(const std::filesystem::path&) const {
    return MetallicRoughnessMaterial{parse_color("base_color", base_color), metallic, roughness};
  }
};

struct Conductor {
  std::string eta = "0.2", k = "3.9", tint = "1";
  float alpha_u = 0.1f, alpha_v = 0.1f;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("eta", &Conductor::eta, {.help = "real part of the index of refraction"});
    visit("k", &Conductor::k, {.help = "its imaginary part"});
    visit("tint", &Conductor::tint, {.help = "multiplies the reflectance"});
    visit("alpha_u", &Conductor::alpha_u, {.help = "GGX slope along the tangent, 0 = mirror", .minimum = 0, .maximum = 1});
    visit("alpha_v", &Conductor::alpha_v, {.help = "GGX slope across it", .minimum = 0, .maximum = 1});
  }
  SurfaceModel model(const std::filesystem::path&) const {
    return ConductorMaterial{parse_color("eta", eta, 100), parse_color("k", k, 100), parse_color("tint", tint), alpha_u, alpha_v, false};
  }
};

struct Dielectric {
  float eta = 1.5f, alpha_u = 0, alpha_v = 0;
  bool thin = false;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("eta", &Dielectric::eta, {.help = "index inside over index outside", .minimum = 0.1, .maximum = 10});
    visit("alpha_u", &Dielectric::alpha_u, {.help = "GGX slope along the tangent, 0 = smooth", .minimum = 0, .maximum = 1});
    visit("alpha_v", &Dielectric::alpha_v, {.help = "GGX slope across it", .minimum = 0, .maximum = 1});
    visit("thin", &Dielectric::thin, {.help = "a pane: light goes straight on"});
  }
  SurfaceModel model(const std::filesystem::path&) const { return DielectricMaterial{eta, alpha_u, alpha_v, false, thin}; }
};

struct CoatedDiffuse {
  std::string reflectance = "0.5";
  float eta = 1.5f, alpha_u = 0.1f, alpha_v = 0.1f;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("reflectance", &CoatedDiffuse::reflectance, {.help = "colour below the coat"});
    visit("eta", &CoatedDiffuse::eta, {.help = "index of refraction of the coat", .minimum = 1, .maximum = 10});
    visit("alpha_u", &CoatedDiffuse::alpha_u, {.help = "GGX slope of the coat along the tangent", .minimum = 0, .maximum = 1});
    visit("alpha_v", &CoatedDiffuse::alpha_v, {.help = "GGX slope across it", .minimum = 0, .maximum = 1});
  }
  SurfaceModel model(const std::filesystem::path&) const {
    return CoatedDiffuseMaterial{parse_color("reflectance", reflectance), eta, alpha_u, alpha_v, false};
  }
};

struct Phong {
  std::string diffuse = "0.5", specular = "0.3";
  float exponent = 32;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("diffuse", &Phong::diffuse, {.help = "colour of the Lambert part"});
    visit("specular", &Phong::specular, {.help = "colour of the lobe"});
    visit("exponent", &Phong::exponent, {.help = "of the cosine to the mirror direction", .minimum = 0, .maximum = 1e6, .symbol = "n"});
  }
  SurfaceModel model(const std::filesystem::path&) const {
    return PhongMaterial{parse_color("diffuse", diffuse), parse_color("specular", specular), exponent};
  }
};

struct DiffuseTransmission {
  std::string reflectance = "0.25", transmittance = "0.25";
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("reflectance", &DiffuseTransmission::reflectance, {.help = "colour that is reflected"});
    visit("transmittance", &DiffuseTransmission::transmittance, {.help = "colour that passes through"});
  }
  SurfaceModel model(const std::filesystem::path&) const {
    return DiffuseTransmissionMaterial{parse_color("reflectance", reflectance), parse_color("transmittance", transmittance)};
  }
};

struct Ward {
  std::string diffuse = "0.1", specular = "0.3";
  float alpha_x = 0.2f, alpha_y = 0.2f;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("diffuse", &Ward::diffuse, {.help = "colour of the Lambert part"});
    visit("specular", &Ward::specular, {.help = "colour of the lobe"});
    visit("alpha_x", &Ward::alpha_x, {.help = "slope along the tangent", .minimum = 0.001, .maximum = 2});
    visit("alpha_y", &Ward::alpha_y,
          {.help = "slope across it; another one than alpha_x brushes the surface", .minimum = 0.001, .maximum = 2});
  }
  SurfaceModel model(const std::filesystem::path&) const {
    return WardMaterial{parse_color("diffuse", diffuse), parse_color("specular", specular), alpha_x, alpha_y};
  }
};

struct CookTorrance {
  std::string diffuse = "0.2", specular = "0.8", f0 = "0.04";
  float roughness = 0.3f;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("diffuse", &CookTorrance::diffuse, {.help = "colour of the Lambert part"});
    visit("specular", &CookTorrance::specular, {.help = "share of the facets, multiplies Fresnel's reflectance"});
    visit("roughness", &CookTorrance::roughness, {.help = "rms slope of the facets", .minimum = 0.001, .maximum = 2, .symbol = "m"});
    visit("f0", &CookTorrance::f0, {.help = "a facet's reflectance at normal incidence"});
  }
  SurfaceModel model(const std::filesystem::path&) const {
    return CookTorranceMaterial{parse_color("diffuse", diffuse), parse_color("specular", specular), roughness, parse_color("f0", f0)};
  }
};

struct Measured {
  std::string file;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("file", &Measured::file, {.help = "measurements in Cornell's text form (.brdf); else looked up in --data"});
  }
  SurfaceModel model(const std::filesystem::path& data_directory) const;
};

struct Interface {
  template <class Visitor>
  static void describe(Visitor&&) {}
  SurfaceModel model(const std::filesystem::path&) const { return InterfaceMaterial{}; }
};

}  // namespace sightline::material_choice
