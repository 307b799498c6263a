#include "methods/square_lights/square_bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/core/error.h"
#include "methods/square_lights/haar.h"
#include "methods/square_lights/patch_coverage.h"
#include "methods/square_lights/solid_ball.h"
#include "methods/square_lights/texel_visibility.h"
#include "shade/material_eval.h"

namespace sightline::square_lights {
namespace {

// Versions of what is stored; to be raised whenever the same input would give other bytes.
constexpr std::uint32_t kLightsVersion = 3, kSelfVersion = 1, kFieldVersion = 2, kMasksVersion = 1, kSourceVersion = 1, kPatchVersion = 1,
                        kBrdfVersion = 1, kPiecesVersion = 1;
template <class T>
BakeHash& add_vector(BakeHash& hash, const std::vector<T>& values) {
  return hash.add(std::span<const T>(values));
}

/// Geometry of an object in its own space, and what makes parts of it transparent.
void add_geometry(BakeHash& hash, const Scene& scene, const ShadingObject& object) {
  hash.add(object.members.size());
  for (std::size_t m = 0; m < object.members.size(); ++m) {
    const std::uint32_t index = object.members[m];
    if (index & kSphereBit) {
      const Sphere& sphere = scene.spheres[index & ~kSphereBit];
      hash.add(sphere.center.x).add(sphere.center.y).add(sphere.center.z).add(sphere.radius);
      continue;
    }
    const Instance& instance = scene.instances[index];
    const Mesh& mesh = scene.meshes[instance.mesh.index];
    hash.add(std::span<const Mat4>(&object.object_from_member[m], 1)).add(mesh.positions.span()).add(mesh.triangles.span());
    const auto add_alpha = [&](MaterialId id) {
      if (!id.valid()) return;
      const Material& material = scene.materials[id.index];
      const bool interface_only = std::holds_alternative<InterfaceMaterial>(material.model);
      hash.add(interface_only).add(material.alpha_mode);
      if (material.alpha_mode == AlphaMode::opaque) return;
      hash.add(material.alpha_cutoff).add(material.alpha.value).add(material.alpha.channel).add(mesh.uvs.span());
      // All pictures, whichever the mask is: masks are rare, and a bake too many costs less than a wrong one.
      for (const ImageAsset& asset : scene.images) {
        if (asset.image) std::visit([&](const auto& values) { add_vector(hash, values); }, asset.image->data);
      }
    };
    if (instance.material_override.valid()) {
      add_alpha(instance.material_override);
    } else {
      hash.add(mesh.triangle_materials.span());
      for (const MaterialId id : mesh.materials) add_alpha(id);
    }
  }
}

void add_vertices(BakeHash& hash, const VertexSpans& v) {
  hash.add(v.position).add(v.normal).add(v.tangent).add(v.geometric_normal).add(v.error);
}

/// The reflectance model with its parameters. Bytes between them may differ where nothing else does, which costs a table and nothing else.
void add_model(BakeHash& hash, const Bsdf& bsdf) {
  hash.add(bsdf.model().index());
  std::visit([&](const auto& model) { hash.add(std::span(&model, 1)); }, bsdf.model());
}

/// Without the slack that look-ups may read past the end: a bake has its own.
std::span<const std::int8_t> whole_tables(const AlignedVector<std::int8_t>& tables) {
  return std::span(tables).first(tables.size() / kTableCells * kTableCells);
}

/// What `make` says of a scene, said once a bake is really made.
void announce(const Context& context, const std::string& what, std::uint64_t bytes) {
  context.info(fmt::format("square-lights: {}, {:.1f} MB", what, static_cast<double>(bytes) * 1e-6));
}

std::array<float, 4> sphere_of(const ShadingObject& object) { return {object.center.x, object.center.y, object.center.z, object.radius}; }

/// 2 x 2 segments of each face of each shell [Sloan2003 through the paper]: the group of every table.
std::vector<std::uint16_t> field_segments() {
  std::vector<std::uint16_t> groups(kFieldTables);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const std::size_t shell = i / kShellPoints, face = i % kShellPoints / (kShellSize * kShellSize);
    const std::size_t y = i / kShellSize % kShellSize, x = i % kShellSize;
    groups[i] = static_cast<std::uint16_t>((shell * 6 + face) * 4 + y / (kShellSize / 2) * 2 + x / (kShellSize / 2));
  }
  return groups;
}
constexpr int kSegments = kShells * 24;

std::vector<BakeSection> sections_of(const CompressedTables& tables) {
  return {bake_section("cluster", tables.cluster_of()), bake_section("weights", tables.weights()),
          bake_section("components", tables.components())};
}

CompressedTables compressed_from(const BakeView& view, int vectors) {
  return CompressedTables::from_arrays(view.array<std::uint16_t>("cluster"), view.array<std::uint16_t>("weights"),
                                       view.array<std::uint16_t>("components"), vectors);
}

bool needs_masks(const SquareLightsSettings& settings) {
  return settings.basis == SquareLightsSettings::Basis::haar || parse_lights(settings.lights).kind == LightChoice::Kind::all;
}

std::uint64_t masks_bytes(const ShadingScene& scene, const SquareLightsSettings& settings) {
  const auto edge = static_cast<std::uint64_t>(settings.cube);
  return needs_masks(settings) ? scene.vertices().size() * kCubeFaces * edge * edge * sizeof(std::uint16_t) : 0;
}

}  // namespace

