// Figures 11 and 12: tables as bytes, and as clustered principal components.
#include <fmt/format.h>

#include <algorithm>

#include "bench/square_lights/parts.h"
#include "bench/thumbnail.h"

namespace sightline {

using Json = nlohmann::ordered_json;

namespace {

constexpr double kTableFloats = 32.0 * 32 * sizeof(float), kFieldTables = 16.0 * 6 * 32 * 32;
constexpr const char *kReceivers = "square-lights.self-visibility", *kOccluders = "square-lights.occluder-field";

struct Stored {
  const char* name;
  std::vector<std::string> settings;
  bool compressed;
};

std::vector<Stored> receiver_forms() {
  const auto cpca = [](const char* name, const char* clusters, const char* vectors) {
    return Stored{name, {"storage=cpca", fmt::format("clusters={}", clusters), fmt::format("vectors={}", vectors)}, true};
  };
  return {{"raw bytes", {"storage=raw"}, false},
          cpca("256 clusters, 16 vectors", "256", "16"),
          cpca("256 clusters, 8 vectors", "256", "8"),
          cpca("128 clusters, 8 vectors", "128", "8")};
}

// Receivers with so many vectors that the occluders' make the difference.
std::vector<Stored> occluder_forms() {
  const auto pca = [](int vectors) {
    return Stored{vectors == 16  ? "16 vectors"
                  : vectors == 8 ? "8 vectors"
                                 : "4 vectors",
                  {"storage=cpca", "clusters=256", "vectors=16", fmt::format("occluder_vectors={}", vectors)},
                  true};
  };
  return {{"raw bytes", {"storage=raw"}, false}, pca(16), pca(8), pca(4)};
}

struct Bytes {
  double bytes = 0, seconds = 0;
  int count = 0;
};

/// Of the bakes of one kind since event `first`; compressed ones have a suffix of their own.
Bytes bytes_of(const BakeStore& store, std::size_t first, const std::string& kind, bool compressed) {
  Bytes sum;
  const std::vector<BakeStore::Event> events = store.events();
  for (std::size_t i = first; i < events.size(); ++i) {
    const std::string& name = events[i].id.kind;
    if (!name.starts_with(kind) || (name.size() > kind.size()) != compressed) continue;
    sum.bytes += static_cast<double>(events[i].bytes), sum.seconds += events[i].seconds, ++sum.count;
  }
  return sum;
}

}  // namespace

Json square_storage(const SquareStage& given, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures,
                    const Context& context) {
  context.info(fmt::format("bench square-lights: storage, {}", given.name));
  SquareStage stage = given;
  set_content_material(stage.scene, glossy_material());
  const bool occluders = moving_part_count(stage.scene) > 0;
  // A quarter of the way, where something moves: not a pose of rest.
  const BuiltView view = build_stage(stage, 0.25f * stage.scene.animation_duration_s, context);
  const std::vector<std::uint8_t> mask = surface_mask(view, light_request(1), context);
  const Shot traced = shoot(view, square_request(shared.options, shared.bakes, {"lights=all"}), context);
  // A store that has nothing open, so that what it opens can be counted.
  const auto store = std::make_shared<BakeStore>(shared.bakes->directory());
  Json rows = Json::array();
  std::optional<ColorImage> raw;
  double raw_l2 = 0;
  for (const Stored& form : occluders ? occluder_forms() : receiver_forms()) {
    const std::size_t first = store->events().size();
    const Shot shot = shoot(view, square_request(shared.options, store, form.settings), context);
    const Bytes stored = bytes_of(*store, first, occluders ? kOccluders : kReceivers, form.compressed);
    const double vertices = shot.statistics.method_statistics.at("vertices");
    const double full = kTableFloats * (occluders ? kFieldTables * stored.count : vertices);
    Json errors = square_differences(traced.image, shot.image, mask);
    if (!raw) raw = shot.image, raw_l2 = errors["l2"].get<double>();
    rows.push_back({{"name", form.name},
                    {"settings", form.settings},
                    {"compressed", form.compressed},
                    {"bytes", stored.bytes},
                    {"bytes_each", stored.bytes / std::max(1.0, occluders ? static_cast<double>(stored.count) : vertices)},
                    {"ratio", stored.bytes > 0 ? Json(full / stored.bytes) : Json()},
                    {"bake_seconds", stored.seconds},
                    {"l2", errors["l2"]},
                    {"more_points", 100 * (errors["l2"].get<double>() - raw_l2)},
                    {"l2_raw", square_differences(*raw, shot.image, mask)["l2"]},
                    {"seconds", shot.seconds}});
    pictures.push_back({fmt::format("{}: {}", stage.name, form.name),
                        fmt::format("Figure {}: l2 {:.3f} % against traced light", occluders ? 12 : 11, 100 * errors["l2"].get<double>()),
                        shot.image, viewing_exposure(traced.image)});
  }
  return {{"view", stage.name},
          {"size", {view.size_px.x, view.size_px.y}},
          {"tables_of", occluders ? "occluders" : "vertices"},
          {"rows", std::move(rows)}};
}

}  // namespace sightline
