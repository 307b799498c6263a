// fit_ltc: writes src/shade/analytic/ltc_table.cpp to the standard output and a table of fit errors to the standard error.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "fit_ltc/diffuse_fit.h"
#include "fit_ltc/lobe_fit.h"
#include "shade/analytic/ltc_table.h"

namespace {

using namespace sightline;
using namespace sightline::fit;
using namespace sightline::ltc_table;

constexpr int kEnergyResolution = 320;

using Node = std::array<double, kLobeColumns>;
using Row = std::array<Node, kCosCount>;

Node node_of(double cosine, double alpha, const InverseTransform& m, const std::array<double, 3>& energies) {
  const double sine = std::sqrt(std::max(1e-12, 1 - cosine * cosine));
  return {m.m11 - cosine * cosine,
          m.m13 / sine - cosine,
          m.m31 / (sine * alpha) + 2 * cosine,
          m.m33 / alpha - 2 * cosine * cosine,
          energies[0],
          energies[1],
          energies[2]};
}
InverseTransform transform_of(double cosine, double alpha, const Node& node) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return {node[kM11] + cosine * cosine, (node[kM13OverSine] + cosine) * sine, (node[kM31OverSineAlpha] - 2 * cosine) * sine * alpha,
          (node[kM33OverAlpha] + 2 * cosine * cosine) * alpha};
}

/// Limits for alpha -> 0, of a mirror.
Row mirror_row() {
  Row row;
  for (int j = 0; j < kCosCount; ++j) {
    const double c = cos_at(j), fifth = std::pow(1 - c, 5);
    row[static_cast<std::size_t>(j)] = {0, 0, 0, 0, 1, fifth, c * fifth * (1 - c)};
  }
  return row;
}

/// Nothing to divide at normal incidence: the neighbours continue.
void extrapolate_last(Row& row) {
  for (const auto k : {static_cast<std::size_t>(kM13OverSine), static_cast<std::size_t>(kM31OverSineAlpha)})
    row[kCosCount - 1][k] = 2 * row[kCosCount - 2][k] - row[kCosCount - 3][k];
}

struct Errors {
  double mean = 0, below_60 = 0, below_80 = 0, worst = 0;
  void add(double cosine, double weight, double error) {
    mean += weight * error;
    if (cosine > 0.5) below_60 = std::max(below_60, error);
    if (cosine > 0.17365) below_80 = std::max(below_80, error);
    worst = std::max(worst, error);
  }
};

Row fitted_row(double alpha, const Row& smoother, double exponent) {
  Row row;
  // From normal incidence, where one number says it all, towards grazing angles. Guesses: the last fit, that of the smoother surface, and
  // the mirror's.
  InverseTransform last{1, 0, 0, alpha * (2 - alpha)};
  for (int j = kCosCount - 1; j >= 0; --j) {
    const double c = cos_at(j);
    const std::array<InverseTransform, 2> guesses{last, transform_of(c, alpha, smoother[static_cast<std::size_t>(j)])};
    last = fit_lobe(c, alpha, guesses, exponent).transform;
    row[static_cast<std::size_t>(j)] = node_of(c, alpha, last, lobe_energies(c, alpha, kEnergyResolution));
  }
  extrapolate_last(row);
  return row;
}

/// Of what look-ups give between the nodes, where interpolation is at its worst; weighted by cosine for the mean.
Errors errors_between(const Row& low, const Row& high, double roughness) {
  Errors errors;
  double weights = 0;
  for (std::size_t j = 0; j + 1 < kCosCount; ++j) {
    const double t = (static_cast<double>(j) + 0.5) / (kCosCount - 1), cosine = t * t, alpha = roughness * roughness;
    Node node;
    for (std::size_t k = 0; k < kLobeColumns; ++k) node[k] = 0.25 * (low[j][k] + low[j + 1][k] + high[j][k] + high[j + 1][k]);
    const double weight = cosine * t;
    weights += weight;
    errors.add(cosine, weight, total_variation(cosine, alpha, transform_of(cosine, alpha, node)));
  }
  errors.mean /= weights;
  return errors;
}

template <class Values>
void print_values(const Values& values) {
  fmt::print("{{");
  for (std::size_t k = 0; k < values.size(); ++k) fmt::print("{}{:.7e}f", k ? ", " : "", values[k]);
  fmt::print("}}");
}

}  // namespace

int main(int argc, char** argv) {
  const double exponent = argc > 1 ? std::atof(argv[1]) : 1.5;
  std::vector<Row> rows{mirror_row()};
  extrapolate_last(rows[0]);
  for (int i = 1; i < kAlphaCount; ++i) rows.push_back(fitted_row(alpha_at(i), rows.back(), exponent));
  fmt::print(stderr, "total variation of the specular lobe between nodes: roughness, mean, worst below 60 and 80 degrees, worst\n");
  for (std::size_t i = 1; i + 1 < kAlphaCount; ++i) {
    const double roughness = (static_cast<double>(i) + 0.5) / (kAlphaCount - 1);
    const Errors e = errors_between(rows[i], rows[i + 1], roughness);
    fmt::print(stderr, "{:.3f} {:.4f} {:.4f} {:.4f} {:.4f}\n", roughness, e.mean, e.below_60, e.below_80, e.worst);
  }
  fmt::print(stderr, "diffuse part: roughness, stretch, amounts, worst error of 1 - E\n");
  std::vector<std::array<double, kDiffuseColumns>> diffuse;
  for (int i = 0; i < kAlphaCount; ++i) {
    const DiffuseFit d = fit_diffuse(alpha_at(i));
    diffuse.push_back({d.stretch, d.mean_full, d.mean_schlick, d.amount_full, d.amount_schlick});
    fmt::print(stderr, "{:.3f} {:.2f} {:.4f} {:.4f} {:.4f}\n", std::sqrt(alpha_at(i)), d.stretch, d.amount_full, d.amount_schlick, d.worst);
  }
  fmt::print("// Made by tools/fit_ltc from src/shade/ggx.h and ggx_albedo.h; checked by test_shade_analytic.\n");
  fmt::print("#include \"shade/analytic/ltc_table.h\"\n\nnamespace sightline::ltc_table {{\n\n// clang-format off\n");
  fmt::print("const float kLobe[kAlphaCount][kCosCount][kLobeColumns] = {{\n");
  for (const Row& row : rows) {
    fmt::print("    {{\n");
    for (const Node& node : row) fmt::print("        "), print_values(node), fmt::print(",\n");
    fmt::print("    }},\n");
  }
  fmt::print("}};\nconst float kDiffuse[kAlphaCount][kDiffuseColumns] = {{\n");
  for (const auto& values : diffuse) fmt::print("    "), print_values(values), fmt::print(",\n");
  fmt::print("}};\n// clang-format on\n\n}}  // namespace sightline::ltc_table\n");
  return 0;
}
