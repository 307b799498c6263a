// PNG through libpng. Its errors come as a longjmp, which must not skip destructors: each function that calls setjmp here has only
// trivial locals, and a message travels in the `Failure` that libpng carries along.
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include "base/core/error.h"
#include "image/io/formats.h"
#include "image/io/image_io.h"

namespace sightline {
namespace {

struct Failure {
  char message[200] = "";
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* failure = static_cast<Failure*>(png_get_error_ptr(png));
  std::snprintf(failure->message, sizeof(failure->message), "%s", message);
  png_longjmp(png, 1);
}
void on_warning(png_structp /*png*/, png_const_charp /*message*/) {}

struct Source {
  const std::byte* bytes = nullptr;
  std::size_t size = 0, position = 0;
};

void read_bytes(png_structp png, png_bytep target, png_size_t count) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (count > source->size - source->position) png_error(png, "the file ends too early");
  std::memcpy(target, source->bytes + source->position, count);
  source->position += count;
}

/// libpng's two structures for reading, released at the end of the scope.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : source_{bytes.data(), bytes.size(), 0} {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure_, on_error, on_warning);
    info_ = png_ ? png_create_info_struct(png_) : nullptr;
  }
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// Reads the header and asks for 8 or 16 bits a channel, and 1, 3 or 4 channels.
  bool start() {
    if (!info_) return false;
    if (setjmp(png_jmpbuf(png_))) return false;
    png_set_read_fn(png_, &source_, read_bytes);
    // Texts, profiles and the like are skipped: they are no business of a picture's pixels, and compressed ones can be bombs.
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, kSkipped, sizeof(kSkipped) / 5);
    png_set_user_limits(png_, 1 << 20, 1 << 20);
    png_read_info(png_, info_);
    const int color_type = png_get_color_type(png_, info_);
    has_transparency_ = png_get_valid(png_, info_, PNG_INFO_tRNS) != 0;
    if (color_type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png_);
    if (color_type == PNG_COLOR_TYPE_GRAY && png_get_bit_depth(png_, info_) < 8) png_set_expand_gray_1_2_4_to_8(png_);
    if (has_transparency_) png_set_tRNS_to_alpha(png_);
    const bool alpha = has_transparency_ || (color_type & PNG_COLOR_MASK_ALPHA) != 0;
    if ((color_type & PNG_COLOR_MASK_COLOR) == 0 && alpha) png_set_gray_to_rgb(png_);
    if (std::endian::native == std::endian::little) png_set_swap(png_);
    width_ = png_get_image_width(png_, info_);
    height_ = png_get_image_height(png_, info_);
    stored_bits_ = png_get_bit_depth(png_, info_) * png_get_channels(png_, info_);
    return true;
  }
  /// After the caller has found the size plausible: settles the layout of rows.
  bool prepare() {
    if (setjmp(png_jmpbuf(png_))) return false;
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    channels_ = png_get_channels(png_, info_);
    bits_ = png_get_bit_depth(png_, info_);
    row_bytes_ = png_get_rowbytes(png_, info_);
    return true;
  }
  bool read(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_))) return false;
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  std::size_t position() const { return source_.position; }
  const char* message() const { return failure_.message[0] ? failure_.message : "libpng cannot be started"; }
  std::int64_t width() const { return width_; }
  std::int64_t height() const { return height_; }
  int stored_bits() const { return stored_bits_; }
  int channels() const { return channels_; }
  int bits() const { return bits_; }
  std::size_t row_bytes() const { return row_bytes_; }

 private:
  static constexpr png_byte kSkipped[] = "iCCP\0zTXt\0iTXt\0tEXt\0sPLT\0eXIf\0hIST";

  Failure failure_;
  Source source_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  bool has_transparency_ = false;
  std::uint32_t width_ = 0, height_ = 0;
  int stored_bits_ = 0, channels_ = 0, bits_ = 0;
  std::size_t row_bytes_ = 0;
};

void append_bytes(png_structp png, png_bytep source, png_size_t count) {
  auto* out = static_cast<std::vector<std::byte>*>(png_get_io_ptr(png));
  const auto* bytes = reinterpret_cast<const std::byte*>(source);
  // An exception must not pass through libpng.
  try {
    out->insert(out->end(), bytes, bytes + count);
  } catch (const std::exception&) {
    png_error(png, "not enough memory");
  }
}
void flush_nothing(png_structp /*png*/) {}

struct Layout {
  std::uint32_t width, height;
  int channels;
};

bool write_png(png_structp png, png_infop info, Layout layout, const std::uint8_t* pixels, std::vector<std::byte>* out) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_write_fn(png, out, append_bytes, flush_nothing);
  png_set_user_limits(png, 1 << 20, 1 << 20);
  png_set_IHDR(png, info, layout.width, layout.height, 8, layout.channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  const std::size_t row_bytes = std::size_t{layout.width} * static_cast<std::size_t>(layout.channels);
  for (std::uint32_t y = 0; y < layout.height; ++y) png_write_row(png, pixels + y * row_bytes);
  png_write_end(png, info);
  return true;
}

}  // namespace

bool looks_like_png(std::span<const std::byte> bytes) {
  return bytes.size() >= 8 && png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, 8) == 0;
}

Image parse_png(std::span<const std::byte> bytes) {
  Reader reader(bytes);
  const auto failure = [&reader] {
    return input_error(std::string("damaged PNG: ") + reader.message()).at("byte " + std::to_string(reader.position()));
  };
  if (!reader.start()) throw failure();
  // Rows in the file take this many bytes; what small depths and palettes become in memory is at most 32 times as much.
  check_picture_size((reader.width() * reader.stored_bits() + 7) / 8, reader.height(), 1, bytes.size(), kDeflateExpansion);
  check_picture_size(reader.width(), reader.height(), 0, bytes.size(), 1);
  if (!reader.prepare()) throw failure();

  Image image{static_cast<int>(reader.width()), static_cast<int>(reader.height()), reader.channels(), {}};
  const std::size_t values = image.pixel_count() * static_cast<std::size_t>(image.channels);
  std::uint8_t* first = nullptr;
  if (reader.bits() == 16) {
    first = reinterpret_cast<std::uint8_t*>(image.data.emplace<Image::Words>(values).data());
  } else {
    first = image.data.emplace<Image::Bytes>(values).data();
  }
  if (reader.row_bytes() * static_cast<std::size_t>(image.height) != image.size_bytes())
    throw input_error("the PNG has an unexpected layout");
  std::vector<png_bytep> rows;
  rows.reserve(static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) rows.push_back(first + static_cast<std::size_t>(y) * reader.row_bytes());
  if (!reader.read(rows.data())) throw failure();
  return image;
}

std::vector<std::byte> encode_png(int width, int height, int channels, std::span<const std::uint8_t> pixels) {
  if (width <= 0 || height <= 0 || (channels != 3 && channels != 4) ||
      pixels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels))
    throw usage_error("a PNG needs width x height pixels of 3 or 4 bytes");
  Failure failure;
  std::vector<std::byte> out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  const Layout layout{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), channels};
  const bool written = info && write_png(png, info, layout, pixels.data(), &out);
  png_destroy_write_struct(&png, &info);
  if (!written) throw resource_error(std::string("the picture cannot be written as PNG: ") + failure.message);
  return out;
}

}  // namespace sightline