LightChoice parse_lights(const std::string& text) {
  if (text == "all") return {LightChoice::Kind::all, 0};
  if (text == "all-tables") return {LightChoice::Kind::all_tables, 0};
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc() || end != text.data() + text.size() || count == 0 || count > 1000000)
    throw usage_error(fmt::format("lights={} is no number of lights", text)).remedy("a number from 1, all, or all-tables");
  return {LightChoice::Kind::count, count};
}

StillPieces still_pieces(const Scene& scene, const ShadingScene& shading) {
  StillPieces result;
  if (!shading.any_moving()) return result;
  for (const ShadingObject& object : shading.objects()) {
    if (object.moving || object.deformable) continue;
    for (std::size_t m = 0; m < object.members.size(); ++m) {
      StillPieces::Piece& piece = result.pieces.emplace_back();
      piece.object.name = "static";
      piece.object.members = {object.members[m]}, piece.object.object_from_member = {object.object_from_member[m]};
      const std::uint32_t index = object.members[m];
      if (index & kSphereBit) {
        const Sphere& sphere = scene.spheres[index & ~kSphereBit];
        piece.object.center = sphere.center, piece.object.radius = sphere.radius;
        continue;
      }
      const Mesh& mesh = scene.meshes[scene.instances[index].mesh.index];
      Bounds bounds;
      std::vector<Vec3> points;
      float area = 0;
      for (const Vec3& p : mesh.positions) points.push_back(transform_point(object.object_from_member[m], p)), bounds.add(points.back());
      for (const UVec3& t : mesh.triangles) area += 0.5f * glm::length(glm::cross(points[t.y] - points[t.x], points[t.z] - points[t.x]));
      piece.plane = PlanarOccluder::fit(points, area);
      if (piece.plane) continue;
      piece.object.center = 0.5f * (bounds.lower + bounds.upper);
      for (const Vec3& p : points) piece.object.radius = std::max(piece.object.radius, glm::length(p - piece.object.center) * (1 + 1e-5f));
    }
  }
  return result;
}

std::uint64_t square_bake_bytes(const Scene& scene, const ShadingScene& shading, const StillPieces& pieces,
                                const SquareLightsSettings& settings) {
  if (scene.environment && needs_masks(settings)) return masks_bytes(shading, settings);
  std::uint64_t bytes = 0;
  for (const ShadingObject& object : shading.objects()) {
    if (!object.deformable && (scene.environment || object.moving)) bytes += self_visibility_bytes(object.count);
    if (object.moving && !object.deformable) bytes += occluder_field_bytes();
  }
  for (const StillPieces::Piece& piece : pieces.pieces) bytes += piece.plane ? 0 : occluder_field_bytes();
  return bytes;
}

