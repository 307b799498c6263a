#include <span>

#include "commands.h"
#include "image/io/image_io.h"

namespace sightline::app {

void write_text(const std::string& path, const std::string& text) { write_file(path, std::as_bytes(std::span(text.data(), text.size()))); }

}  // namespace sightline::app
