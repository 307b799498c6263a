#include "scene/load/gltf/document.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/core/error.h"
#include "image/io/image_io.h"
#include "scene/load/gltf/uri.h"

namespace sightline::gltf {
namespace {

/// What nlohmann says, without its own prefix.
std::string_view plain_message(std::string_view what) {
  const std::size_t bracket = what.find("] ");
  return bracket == std::string_view::npos ? what : what.substr(bracket + 2);
}

nlohmann::json parse_json(const Container& container) {
  try {
    return nlohmann::json::parse(container.json.begin(), container.json.end());
  } catch (const nlohmann::json::parse_error& error) {
    throw input_error(fmt::format("malformed JSON: {}", plain_message(error.what())))
        .at(fmt::format("byte {}", container.json_offset + std::max<std::size_t>(error.byte, 1) - 1));
  } catch (const nlohmann::json::exception& error) {
    throw input_error(fmt::format("malformed JSON: {}", plain_message(error.what())));
  }
}

void check_version(const JsonView& root) {
  const JsonView asset = root.require("asset");
  const std::string version = asset.string_or("minVersion", asset.require("version").as_string());
  if (!version.starts_with("2.")) throw input_error(fmt::format("glTF version '{}' is not supported, only 2.x", version)).at("/asset");
}

}  // namespace

struct Document::Json {
  nlohmann::json value;
};

Document::Document(std::span<const std::byte> file, const std::filesystem::path* folder, const Context& context)
    : container_(split_container(file)), folder_(folder), context_(context) {
  json_ = std::make_unique<const Json>(Json{parse_json(container_)});
  check_version(root());
  budget_bytes_ = std::uint64_t{16} << 20;
  add_file_bytes(file.size());
}

Document::~Document() = default;

JsonView Document::root() const { return {json_->value, ""}; }

std::size_t Document::count(std::string_view section) const {
  const std::optional<JsonView> elements = root().find(section);
  return elements ? elements->size() : 0;
}

JsonView Document::element(std::string_view section, std::size_t index) const { return root().require(section).at(index); }

std::size_t Document::resolve(std::string_view section, const JsonView& reference) const {
  const std::uint64_t index = reference.as_unsigned();
  if (index >= count(section)) {
    throw input_error(fmt::format("there is no {}[{}], only {}", section, index, count(section))).at(reference.path());
  }
  return static_cast<std::size_t>(index);
}

std::span<const std::byte> Document::buffer(std::size_t index) {
  if (const auto found = buffers_.find(index); found != buffers_.end()) return found->second;

  const JsonView buffer = element("buffers", index);
  const std::uint64_t length = buffer.require("byteLength").as_unsigned();
  std::span<const std::byte> bytes;
  if (const std::optional<JsonView> uri_member = buffer.find("uri")) {
    const std::string& uri = uri_member->as_string();
    if (is_data_uri(uri)) {
      std::optional<std::vector<std::byte>> data = decode_data_uri(uri);
      if (!data) throw input_error("the data URI is malformed").at(uri_member->path());
      bytes = owned_buffers_[index] = std::move(*data);
    } else {
      if (folder_ == nullptr)
        throw input_error(fmt::format("external file '{}' is refused: only memory is read here", uri)).at(uri_member->path());
      const std::optional<std::filesystem::path> path = file_of_uri(uri, *folder_);
      if (!path) throw input_error(fmt::format("'{}' is no file in the folder of the scene", uri)).at(uri_member->path());
      std::shared_ptr<const std::vector<std::byte>>& file = external_files_[path->string()];
      if (!file) {
        try {
          file = std::make_shared<const std::vector<std::byte>>(read_file(*path));
        } catch (Error& error) {
          throw error.at(uri_member->path());
        }
        add_file_bytes(file->size());
      }
      bytes = *file;
    }
  } else if (index == 0 && container_.has_binary) {
    bytes = container_.binary;
  } else {
    const bool is_fallback = buffer.extension("EXT_meshopt_compression") || buffer.extension("KHR_meshopt_compression");
    throw input_error(is_fallback ? "the data is only there in compressed form (meshopt), which is not supported"
                                  : "the buffer has neither a URI nor a binary chunk")
        .at(buffer.path());
  }
  if (length > bytes.size()) {
    throw input_error(fmt::format("the buffer has {} bytes, byteLength says {}", bytes.size(), length)).at(buffer.path());
  }
  return buffers_[index] = bytes.first(static_cast<std::size_t>(length));
}

BufferView Document::buffer_view(std::size_t index) {
  const JsonView view = element("bufferViews", index);
  const std::span<const std::byte> bytes = buffer(resolve("buffers", view.require("buffer")));
  const std::uint64_t offset = view.unsigned_or("byteOffset", 0);
  const std::uint64_t length = view.require("byteLength").as_unsigned();
  if (offset > bytes.size() || length > bytes.size() - offset) {
    throw input_error(fmt::format("bytes {} to {} lie outside the buffer of {}", offset, offset + length, bytes.size())).at(view.path());
  }
  const std::uint64_t stride = view.unsigned_or("byteStride", 0);
  // glTF allows up to 252; some writers go beyond, which does no harm.
  if (stride > 65536) throw input_error(fmt::format("a stride of {} bytes is too large", stride)).at(view.path());
  return {bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length)), static_cast<std::size_t>(stride), view.path()};
}

void Document::add_file_bytes(std::uint64_t bytes) {
  // The largest honest growth: byte indices of a strip (1 byte) become triangles of 12.
  constexpr std::uint64_t kGrowth = 24;
  budget_bytes_ += kGrowth * bytes;
}

void Document::charge(std::uint64_t bytes, const std::string& path) {
  context_.check_cancelled();
  if (bytes > budget_bytes_ - spent_bytes_) {
    throw input_error(fmt::format("the accessors ask for {} bytes, far more than the file holds", spent_bytes_ + bytes)).at(path);
  }
  spent_bytes_ += bytes;
}

}  // namespace sightline::gltf