SquareBake::SquareBake(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context)
    : scene_(world, &store.recent()) {
  pieces_ = store.recent().get<StillPieces>({"square-lights.still-pieces", kPiecesVersion, scene_.key()},
                                            [&] { return still_pieces(world.scene(), scene_); });
  const std::uint64_t needed = square_bake_bytes(world.scene(), scene_, *pieces_, settings);
  if (context.memory_budget_bytes > 0 && needed + current_resident_bytes() > context.memory_budget_bytes)
    throw resource_error(fmt::format("square-lights: the tables of {} vertices take {:.1f} GB, more than the memory limit leaves",
                                     scene_.vertices().size(), static_cast<double>(needed) * 1e-9))
        .remedy("raise --memory-limit, or use a coarser mesh");
  make_lights(world, settings, store, context);
  make_materials(world, settings, store, context);
  if (needs_masks(settings) && !cube_.texels.empty()) {
    make_masks(world, settings, store, context);
  } else {
    make_tables(world, settings, store, context);
    make_occluders(world, settings, store, context);
    make_sources(world, settings, store, context);
  }
}

void SquareBake::make_lights(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context) {
  if (!world.scene().environment) return;
  const Environment& environment = *world.scene().environment;
  world_from_environment_ = environment.world_from_environment;
  BakeHash hash;
  if (environment.image) {
    const Image& image = *environment.image;
    hash.add(image.width).add(image.height).add(image.channels).add(image.data.index());
    std::visit([&](const auto& values) { add_vector(hash, values); }, image.data);
  }
  hash.add(environment.mapping).add(environment.scale.x).add(environment.scale.y).add(environment.scale.z);
  hash.add(settings.cube).add(settings.merge).add(settings.area_penalty);
  const BakeId id{"square-lights.lights", kLightsVersion, hash.key()};
  const std::shared_ptr<const BakeView> view = store.get(id, context, [&](const auto& keep) {
    const LightCube cube = light_cube_of(environment, settings.cube, context);
    MergeOptions options;
    // The settings' names stand in the same order.
    options.criterion = static_cast<MergeOptions::Criterion>(settings.merge);
    options.area_penalty = settings.area_penalty;
    const MergeTree tree = MergeTree::build(cube, options, context);
    const std::vector<BakeSection> sections{bake_section("texels", std::span<const Color>(cube.texels)),
                                            bake_section("nodes", tree.nodes())};
    keep(sections);
  });
  const auto texels = view->array<Color>("texels");
  const auto nodes = view->array<MergeNode>("nodes");
  cube_ = {settings.cube, {texels.begin(), texels.end()}};
  tree_ = MergeTree({nodes.begin(), nodes.end()}, texels.size());
  bytes_ += view->bytes();
  const LightChoice choice = parse_lights(settings.lights);
  if (choice.kind != LightChoice::Kind::count || settings.basis == SquareLightsSettings::Basis::haar) return;
  // Splitting at a vertex goes on along the tree, whose regions it has to find.
  const bool exchange = settings.exchange && settings.split == 0;
  hash.add(choice.count).add(exchange);
  squares_ = store.recent().get<TexelExchange>({"square-lights.squares", kLightsVersion, hash.key()}, [&] {
    if (exchange) return exchange_texels(cube_, tree_, choice.count);
    return TexelExchange{.lights = tree_.lights(choice.count)};
  });
}

