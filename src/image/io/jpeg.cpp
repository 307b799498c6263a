// JPEG through libjpeg-turbo. As in png.cpp, functions that call setjmp have only trivial locals.
#include <cstddef>
#include <cstdio>
// libjpeg's headers need both of the above before them.
#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>
#include <cstdlib>
#include <cstring>

#include "base/core/error.h"
#include "image/io/formats.h"
#include "image/io/image_io.h"

namespace sightline {
namespace {

/// libjpeg's error manager with a place to jump to.
struct ErrorManager {
  jpeg_error_mgr base;
  std::jmp_buf jump;
  char message[JMSG_LENGTH_MAX];
};

[[noreturn]] void on_error(j_common_ptr codec) {
  auto* manager = reinterpret_cast<ErrorManager*>(codec->err);
  codec->err->format_message(codec, manager->message);
  std::longjmp(manager->jump, 1);
}

/// libjpeg fills what is missing with grey and calls it a warning; to us a picture that is cut short or garbled is an error. Odd but
/// harmless things (unknown markers, stray bytes between segments) pass.
void on_message(j_common_ptr codec, int level) {
  if (level >= 0) return;
  switch (codec->err->msg_code) {
    case JWRN_JPEG_EOF:
    case JWRN_HIT_MARKER:
    case JWRN_HUFF_BAD_CODE:
    case JWRN_MUST_RESYNC:
      on_error(codec);
    default:
      break;
  }
}
void print_nothing(j_common_ptr /*codec*/) {}

void set_up(ErrorManager& manager) {
  jpeg_std_error(&manager.base);
  manager.base.error_exit = on_error;
  manager.base.emit_message = on_message;
  manager.base.output_message = print_nothing;
  manager.message[0] = '\0';
}

/// A progressive file may repeat scans over the whole picture as long as it likes, a few bytes each; real ones have about ten.
void limit_scans(j_common_ptr codec) {
  constexpr int most_scans = 100;
  auto* decoder = reinterpret_cast<j_decompress_ptr>(codec);
  if (decoder->input_scan_number > most_scans) ERREXIT(codec, JERR_BAD_PROGRESSION);
}

class Decoder {
 public:
  Decoder() {
    std::memset(&codec_, 0, sizeof(codec_));
    set_up(errors_);
    codec_.err = &errors_.base;
  }
  ~Decoder() { jpeg_destroy_decompress(&codec_); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  bool read_header(std::span<const std::byte> bytes) {
    if (setjmp(errors_.jump)) return false;
    jpeg_create_decompress(&codec_);
    progress_.progress_monitor = limit_scans;
    codec_.progress = &progress_;
    jpeg_mem_src(&codec_, reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<unsigned long>(bytes.size()));
    jpeg_read_header(&codec_, TRUE);
    switch (codec_.jpeg_color_space) {
      case JCS_GRAYSCALE:
        codec_.out_color_space = JCS_GRAYSCALE;
        break;
      case JCS_CMYK:
      case JCS_YCCK:
        codec_.out_color_space = JCS_CMYK;
        break;
      default:
        codec_.out_color_space = JCS_RGB;
        break;
    }
    return true;
  }
  bool start() {
    if (setjmp(errors_.jump)) return false;
    jpeg_start_decompress(&codec_);
    return true;
  }
  bool read_row(std::uint8_t* row) {
    if (setjmp(errors_.jump)) return false;
    JSAMPROW rows[] = {row};
    return jpeg_read_scanlines(&codec_, rows, 1) == 1;
  }
  bool finish() {
    if (setjmp(errors_.jump)) return false;
    return jpeg_finish_decompress(&codec_) != FALSE;
  }

  const char* message() const { return errors_.message[0] ? errors_.message : "the data end too early"; }
  std::int64_t width() const { return codec_.image_width; }
  std::int64_t height() const { return codec_.image_height; }
  int components() const { return codec_.num_components; }
  /// Components a pixel as read: 1, 3, or 4 for inks.
  int output_components() const { return codec_.output_components; }

 private:
  jpeg_decompress_struct codec_;
  jpeg_progress_mgr progress_{};
  ErrorManager errors_;
};

/// CMYK as Adobe's programs write it, which is inverted (255 = no ink), to RGB.
void rgb_from_inverted_inks(const std::uint8_t* inks, std::uint8_t* rgb, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i, inks += 4, rgb += 3) {
    for (int c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint8_t>((inks[c] * inks[3] + 127) / 255);
  }
}

bool encode_rows(jpeg_compress_struct& codec, ErrorManager& errors, int width, int height, const std::uint8_t* rgb, int quality,
                 unsigned char** target, unsigned long* size) {
  if (setjmp(errors.jump)) return false;
  jpeg_create_compress(&codec);
  codec.image_width = static_cast<JDIMENSION>(width);
  codec.image_height = static_cast<JDIMENSION>(height);
  codec.input_components = 3;
  codec.in_color_space = JCS_RGB;
  jpeg_mem_dest(&codec, target, size);
  jpeg_set_defaults(&codec);
  jpeg_set_quality(&codec, quality, TRUE);
  // Full-resolution chroma: coloured shadow borders are what these pictures are looked at for.
  for (int c = 0; c < 3; ++c) codec.comp_info[c].h_samp_factor = codec.comp_info[c].v_samp_factor = 1;
  codec.optimize_coding = TRUE;
  jpeg_start_compress(&codec, TRUE);
  const std::size_t row_bytes = std::size_t{codec.image_width} * 3;
  while (codec.next_scanline < codec.image_height) {
    JSAMPROW row = const_cast<JSAMPROW>(rgb + codec.next_scanline * row_bytes);
    jpeg_write_scanlines(&codec, &row, 1);
  }
  jpeg_finish_compress(&codec);
  return true;
}

}  // namespace

bool looks_like_jpeg(std::span<const std::byte> bytes) {
  return bytes.size() >= 3 && bytes[0] == std::byte{0xff} && bytes[1] == std::byte{0xd8} && bytes[2] == std::byte{0xff};
}

Image parse_jpeg(std::span<const std::byte> bytes) {
  Decoder decoder;
  const auto failure = [&decoder] { return input_error(std::string("damaged JPEG: ") + decoder.message()); };
  if (!decoder.read_header(bytes)) throw failure();
  // A block of 64 values takes two bits at the least in a sequential file, and with halved chroma that is 1 : 512; progressive files can
  // do with half of it.
  constexpr double expansion = 1024;
  check_picture_size(decoder.width(), decoder.height(), static_cast<std::size_t>(decoder.components()), bytes.size(), expansion);
  if (!decoder.start()) throw failure();

  const bool inks = decoder.output_components() == 4;
  const int channels = inks ? 3 : decoder.output_components();
  Image image{static_cast<int>(decoder.width()), static_cast<int>(decoder.height()), channels, {}};
  const std::size_t width = static_cast<std::size_t>(image.width), row_values = width * static_cast<std::size_t>(channels);
  auto& values = image.data.emplace<Image::Bytes>(row_values * static_cast<std::size_t>(image.height));
  std::vector<std::uint8_t> ink_row(inks ? width * 4 : 0);
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    std::uint8_t* row = values.data() + y * row_values;
    if (!decoder.read_row(inks ? ink_row.data() : row)) throw failure().at("row " + std::to_string(y));
    if (inks) rgb_from_inverted_inks(ink_row.data(), row, width);
  }
  if (!decoder.finish()) throw failure();
  return image;
}

std::vector<std::byte> encode_jpeg(int width, int height, std::span<const std::uint8_t> rgb, int quality) {
  if (width <= 0 || height <= 0 || rgb.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3)
    throw usage_error("a JPEG needs width x height pixels of 3 bytes");
  jpeg_compress_struct codec;
  std::memset(&codec, 0, sizeof(codec));
  ErrorManager errors;
  set_up(errors);
  codec.err = &errors.base;
  unsigned char* target = nullptr;
  unsigned long size = 0;
  const bool written = encode_rows(codec, errors, width, height, rgb.data(), quality, &target, &size);
  jpeg_destroy_compress(&codec);
  std::vector<std::byte> out;
  if (written) out.assign(reinterpret_cast<std::byte*>(target), reinterpret_cast<std::byte*>(target) + size);
  std::free(target);
  if (!written) throw usage_error(std::string("the picture cannot be written as JPEG: ") + errors.message);
  return out;
}

}  // namespace sightline
