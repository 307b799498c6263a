// Measured figures beside what they are meant to be.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sightline {

/// Collects aims as rows of JSON; what was not measured (no number) is left out.
class BenchAims {
 public:
  enum class Shown { number, percent };

  void at_most(const std::string& figure, const nlohmann::ordered_json& measured, double aim, Shown shown = Shown::number);
  void at_least(const std::string& figure, const nlohmann::ordered_json& measured, double aim, Shown shown = Shown::number);
  nlohmann::ordered_json take() { return std::move(rows_); }

 private:
  void add(const std::string& figure, const nlohmann::ordered_json& measured, double aim, bool at_most, Shown shown);

  nlohmann::ordered_json rows_ = nlohmann::ordered_json::array();
};

}  // namespace sightline
