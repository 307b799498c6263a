#include "film/frame_file.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/core/error.h"

namespace sightline {
namespace {

constexpr char kMagic[8] = {'S', 'L', 'F', 'R', 'A', 'M', 'E', '1'};

// File: magic, header bytes (u64), payload bytes (u64), xxh64 of header and payload, JSON header, zstd payload (tile counts, then sums,
// then those of the light image).
struct Prefix {
  char magic[8];
  std::uint64_t header_bytes, payload_bytes, checksum;
};

std::uint64_t checksum_of(std::span<const std::byte> body) { return XXH64(body.data(), body.size(), 1); }

// A whole number of the header, or nothing if it is missing, of another type or above `maximum`.
std::optional<std::uint64_t> number(const nlohmann::json& header, const char* key, std::uint64_t maximum) {
  const auto found = header.find(key);
  if (found == header.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() > maximum) return std::nullopt;
  return found->get<std::uint64_t>();
}

std::string text(const nlohmann::json& header, const char* key) {
  const auto found = header.find(key);
  return found != header.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::size_t raw_size(const Frame& frame) {
  std::size_t size = frame.tile_count() * sizeof(std::uint32_t);
  for (const AovInfo& info : aov_table()) size += frame.sums(info.id).size_bytes() + frame.light_image_sums(info.id).size_bytes();
  return size;
}

}  // namespace

std::vector<std::byte> encode_frame(const Frame& frame, const FrameIdentity& identity, const std::string& note) {
  if (frame.has_single_colors()) throw Error(ErrorCode::bug, "a picture of single samples has no file of sums");
  const nlohmann::json header = {{"width", frame.width()},
                                 {"height", frame.height()},
                                 {"layers", frame.aovs().bits()},
                                 {"first_sample", frame.first_sample()},
                                 {"light_image", frame.has_light_image()},
                                 {"identity", identity.text},
                                 {"note", note},
                                 {"nonfinite", frame.nonfinite_samples()}};
  const std::string header_text = header.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);

  std::vector<std::byte> raw(raw_size(frame));
  std::size_t at = 0;
  const auto put = [&](const void* data, std::size_t size) {
    if (size) std::memcpy(raw.data() + at, data, size);
    at += size;
  };
  put(frame.samples_per_tile().data(), frame.samples_per_tile().size_bytes());
  for (const AovInfo& info : aov_table()) put(frame.sums(info.id).data(), frame.sums(info.id).size_bytes());
  for (const AovInfo& info : aov_table()) put(frame.light_image_sums(info.id).data(), frame.light_image_sums(info.id).size_bytes());

  std::vector<std::byte> bytes(sizeof(Prefix) + header_text.size() + ZSTD_compressBound(raw.size()));
  std::byte* body = bytes.data() + sizeof(Prefix);
  std::memcpy(body, header_text.data(), header_text.size());
  const std::size_t packed = ZSTD_compress(body + header_text.size(), ZSTD_compressBound(raw.size()), raw.data(), raw.size(), 1);
  if (ZSTD_isError(packed)) throw Error(ErrorCode::bug, fmt::format("compressing a frame failed: {}", ZSTD_getErrorName(packed)));
  bytes.resize(sizeof(Prefix) + header_text.size() + packed);

  Prefix prefix{{}, header_text.size(), packed, checksum_of(std::span(bytes).subspan(sizeof(Prefix)))};
  std::memcpy(prefix.magic, kMagic, sizeof kMagic);
  std::memcpy(bytes.data(), &prefix, sizeof prefix);
  return bytes;
}

StoredFrame decode_frame(std::span<const std::byte> bytes, const std::string& name) {
  const auto fail = [&](const std::string& why) { return input_error(why).at(name); };
  Prefix prefix;
  if (bytes.size() < sizeof prefix) throw fail("too short for a frame file");
  std::memcpy(&prefix, bytes.data(), sizeof prefix);
  if (std::memcmp(prefix.magic, kMagic, sizeof kMagic) != 0) throw fail("not a frame file of this version");
  const std::span<const std::byte> body = bytes.subspan(sizeof prefix);
  if (prefix.header_bytes > body.size() || prefix.payload_bytes != body.size() - prefix.header_bytes) throw fail("truncated frame file");
  if (checksum_of(body) != prefix.checksum) throw fail("damaged frame file: checksum differs");

  const auto* header_text = reinterpret_cast<const char*>(body.data());
  const nlohmann::json header = nlohmann::json::parse(header_text, header_text + prefix.header_bytes, nullptr, false);
  if (!header.is_object()) throw fail("frame header is not JSON");
  const auto width = number(header, "width", 65536), height = number(header, "height", 65536);
  const auto layers = number(header, "layers", (std::uint64_t{1} << kAovCount) - 1), first_sample = number(header, "first_sample", ~0u);
  // Pixel numbers are 32-bit.
  if (!width || !height || !layers || !first_sample || *width * *height == 0 || *width * *height > 0x7fffffff)
    throw fail("frame header is out of range");

  // The decompressed size must be what the header's dimensions demand before anything of that size is allocated.
  std::size_t channels = 0;
  const AovSet aovs = AovSet::from_bits(static_cast<std::uint32_t>(*layers));
  for (const AovInfo& info : aov_table()) channels += aovs.has(info.id) ? info.channels.size() : 0;
  const auto light_image_key = header.find("light_image");
  const bool light_image = light_image_key != header.end() && light_image_key->is_boolean() && light_image_key->get<bool>();
  if (light_image) {
    for (const Aov aov : kLightImageLayers) channels += aovs.has(aov) ? aov_info(aov).channels.size() : 0;
  }
  const std::uint64_t pixel_bytes = *width * *height * channels * sizeof(ExactSum);
  const std::span<const std::byte> payload = body.subspan(prefix.header_bytes);
  const unsigned long long content = ZSTD_getFrameContentSize(payload.data(), payload.size());
  // Nothing packs better than zstd's runs, about 128 KiB in 4 bytes: what claims more is made up.
  if (content == ZSTD_CONTENTSIZE_ERROR || content == ZSTD_CONTENTSIZE_UNKNOWN || content < pixel_bytes ||
      content > pixel_bytes + (pixel_bytes >> 4) + 4096 || content / 40000 > payload.size())
    throw fail("frame payload does not fit its header");

  StoredFrame stored{Frame(static_cast<int>(*width), static_cast<int>(*height), aovs, static_cast<std::uint32_t>(*first_sample)),
                     {text(header, "identity")},
                     text(header, "note")};
  if (light_image) stored.frame.enable_light_image();
  std::vector<std::byte> raw(raw_size(stored.frame));
  if (raw.size() != content) throw fail("frame payload does not fit its header");
  const std::size_t unpacked = ZSTD_decompress(raw.data(), raw.size(), payload.data(), payload.size());
  if (ZSTD_isError(unpacked) || unpacked != raw.size()) throw fail("frame payload cannot be decompressed");
  std::size_t at = 0;
  for (std::size_t tile = 0; tile < stored.frame.tile_count(); ++tile, at += sizeof(std::uint32_t)) {
    std::uint32_t count;
    std::memcpy(&count, raw.data() + at, sizeof count);
    stored.frame.set_samples_done(tile, count);
  }
  const auto take = [&](std::span<ExactSum> sums) {
    if (!sums.empty()) std::memcpy(sums.data(), raw.data() + at, sums.size_bytes());
    at += sums.size_bytes();
  };
  for (const AovInfo& info : aov_table()) take(stored.frame.sums(info.id));
  for (const AovInfo& info : aov_table()) take(stored.frame.light_image_sums(info.id));
  return stored;
}

}  // namespace sightline
