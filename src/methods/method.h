// The interface behind which every way of forming a picture lives.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bake/bake_store.h"
#include "base/core/context.h"
#include "base/settings/settings.h"
#include "film/frame.h"
#include "film/view.h"
#include "visibility/visibility.h"
#include "world/world.h"

namespace sightline {

/// Kinds of light and material, for saying what a method can handle.
enum class LightKind : std::uint8_t { point, spot, directional, rectangle, disk, sphere, mesh, environment };
enum class MaterialKind : std::uint8_t {
  diffuse,
  metallic_roughness,
  conductor,
  dielectric,
  coated_diffuse,
  phong,
  diffuse_transmission,
  mix,
  interface_only,
  ward,
  cook_torrance,
  measured
};
std::string_view name_of(LightKind kind);
std::string_view name_of(MaterialKind kind);
/// Every kind, for methods that handle whatever a scene may hold.
std::vector<LightKind> all_light_kinds();
std::vector<MaterialKind> all_material_kinds();

/// Facts about a method, as data: nobody compares method names.
struct MethodInfo {
  std::string name, help, citation;
  bool unbiased = false, consistent = false, progressive = false, needs_bake = false, deterministic = true;
  std::vector<LightKind> lights;
  std::vector<MaterialKind> materials;
};

/// What a method precomputed; opaque outside its folder.
class Bake {
 public:
  virtual ~Bake() = default;
  /// Memory that it holds, mapped files included.
  virtual std::uint64_t bytes() const { return 0; }
};

/// Everything one pass needs besides the frame.
struct RenderJob {
  std::shared_ptr<const World> world;
  const View* view = nullptr;
  SettingsValue settings;
  Visibility* visibility = nullptr;  ///< of this picture alone; a pass begins with Visibility::begin_pass
  const Bake* bake = nullptr;
  BakeStore* bakes = nullptr;  ///< where prepare() keeps what it makes; null: nowhere
  int max_bounces = 8;
  int light_samples = 0;        ///< 0 = the method's own
  std::uint32_t total_spp = 1;  ///< of the whole picture, for modes that depend on it
};

/// What a pass counted; added up over passes.
struct PassStatistics {
  RayCounts rays;
  VisibilityCounts visibility;
  std::map<std::string, double> stage_seconds;      ///< CPU seconds by stage, summed over threads
  std::map<std::string, double> method_statistics;  ///< named after the paper's terms
  PassStatistics& operator+=(const PassStatistics& other);
};

/// Stateless: state lives in the Bake and in the Frame. Thread-safe.
class Method {
 public:
  virtual ~Method() = default;
  virtual const MethodInfo& info() const = 0;
  virtual SettingsValue default_settings() const = 0;
  /// The visibility a user gets without --visibility.
  virtual std::string default_visibility() const { return "exact"; }
  /// Samples a pixel where neither user nor scene say.
  virtual int default_spp() const { return 64; }
  /// Throws Error{usage} where scene or options do not suit the method (beyond lights and materials, which the session checks).
  virtual void check(const Scene&, const RenderJob&) const {}
  virtual std::unique_ptr<const Bake> prepare(const RenderJob&, const Context&) const { return nullptr; }
  /// Passes begin at multiples of this many samples, and end at one or with the picture: what shares answers among its samples needs them
  /// in the same groups however a picture is cut into passes.
  virtual std::uint32_t pass_multiple(const RenderJob&) const { return 1; }
  /// Whether render_pass() will add a light image to the frame, which then takes more memory.
  virtual bool light_image(const RenderJob&) const { return false; }
  /// Adds samples [range.begin, range.end) of every pixel to the frame, tile by tile; tiles that have them already are skipped. N passes
  /// equal one of N. On cancellation throws Error{interrupted}; complete tiles stay valid.
  virtual void render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                           const Context& context) const = 0;
};

/// The explicit table of all methods, and the same as a look-up that names the nearest on failure.
std::span<const Method* const> methods();
const Method& find_method(std::string_view name);

/// Throws Error{usage} naming the first light or material of the scene that the method cannot handle, and the methods that can.
void check_supported(const Method& method, const Scene& scene);

}  // namespace sightline
