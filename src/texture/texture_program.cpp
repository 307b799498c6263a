#include "texture/texture_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "base/core/error.h"

namespace sightline {
namespace {

/// Operands of a node; an invalid id stands for white.
std::vector<TextureId> operands_of(const Texture& texture) {
  if (const auto* n = std::get_if<CheckerboardTexture>(&texture.node)) return {n->even, n->odd};
  if (const auto* n = std::get_if<ScaleTexture>(&texture.node)) return {n->texture, n->factor};
  if (const auto* n = std::get_if<MixTexture>(&texture.node)) return {n->first, n->second, n->amount};
  return {};
}

TextureStep step_of(const Texture& texture, const std::shared_ptr<const MipMap>& map, const std::vector<std::uint32_t>& registers) {
  struct Compiler {
    const std::shared_ptr<const MipMap>& map;
    const std::vector<std::uint32_t>& r;
    TextureStep operator()(const ConstantTexture& n) const { return {TextureStep::Constant{n.value}}; }
    TextureStep operator()(const ImageTexture& n) const {
      return {TextureStep::Lookup{map.get(), n.filter, {n.wrap_u, n.wrap_v}, n.uv, n.scale, n.invert}};
    }
    TextureStep operator()(const CheckerboardTexture& n) const { return {TextureStep::Checkerboard{r[0], r[1], n.uv}}; }
    TextureStep operator()(const ScaleTexture&) const { return {TextureStep::Scale{r[0], r[1]}}; }
    TextureStep operator()(const MixTexture&) const { return {TextureStep::Mix{r[0], r[1], r[2]}}; }
  };
  return std::visit(Compiler{map, registers}, texture.node);
}

/// Share of the interval of width `width` around x that lies in odd unit fields: the integral of the square wave, divided by the width.
float odd_share(float x, float width) {
  if (!(width > 1e-6f * std::max(1.f, std::fabs(x)))) return x - 2 * std::floor(0.5f * x) >= 1 ? 1.f : 0.f;
  const auto integral = [](float y) {
    const float pairs = std::floor(0.5f * y);
    return pairs + std::max(y - 2 * pairs - 1, 0.f);
  };
  if (!(width < 1e5f)) return 0.5f;
  return std::clamp((integral(x + 0.5f * width) - integral(x - 0.5f * width)) / width, 0.f, 1.f);
}

/// Share of odd fields in the footprint's box: the box is a product, so the shares of the axes are independent.
float checkerboard_odd_share(const UvTransform& transform, const Vec2& uv, const Footprint& footprint) {
  const Vec2 p = transform.matrix * uv + transform.offset;
  const Vec2 dx = transform.matrix * footprint.dx, dy = transform.matrix * footprint.dy;
  if (!std::isfinite(p.x) || !std::isfinite(p.y)) return 0.5f;
  const float u = odd_share(p.x, std::max(std::fabs(dx.x), std::fabs(dy.x)));
  const float v = odd_share(p.y, std::max(std::fabs(dx.y), std::fabs(dy.y)));
  return u * (1 - v) + v * (1 - u);
}

Vec4 finish_lookup(const TextureStep::Lookup& n, Vec4 value) {
  // Inversion and scale are for the values, not for coverage.
  Vec3 color(value);
  if (n.invert) color = Vec3(1) - color;
  return {n.scale * color, value.w};
}

Vec4 look_up(const TextureStep::Lookup& n, const TexturePoint& point) {
  const Vec2 uv = n.uv.matrix * point.uv + n.uv.offset;
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return finish_lookup(n, n.map->mean());
  switch (n.filter) {
    case TextureFilter::nearest:
      return finish_lookup(n, n.map->nearest(uv, n.wraps));
    case TextureFilter::linear:
      return finish_lookup(n, n.map->bilinear(0, uv, n.wraps));
    case TextureFilter::trilinear:
      break;
  }
  return finish_lookup(n, n.map->filtered(uv, {n.uv.matrix * point.duv_dx, n.uv.matrix * point.duv_dy}, n.wraps));
}

template <class Leaf>
Vec4 run(std::span<const TextureStep> steps, const TexturePoint& point, Leaf&& leaf) {
  std::array<Vec4, TextureProgram::kMaxSteps> registers;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto& node = steps[i].node;
    if (const auto* c = std::get_if<TextureStep::Constant>(&node)) {
      registers[i] = c->value;
    } else if (const auto* l = std::get_if<TextureStep::Lookup>(&node)) {
      registers[i] = leaf(*l);
    } else if (const auto* b = std::get_if<TextureStep::Checkerboard>(&node)) {
      const float odd = checkerboard_odd_share(b->uv, point.uv, {point.duv_dx, point.duv_dy});
      registers[i] = (1 - odd) * registers[b->even] + odd * registers[b->odd];
    } else if (const auto* s = std::get_if<TextureStep::Scale>(&node)) {
      registers[i] = registers[s->texture] * registers[s->factor];
    } else if (const auto* m = std::get_if<TextureStep::Mix>(&node)) {
      const Vec4& amount = registers[m->amount];
      registers[i] = (Vec4(1) - amount) * registers[m->first] + amount * registers[m->second];
    }
  }
  return registers[steps.size() - 1];
}

}  // namespace

