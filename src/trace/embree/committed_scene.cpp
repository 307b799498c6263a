#include "trace/embree/committed_scene.h"

#include <algorithm>
#include <cmath>

#include "trace/embree/alpha_filter.h"

namespace sightline {
namespace {

// Releases Embree's handle once a scene holds it.
struct Geometry {
  RTCGeometry handle;
  Geometry(RTCDevice device, RTCGeometryType type) : handle(rtcNewGeometry(device, type)) {}
  ~Geometry() {
    if (handle) rtcReleaseGeometry(handle);
  }
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;

  void attach(RTCScene scene, unsigned id, HitFilter filter) {
    if (filter.holes) {
      rtcSetGeometryIntersectFilterFunction(handle, reject_holes);
      rtcSetGeometryOccludedFilterFunction(handle, reject_holes);
    }
    if (filter.interfaces) rtcSetGeometryOccludedFilterFunction(handle, reject_holes_and_interfaces);
    rtcCommitGeometry(handle);
    rtcAttachGeometryByID(scene, handle, id);
  }
};

}  // namespace

CommittedScene::CommittedScene(std::shared_ptr<EmbreeDevice> device) : device_(std::move(device)), scene_(rtcNewScene(device_->get())) {}

CommittedScene::~CommittedScene() {
  if (scene_) rtcReleaseScene(scene_);
}

std::uint64_t CommittedScene::triangle_count() const {
  std::uint64_t count = 0;
  for (const TriangleGeometry& g : geometries_) count += g.triangles.size();
  return count;
}

bool CommittedScene::serves(std::span<const TriangleGeometry> geometries) const {
  return std::equal(geometries.begin(), geometries.end(), geometries_.begin(), geometries_.end(),
                    [](const TriangleGeometry& wanted, const TriangleGeometry& have) {
                      return wanted.positions == have.positions && wanted.triangles == have.triangles && have.filter.covers(wanted.filter);
                    });
}

SceneCommitter::SceneCommitter(std::shared_ptr<EmbreeDevice> device, EmbreeDevice::Build& build, bool robust, bool compact,
                               std::uint64_t total_triangles)
    : device_(std::move(device)),
      build_(build),
      robust_(robust),
      compact_(compact),
      total_triangles_(static_cast<double>(std::max<std::uint64_t>(total_triangles, 1))) {}

bool SceneCommitter::on_progress(void* self, double fraction) {
  const auto& committer = *static_cast<const SceneCommitter*>(self);
  const Context& context = committer.build_.context();
  const double done = committer.done_triangles_ + std::clamp(fraction, 0.0, 1.0) * committer.current_triangles_;
  context.report("build", std::min(done, committer.total_triangles_), committer.total_triangles_);
  return !context.cancelled.load(std::memory_order_relaxed);
}

void SceneCommitter::commit(CommittedScene& scene, std::uint64_t triangle_count) {
  // Errors of attaching come first: a scene that lacks a geometry must not be committed as if it were whole.
  build_.check();
  int flags = RTC_SCENE_FLAG_NONE;
  if (robust_) flags |= RTC_SCENE_FLAG_ROBUST;
  if (compact_) flags |= RTC_SCENE_FLAG_COMPACT;
  rtcSetSceneFlags(scene.scene_, static_cast<RTCSceneFlags>(flags));
  current_triangles_ = static_cast<double>(triangle_count);
  rtcSetSceneProgressMonitorFunction(scene.scene_, on_progress, this);
  rtcCommitScene(scene.scene_);
  rtcSetSceneProgressMonitorFunction(scene.scene_, nullptr, nullptr);
  build_.check();
  done_triangles_ += current_triangles_;
  build_.context().report("build", std::min(done_triangles_, total_triangles_), total_triangles_);
}

std::shared_ptr<const CommittedScene> SceneCommitter::commit_triangles(std::vector<TriangleGeometry> geometries) {
  const std::int64_t bytes_before = device_->bytes();
  auto scene = std::make_shared<CommittedScene>(device_);
  scene->geometries_ = std::move(geometries);
  for (std::size_t i = 0; i < scene->geometries_.size(); ++i) {
    const TriangleGeometry& source = scene->geometries_[i];
    Geometry geometry(device_->get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry.handle, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, source.positions.data(), 0, sizeof(Vec3),
                               source.positions.size());
    rtcSetSharedGeometryBuffer(geometry.handle, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, source.triangles.data(), 0, sizeof(UVec3),
                               source.triangles.size());
    geometry.attach(scene->scene_, static_cast<unsigned>(i), source.filter);
  }
  commit(*scene, scene->triangle_count());
  scene->bytes_ = static_cast<std::uint64_t>(std::max<std::int64_t>(0, device_->bytes() - bytes_before));
  return scene;
}

std::shared_ptr<const CommittedScene> SceneCommitter::commit_top(std::span<const InstanceGeometry> instances,
                                                                 std::span<const Sphere> spheres, HitFilter sphere_filter) {
  const std::int64_t bytes_before = device_->bytes();
  auto scene = std::make_shared<CommittedScene>(device_);
  for (std::size_t i = 0; i < instances.size(); ++i) {
    Geometry geometry(device_->get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry.handle, instances[i].mesh->get());
    rtcSetGeometryTransform(geometry.handle, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &instances[i].world_from_object[0][0]);
    geometry.attach(scene->scene_, static_cast<unsigned>(i), {});
    scene->instanced_.push_back(instances[i].mesh);
  }
  if (!spheres.empty()) {
    Geometry geometry(device_->get(), RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto* points = static_cast<Vec4*>(
        rtcSetNewGeometryBuffer(geometry.handle, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(Vec4), spheres.size()));
    build_.check();
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      // Embree leaves out points of negative radius, so that the others keep their index.
      const bool usable = is_finite(spheres[i].center) && std::isfinite(spheres[i].radius) && spheres[i].radius > 0;
      points[i] = usable ? Vec4(spheres[i].center, spheres[i].radius) : Vec4(0, 0, 0, -1);
    }
    geometry.attach(scene->scene_, static_cast<unsigned>(instances.size()), sphere_filter);
  }
  commit(*scene, 0);
  scene->bytes_ = static_cast<std::uint64_t>(std::max<std::int64_t>(0, device_->bytes() - bytes_before));
  return scene;
}

}  // namespace sightline
