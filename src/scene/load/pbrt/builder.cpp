#include "scene/load/pbrt/builder.h"

#include <system_error>

#include "base/settings/settings.h"
#include "image/io/image_io.h"
#include "scene/load/warnings.h"

namespace sightline::pbrt {

Builder::Builder(std::optional<std::filesystem::path> directory, const Context& context)
    : directory_(std::move(directory)), context_(context) {}

void Builder::warn(const Place& place, std::string_view message) {
  add_warning(scene_, context_, fmt::format("{}: {}", place.text(), message));
}

void Builder::warn_once(const Place& place, const std::string& message) {
  constexpr std::size_t kMostRemembered = 1000;
  if (said_.size() < kMostRemembered && said_.insert(message).second) warn(place, message);
}

void Builder::report_unused(const ParameterList& parameters, std::string_view directive) {
  for (const Parameter* const parameter : parameters.unused()) {
    const std::string nearest = nearest_name(parameter->name, parameters.asked());
    warn(parameter->place, fmt::format("\"{} {}\" has no effect on {}{}", parameter->type, shown(parameter->name), directive,
                                       nearest.empty() || nearest == parameter->name ? "" : fmt::format(" (did you mean '{}'?)", nearest)));
  }
}

std::filesystem::path Builder::resolve(const std::string& name) const {
  if (!directory_) return name;
  const std::filesystem::path path(name);
  return path.is_absolute() ? path : *directory_ / path;
}

std::optional<Builder::SpectrumValue> Builder::spectrum_value(const ParameterList& parameters, std::string_view name, ColorSpace space) {
  const Parameter* const parameter = parameters.find(name, "rgb spectrum blackbody xyz");
  if (parameter == nullptr) return std::nullopt;
  SpectrumValue value;
  const std::vector<float>& numbers = parameter->numbers;
  if (parameter->type == "rgb" && numbers.size() == 3) {
    value.rgb = to_working_space(space, {numbers[0], numbers[1], numbers[2]});
    if (!is_finite(value.rgb)) throw error_at(parameter->place, "a colour is not finite");
    return value;
  }
  if (parameter->type == "blackbody" && !numbers.empty()) {
    if (!(numbers[0] > 0) || !std::isfinite(numbers[0])) throw error_at(parameter->place, "a temperature is not positive");
    value.spectrum = blackbody_spectrum(numbers[0]);
    // pbrt-v3 has a factor behind the temperature.
    value.rgb = Color(numbers.size() > 1 ? numbers[1] : 1);
    return value;
  }
  if (parameter->type == "spectrum") {
    value.rgb = Color(1);
    if (!parameter->strings.empty()) {
      const std::string& source = parameter->strings.front();
      value.spectrum = named_spectrum(source);
      std::error_code error;
      if (!value.spectrum && directory_ && std::filesystem::is_regular_file(resolve(source), error)) {
        constexpr std::uint64_t kLargestSpectrumBytes = 1 << 22;
        const std::vector<std::byte> bytes = read_file(resolve(source), kLargestSpectrumBytes);
        value.spectrum = spectrum_from_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        if (!value.spectrum)
          throw error_at(parameter->place, fmt::format("'{}' is no list of increasing wavelengths and values", shown(source)));
      }
      if (value.spectrum) return value;
      const std::string nearest = nearest_name(source, spectrum_names());
      warn(parameter->place, fmt::format("spectrum '{}' is neither known nor a file{}; the default is used", shown(source),
                                         nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest)));
      return std::nullopt;
    }
    if (numbers.size() == 1) {  // a constant
      value.spectrum = Spectrum{{{560.f, numbers[0]}}};
      return value;
    }
    value.spectrum = spectrum_from_pairs(numbers);
    if (value.spectrum) return value;
  }
  throw error_at(parameter->place, fmt::format("\"{} {}\" is no spectrum of that type", parameter->type, shown(parameter->name)));
}

Color Builder::light_color(const ParameterList& parameters, std::string_view name, const GraphicsState& state) {
  const std::optional<SpectrumValue> value = spectrum_value(parameters, name, state.color_space);
  // pbrt divides a light's spectrum by its own luminance, an RGB light only by that of its illuminant: RGB keeps its value, sampled and
  // blackbody spectra have luminance 1.
  if (!value) return Color(1);
  return value->spectrum ? value->rgb * emission_color(*value->spectrum) : glm::max(value->rgb, Color(0));
}

Color Builder::surface_color(const ParameterList& parameters, std::string_view name, Color fallback, ColorSpace space) {
  const std::optional<SpectrumValue> value = spectrum_value(parameters, name, space);
  if (!value) return fallback;
  return glm::max(value->spectrum ? reflectance_color(*value->spectrum) : value->rgb, Color(0));
}

}  // namespace sightline::pbrt