void SquareBake::make_tables(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context) {
  const bool compress = settings.storage == SquareLightsSettings::Storage::cpca;
  tables_.resize(scene_.objects().size());
  for (std::size_t o = 0; o < tables_.size(); ++o) {
    const ShadingObject& object = scene_.objects()[o];
    if (object.deformable || object.count == 0) continue;
    // Only what lies infinitely far, or lights something that moves, is asked of these tables.
    if (cube_.texels.empty() && !object.moving) continue;
    const VertexSpans vertices = scene_.vertices().spans(object);
    BakeHash hash;
    add_geometry(hash, world.scene(), object), add_vertices(hash, vertices);
    hash.add(settings.rays).add(settings.count_horizon);
    const BakeId raw_id{"square-lights.self-visibility", kSelfVersion, hash.key()};
    const auto raw = [&] {
      return store.get(raw_id, context, [&](const auto& keep) {
        announce(context, fmt::format("self-visibility of {} vertices of '{}'", object.count, object.name),
                 self_visibility_bytes(object.count));
        const Scene alone = object_scene(world.scene(), object);
        const std::unique_ptr<Tracer> tracer = make_embree_tracer(alone, world.textures(), {}, context);
        const AlignedVector<std::int8_t> tables =
            bake_self_visibility(*tracer, vertices, {settings.rays, settings.count_horizon}, rays_, context);
        const std::vector<BakeSection> sections{bake_section("tables", whole_tables(tables))};
        keep(sections);
      });
    };
    if (!compress) {
      tables_[o].held = raw();
      tables_[o].raw = tables_[o].held->array<std::int8_t>("tables");
      if (tables_[o].raw.size() != object.count * kTableCells)
        throw input_error("square-lights: a stored bake has another size than its mesh");
      bytes_ += tables_[o].held->bytes();
      continue;
    }
    hash.add(settings.clusters).add(settings.vectors).add(context.seed);
    tables_[o].held = store.get({"square-lights.self-visibility-cpca", kSelfVersion, hash.key()}, context, [&](const auto& keep) {
      const std::shared_ptr<const BakeView> all = raw();
      CompressionOptions options;
      options.clusters = std::min<int>(settings.clusters, static_cast<int>(object.count));
      options.vectors = settings.vectors, options.seed = context.seed;
      keep(sections_of(CompressedTables::cluster(all->array<std::int8_t>("tables"), object.count, options, context)));
    });
    store.close(raw_id);
    tables_[o].compressed = compressed_from(*tables_[o].held, settings.vectors);
    bytes_ += tables_[o].compressed->bytes();
  }
}

void SquareBake::make_occluders(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context) {
  if (!scene_.any_moving()) return;
  for (std::uint32_t o = 0; o < scene_.objects().size(); ++o) {
    const ShadingObject& object = scene_.objects()[o];
    if (object.deformable) continue;
    if (object.moving) {
      add_occluder(world, object, object.world_from_object, o, settings, store, context);
      continue;
    }
    // What stands still hides light from what moves, piece by piece: flat convex pieces exactly, others by fields of their own.
    for (const StillPieces::Piece& piece : pieces_->pieces) {
      if (piece.plane)
        planes_.push_back(*piece.plane);
      else
        add_occluder(world, piece.object, Mat4(1), o, settings, store, context);
    }
  }
}

void SquareBake::add_occluder(const World& world, const ShadingObject& object, const Mat4& world_from_field, std::uint32_t index,
                              const SquareLightsSettings& settings, BakeStore& store, const Context& context) {
  BakeHash hash;
  add_geometry(hash, world.scene(), object);
  const std::array<float, 4> sphere = sphere_of(object);
  hash.add(std::span<const float>(sphere)).add(settings.occluder_rays).add(settings.zoom);
  const OccluderFieldOptions options{settings.occluder_rays, settings.zoom};
  const BakeId raw_id{"square-lights.occluder-field", kFieldVersion, hash.key()};
  const auto raw = [&] {
    return store.get(raw_id, context, [&](const auto& keep) {
      announce(context, fmt::format("occluder field of '{}'", object.name), occluder_field_bytes());
      const Scene alone = object_scene(world.scene(), object);
      const std::unique_ptr<Tracer> tracer = make_embree_tracer(alone, world.textures(), {}, context);
      // Not part of the key: it changes the number of rays, not what they find.
      OccluderFieldOptions traced = options;
      traced.solid = solid_ball(world.scene(), object, object.center);
      const AlignedVector<std::int8_t> tables = bake_occluder_field(*tracer, object.center, object.radius, traced, rays_, context);
      OccluderField field(object.center, object.radius, shell_zoom(options), whole_tables(tables));
      field.measure(context);
      const std::vector<BakeSection> sections{bake_section("tables", whole_tables(tables)), bake_section("hidden", field.hidden())};
      keep(sections);
    });
  };
  Occluder occluder;
  occluder.object = index;
  occluder.world_from_field = world_from_field;
  std::span<const std::int8_t> tables;
  if (settings.storage == SquareLightsSettings::Storage::raw) {
    occluder.held = raw();
    tables = occluder.held->array<std::int8_t>("tables");
    bytes_ += occluder.held->bytes();
  } else {
    hash.add(settings.occluder_vectors);
    occluder.held = store.get({"square-lights.occluder-field-pca", kFieldVersion, hash.key()}, context, [&](const auto& keep) {
      const std::shared_ptr<const BakeView> all = raw();
      const CompressedTables small =
          CompressedTables::groups(all->array<std::int8_t>("tables"), field_segments(), kSegments, settings.occluder_vectors, context);
      std::vector<BakeSection> sections = sections_of(small);
      sections.push_back({"hidden", all->section("hidden")});
      keep(sections);
    });
    store.close(raw_id);
    occluder.compressed = compressed_from(*occluder.held, settings.occluder_vectors);
    bytes_ += occluder.compressed->bytes();
    // Deviation: look-ups want eight tables a point, far more than a vertex's one; they are expanded once, so that compression saves disk
    // and bakes' transport, not memory while a picture is made.
    occluder.expanded.resize(kFieldTables * kTableCells + kTableSlack);
    for (std::size_t i = 0; i < kFieldTables; ++i)
      occluder.compressed->expand(i, std::span<std::int8_t, kTableCells>(occluder.expanded.data() + i * kTableCells, kTableCells));
    tables = std::span<const std::int8_t>(occluder.expanded).first(kFieldTables * kTableCells);
  }
  if (tables.size() != kFieldTables * kTableCells)
    throw input_error("square-lights: a stored occluder field has another size than expected");
  occluder.field = OccluderField(object.center, object.radius, shell_zoom(options), tables);
  occluder.field.use_hidden(occluder.held->array<float>("hidden"));
  if (occluder.field.hidden().size() != kFieldTables)
    throw input_error("square-lights: a stored occluder field lacks what its tables hide");
  occluders_.push_back(std::move(occluder));
}

