// Text for HTML pages: escaping, base64, data URIs.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace sightline {

/// The text with & < > " ' as entities: safe between tags and inside quoted attributes.
std::string escape_html(std::string_view text);
/// JSON text made safe inside <script>: "</" and "<!--" cannot occur in it any more, and its meaning stays.
std::string escape_script(std::string_view json);
std::string base64(std::span<const std::byte> bytes);
/// "data:TYPE;base64,...".
std::string data_uri(std::string_view media_type, std::span<const std::byte> bytes);
/// The start of a page up to <body>: title, character set, dark colour scheme, a policy that forbids any network access, the style sheet.
std::string page_head(std::string_view title);

}  // namespace sightline
