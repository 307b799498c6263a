// Style sheet and scripts of the reports, compiled in from src/report/assets/.
#pragma once

#include <string_view>

namespace sightline::assets {

extern const std::string_view report_css;   ///< both reports
extern const std::string_view decode_js;    ///< packed pictures to arrays
extern const std::string_view tone_js;      ///< exposure and tone maps by look-up
extern const std::string_view colormap_js;  ///< false colours of errors
extern const std::string_view viewport_js;  ///< pan, zoom, wipe
extern const std::string_view tables_js;    ///< metrics and statistics
extern const std::string_view compare_js;   ///< wires the compare report together

}  // namespace sightline::assets