void SquareBake::make_sources(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context) {
  std::vector<LocalLight> lights = collect_local_lights(world.scene(), world.lights(), world.textures(), settings.patches);
  source_patches_ = patch_count(lights);
  if (lights.empty()) return;
  // What stands still knows what it hides of each patch.
  if (const ShadingObject& still = scene_.objects().front(); !still.moving && !still.deformable && still.count > 0) {
    const VertexSpans vertices = scene_.vertices().spans(still);
    BakeHash hash;
    add_geometry(hash, world.scene(), still), add_vertices(hash, vertices);
    for (const LocalLight& light : lights)
      hash.add(light.patches()).add(light.center().x).add(light.center().y).add(light.center().z).add(light.radius()).add(light.count());
    coverage_held_ = store.get({"square-lights.patch-coverage", kPatchVersion, hash.key()}, context, [&](const auto& keep) {
      announce(context, fmt::format("{} patches of local lights from {} vertices", source_patches_, still.count),
               still.count * source_patches_);
      const std::unique_ptr<Tracer> tracer = make_embree_tracer(object_scene(world.scene(), still), world.textures(), {}, context);
      const AlignedVector<std::uint8_t> coverage = trace_patches(*tracer, vertices, lights, rays_, context);
      const std::vector<BakeSection> sections{bake_section("coverage", std::span<const std::uint8_t>(coverage))};
      keep(sections);
    });
    coverage_ = coverage_held_->array<std::uint8_t>("coverage");
    if (coverage_.size() != still.count * source_patches_) throw input_error("square-lights: a stored bake has another size than its mesh");
    bytes_ += coverage_held_->bytes();
  }
  for (LocalLight& light : lights) {
    Source& source = sources_.emplace_back();
    source.light = std::move(light);
    if (!settings.source_fields || source.light.is_sphere()) continue;
    // The table is the emitter's own: where it stands does not matter.
    source.origin = source.light.center();
    Mat4 to_origin(1);
    to_origin[3] = Vec4(-source.origin, 1);
    const LocalLight own = source.light.transformed(to_origin);
    BakeHash hash;
    hash.add(own.patches());
    source.held = store.get({"square-lights.source-field", kSourceVersion, hash.key()}, context, [&](const auto& keep) {
      announce(context, "field of a local light", source_field_bytes(own));
      const AlignedVector<PackedPatch> table = bake_source_field(own, context);
      const std::vector<BakeSection> sections{bake_section("patches", std::span<const PackedPatch>(table))};
      keep(sections);
    });
    source.field = SourceField(own.center(), own.radius(), own.count(), source.held->array<PackedPatch>("patches"));
    bytes_ += source.held->bytes();
  }
}

