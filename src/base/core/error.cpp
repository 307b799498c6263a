#include "base/core/error.h"

#include <utility>

namespace sightline {

Error::Error(ErrorCode code, std::string message) : code_(code), message_(std::move(message)) { render(); }

Error& Error::at(std::string_view place) {
  place_ = place_.empty() ? std::string(place) : std::string(place) + ": " + place_;
  render();
  return *this;
}

Error& Error::during(std::string_view action) {
  action_ = action_.empty() ? std::string(action) : std::string(action) + ", " + action_;
  render();
  return *this;
}

Error& Error::remedy(std::string_view advice) {
  advice_ = advice;
  render();
  return *this;
}

void Error::render() {
  rendered_ = place_.empty() ? message_ : place_ + ": " + message_;
  if (!action_.empty()) rendered_ += " (while " + action_ + ")";
  if (!advice_.empty()) rendered_ += "; " + advice_;
  // One failure is one line, whatever a foreign library or file name put into the text.
  for (char& c : rendered_) {
    if (c == '\n' || c == '\r') c = ' ';
  }
}

}  // namespace sightline
