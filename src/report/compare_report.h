// The comparison of pictures as one self-contained HTML page.
#pragma once

#include <string>
#include <vector>

#include "image/image.h"

namespace sightline {

/// One cell of the metrics table.
struct ReportMetric {
  std::string name;
  double value = 0;
  bool larger_is_better = false;
  std::string formula;  ///< one line, shown as a tooltip; may be empty
};

/// One picture of the report.
struct ReportImage {
  std::string name;  ///< shown; usually the file name
  ColorImage image;
  std::vector<ReportMetric> metrics;  ///< against the reference; empty for the reference itself
  std::string statistics_json;        ///< what --stats wrote for it, or empty
};

struct ReportInput {
  std::string title = "Comparison";
  ReportImage reference;
  std::vector<ReportImage> images;
  std::vector<std::string> notes;  ///< sentences below the tables: mask in use, exposure of the metrics, warnings
  std::string command;             ///< the command line that made the report, or empty
};

/// A page that needs no network: pictures side by side with a wipe, exposure, tone maps, false-colour errors, tables of metrics and
/// statistics. All pictures have the reference's size; Error{input} names one that has not. The page checks itself when it is opened and
/// says so in the attribute data-self-check of its root element: "ok", or what failed.
std::string compare_report(const ReportInput& input);

}  // namespace sightline
