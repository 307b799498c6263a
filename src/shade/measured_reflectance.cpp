#include "shade/measured_reflectance.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/sample/warp.h"

namespace sightline {
namespace {

/// Of the sampling density this much is a cosine: it reaches where the table has nothing, and bounds the weights.
constexpr float kCosinePart = 0.1f;

/// Place between nodes 0 to last of an even grid over [0, 1].
struct Between {
  int lower;
  float fraction;
  Between(float t, int last) {
    const float scaled = std::clamp(t, 0.f, 1.f) * static_cast<float>(last);
    lower = std::min(static_cast<int>(scaled), last - 1);
    fraction = scaled - static_cast<float>(lower);
  }
};

std::uint64_t hash_of(std::span<const ReflectanceSample> samples) {
  static_assert(sizeof(ReflectanceSample) == 6 * sizeof(float));
  return XXH3_64bits(samples.data(), samples.size_bytes());
}

Vec3 direction(float sin2, float turn) {
  const float sine = std::sqrt(sin2), phi = kPi * turn;
  return {sine * std::cos(phi), sine * std::sin(phi), std::sqrt(std::max(0.f, 1 - sin2))};
}

}  // namespace

MeasuredReflectance::MeasuredReflectance(std::span<const ReflectanceSample> samples) : content_hash_(hash_of(samples)) {
  const ScatteredReflectance scattered(samples);
  grid_.reserve(std::size_t{kNodes} * kNodes * kNodes);
  constexpr float kStep = 1.f / (kNodes - 1);
  for (int x = 0; x < kNodes; ++x) {
    for (int z = 0; z < kNodes; ++z) {
      // cos(theta_i - theta_o) = x + z is at most 1; beyond, and one node more, nothing is looked up.
      const bool used = x + z <= kNodes;
      for (int y = 0; y < kNodes; ++y)
        grid_.push_back(used ? scattered.at(kStep * Vec3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z))) : Color(0));
    }
  }
  scale_.assign(kAngles, 1.f);
  limit_albedo();
  build_tables();
}

Color MeasuredReflectance::grid_value(const PairPoint& point) const {
  const Between x(point.x, kNodes - 1), y(point.y, kNodes - 1), z(point.z, kNodes - 1);
  const auto along_y = [&](int i, int k) {
    const Color* row =
        &grid_[(static_cast<std::size_t>(i) * kNodes + static_cast<std::size_t>(k)) * kNodes + static_cast<std::size_t>(y.lower)];
    return glm::mix(row[0], row[1], y.fraction);
  };
  return glm::mix(glm::mix(along_y(x.lower, z.lower), along_y(x.lower, z.lower + 1), z.fraction),
                  glm::mix(along_y(x.lower + 1, z.lower), along_y(x.lower + 1, z.lower + 1), z.fraction), x.fraction);
}

float MeasuredReflectance::scale_at(float cos_theta) const {
  const Between at(cos_theta, kAngles - 1);
  const auto lower = static_cast<std::size_t>(at.lower);
  return std::lerp(scale_[lower], scale_[lower + 1], at.fraction);
}

float MeasuredReflectance::least_scale() const { return *std::min_element(scale_.begin(), scale_.end()); }

Color MeasuredReflectance::value(const Vec3& wo, const Vec3& wi) const {
  return grid_value(pair_point(wo, wi)) * (scale_at(wo.z) * scale_at(wi.z));
}

Color MeasuredReflectance::directional_albedo(float cos_theta) const {
  const Between at(cos_theta, kAngles - 1);
  const auto lower = static_cast<std::size_t>(at.lower);
  return glm::mix(directional_albedo_[lower], directional_albedo_[lower + 1], at.fraction);
}

void MeasuredReflectance::limit_albedo() {
  // Transfer between the nodes of the cosine, summed over the azimuth: albedo(o) = s(o) sum_i transfer(o, i) s(i).
  constexpr int kTurns = 2 * (kNodes - 1), kPerNode = 2, kCosines = kPerNode * (kAngles - 1);
  std::vector<Color> transfer(std::size_t{kAngles} * kCosines, Color(0));
  const auto at = [](int o, int i) { return static_cast<std::size_t>(o) * kCosines + static_cast<std::size_t>(i); };
  const auto cosine_of = [](int i) { return (static_cast<float>(i) + 0.5f) / kCosines; };
  for (int o = 0; o < kAngles; ++o) {
    const float cos_o = static_cast<float>(o) / (kAngles - 1), sin_o = std::sqrt(1 - cos_o * cos_o);
    for (int i = 0; i < kCosines; ++i) {
      const float cos_i = cosine_of(i), sin_i = std::sqrt(1 - cos_i * cos_i);
      Color sum(0);
      for (int t = 0; t < kTurns; ++t) sum += grid_value({sin_o * sin_i, (static_cast<float>(t) + 0.5f) / kTurns, cos_o * cos_i});
      transfer[at(o, i)] = sum * (2 * kPi * cos_i / (kTurns * kCosines));
    }
  }
  // Each round takes back half of what is too much in every direction, since the other direction of each pair is scaled as well.
  constexpr int kRounds = 60;
  directional_albedo_.assign(kAngles, Color(0));
  for (int round = 0; round <= kRounds; ++round) {
    for (int o = 0; o < kAngles; ++o) {
      Color sum(0);
      for (int i = 0; i < kCosines; ++i) sum += transfer[at(o, i)] * scale_at(cosine_of(i));
      directional_albedo_[static_cast<std::size_t>(o)] = sum * scale_[static_cast<std::size_t>(o)];
    }
    if (round == kRounds) break;
    for (std::size_t o = 0; o < scale_.size(); ++o) {
      const float albedo = max_component(directional_albedo_[o]);
      if (albedo > kMostAlbedo) scale_[o] *= std::sqrt(kMostAlbedo / albedo);
    }
  }
  for (int o = 0; o + 1 < kAngles; ++o) {
    const float cosine = (static_cast<float>(o) + 0.5f) / (kAngles - 1);
    albedo_ += directional_albedo(cosine) * (2 * cosine / (kAngles - 1));
  }
}