void SquareBake::make_materials(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context) {
  const std::size_t count = world.scene().materials.size() + 1;
  materials_.resize(count), bsdfs_.resize(count);
  std::vector<bool> used(count, false);
  for (const std::uint32_t material : scene_.vertices().material) used[slot(material)] = true;
  // A footprint of the whole picture: textures give their mean.
  TexturePoint everywhere;
  everywhere.uv = Vec2(0.5f), everywhere.duv_dx = Vec2(4, 0), everywhere.duv_dy = Vec2(0, 4);
  for (std::size_t m = 0; m < count; ++m) {
    if (!used[m]) continue;
    const MaterialId id = m + 1 == count ? MaterialId() : MaterialId(m);
    bsdfs_[m] = make_bsdf(world.scene(), world.textures(), id, everywhere, 0.5f);
    // Tables of a material hang on its parameters alone: they are made anew when one changes.
    BakeHash hash;
    add_model(hash, bsdfs_[m]);
    hash.add(settings.brdf_samples).add(settings.sharp_lobes);
    if (id.valid()) {
      // What a BSDF only points at.
      if (const auto* measured = std::get_if<MeasuredMaterial>(&world.scene().materials[id.index].model)) hash.add(measured->content_hash);
    }
    materials_[m] = store.recent().get<MaterialTables>({"square-lights.brdf", kBrdfVersion, hash.key()}, [&] {
      SharpLobe lobe = settings.sharp_lobes ? SharpLobe::fit(bsdfs_[m]) : SharpLobe();
      BrdfTable table = BrdfTable::build(bsdfs_[m], settings.brdf_samples, context, lobe.empty() ? nullptr : &lobe);
      return MaterialTables{std::move(table), std::move(lobe)};
    });
    bytes_ += materials_[m]->bytes();
  }
}

const BrdfTable* SquareBake::brdf(std::uint32_t material) const {
  const MaterialTables* tables = materials_[slot(material)].get();
  return tables != nullptr ? &tables->brdf : nullptr;
}

void SquareBake::make_masks(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context) {
  const ShadingVertices& vertices = scene_.vertices();
  std::vector<Vec3> position(vertices.size()), normal(vertices.size()), geometric_normal(vertices.size());
  BakeHash hash;
  for (const ShadingObject& object : scene_.objects()) {
    const Mat3 normal_matrix = glm::transpose(glm::inverse(Mat3(object.world_from_object)));
    for (std::uint32_t i = object.first; i < object.first + object.count; ++i) {
      position[i] = transform_point(object.world_from_object, vertices.position[i]);
      normal[i] = glm::normalize(normal_matrix * vertices.normal[i]);
      geometric_normal[i] = glm::normalize(normal_matrix * vertices.geometric_normal[i]);
    }
    add_geometry(hash, world.scene(), object);
  }
  add_vector(hash, position), add_vector(hash, normal), add_vector(hash, geometric_normal), add_vector(hash, vertices.error);
  hash.add(std::span<const Mat3>(&world_from_environment_, 1)).add(settings.cube);
  masks_held_ = store.get({"square-lights.texel-visibility", kMasksVersion, hash.key()}, context, [&](const auto& keep) {
    announce(context, fmt::format("visibility of {} texels from {} vertices", kCubeFaces * settings.cube * settings.cube, vertices.size()),
             masks_bytes(scene_, settings));
    const TexelDirections directions = texel_directions(settings.cube, world_from_environment_);
    const AlignedVector<std::uint16_t> masks =
        trace_texels(world.tracer(), position, normal, geometric_normal, vertices.error, directions, rays_, context);
    const std::vector<BakeSection> sections{bake_section("masks", std::span<const std::uint16_t>(masks))};
    keep(sections);
  });
  masks_ = masks_held_->array<std::uint16_t>("masks");
  bytes_ += masks_held_->bytes();
}

}  // namespace sightline::square_lights
