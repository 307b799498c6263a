// Which parts of a suite are measured over which views.
#pragma once

#include <string>
#include <vector>

namespace sightline {

/// A part of a suite with the views it takes by itself.
struct BenchPart {
  std::string name;
  std::vector<std::string> views;
};
std::vector<std::string> part_names(const std::vector<BenchPart>& parts);

/// What is to be done, views outermost: each is loaded and built once.
class BenchPlan {
 public:
  /// `wanted` and `views` are what the user asks for; empty is everything. Throws Error{usage} for unknown names.
  BenchPlan(const std::vector<BenchPart>& parts, const std::vector<std::string>& wanted, const std::vector<std::string>& views);

  const std::vector<std::string>& views() const { return views_; }
  bool has(const std::string& part, const std::string& view) const;
  /// An option that none of the parts reads is a mistake: throws Error{usage} if it is given and no reader is wanted.
  void check_read(const char* option, bool given, const std::vector<std::string>& readers) const;

 private:
  bool wanted(const std::string& part) const;

  std::vector<BenchPart> parts_;
  std::vector<std::string> wanted_, views_;
  bool views_given_ = false;
};

}  // namespace sightline
