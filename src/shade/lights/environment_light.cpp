#include "shade/lights/environment_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/core/error.h"
#include "base/math/vec3_batch.h"
#include "base/parallel/parallel.h"
#include "base/sample/warp.h"
#include "shade/cube_map.h"
#include "shade/lights/environment_lanes.h"

namespace sightline {

EnvironmentLight::EnvironmentLight(const Environment& environment, const Context& context, const EnvironmentLight* previous) {
  const Color scale = glm::max(environment.scale, Color(0));
  if (previous && environment.image && previous->picture_ == environment.image && previous->mapping_ == environment.mapping &&
      previous->scale_ == scale) {
    *this = *previous;
    turn(environment);
    return;
  }
  picture_ = environment.image, mapping_ = environment.mapping, scale_ = scale;
  if (!is_finite(scale_)) throw input_error("the environment's scale is not finite").at(environment.name);
  turn(environment);
  if (!environment.image) {
    total_luminance_ = 4 * std::numbers::pi * static_cast<double>(luminance(scale_));
    return;
  }
  map_.emplace(environment.image, environment.mapping, context);
  build(context);
}

void EnvironmentLight::turn(const Environment& environment) {
  world_from_local_ = environment.world_from_environment;
  // Rotations and reflections only: a scale would change solid angles.
  for (int i = 0; i < 3; ++i) world_from_local_[i] = normalize_or(world_from_local_[i], Vec3(0));
  const float determinant = glm::determinant(world_from_local_);
  if (!(std::fabs(std::fabs(determinant) - 1) < 1e-3f)) {
    throw input_error("the environment's transform is neither a rotation nor a reflection").at(environment.name);
  }
  local_from_world_ = glm::transpose(world_from_local_);
}

void EnvironmentLight::build(const Context& context) {
  const int width = map_->width(), height = map_->height();
  // Whole pixels a cell, so that cells never cut through a texel.
  const auto cells = [&](int n) { return (static_cast<std::uint32_t>(n) + block_ - 1) / block_; };
  while (!is_cube() && static_cast<std::uint64_t>(cells(width)) * cells(height) > kMaxCells) ++block_;
  columns_ = cells(width);
  rows_ = cells(height);

  const EnvironmentMapping mapping = map_->mapping();
  // A pixel's solid angle: exact for latlong and octahedral, by its centre for angular maps.
  const auto row_cosine = [&](int y) { return std::cos(std::numbers::pi * y / height); };
  const auto pixel_solid_angle = [&](int x, int y) {
    if (mapping == EnvironmentMapping::latlong) return 2 * std::numbers::pi / width * (row_cosine(y) - row_cosine(y + 1));
    const double equal = 4 * std::numbers::pi / (static_cast<double>(width) * height);
    if (mapping == EnvironmentMapping::octahedral) return equal;
    if (mapping == EnvironmentMapping::cube) return static_cast<double>(cube_texel_solid_angle(x, y % width, width));
    const double px = (2 * x + 1.0) / width - 1, py = (2 * y + 1.0) / height - 1;
    const double theta = std::numbers::pi * std::hypot(px, py);
    // A rim pixel whose centre lies outside the disk still shows something.
    const double least = 0.1 * std::numbers::pi / std::max(width, height);
    if (theta > std::numbers::pi * (1 + 1.5 / std::min(width, height))) return 0.0;
    return equal * std::numbers::pi * std::max(std::sin(std::min(theta, std::numbers::pi)), least) / std::max(theta, least);
  };

  column_tables_.resize(rows_);
  std::vector<double> row_luminance(rows_);
  std::vector<float> row_weights(rows_);
  parallel_for(context, rows_, 8, [&](std::size_t begin, std::size_t end) {
    std::vector<float> weights(columns_);
    for (std::size_t row = begin; row < end; ++row) {
      std::fill(weights.begin(), weights.end(), 0.f);
      for (int y = static_cast<int>(row * block_); y < std::min(static_cast<int>((row + 1) * block_), height); ++y) {
        if (is_cube()) {
          for (int x = 0; x < width; ++x) {
            weights[static_cast<std::size_t>(x)] =
                static_cast<float>(static_cast<double>(luminance(map_->texel(x, y))) * pixel_solid_angle(x, y));
          }
          continue;
        }
        // Mean of the bilinear reconstruction over a pixel: it and its neighbours with weights 1/8, 3/4, 1/8 each way. So wherever
        // radiance is read as more than 0, the density is more than 0.
        const auto column_mean = [&](int x) {
          return 0.125f * luminance(map_->texel(x, y - 1)) + 0.75f * luminance(map_->texel(x, y)) +
                 0.125f * luminance(map_->texel(x, y + 1));
        };
        float left = column_mean(-1), middle = column_mean(0);
        for (int x = 0; x < width; ++x) {
          const float right = column_mean(x + 1);
          const double mean = 0.125 * left + 0.75 * middle + 0.125 * right;
          weights[static_cast<std::size_t>(x) / block_] += static_cast<float>(mean * pixel_solid_angle(x, y));
          left = middle;
          middle = right;
        }
      }
      column_tables_[row] = AliasTable(weights);
      row_luminance[row] = column_tables_[row].sum();
    }
  });
  double sum = 0;
  for (std::uint32_t row = 0; row < rows_; ++row) sum += row_luminance[row];
  for (std::uint32_t row = 0; row < rows_; ++row) row_weights[row] = sum > 0 ? static_cast<float>(row_luminance[row] / sum) : 0.f;
  row_table_ = AliasTable(row_weights);
  total_luminance_ = sum * static_cast<double>(luminance(scale_));
  if (mapping == EnvironmentMapping::latlong) {
    for (std::uint32_t row = 0; row <= rows_; ++row) {
      row_cosines_.push_back(static_cast<float>(row_cosine(std::min(static_cast<int>(row * block_), height))));
    }
  }
}

Color EnvironmentLight::radiance(const Vec3& direction) const {
  return map_ ? scale_ * map_->radiance(local_from_world_ * direction) : scale_;
}

void EnvironmentLight::radiance(const Vec3Batch& direction, std::size_t count, Vec3Batch& colors) const {
  EnvironmentPicture picture;
  if (map_) {
    picture = {map_->values(), map_->width(), map_->height(), map_->channels(), map_->mapping(), local_from_world_, scale_};
    if (picture.has_lanes()) return environment_radiance(picture, direction, count, colors);
  }
  if (colors.x.size() < padded(count)) colors.resize(count);
  for (std::size_t i = 0; i < count; ++i) store(colors, i, radiance(load(direction, i)));
}

EnvironmentLight::Cell EnvironmentLight::cell_of(const Vec2& uv) const {
  const auto index = [&](float u, int pixels) {
    return static_cast<std::uint32_t>(std::clamp(u, 0.f, kOneMinusEpsilon) * static_cast<float>(pixels)) / block_;
  };
  return {std::min(index(uv.x, map_->width()), columns_ - 1), std::min(index(uv.y, map_->height()), rows_ - 1)};
}

float EnvironmentLight::column_border(std::uint32_t column) const {
  const auto width = static_cast<std::uint32_t>(map_->width());
  return static_cast<float>(std::min(column * block_, width)) / static_cast<float>(width);
}
float EnvironmentLight::row_border(std::uint32_t row) const {
  const auto height = static_cast<std::uint32_t>(map_->height());
  return static_cast<float>(std::min(row * block_, height)) / static_cast<float>(height);
}

Vec3 EnvironmentLight::sample(const Vec2& u) const {
  if (!map_) return sample_uniform_sphere(u);
  if (!row_table_.can_sample()) return Vec3(0);
  const AliasTable::Choice row = row_table_.sample(u.y);
  const AliasTable::Choice column = column_tables_[row.index].sample(u.x);
  const auto between = [](float a, float b, float t) { return a + t * (b - a); };
  const float pu = between(column_border(column.index), column_border(column.index + 1), column.u);
  Vec3 local;
  if (map_->mapping() == EnvironmentMapping::latlong) {
    // Uniform in solid angle inside the cell, so that the density has no pole.
    const float cosine = between(row_cosines_[row.index], row_cosines_[row.index + 1], row.u);
    const float sine = std::sqrt(std::max(0.f, 1 - cosine * cosine));
    const float phi = 2 * kPi * (pu - 0.5f);
    local = {sine * std::sin(phi), cosine, -sine * std::cos(phi)};
  } else if (is_cube()) {
    // Uniform over the texel's square, but for a rim as wide as rounding: beyond it another texel may be dark.
    const auto size = static_cast<std::uint32_t>(map_->width());
    const float rim = std::min(5e-7f * static_cast<float>(size), 0.1f);
    const auto coordinate = [&](std::uint32_t texel, float inside) {
      return 2 * (static_cast<float>(texel) + std::clamp(inside, rim, 1 - rim)) / static_cast<float>(size) - 1;
    };
    local = glm::normalize(
        cube_direction(static_cast<int>(row.index / size), coordinate(column.index, column.u), coordinate(row.index % size, row.u)));
  } else {
    local = environment_direction(map_->mapping(), {pu, between(row_border(row.index), row_border(row.index + 1), row.u)});
  }
  return world_from_local_ * local;
}

float EnvironmentLight::pdf(const Vec3& direction) const {
  if (!map_) return pdf_uniform_sphere();
  const Vec3 local = local_from_world_ * direction;
  if (is_cube()) return cube_pdf(cube_cell(local), local);
  return pdf_at(environment_uv(map_->mapping(), local), local);
}

EnvironmentLight::Evaluation EnvironmentLight::evaluate(const Vec3& direction) const {
  if (!map_) return {scale_, pdf_uniform_sphere()};
  const Vec3 local = local_from_world_ * direction;
  if (is_cube()) {
    const Cell cell = cube_cell(local);
    return {scale_ * map_->texel(static_cast<int>(cell.x), static_cast<int>(cell.y)), cube_pdf(cell, local)};
  }
  const Vec2 uv = environment_uv(map_->mapping(), local);
  return {scale_ * map_->radiance_uv(uv), pdf_at(uv, local)};
}

EnvironmentLight::Cell EnvironmentLight::cube_cell(const Vec3& local) const {
  const IVec2 texel = map_->cube_texel(local);
  return {static_cast<std::uint32_t>(texel.x), static_cast<std::uint32_t>(texel.y)};
}

float EnvironmentLight::cube_pdf(Cell cell, const Vec3& local) const {
  if (!row_table_.can_sample()) return 0;
  const float probability = row_table_.probability(cell.y) * column_tables_[cell.y].probability(cell.x);
  // Area on the face, whose edge is 2, to solid angle: the cube of the distance to the point on the face.
  const auto size = static_cast<float>(map_->width());
  const float height = max_component(glm::abs(local));
  return probability * 0.25f * size * size / (height * height * height);
}

float EnvironmentLight::pdf_at(const Vec2& uv, const Vec3& local) const {
  if (!row_table_.can_sample()) return 0;
  const Cell cell = cell_of(uv);
  const float probability = row_table_.probability(cell.y) * column_tables_[cell.y].probability(cell.x);
  const float width = column_border(cell.x + 1) - column_border(cell.x), height = row_border(cell.y + 1) - row_border(cell.y);
  switch (map_->mapping()) {
    case EnvironmentMapping::latlong:
      return probability / (2 * kPi * width * (row_cosines_[cell.y] - row_cosines_[cell.y + 1]));
    case EnvironmentMapping::octahedral:
      return probability / (4 * kPi * width * height);
    case EnvironmentMapping::angular: {
      // Area of the square to solid angle: 4 pi² sin(theta) / theta.
      const float sine = std::sqrt(local.x * local.x + local.y * local.y);
      const float theta = std::atan2(sine, -local.z);
      const float stretch = theta > 1e-4f ? std::max(sine, 1e-6f) / theta : 1.f;
      return probability / (4 * kPi * kPi * stretch * width * height);
    }
    case EnvironmentMapping::cube:
      return cube_pdf(cell, local);
  }
  return 0;
}

std::uint64_t EnvironmentLight::memory_bytes() const {
  std::uint64_t bytes = row_table_.memory_bytes() + row_cosines_.size() * sizeof(float);
  for (const AliasTable& table : column_tables_) bytes += table.memory_bytes() + sizeof(AliasTable);
  return bytes;
}

}  // namespace sightline