TextureProgram TextureProgram::compile(std::span<const Texture> textures, std::span<const std::shared_ptr<const MipMap>> maps,
                                       TextureId root) {
  TextureProgram program;
  std::map<std::uint32_t, std::optional<std::uint32_t>> register_of;  // empty: being compiled, so meeting it again is a cycle
  const auto place = [&](std::uint32_t id) { return fmt::format("texture {} '{}'", id, textures[id].name); };

  // Depth first, operands before their node. An explicit stack, since a hostile file may nest as deep as it likes.
  struct Visit {
    std::uint32_t id;
    std::vector<TextureId> operands;
    std::vector<std::uint32_t> registers;
  };
  std::vector<Visit> stack;
  const auto enter = [&](std::uint32_t id) {
    if (register_of.size() >= kMaxNodes) {
      throw input_error(fmt::format("the graph of this texture has more than {} nodes", kMaxNodes)).at(place(root.index));
    }
    register_of[id] = std::nullopt;
    stack.push_back({id, operands_of(textures[id]), {}});
  };
  enter(root.index);
  std::optional<std::uint32_t> white;
  while (!stack.empty()) {
    Visit& visit = stack.back();
    if (visit.registers.size() == visit.operands.size()) {
      const std::uint32_t id = visit.id;
      program.steps_.push_back(step_of(textures[id], maps[id], visit.registers));
      register_of[id] = static_cast<std::uint32_t>(program.steps_.size() - 1);
      stack.pop_back();
      continue;
    }
    const TextureId operand = visit.operands[visit.registers.size()];
    if (!operand.valid()) {
      if (!white) {
        program.steps_.push_back({TextureStep::Constant{Vec4(1)}});
        white = static_cast<std::uint32_t>(program.steps_.size() - 1);
      }
      visit.registers.push_back(*white);
    } else if (operand.index >= textures.size()) {
      throw input_error(fmt::format("operand {} does not exist; the scene has {} textures", operand.index, textures.size()))
          .at(place(visit.id));
    } else if (const auto known = register_of.find(operand.index); known == register_of.end()) {
      enter(operand.index);
    } else if (known->second) {
      visit.registers.push_back(*known->second);
    } else {
      throw input_error("the texture uses itself as an operand").at(place(operand.index));
    }
  }
  return program;
}

Vec4 TextureProgram::evaluate(const TexturePoint& point) const {
  if (steps_.size() == 1) {
    if (const auto* lookup = std::get_if<TextureStep::Lookup>(&steps_[0].node)) return look_up(*lookup, point);
    if (const auto* constant = std::get_if<TextureStep::Constant>(&steps_[0].node)) return constant->value;
  }
  return run(steps_, point, [&](const TextureStep::Lookup& n) { return look_up(n, point); });
}

Vec4 TextureProgram::mean() const {
  const TexturePoint unit_square{Vec2(0.5f), {1, 0}, {0, 1}};
  return run(steps_, unit_square, [](const TextureStep::Lookup& n) { return finish_lookup(n, n.map->mean()); });
}

}  // namespace sightline
