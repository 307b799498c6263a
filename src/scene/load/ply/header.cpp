#include "scene/load/ply/header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <optional>

namespace sightline::ply {
namespace {

/// No sane header is longer; it bounds what a file without line ends makes us read.
constexpr std::size_t kMaxLineBytes = 64 * 1024;
constexpr std::size_t kMaxElements = 1024, kMaxProperties = 4096;

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t begin = line.find_first_not_of(" \t\r", i);
    if (begin == std::string_view::npos) break;
    i = std::min(line.find_first_of(" \t\r", begin), line.size());
    words.push_back(line.substr(begin, i - begin));
  }
  return words;
}

std::optional<ScalarType> scalar_type(std::string_view word) {
  struct Name {
    std::string_view word;
    ScalarType type;
  };
  static constexpr std::array<Name, 16> kNames{{{"char", ScalarType::int8},
                                                {"int8", ScalarType::int8},
                                                {"uchar", ScalarType::uint8},
                                                {"uint8", ScalarType::uint8},
                                                {"short", ScalarType::int16},
                                                {"int16", ScalarType::int16},
                                                {"ushort", ScalarType::uint16},
                                                {"uint16", ScalarType::uint16},
                                                {"int", ScalarType::int32},
                                                {"int32", ScalarType::int32},
                                                {"uint", ScalarType::uint32},
                                                {"uint32", ScalarType::uint32},
                                                {"float", ScalarType::float32},
                                                {"float32", ScalarType::float32},
                                                {"double", ScalarType::float64},
                                                {"float64", ScalarType::float64}}};
  for (const Name& name : kNames) {
    if (name.word == word) return name.type;
  }
  return std::nullopt;
}

/// One line without its end; the stream moves behind it.
std::string read_line(ByteStream& stream) {
  stream.ensure(kMaxLineBytes);
  const std::size_t length = std::min(stream.available(), kMaxLineBytes);
  const void* newline = length ? std::memchr(stream.cursor(), '\n', length) : nullptr;
  if (!newline) throw input_error(length < kMaxLineBytes ? "the file ends inside the header" : "a header line is absurdly long");
  const char* end = static_cast<const char*>(newline);
  std::string line(stream.cursor(), end);
  stream.set_cursor(end + 1);
  return line;
}

ScalarType require_type(std::string_view word) {
  const auto type = scalar_type(word);
  if (!type) throw input_error(fmt::format("unknown type '{}'", word));
  return *type;
}

Property parse_property(const std::vector<std::string_view>& words) {
  Property property;
  property.is_list = words.size() > 1 && words[1] == "list";
  const std::size_t expected = property.is_list ? 5 : 3;
  if (words.size() != expected) throw input_error(fmt::format("a property line has {} words instead of {}", words.size(), expected));
  property.type = require_type(words[expected - 2]);
  property.name = words[expected - 1];
  if (property.is_list) {
    property.count_type = require_type(words[2]);
    if (!is_integral(property.count_type)) throw input_error(fmt::format("the length of list '{}' is not an integer", property.name));
  }
  return property;
}

Element parse_element(const std::vector<std::string_view>& words) {
  if (words.size() != 3) throw input_error("an element line needs a name and a count");
  Element element{.name = std::string(words[1]), .count = 0, .properties = {}};
  const auto [end, failure] = std::from_chars(words[2].data(), words[2].data() + words[2].size(), element.count);
  if (failure != std::errc{} || end != words[2].data() + words[2].size()) {
    throw input_error(fmt::format("'{}' is not a count of elements", words[2]));
  }
  return element;
}

void parse_format(Header& header, const std::vector<std::string_view>& words) {
  if (words.size() != 3) throw input_error("a format line needs an encoding and a version");
  if (words[1] == "ascii") {
    header.encoding = Encoding::ascii;
  } else if (words[1] == "binary_little_endian") {
    header.encoding = Encoding::binary_little_endian;
  } else if (words[1] == "binary_big_endian") {
    header.encoding = Encoding::binary_big_endian;
  } else {
    throw input_error(fmt::format("unknown encoding '{}'", words[1]));
  }
  if (words[2] != "1.0") throw input_error(fmt::format("unknown version '{}'", words[2]));
}

/// True at end_header.
bool parse_line(Header& header, const std::vector<std::string_view>& words, bool& has_format) {
  if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return false;
  if (words[0] == "format") {
    if (has_format) throw input_error("a second format line");
    parse_format(header, words);
    has_format = true;
    return false;
  }
  if (!has_format) throw input_error(fmt::format("'{}' before the format line", words[0]));
  if (words[0] == "end_header") return true;
  if (words[0] == "element") {
    if (header.elements.size() >= kMaxElements) throw input_error("too many elements");
    header.elements.push_back(parse_element(words));
  } else if (words[0] == "property") {
    if (header.elements.empty()) throw input_error("a property before any element");
    if (header.elements.back().properties.size() >= kMaxProperties) throw input_error("too many properties");
    header.elements.back().properties.push_back(parse_property(words));
  } else {
    throw input_error(fmt::format("unknown header word '{}'", words[0]));
  }
  return false;
}

}  // namespace

std::size_t scalar_size(ScalarType type) {
  static constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool Element::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const Property& p) { return p.is_list; });
}

std::uint64_t Element::least_bytes(Encoding encoding) const {
  // A value of an ascii file takes a digit and a separator; a list at least its length.
  std::uint64_t bytes = 0;
  for (const Property& p : properties) bytes += encoding == Encoding::ascii ? 2 : scalar_size(p.is_list ? p.count_type : p.type);
  return bytes;
}

int Element::find(std::initializer_list<std::string_view> names) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    for (const std::string_view wanted : names) {
      if (properties[i].name == wanted) return static_cast<int>(i);
    }
  }
  return -1;
}

Header read_header(ByteStream& stream) {
  Header header;
  std::uint64_t line = 0;
  try {
    bool has_format = false;
    ++line;
    stream.ensure(4);
    if (stream.available() < 3 || std::memcmp(stream.cursor(), "ply", 3) != 0) throw input_error("the file does not begin with 'ply'");
    if (split(read_line(stream)) != std::vector<std::string_view>{"ply"}) throw input_error("the file does not begin with a line 'ply'");
    for (bool done = false; !done;) {
      ++line;
      const std::string text = read_line(stream);
      done = parse_line(header, split(text), has_format);
    }
  } catch (Error& error) {
    throw error.at(fmt::format("{}:{}", stream.name(), line)).during("reading the PLY header");
  }
  header.body_offset = stream.offset();
  return header;
}

}  // namespace sightline::ply
