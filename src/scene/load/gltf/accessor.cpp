#include "scene/load/gltf/accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "base/core/error.h"

namespace sightline::gltf {
namespace {

enum ComponentType : std::uint64_t { kByte = 5120, kUnsignedByte, kShort, kUnsignedShort, kUnsignedInt = 5125, kFloat = 5126 };

std::size_t component_size(const AccessorInfo& info) {
  switch (info.component_type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      throw input_error(fmt::format("{} is no component type", info.component_type)).at(info.path + "/componentType");
  }
}

int component_count(const JsonView& type) {
  constexpr std::array<std::string_view, 4> kNames = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  const auto found = std::find(kNames.begin(), kNames.end(), type.as_string());
  if (found != kNames.end()) return static_cast<int>(found - kNames.begin()) + 1;
  if (type.as_string() == "MAT4") return 16;
  if (type.as_string().starts_with("MAT")) return 0;
  throw input_error(fmt::format("'{}' is no accessor type", type.as_string())).at(type.path());
}

template <class T>
T read_raw(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// glTF's rule for normalised integers: the most negative one is clamped to -1.
template <class T>
float as_float(const std::byte* bytes, bool normalized) {
  const T value = read_raw<T>(bytes);
  if constexpr (std::is_floating_point_v<T>) {
    return value;
  } else {
    const auto number = static_cast<float>(value);
    return normalized ? std::max(number / static_cast<float>(std::numeric_limits<T>::max()), -1.f) : number;
  }
}

struct FloatComponent {
  bool normalized;
  float operator()(const std::byte* bytes, std::uint64_t type) const {
    switch (type) {
      case kByte:
        return as_float<std::int8_t>(bytes, normalized);
      case kUnsignedByte:
        return as_float<std::uint8_t>(bytes, normalized);
      case kShort:
        return as_float<std::int16_t>(bytes, normalized);
      case kUnsignedShort:
        return as_float<std::uint16_t>(bytes, normalized);
      case kUnsignedInt:
        return as_float<std::uint32_t>(bytes, normalized);
      default:
        return as_float<float>(bytes, false);
    }
  }
};

struct UnsignedComponent {
  std::uint32_t operator()(const std::byte* bytes, std::uint64_t type) const {
    switch (type) {
      case kUnsignedByte:
        return read_raw<std::uint8_t>(bytes);
      case kUnsignedShort:
        return read_raw<std::uint16_t>(bytes);
      default:
        return read_raw<std::uint32_t>(bytes);
    }
  }
};

/// A strided run of elements inside a buffer view, checked to fit.
struct Elements {
  const std::byte* first = nullptr;
  std::size_t stride = 0;
};

Elements elements_in(Document& document, const JsonView& owner, std::uint64_t count, std::size_t element_size, bool may_stride) {
  const BufferView view = document.buffer_view(document.resolve("bufferViews", owner.require("bufferView")));
  const std::uint64_t offset = owner.unsigned_or("byteOffset", 0);
  const std::size_t stride = may_stride && view.stride != 0 ? view.stride : element_size;
  if (stride < element_size) {
    throw input_error(fmt::format("elements of {} bytes overlap at a stride of {}", element_size, stride)).at(view.path + "/byteStride");
  }
  // Written so that no product can overflow: count elements need (count - 1) strides and one element.
  const bool fits = count == 0 || (offset <= view.bytes.size() && element_size <= view.bytes.size() - offset &&
                                   count - 1 <= (view.bytes.size() - offset - element_size) / stride);
  if (!fits) {
    throw input_error(fmt::format("{} elements of {} bytes from byte {} with stride {} do not fit into the buffer view of {} bytes", count,
                                  element_size, offset, stride, view.bytes.size()))
        .at(owner.path());
  }
  return {view.bytes.data() + (count == 0 ? 0 : offset), stride};
}

/// Reads the accessor's own elements, then puts the sparse ones over them.
template <class T, class Convert>
std::vector<T> read_elements(Document& document, const AccessorInfo& info, std::size_t index, const Convert& convert) {
  const JsonView accessor = document.element("accessors", index);
  const std::size_t size = component_size(info);
  const auto components = static_cast<std::size_t>(info.components);
  const std::optional<JsonView> sparse = accessor.find("sparse");

  Elements elements;
  if (accessor.find("bufferView")) {
    elements = elements_in(document, accessor, info.count, size * components, true);
  } else if (accessor.find("byteOffset")) {
    throw input_error("byteOffset needs a bufferView").at(info.path);
  }
  document.charge(info.count > (std::uint64_t{1} << 48) ? info.count : info.count * components * sizeof(T), info.path);

  std::vector<T> values(static_cast<std::size_t>(info.count) * components);
  const auto read_one = [&](const std::byte* bytes, T* out) {
    for (std::size_t c = 0; c < components; ++c) out[c] = convert(bytes + c * size, info.component_type);
  };
  if (elements.first != nullptr) {
    if (std::is_same_v<T, float> && info.component_type == kFloat && elements.stride == size * components) {
      if (!values.empty()) std::memcpy(values.data(), elements.first, values.size() * sizeof(T));
    } else {
      for (std::size_t i = 0; i < info.count; ++i) read_one(elements.first + i * elements.stride, &values[i * components]);
    }
  }
  if (!sparse) return values;

  const std::uint64_t sparse_count = sparse->require("count").as_unsigned();
  if (sparse_count > info.count) {
    throw input_error(fmt::format("{} sparse elements in an accessor of {}", sparse_count, info.count)).at(sparse->path());
  }
  const JsonView index_owner = sparse->require("indices"), value_owner = sparse->require("values");
  AccessorInfo index_info{.path = index_owner.path(), .component_type = index_owner.require("componentType").as_unsigned()};
  const std::size_t index_size = component_size(index_info);
  if (index_info.component_type != kUnsignedByte && index_info.component_type != kUnsignedShort &&
      index_info.component_type != kUnsignedInt) {
    throw input_error("sparse indices must be of an unsigned integer type").at(index_info.path + "/componentType");
  }
  const Elements targets = elements_in(document, index_owner, sparse_count, index_size, false);
  const Elements sources = elements_in(document, value_owner, sparse_count, size * components, false);
  for (std::size_t i = 0; i < sparse_count; ++i) {
    const std::uint32_t target = UnsignedComponent{}(targets.first + i * index_size, index_info.component_type);
    if (target >= info.count) {
      throw input_error(fmt::format("sparse index {} is out of range, the accessor has {} elements", target, info.count))
          .at(index_info.path);
    }
    read_one(sources.first + i * sources.stride, &values[target * components]);
  }
  return values;
}

}  // namespace

AccessorInfo accessor_info(const Document& document, std::size_t index) {
  const JsonView accessor = document.element("accessors", index);
  AccessorInfo info;
  info.path = accessor.path();
  info.component_type = accessor.require("componentType").as_unsigned();
  component_size(info);
  info.components = component_count(accessor.require("type"));
  info.normalized = accessor.bool_or("normalized", false);
  info.count = accessor.require("count").as_unsigned();
  info.has_data = accessor.find("bufferView") || accessor.find("sparse");
  return info;
}

std::vector<float> read_floats(Document& document, std::size_t index, int components) {
  const AccessorInfo info = accessor_info(document, index);
  if (info.components != components) {
    throw input_error(fmt::format("{} components are expected here, the accessor has {}", components, info.components)).at(info.path);
  }
  return read_elements<float>(document, info, index, FloatComponent{info.normalized});
}

std::vector<std::uint32_t> read_unsigned(Document& document, std::size_t index, int components) {
  const AccessorInfo info = accessor_info(document, index);
  const bool is_unsigned =
      info.component_type == kUnsignedByte || info.component_type == kUnsignedShort || info.component_type == kUnsignedInt;
  if (info.components != components || !is_unsigned) {
    throw input_error(fmt::format("indices must be unsigned integers, {} an element", components)).at(info.path);
  }
  return read_elements<std::uint32_t>(document, info, index, UnsignedComponent{});
}

}  // namespace sightline::gltf
