#include "scene/load/pbrt/reader.h"

#include <algorithm>
#include <system_error>

#include "base/settings/settings.h"
#include "image/io/image_io.h"
#include "scene/load/pbrt/transform.h"

namespace sightline::pbrt {
namespace {

constexpr std::size_t kDeepestInclude = 64;
// Files that include others several times could ask for any amount of work; these are far beyond real scenes.
constexpr std::uint64_t kMostIncludes = 50'000, kMostIncludedBytes = std::uint64_t{1} << 36;
constexpr std::uint64_t kRepeatedIncludeBytes = std::uint64_t{1} << 30;

std::filesystem::path real_path(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::path result = std::filesystem::weakly_canonical(path, error);
  return error ? path : result;
}

}  // namespace

Reader::Reader(Builder& builder, std::optional<std::filesystem::path> directory, const Context& context)
    : builder_(builder), directory_(std::move(directory)), context_(context) {}

void Reader::read_file(const std::filesystem::path& path) {
  if (path.extension() == ".gz") throw input_error("compressed pbrt files are not supported").at(path.string()).remedy("unpack it first");
  const std::vector<std::byte> bytes = sightline::read_file(path);
  open_files_.push_back(real_path(path));
  read_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path.string());
  open_files_.pop_back();
}

void Reader::read_text(std::string_view text, const std::string& name) {
  Tokenizer tokens(text, name);
  read(tokens);
  end_ = tokens.here();
}

void Reader::read(Tokenizer& tokens) {
  constexpr std::size_t kCancelInterval = 1024;
  for (std::size_t count = 0;; ++count) {
    if (count % kCancelInterval == 0) context_.check_cancelled();
    const Token token = tokens.next();
    if (token.kind == Token::Kind::end) return;
    const Place place = tokens.place(token);
    if (token.kind != Token::Kind::word) {
      throw error_at(place, fmt::format("a directive is expected, not '{}'", shown(token.text)));
    }
    const std::span<const Directive> known = directives();
    const auto found = std::lower_bound(known.begin(), known.end(), token.text,
                                        [](const Directive& directive, std::string_view name) { return directive.name < name; });
    if (found == known.end() || found->name != token.text) {
      std::vector<std::string> names;
      for (const Directive& directive : known) names.emplace_back(directive.name);
      const std::string nearest = nearest_name(shown(token.text), names);
      Error error = error_at(place, fmt::format("unknown directive '{}'", shown(token.text)));
      if (!nearest.empty()) error.remedy(fmt::format("did you mean '{}'?", nearest));
      throw error;
    }
    (this->*found->handle)(tokens, place);
  }
}

void Reader::finish() {
  if (!saved_.empty()) {
    constexpr std::string_view kNames[] = {"AttributeBegin", "TransformBegin", "ObjectBegin"};
    throw error_at(saved_.back().place, fmt::format("this {} is never closed", kNames[static_cast<int>(saved_.back().opener)]));
  }
  if (!in_world_) throw error_at(end_, "the file ends before WorldBegin");
}

std::string Reader::read_string(Tokenizer& tokens, std::string_view what) {
  const Token token = tokens.next();
  if (token.kind == Token::Kind::string) return std::string(token.text);
  throw error_at(tokens.place(token),
                 fmt::format("{} in quotes is expected{}", what,
                             token.kind == Token::Kind::end ? " where the file ends" : ", not '" + shown(token.text) + "'"));
}

std::vector<double> Reader::read_numbers(Tokenizer& tokens, std::size_t count) {
  std::vector<double> numbers;
  const bool bracketed = tokens.peek().kind == Token::Kind::open_bracket;
  if (bracketed) tokens.next();
  while (numbers.size() < count) {
    const Token token = tokens.next();
    numbers.push_back(parse_number(tokens, token));
  }
  if (bracketed) {
    const Token token = tokens.next();
    if (token.kind != Token::Kind::close_bracket)
      throw error_at(tokens.place(token), fmt::format("']' is expected after {} numbers", count));
  }
  return numbers;
}

ParameterList Reader::read_parameters(Tokenizer& tokens, const Place& place, std::string_view defaults) {
  bool old_types = false;
  ParameterList parameters = ParameterList::parse(tokens, &old_types);
  if (old_types) builder_.warn_once(place, "this is pbrt-v3's language; it is read as pbrt-v4 as far as the two agree");
  if (!defaults.empty() && state_.defaults) {
    if (const auto found = state_.defaults->find(defaults); found != state_.defaults->end()) parameters.add_defaults(found->second);
  }
  return parameters;
}

void Reader::set_transform(const Mat4d& m, const Place& place) {
  if (!is_finite_transform(m)) throw error_at(place, "the transformation is not finite");
  // Of moving transformations the state at the shutter's opening counts.
  if (state_.transforms_at_start) state_.world_from_object = m;
}

void Reader::transform(const Mat4d& m, const Place& place) { set_transform(state_.world_from_object * m, place); }

void Reader::push(Saved::Opener opener, const Place& place) { saved_.push_back({state_, opener, place}); }

void Reader::pop(Saved::Opener opener, const Place& place) {
  constexpr std::string_view kNames[] = {"Attribute", "Transform", "Object"};
  const auto name = [&](Saved::Opener o) { return kNames[static_cast<int>(o)]; };
  if (saved_.empty()) throw error_at(place, fmt::format("{}End without {}Begin", name(opener), name(opener)));
  if (saved_.back().opener != opener) {
    throw error_at(place,
                   fmt::format("{}End closes the {}Begin of {}", name(opener), name(saved_.back().opener), saved_.back().place.text()));
  }
  state_ = std::move(saved_.back().state);
  saved_.pop_back();
}

void Reader::require_world(std::string_view what, const Place& place) const {
  if (!in_world_) throw error_at(place, fmt::format("{} before WorldBegin", what));
}

bool Reader::before_world(std::string_view what, const Place& place) {
  if (in_world_) builder_.warn(place, fmt::format("{} after WorldBegin has no effect", what));
  return !in_world_;
}

void Reader::include(Tokenizer& tokens, const Place& place) {
  const std::string name = read_string(tokens, "the name of a file");
  if (!directory_) throw error_at(place, fmt::format("'{}' is not included: other files are out of reach", shown(name)));
  // pbrt looks beside the main file; beside the including one is the other sensible reading.
  std::error_code error;
  std::filesystem::path path = builder_.resolve(name);
  if (!std::filesystem::is_regular_file(path, error) && !open_files_.empty()) {
    const std::filesystem::path beside = open_files_.back().parent_path() / name;
    if (std::filesystem::is_regular_file(beside, error)) path = beside;
  }
  if (!std::filesystem::is_regular_file(path, error))
    throw error_at(place, fmt::format("the included file '{}' is not there", shown(name)));
  if (std::find(open_files_.begin(), open_files_.end(), real_path(path)) != open_files_.end()) {
    throw error_at(place, fmt::format("'{}' includes itself", shown(name)));
  }
  if (open_files_.size() > kDeepestInclude) throw error_at(place, fmt::format("files are included more than {} deep", kDeepestInclude));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::uint64_t& repeated = bytes_included_[real_path(path).string()];
  repeated += error ? 0 : size;
  included_bytes_ += error ? 0 : size;
  const bool is_repeated_too_often = repeated > size && repeated > kRepeatedIncludeBytes;
  if (++includes_ > kMostIncludes || included_bytes_ > kMostIncludedBytes || is_repeated_too_often) {
    throw error_at(place, "far too much is included").remedy("look for files that include others again and again");
  }
  const Place end = end_;
  read_file(path);
  end_ = end;
}

}  // namespace sightline::pbrt
