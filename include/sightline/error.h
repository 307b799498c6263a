// The one exception type that leaves Sightline's library code.
#pragma once

#include <exception>
#include <string>
#include <string_view>
#include <utility>

namespace sightline {

/// What kind of failure an Error is. The command line maps each to its exit code (docs/cli.md).
enum class ErrorCode {
  bug,          ///< an invariant of ours does not hold
  usage,        ///< wrong option, unknown name, argument out of range
  input,        ///< a file is unreadable or malformed
  resource,     ///< memory limit, disk full, no such device
  interrupted,  ///< cancelled by the user or a time limit
};

/// A failure: what was being done, what is wrong, where, and what would mend it. Rendered by what() as one line
/// "place: message (while doing; remedy)". Immutable but for the context that is added while it propagates.
class Error : public std::exception {
 public:
  Error(ErrorCode code, std::string message);

  /// Sets the place: a file, "file:line:column", a byte offset, a JSON path. The innermost place wins; later ones are prefixed.
  Error& at(std::string_view place);
  /// Adds what was being done ("reading material 'wood'"); the outermost comes first in the message.
  Error& during(std::string_view action);
  /// Sets what the user can do about it.
  Error& remedy(std::string_view advice);

  ErrorCode code() const { return code_; }
  const std::string& message() const { return message_; }
  const std::string& place() const { return place_; }
  const char* what() const noexcept override { return rendered_.c_str(); }

 private:
  void render();

  ErrorCode code_;
  std::string message_, place_, action_, advice_, rendered_;
};

inline Error input_error(std::string message) { return {ErrorCode::input, std::move(message)}; }
inline Error usage_error(std::string message) { return {ErrorCode::usage, std::move(message)}; }
inline Error resource_error(std::string message) { return {ErrorCode::resource, std::move(message)}; }

}  // namespace sightline
