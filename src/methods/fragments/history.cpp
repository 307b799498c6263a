#include "methods/fragments/history.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/fragments/probe_test.h"

namespace sightline {
namespace {

// One pixel and one fragment in so many are asked anew.
constexpr std::uint32_t kAskedAnew = 8;
// What is one surface: distance from the tangent plane over depth, and cosine between normals.
constexpr float kMaxOffPlane = 3e-3f, kMinNormals = 0.9f;
// Quadrants whose shares differ by so much are split without a test.
constexpr float kSplitSpread = 0.25f;

}  // namespace

PictureProjection::PictureProjection(const PinholeRays& rays) : orthographic_(rays.orthographic) {
  // A point is position + s (origin + x step_x + y step_y), or origin + x step_x + y step_y + s position where rays are parallel.
  const Mat3 m(rays.step_x, rays.step_y, orthographic_ ? rays.position : rays.origin);
  picture_from_world_ = glm::inverse(m);
  origin_ = orthographic_ ? rays.origin : rays.position;
}

bool PictureProjection::project(const Vec3& point, float& x, float& y) const {
  const Vec3 p = picture_from_world_ * (point - origin_);
  if (!(p.z > 0)) return false;
  x = orthographic_ ? p.x : p.x / p.z, y = orthographic_ ? p.y : p.y / p.z;
  return true;
}

void PictureHistory::resize(const GBuffer& g, std::size_t light_count) {
  width = g.width, height = g.height, stride = g.stride;
  const std::size_t n = g.element_count();
  reserve_in_large_pages(surfaces, n), surfaces.resize(n);
  lights.resize(light_count);
  for (Light& light : lights) {
    reserve_in_large_pages(light.shares, n), light.shares.resize(n);
    light.blocks.resize(n / (kBlock * kBlock));
  }
}

void PictureHistory::keep_surfaces(const GBuffer& g, const RootTile& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (std::size_t at = g.at(tile.x0, y); at < g.at(tile.x1, y); ++at)
      surfaces[at] = {load(g.position, at), load(g.geometric_normal, at)};
  }
}

void PictureHistory::keep_shares(const GBuffer& g, const RootTile& tile, std::size_t light, const LightSignal& signal,
                                 const AlignedVector<float>& share) {
  Light& kept = lights[light];
  for (int by = tile.y0; by < tile.y1; by += kBlock) {
    for (int bx = tile.x0; bx < tile.x1; bx += kBlock) {
      float least = 1, most = 0;
      bool known = true;
      for (int y = by; y < std::min(by + kBlock, tile.y1); ++y) {
        for (int x = bx; x < std::min(bx + kBlock, tile.x1); ++x) {
          const std::size_t at = g.at(x, y);
          const bool receives = g.kind[at] == PixelKind::diffuse || g.kind[at] == PixelKind::analytic;
          const bool valid = receives && !(signal.flags[at] & LightSignal::kUnlit);
          kept.shares[at] = {share[at], valid ? static_cast<float>(signal.rays[at]) : 0.f};
          known = known && valid, least = std::min(least, share[at]), most = std::max(most, share[at]);
        }
      }
      const auto block =
          static_cast<std::size_t>(by / kBlock) * static_cast<std::size_t>(stride / kBlock) + static_cast<std::size_t>(bx / kBlock);
      kept.blocks[block] = !known ? kMixed : most == 0 ? kDark : least == 1 ? kLit : kMixed;
    }
  }
}

PriorShares::Value PriorShares::at(const GBuffer& g, std::size_t pixel) const {
  const Vec3 p = load(g.position, pixel), n = load(g.geometric_normal, pixel);
  float x, y;
  if (!history_->projection.project(p, x, y)) return {};
  // Between the centres of four pixels.
  x -= 0.5f, y -= 0.5f;
  if (!(x >= 0 && y >= 0 && x < static_cast<float>(history_->width - 1) && y < static_cast<float>(history_->height - 1))) return {};
  const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
  const auto stride = static_cast<std::size_t>(history_->stride), first = row * stride + column;
  const std::array<std::size_t, 4> taps = {first, first + 1, first + stride, first + stride + 1};
  const float off_plane = kMaxOffPlane * g.depth[pixel];
  const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
  const std::array<float, 4> weights = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  // All of them must be on its surface: beside what has come into sight, the rest would stand for what nobody has seen.
  float share = 0, rays = 0, least = 1, most = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const PictureHistory::Share& known = light_->shares[taps[i]];
    if (!(known.rays > 0)) return {};
    const PictureHistory::Surface& surface = history_->surfaces[taps[i]];
    if (std::fabs(glm::dot(surface.position - p, n)) > off_plane || glm::dot(surface.normal, n) < kMinNormals) return {};
    share += weights[i] * known.value, rays += weights[i] * known.rays;
    least = std::min(least, known.value), most = std::max(most, known.value);
  }
  // All or nothing stays exact.
  const Value value{least == most ? least : share, rays, most - least};
  // What part of a lobe's light arrives depends on where it is seen from.
  if (g.kind[pixel] == PixelKind::analytic && !value.saturated()) return {};
  return value;
}

