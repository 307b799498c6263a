// EXR through OpenEXR's C++ interface, from memory.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>

#include "base/core/error.h"
#include "image/io/exr_header.h"
#include "image/io/formats.h"

namespace sightline {
namespace {

/// What OpenEXR reads from. It wants exceptions at the end of the data; they do not leave parse_exr_layers().
class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(std::span<const std::byte> bytes) : IStream("memory"), bytes_(bytes) {}

  bool isMemoryMapped() const override { return true; }
  bool read(char target[], int count) override {
    std::memcpy(target, take(count), static_cast<std::size_t>(count));
    return position_ < bytes_.size();
  }
  char* readMemoryMapped(int count) override { return const_cast<char*>(take(count)); }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override {
    if (position > bytes_.size()) throw std::runtime_error("an offset leaves the file");
    position_ = static_cast<std::size_t>(position);
  }

 private:
  const char* take(int count) {
    if (count < 0 || static_cast<std::size_t>(count) > bytes_.size() - position_) throw std::runtime_error("the file ends too early");
    const char* result = reinterpret_cast<const char*>(bytes_.data()) + position_;
    position_ += static_cast<std::size_t>(count);
    return result;
  }

  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

/// Rows read with one call: whole chunks, a few at a time, so that a damaged file fails before memory for all of it is taken.
int band_height(const ExrPartHeader& part) {
  const std::int64_t chunk = part.tile_height > 0 ? part.tile_height : exr_rows_per_chunk(part.compression);
  constexpr std::int64_t wanted = 64;
  return static_cast<int>(std::min(part.height(), (wanted + chunk - 1) / chunk * chunk));
}

void read_pixels(Imf::InputPart& input, const ExrPartHeader& part, LayeredImage& image) {
  const auto width = static_cast<std::size_t>(image.width);
  const int band = band_height(part);
  std::vector<std::vector<float>> rows(image.channels.size(), std::vector<float>(width * static_cast<std::size_t>(band)));
  for (int y = 0; y < image.height; y += band) {
    const int count = std::min(band, image.height - y);
    Imf::FrameBuffer target;
    for (std::size_t c = 0; c < rows.size(); ++c) {
      // A slice's address is that of pixel (0, 0), wherever the data window lies; computed as an integer, since it may be far outside.
      const std::size_t row_bytes = width * sizeof(float);
      const std::int64_t origin =
          (part.y_min + y) * static_cast<std::int64_t>(row_bytes) + part.x_min * static_cast<std::int64_t>(sizeof(float));
      const std::uintptr_t address = reinterpret_cast<std::uintptr_t>(rows[c].data()) - static_cast<std::uintptr_t>(origin);
      // NOLINTNEXTLINE(performance-no-int-to-ptr): a pointer may not leave its array, an integer may.
      char* base = reinterpret_cast<char*>(address);
      target.insert(image.channels[c].name, Imf::Slice(Imf::FLOAT, base, sizeof(float), row_bytes));
    }
    input.setFrameBuffer(target);
    const int first = static_cast<int>(part.y_min) + y;
    input.readPixels(first, first + count - 1);
    for (std::size_t c = 0; c < rows.size(); ++c) {
      const auto end = rows[c].begin() + static_cast<std::ptrdiff_t>(width * static_cast<std::size_t>(count));
      image.channels[c].values.insert(image.channels[c].values.end(), rows[c].begin(), end);
    }
  }
}

LayeredImage read_first_part(std::span<const std::byte> bytes, const ExrPartHeader& part) {
  MemoryInput stream(bytes);
  // No threads of OpenEXR's own, and no search through a file whose table of chunks was never written.
  Imf::MultiPartInputFile file(stream, 0, false);
  Imf::InputPart input(file, 0);
  const Imf::Header& header = input.header();
  const Imath::Box2i window = header.dataWindow();
  if (window.min.x != part.x_min || window.min.y != part.y_min || window.max.x != part.x_max || window.max.y != part.y_max)
    throw input_error("the data window is ambiguous");

  LayeredImage image{static_cast<int>(part.width()), static_cast<int>(part.height()), {}, {}};
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel)
    image.channels.push_back({channel.name(), channel.channel().type == Imf::HALF, {}});
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute()))
      image.metadata.emplace_back(attribute.name(), text->value());
  }
  read_pixels(input, part, image);
  return image;
}

}  // namespace

LayeredImage parse_exr_layers(std::span<const std::byte> bytes) {
  const ExrPartHeader part = check_exr_headers(bytes).front();
  if (part.deep) throw input_error("deep pictures are not read").remedy("flatten it first");
  if (part.subsampled)
    throw input_error("pictures with subsampled channels are not read").remedy("store it as R, G, B or Y at full resolution");
  try {
    return read_first_part(bytes, part);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw input_error(std::string("damaged EXR data: ") + error.what());
  }
}

}  // namespace sightline
