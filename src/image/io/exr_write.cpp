// EXR through OpenEXR's C++ interface, into memory.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <set>
#include <string>

#include "base/core/error.h"
#include "image/io/image_io.h"

namespace sightline {
namespace {

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : OStream("memory") {}

  void write(const char source[], int count) override {
    const std::size_t end = position_ + static_cast<std::size_t>(count);
    if (end > bytes.size()) bytes.resize(end);
    std::memcpy(bytes.data() + position_, source, static_cast<std::size_t>(count));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = static_cast<std::size_t>(position); }

  std::vector<std::byte> bytes;

 private:
  std::size_t position_ = 0;
};

Imf::Compression openexr_compression(ExrCompression compression) {
  switch (compression) {
    case ExrCompression::none:
      return Imf::NO_COMPRESSION;
    case ExrCompression::rle:
      return Imf::RLE_COMPRESSION;
    case ExrCompression::zip:
      return Imf::ZIP_COMPRESSION;
    case ExrCompression::piz:
      return Imf::PIZ_COMPRESSION;
    case ExrCompression::dwab:
      return Imf::DWAB_COMPRESSION;
  }
  return Imf::ZIP_COMPRESSION;
}

Imf::Header make_header(const LayeredImage& image, const ExrOptions& options) {
  Imf::Header header(image.width, image.height);
  header.compression() = openexr_compression(options.compression);
  // OpenEXR's default chromaticities are those of Rec.709 with white point D65; written out, so that no reader has to guess.
  Imf::addChromaticities(header, Imf::Chromaticities());
  for (const auto& [key, value] : image.metadata) {
    const auto existing = header.find(key.c_str());
    const bool text = existing == header.end() || std::string_view(existing.attribute().typeName()) == "string";
    if (key.empty() || key.size() > 255 || !text) throw usage_error("'" + key + "' cannot be a text attribute of an EXR header");
    header.insert(key, Imf::StringAttribute(value));
  }
  return header;
}

/// Float to half as the file will hold it; values beyond the largest half stay finite, since one firefly must not become infinite.
std::vector<half> to_halves(const std::vector<float>& values) {
  std::vector<half> halves;
  halves.reserve(values.size());
  for (const float value : values) {
    const float largest = HALF_MAX;
    halves.emplace_back(std::isfinite(value) ? std::clamp(value, -largest, largest) : value);
  }
  return halves;
}

}  // namespace

std::vector<std::byte> encode_exr(const LayeredImage& image, const ExrOptions& options) {
  if (image.width <= 0 || image.height <= 0 || image.channels.empty()) throw usage_error("an empty picture cannot be written as EXR");
  const std::size_t width = static_cast<std::size_t>(image.width), pixels = width * static_cast<std::size_t>(image.height);
  try {
    Imf::Header header = make_header(image, options);
    Imf::FrameBuffer source;
    std::set<std::string_view> names;
    std::vector<std::vector<half>> halves;
    for (const Channel& channel : image.channels) {
      if (channel.values.size() != pixels) throw usage_error("channel '" + channel.name + "' does not have one value a pixel");
      if (channel.name.empty() || channel.name.size() > 255 || !names.insert(channel.name).second)
        throw usage_error("'" + channel.name + "' is no channel name, or stands twice");
      header.channels().insert(channel.name, Imf::Channel(channel.half ? Imf::HALF : Imf::FLOAT));
      if (channel.half) halves.push_back(to_halves(channel.values));
      // OpenEXR takes non-const addresses for writing, too.
      char* base =
          channel.half ? reinterpret_cast<char*>(halves.back().data()) : reinterpret_cast<char*>(const_cast<float*>(channel.values.data()));
      const std::size_t value_bytes = channel.half ? sizeof(half) : sizeof(float);
      source.insert(channel.name, Imf::Slice(channel.half ? Imf::HALF : Imf::FLOAT, base, value_bytes, value_bytes * width));
    }
    MemoryOutput stream;
    {
      Imf::OutputFile file(stream, header, 0);
      file.setFrameBuffer(source);
      file.writePixels(image.height);
    }
    return std::move(stream.bytes);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw resource_error("not enough memory to encode an EXR picture");
  } catch (const std::exception& error) {
    throw usage_error(std::string("the picture cannot be written as EXR: ") + error.what());
  }
}

}  // namespace sightline