bool PriorShares::is_due(std::size_t pixel) const {
  return hash_combine(static_cast<std::uint32_t>(pixel), history_->pictures) % kAskedAnew == 0;
}

PictureHistory::Block PriorShares::block_at(const GBuffer& g, std::size_t pixel) const {
  const Vec3 p = load(g.position, pixel), n = load(g.geometric_normal, pixel);
  float x, y;
  if (!history_->projection.project(p, x, y)) return PictureHistory::kMixed;
  if (!(x >= 0 && y >= 0 && x < static_cast<float>(history_->width) && y < static_cast<float>(history_->height)))
    return PictureHistory::kMixed;
  const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y), stride = static_cast<std::size_t>(history_->stride);
  const auto block = static_cast<PictureHistory::Block>(
      light_->blocks[row / PictureHistory::kBlock * (stride / PictureHistory::kBlock) + column / PictureHistory::kBlock]);
  if (block == PictureHistory::kMixed) return block;
  const PictureHistory::Surface& surface = history_->surfaces[row * stride + column];
  const bool same =
      std::fabs(glm::dot(surface.position - p, n)) <= kMaxOffPlane * g.depth[pixel] && glm::dot(surface.normal, n) >= kMinNormals;
  return same ? block : PictureHistory::kMixed;
}

// Places no farther apart than blocks are: between them, they meet every block that the fragment lies in.
PriorShares::Verdict PriorShares::of_blocks(const GBuffer& g, const Fragment& f) const {
  const int step = std::min(f.width() / 2, PictureHistory::kBlock), last = f.width() - 1;
  const auto place = [&](int x, int y) {
    return g.at(std::min(f.x + std::min(x, last), g.width - 1), std::min(f.y + std::min(y, last), g.height - 1));
  };
  const PictureHistory::Block first = block_at(g, place(0, 0));
  if (first == PictureHistory::kMixed) return Verdict::open;
  for (int y = 0; y <= f.width(); y += step) {
    for (int x = 0; x <= f.width(); x += step) {
      if (block_at(g, place(x, y)) != first) return Verdict::open;
    }
  }
  return first == PictureHistory::kLit ? Verdict::lit : Verdict::dark;
}

PriorShares::Verdict PriorShares::of(const GBuffer& g, const Fragment& f, int rays, ProbeMasks& masks) const {
  const bool large = f.width() >= PictureHistory::kBlock, due = is_due(g.at(f.x, f.y));
  if (large && !due) {
    const Verdict verdict = of_blocks(g, f);
    if (verdict != Verdict::open) return verdict;
  }
  std::array<Value, 4> values;
  float least = 1, most = 0;
  bool saturated = true;
  for (int q = 0; q < 4; ++q) {
    const IVec2 probe = probe_pixel(g, f, q);
    const Value value = at(g, g.at(probe.x, probe.y));
    if (!(value.rays > 0)) return Verdict::open;
    least = std::min(least, value.share), most = std::max(most, value.share), saturated = saturated && value.saturated();
    values[static_cast<std::size_t>(q)] = value;
  }
  if (!large && !due && saturated && least == most) return least == 1 ? Verdict::lit : Verdict::dark;
  if (most - least < kSplitSpread) return Verdict::open;
  for (std::size_t q = 0; q < 4; ++q) {
    const float share = values[q].share;
    const int seen = share <= 0   ? 0
                     : share >= 1 ? rays
                                  : std::clamp(static_cast<int>(std::lround(share * static_cast<float>(rays))), 1, rays - 1);
    masks[q] = seen == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << seen) - 1;
  }
  return Verdict::split;
}

}  // namespace sightline
