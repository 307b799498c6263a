#include "shade/measured_file.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "base/core/error.h"
#include "image/io/image_io.h"
#include "scene/load/pbrt/spectrum.h"
#include "shade/measured_reflectance.h"

namespace sightline {
namespace {

constexpr std::size_t kMostWavelengths = 1024;
constexpr float kMostValue = 1e6f;

/// Numbers one after the other, wherever lines break.
class NumberReader {
 public:
  NumberReader(std::string_view text, const std::string& name) : p_(text.data()), end_(p_ + text.size()), name_(name) {}

  bool at_end() {
    while (p_ != end_ && (*p_ == '#' || is_space(*p_))) {
      if (*p_ == '#') {
        p_ = std::find(p_, end_, '\n');
      } else {
        line_ += *p_ == '\n' ? 1 : 0;
        ++p_;
      }
    }
    return p_ == end_;
  }
  float number(std::string_view what) {
    if (at_end()) throw failure(fmt::format("the file ends where {} should be", what));
    float value = 0;
    const char* const begin = p_ + (*p_ == '+' ? 1 : 0);
    const auto [after, status] = fast_float::from_chars(begin, end_, value);
    if (status != std::errc{} || !std::isfinite(value) || (after != end_ && !is_space(*after) && *after != '#'))
      throw failure(fmt::format("expected {}, a number", what));
    p_ = after;
    return value;
  }
  Error failure(std::string message) const {
    return std::move(input_error(std::move(message)).at(fmt::format("{}:{}", name_, line_)).during("reading a measured BRDF"));
  }
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - p_); }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ','; }
  const char *p_, *end_;
  const std::string& name_;
  int line_ = 1;
};

std::vector<float> read_wavelengths(NumberReader& reader) {
  const float count = reader.number("the number of wavelengths");
  if (!(count >= 1 && count <= kMostWavelengths) || count != std::floor(count))
    throw reader.failure(fmt::format("{} is no number of wavelengths (1 to {})", count, kMostWavelengths));
  std::vector<float> wavelengths;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    const float nm = reader.number("a wavelength");
    if (!(nm > 0) || (!wavelengths.empty() && nm <= wavelengths.back()))
      throw reader.failure(fmt::format("wavelengths must increase, {} does not", nm));
    wavelengths.push_back(nm);
  }
  return wavelengths;
}

/// What each wavelength adds to the colour: the colour is linear in the spectrum.
std::vector<Color> wavelength_colors(const std::vector<float>& wavelengths) {
  pbrt::Spectrum basis;
  for (const float nm : wavelengths) basis.samples.emplace_back(nm, 0.f);
  std::vector<Color> colors;
  for (auto& [nm, value] : basis.samples) {
    value = 1;
    colors.push_back(pbrt::reflectance_color(basis));
    value = 0;
  }
  return colors;
}

float read_polar_angle(NumberReader& reader, std::string_view what) {
  constexpr float kMost = 0.5f * kPi + 1e-3f;
  const float theta = reader.number(what);
  if (!(theta >= 0 && theta <= kMost)) throw reader.failure(fmt::format("{} of {} rad is not between 0 and pi/2", what, theta));
  return std::min(theta, 0.5f * kPi);
}

}  // namespace

std::vector<ReflectanceSample> parse_cornell_brdf(std::string_view text, const std::string& name) {
  NumberReader reader(text, name);
  const std::vector<float> wavelengths = read_wavelengths(reader);
  const std::vector<Color> colors = wavelength_colors(wavelengths);
  std::vector<ReflectanceSample> samples;
  samples.reserve(reader.bytes_left() / (2 * (colors.size() + 4)));
  while (!reader.at_end()) {
    ReflectanceSample sample;
    sample.theta_i = read_polar_angle(reader, "theta_i");
    const float phi_i = reader.number("phi_i");
    sample.theta_o = read_polar_angle(reader, "theta_o");
    sample.delta_phi = reader.number("phi_o") - phi_i;
    if (!std::isfinite(sample.delta_phi)) throw reader.failure("the azimuths are out of range");
    Color sum(0);
    for (const Color& color : colors) {
      const float value = reader.number("a value");
      if (!(std::fabs(value) <= kMostValue)) throw reader.failure(fmt::format("{} is no reflectance", value));
      sum += value * color;
    }
    sample.value = glm::max(sum, 0.f);
    samples.push_back(sample);
  }
  if (samples.empty()) throw reader.failure("there is no measurement");
  return samples;
}

MeasuredMaterial load_measured_material(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = read_file(path);
  const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  auto data = std::make_shared<const MeasuredReflectance>(parse_cornell_brdf(text, path.string()));
  MeasuredMaterial material;
  material.content_hash = data->content_hash();
  material.data = std::move(data);
  material.file = path.string();
  return material;
}

}  // namespace sightline