MeasuredReflectance::View MeasuredReflectance::view_of(float cos_theta) {
  const Between at(std::acos(std::clamp(cos_theta, 0.f, 1.f)) * (2 * kInvPi), kViews - 1);
  return {at.lower, at.fraction};
}

void MeasuredReflectance::build_tables() {
  constexpr int kSub = 2;
  density_.resize(kViews * kTable);
  row_cdf_.resize(std::size_t{kViews} * kRows);
  column_cdf_.resize(kViews * kTable);
  for (int v = 0; v < kViews; ++v) {
    const float theta = 0.5f * kPi * static_cast<float>(v) / (kViews - 1);
    const Vec3 wo{std::sin(theta), 0, std::max(std::cos(theta), 0.f)};
    float* table = &density_[static_cast<std::size_t>(v) * kTable];
    double total = 0;
    for (int r = 0; r < kRows; ++r) {
      for (int c = 0; c < kColumns; ++c) {
        float sum = 0;
        for (int sub = 0; sub < kSub * kSub; ++sub) {
          const float row = static_cast<float>(r) + (static_cast<float>(sub % kSub) + 0.5f) / kSub;
          const float column = static_cast<float>(c) + (static_cast<float>(sub / kSub) + 0.5f) / kSub;  // NOLINT(bugprone-integer-division)
          sum += luminance(value(wo, direction(column / kColumns, row / kRows)));
        }
        table[r * kColumns + c] = sum;
        total += static_cast<double>(sum);
      }
    }
    const float scale = total > 0 ? (1 - kCosinePart) * static_cast<float>(kTable / total) : 0.f;
    const float floor = total > 0 ? kCosinePart : 1.f;
    double below = 0;
    for (int r = 0; r < kRows; ++r) {
      double in_row = 0;
      float* cdf = &column_cdf_[static_cast<std::size_t>(v) * kTable + static_cast<std::size_t>(r) * kColumns];
      for (int c = 0; c < kColumns; ++c) {
        table[r * kColumns + c] = table[r * kColumns + c] * scale + floor;
        in_row += static_cast<double>(table[r * kColumns + c]);
        cdf[c] = static_cast<float>(in_row);
      }
      for (int c = 0; c < kColumns; ++c) cdf[c] /= static_cast<float>(in_row);
      below += in_row;
      row_cdf_[static_cast<std::size_t>(v) * kRows + static_cast<std::size_t>(r)] = static_cast<float>(below / kTable);
    }
  }
}

float MeasuredReflectance::table_pdf(int view, float sin2, float turn) const {
  const int row = std::min(static_cast<int>(turn * kRows), kRows - 1), column = std::min(static_cast<int>(sin2 * kColumns), kColumns - 1);
  return density_[static_cast<std::size_t>(view) * kTable + static_cast<std::size_t>(row * kColumns + column)];
}

float MeasuredReflectance::pdf(const Vec3& wo, const Vec3& wi) const {
  const View view = view_of(wo.z);
  const float sin2 = std::clamp(1 - wi.z * wi.z, 0.f, 1.f), turn = pair_point(wo, wi).y;
  return std::lerp(table_pdf(view.lower, sin2, turn), table_pdf(view.lower + 1, sin2, turn), view.upper_weight) * wi.z * kInvPi;
}

Vec3 MeasuredReflectance::sample(const Vec3& wo, float u_view, const Vec2& u) const {
  const View view = view_of(wo.z);
  const auto table = static_cast<std::size_t>(u_view < view.upper_weight ? view.lower + 1 : view.lower);
  // Azimuths of both signs are alike; then a row of the table, and a column in it.
  const bool mirrored = u.y < 0.5f;
  const auto within = [](const float* cdf, int count, float x, int& cell) {
    cell = std::min(static_cast<int>(std::upper_bound(cdf, cdf + count, x) - cdf), count - 1);
    const float below = cell > 0 ? cdf[cell - 1] : 0.f, width = cdf[cell] - below;
    return static_cast<float>(cell) + (width > 0 ? std::clamp((x - below) / width, 0.f, kOneMinusEpsilon) : 0.5f);
  };
  int row = 0, column = 0;
  const float turn = within(&row_cdf_[table * kRows], kRows, mirrored ? 1 - 2 * u.y : 2 * u.y - 1, row) / kRows;
  const float sin2 = within(&column_cdf_[table * kTable + static_cast<std::size_t>(row) * kColumns], kColumns, u.x, column) / kColumns;
  const Vec3 local = direction(std::min(sin2, kOneMinusEpsilon), mirrored ? -turn : turn);
  const float length = std::sqrt(wo.x * wo.x + wo.y * wo.y);
  const Vec2 along = length > 0 ? Vec2(wo.x, wo.y) / length : Vec2(1, 0);
  return {local.x * along.x - local.y * along.y, local.x * along.y + local.y * along.x, local.z};
}

std::size_t MeasuredReflectance::bytes() const {
  return sizeof(*this) + grid_.size() * sizeof(Color) + directional_albedo_.size() * sizeof(Color) +
         (scale_.size() + density_.size() + row_cdf_.size() + column_cdf_.size()) * sizeof(float);
}

}  // namespace sightline
