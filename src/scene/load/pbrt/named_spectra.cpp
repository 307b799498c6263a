// Measured optical constants of the metals and glasses that pbrt names.
#include <array>

#include "scene/load/pbrt/spectrum.h"

namespace sightline::pbrt {
namespace {

// Silver, aluminium, gold and copper after [Palik1998], at photon energies from 3.35 eV (370 nm) down to 1.55 eV (800 nm) in steps of
// 0.05 eV.
constexpr std::size_t kMetalSamples = 37;
constexpr float kFirstEnergyEv = 3.35f, kEnergyStepEv = 0.05f;
constexpr float kNmTimesEv = 1239.842f;

constexpr std::array<float, kMetalSamples> kAgEta = {0.1921f, 0.2f,   0.1981f, 0.192f, 0.182f,  0.173f, 0.1726f, 0.173f, 0.1667f, 0.16f,
                                                     0.1585f, 0.157f, 0.1511f, 0.144f, 0.1373f, 0.132f, 0.1303f, 0.13f,  0.1299f, 0.13f,
                                                     0.1301f, 0.129f, 0.1244f, 0.12f,  0.1193f, 0.121f, 0.1255f, 0.131f, 0.1361f, 0.14f,
                                                     0.1401f, 0.14f,  0.1443f, 0.148f, 0.1459f, 0.143f, 0.1426f};
constexpr std::array<float, kMetalSamples> kAgK = {1.642f, 1.67f, 1.735f, 1.81f, 1.879f, 1.95f, 2.029f, 2.11f, 2.186f, 2.26f,
                                                   2.329f, 2.4f,  2.479f, 2.56f, 2.64f,  2.72f, 2.798f, 2.88f, 2.974f, 3.07f,
                                                   3.159f, 3.25f, 3.348f, 3.45f, 3.554f, 3.66f, 3.766f, 3.88f, 4.011f, 4.15f,
                                                   4.293f, 4.44f, 4.586f, 4.74f, 4.908f, 5.09f, 5.289f};
constexpr std::array<float, kMetalSamples> kAlEta = {0.4191f, 0.432f, 0.4457f, 0.46f,  0.4747f, 0.49f,  0.5062f, 0.523f, 0.5401f, 0.558f,
                                                     0.5773f, 0.598f, 0.6203f, 0.644f, 0.6686f, 0.695f, 0.7238f, 0.755f, 0.789f,  0.826f,
                                                     0.867f,  0.912f, 0.963f,  1.02f,  1.08f,   1.15f,  1.22f,   1.3f,   1.39f,   1.49f,
                                                     1.6f,    1.74f,  1.91f,   2.14f,  2.41f,   2.63f,  2.8f};
constexpr std::array<float, kMetalSamples> kAlK = {4.494f, 4.56f, 4.634f, 4.71f, 4.784f, 4.86f, 4.938f, 5.02f, 5.109f, 5.2f,
                                                   5.29f,  5.38f, 5.48f,  5.58f, 5.69f,  5.8f,  5.915f, 6.03f, 6.15f,  6.28f,
                                                   6.42f,  6.55f, 6.7f,   6.85f, 7.f,    7.15f, 7.31f,  7.48f, 7.65f,  7.82f,
                                                   8.01f,  8.21f, 8.39f,  8.57f, 8.62f,  8.6f,  8.45f};
constexpr std::array<float, kMetalSamples> kAuEta = {1.706f,  1.696f, 1.685f,  1.674f, 1.666f,  1.658f, 1.647f,  1.636f, 1.628f,  1.616f,
                                                     1.596f,  1.562f, 1.502f,  1.426f, 1.346f,  1.242f, 1.087f,  0.916f, 0.7545f, 0.608f,
                                                     0.4918f, 0.402f, 0.3455f, 0.306f, 0.2676f, 0.236f, 0.2124f, 0.194f, 0.1777f, 0.166f,
                                                     0.161f,  0.16f,  0.1609f, 0.164f, 0.1695f, 0.176f, 0.1814f};
constexpr std::array<float, kMetalSamples> kAuK = {1.883f, 1.906f, 1.923f, 1.936f, 1.948f, 1.956f, 1.959f, 1.958f, 1.951f, 1.94f,
                                                   1.925f, 1.904f, 1.876f, 1.846f, 1.815f, 1.796f, 1.797f, 1.84f,  1.956f, 2.12f,
                                                   2.326f, 2.54f,  2.731f, 2.88f,  2.941f, 2.97f,  3.015f, 3.06f,  3.07f,  3.15f,
                                                   3.446f, 3.8f,   4.088f, 4.357f, 4.61f,  4.86f,  5.126f};
constexpr std::array<float, kMetalSamples> kCuEta = {1.249f,  1.225f, 1.2f,    1.18f,  1.174f,  1.175f, 1.177f,  1.18f,  1.178f,  1.175f,
                                                     1.173f,  1.17f,  1.165f,  1.16f,  1.155f,  1.15f,  1.143f,  1.135f, 1.132f,  1.12f,
                                                     1.092f,  1.04f,  0.9504f, 0.826f, 0.6459f, 0.468f, 0.3513f, 0.272f, 0.2308f, 0.214f,
                                                     0.2092f, 0.213f, 0.2162f, 0.223f, 0.2365f, 0.25f,  0.2542f};
constexpr std::array<float, kMetalSamples> kCuK = {1.972f, 2.015f, 2.122f, 2.21f,  2.177f, 2.13f,  2.16f,  2.21f,  2.25f,  2.289f,
                                                   2.326f, 2.362f, 2.398f, 2.433f, 2.469f, 2.504f, 2.536f, 2.564f, 2.59f,  2.605f,
                                                   2.596f, 2.583f, 2.576f, 2.599f, 2.678f, 2.809f, 3.011f, 3.24f,  3.458f, 3.67f,
                                                   3.863f, 4.05f,  4.24f,  4.43f,  4.62f,  4.817f, 5.034f};

struct Metal {
  std::string_view name;
  const std::array<float, kMetalSamples>&eta, &k;
};
constexpr std::array kMetals = {Metal{"Ag", kAgEta, kAgK}, Metal{"Al", kAlEta, kAlK}, Metal{"Au", kAuEta, kAuK}, Metal{"Cu", kCuEta, kCuK}};

constexpr std::size_t kMostSamples = 9;
struct Sampled {
  std::string_view name;
  std::array<std::pair<float, float>, kMostSamples> samples;  ///< unused ones have wavelength 0
};

// Few samples suffice where the curve is smooth. Brass after [Querry1985] at three wavelengths.
constexpr std::array kOthers = {
    Sampled{"metal-CuZn-eta", {{std::pair(465.f, 0.947f), std::pair(550.f, 0.5682f), std::pair(630.f, 0.445f)}}},
    Sampled{"metal-CuZn-k", {{std::pair(465.f, 1.92f), std::pair(550.f, 2.588f), std::pair(630.f, 3.522f)}}},
    Sampled{"metal-MgO-eta",
            {{std::pair(404.6f, 1.761f), std::pair(435.8f, 1.7547f), std::pair(486.f, 1.7471f), std::pair(546.2f, 1.7408f),
              std::pair(589.3f, 1.7374f), std::pair(656.3f, 1.7334f), std::pair(706.4f, 1.731f)}}},
    Sampled{"metal-MgO-k", {{std::pair(404.6f, 0.f), std::pair(706.4f, 0.f)}}},
    Sampled{"metal-TiO2-eta",
            {{std::pair(388.f, 3.49f), std::pair(412.f, 3.24f), std::pair(440.f, 3.2f), std::pair(480.f, 3.08f), std::pair(520.f, 3.f),
              std::pair(560.f, 2.94f), std::pair(600.f, 2.9f), std::pair(660.f, 2.85f), std::pair(740.f, 2.81f)}}},
    Sampled{"metal-TiO2-k", {{std::pair(388.f, 0.f), std::pair(740.f, 0.f)}}},
    Sampled{"glass-BK7",
            {{std::pair(410.f, 1.52957f), std::pair(454.f, 1.52496f), std::pair(498.f, 1.52155f), std::pair(564.f, 1.51784f),
              std::pair(630.f, 1.51519f), std::pair(696.f, 1.51317f)}}},
    Sampled{"glass-BAF10",
            {{std::pair(414.f, 1.69246f), std::pair(457.f, 1.6842f), std::pair(500.f, 1.67819f), std::pair(565.f, 1.67177f),
              std::pair(629.f, 1.66727f), std::pair(694.f, 1.66394f)}}},
    Sampled{"glass-FK51A",
            {{std::pair(422.f, 1.49465f), std::pair(466.f, 1.49162f), std::pair(511.f, 1.48936f), std::pair(577.f, 1.48688f),
              std::pair(643.f, 1.48508f), std::pair(709.f, 1.48373f)}}},
    Sampled{"glass-LASF9",
            {{std::pair(412.f, 1.89454f), std::pair(455.f, 1.87786f), std::pair(497.f, 1.86614f), std::pair(561.f, 1.85397f),
              std::pair(625.f, 1.84566f), std::pair(689.f, 1.83966f)}}},
    Sampled{"glass-F5",
            {{std::pair(412.f, 1.7079f), std::pair(455.f, 1.69455f), std::pair(497.f, 1.68524f), std::pair(561.f, 1.67564f),
              std::pair(625.f, 1.66909f), std::pair(689.f, 1.66435f)}}},
    Sampled{"glass-F10",
            {{std::pair(422.f, 1.76736f), std::pair(464.f, 1.75221f), std::pair(507.f, 1.74158f), std::pair(570.f, 1.73053f),
              std::pair(634.f, 1.72298f), std::pair(698.f, 1.7175f)}}},
    Sampled{"glass-F11",
            {{std::pair(412.f, 1.83747f), std::pair(455.f, 1.81709f), std::pair(497.f, 1.80316f), std::pair(561.f, 1.78899f),
              std::pair(625.f, 1.77948f), std::pair(689.f, 1.77269f)}}},
};

Spectrum metal_spectrum(const std::array<float, kMetalSamples>& values) {
  Spectrum spectrum;
  for (std::size_t i = 0; i < kMetalSamples; ++i) {
    spectrum.samples.emplace_back(kNmTimesEv / (kFirstEnergyEv - kEnergyStepEv * static_cast<float>(i)), values[i]);
  }
  return spectrum;
}

}  // namespace

std::optional<Spectrum> named_spectrum(std::string_view name) {
  constexpr std::string_view kMetalPrefix = "metal-";
  for (const Metal& metal : kMetals) {
    if (!name.starts_with(kMetalPrefix) || !name.substr(kMetalPrefix.size()).starts_with(metal.name)) continue;
    const std::string_view property = name.substr(kMetalPrefix.size() + metal.name.size());
    if (property == "-eta") return metal_spectrum(metal.eta);
    if (property == "-k") return metal_spectrum(metal.k);
  }
  for (const Sampled& other : kOthers) {
    if (name != other.name) continue;
    Spectrum spectrum;
    for (const auto& [wavelength_nm, value] : other.samples) {
      if (wavelength_nm > 0) spectrum.samples.emplace_back(wavelength_nm, value);
    }
    return spectrum;
  }
  // pbrt gives three flint glasses two names.
  if (name.starts_with("glass-SF")) return named_spectrum("glass-" + std::string(name.substr(7)));
  if (name == "stdillum-D65") return Spectrum{daylight_d65_samples()};
  return std::nullopt;
}

std::vector<std::string> spectrum_names() {
  std::vector<std::string> names;
  for (const Metal& metal : kMetals) {
    for (const std::string_view property : {"-eta", "-k"}) names.push_back("metal-" + std::string(metal.name) + std::string(property));
  }
  for (const Sampled& other : kOthers) names.emplace_back(other.name);
  names.emplace_back("stdillum-D65");
  return names;
}

}  // namespace sightline::pbrt
