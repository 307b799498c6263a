// The zero surface of a noise field in a cube, by marching cubes, as a stream of chunks: only a slab of the field exists at a time.
#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

#include "base/core/error.h"
#include "base/parallel/parallel.h"
#include "scene/builtin/marching_cubes.h"
#include "scene/builtin/noise.h"
#include "scene/builtin/parts.h"
#include "scene/builtin/scenes.h"
#include "scene/materialize.h"

namespace sightline::builtin {
namespace {

struct IsosurfaceSettings {
  std::uint64_t triangles = 1000000;
  int resolution = 0;
  std::uint64_t seed = 1;
  int frequency = 4, octaves = 3;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    using S = IsosurfaceSettings;
    visit("triangles", &S::triangles, {.help = "about how many; sets the resolution", .minimum = 1000, .maximum = 1e11});
    visit("resolution", &S::resolution, {.help = "grid cells an axis; 0 takes them from `triangles`", .minimum = 0, .maximum = 32768});
    visit("seed", &S::seed, {.help = "of the noise"});
    visit("frequency", &S::frequency, {.help = "coarsest noise cells an axis", .minimum = 1, .maximum = 64});
    visit("octaves", &S::octaves, {.help = "of noise, each twice as fine and half as strong", .minimum = 1, .maximum = 5});
  }
};

/// Triangles that a chunk aims for, below the 2^16 that MeshSource allows.
constexpr std::uint64_t kSurfaceChunk = 49152;

/// Grid cells [z_begin, z_end) x [y_begin, y_end) x all x.
struct Brick {
  int z_begin, z_end, y_begin, y_end;
  std::uint32_t vertices, triangles;
};

/// One row of field values and, as bits, whether each is inside. Bits past the row are 0.
struct Row {
  std::vector<float> values;
  std::vector<std::uint64_t> inside;
};

using Words = std::vector<std::uint64_t>;
/// Bits of the neighbours at x + 1.
std::uint64_t shifted(const Words& words, std::size_t i) { return words[i] >> 1 | (i + 1 < words.size() ? words[i + 1] << 63 : 0); }

/// The eight-corner test for 64 cells at once: bit set where corners differ. Rows: (y, z), (y+1, z), (y, z+1), (y+1, z+1).
std::uint64_t active_cells(const Words& a, const Words& b, const Words& c, const Words& d, std::size_t i) {
  const std::uint64_t some = a[i] | b[i] | c[i] | d[i] | shifted(a, i) | shifted(b, i) | shifted(c, i) | shifted(d, i);
  const std::uint64_t all = a[i] & b[i] & c[i] & d[i] & shifted(a, i) & shifted(b, i) & shifted(c, i) & shifted(d, i);
  return some & ~all;
}
std::size_t cube_case(const Words& a, const Words& b, const Words& c, const Words& d, std::size_t x) {
  const auto pair = [x](const Words& w) {
    const std::size_t i = x >> 6, bit = x & 63;
    return (bit < 63 ? w[i] >> bit : w[i] >> 63 | (i + 1 < w.size() ? w[i + 1] << 1 : 0)) & 3;
  };
  return pair(a) | pair(b) << 2 | pair(c) << 4 | pair(d) << 6;
}

template <class Visit>
void for_each_bit(std::uint64_t word, std::size_t i, Visit&& visit) {
  for (; word != 0; word &= word - 1) visit(i * 64 + static_cast<std::size_t>(std::countr_zero(word)));
}

/// The field that is cut: noise, and outside at the border of the cube, so that the surface is closed.
class Field {
 public:
  explicit Field(const IsosurfaceSettings& s, int resolution) : noise_(s.seed, resolution, s.frequency, s.octaves) {}
  int resolution() const { return noise_.resolution(); }

  void row(int y, int z, Row& row) const {
    const auto samples = static_cast<std::size_t>(resolution()) + 1;
    row.values.resize(samples);
    noise_.row(y, z, row.values);
    const bool border_row = y == 0 || z == 0 || y == resolution() || z == resolution();
    row.inside.assign(samples / 64 + 1, 0);
    for (std::size_t x = 0; x < samples; ++x) {
      float& v = row.values[x];
      if (border_row || x == 0 || x + 1 == samples) v = -std::fabs(v);
      if (v > 0) row.inside[x >> 6] |= std::uint64_t{1} << (x & 63);
    }
  }
  /// Place of the surface on an edge between two samples, clear of both ends so that no triangle degenerates.
  static float crossing(float a, float b) { return std::clamp(a / (a - b), 0.01f, 0.99f); }

 private:
  NoiseGrid noise_;
};

class IsosurfaceSource final : public MeshSource {
 public:
  IsosurfaceSource(const IsosurfaceSettings& s, int resolution, const Context& context) : field_(s, resolution) { plan(context); }

  std::uint64_t vertex_count() const override { return vertex_count_; }
  std::uint64_t triangle_count() const override { return triangle_count_; }
  Bounds bounds() const override { return {Vec3(-1), Vec3(1)}; }
  void restart() override { next_brick_ = 0; }
  bool next(MeshChunk& chunk) override {
    if (next_brick_ == bricks_.size()) return false;
    emit(bricks_[next_brick_++], chunk);
    return true;
  }

 private:
  /// Counts of one row of cells or edges, summed over the layers of a slab.
  struct RowCounts {
    std::uint64_t triangles = 0, at_row = 0, to_next_row = 0;  ///< vertices on edges in the row, and on edges to the next row
  };

  /// Counts crossings slab by slab, on bits alone, and cuts each slab into bricks.
  void plan(const Context& context) {
    const int n = field_.resolution();
    const int thickness = std::clamp(32768 / n, 1, 16);
    const auto slabs = static_cast<std::size_t>((n + thickness - 1) / thickness);
    std::vector<std::vector<Brick>> bricks(slabs);
    parallel_for(context, slabs, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t slab = begin; slab < end; ++slab) {
        const int z_begin = static_cast<int>(slab) * thickness;
        bricks[slab] = plan_slab(z_begin, std::min(z_begin + thickness, n));
      }
    });
    for (const auto& slab : bricks) {
      for (const Brick& brick : slab) {
        bricks_.push_back(brick);
        vertex_count_ += brick.vertices;
        triangle_count_ += brick.triangles;
      }
    }
  }

  std::vector<Brick> plan_slab(int z_begin, int z_end) const {
    const auto n = static_cast<std::size_t>(field_.resolution());
    std::vector<RowCounts> counts(n + 1);
    std::vector<Words> below, here(n + 1);
    Row row;
    for (int z = z_begin; z <= z_end; ++z) {
      for (std::size_t y = 0; y <= n; ++y) {
        field_.row(static_cast<int>(y), z, row);
        here[y] = row.inside;
      }
      for (std::size_t y = 0; y <= n; ++y) count_row(below, here, y, counts);
      below.swap(here);
      here.resize(n + 1);
    }
    std::vector<Brick> bricks;
    for (std::size_t y = 0; y < n;) {
      Brick brick{z_begin, z_end, static_cast<int>(y), 0, static_cast<std::uint32_t>(counts[y].at_row), 0};
      do {
        brick.triangles += static_cast<std::uint32_t>(counts[y].triangles);
        brick.vertices += static_cast<std::uint32_t>(counts[y].to_next_row + counts[y + 1].at_row);
        ++y;
      } while (y < n && brick.triangles + counts[y].triangles <= kSurfaceChunk);
      brick.y_end = static_cast<int>(y);
      if (brick.triangles > 0) bricks.push_back(brick);
    }
    return bricks;
  }

  static void count_row(const std::vector<Words>& below, const std::vector<Words>& here, std::size_t y, std::vector<RowCounts>& counts) {
    const auto& table = marching_cubes_table();
    const auto ones = [](std::uint64_t word) { return static_cast<std::uint64_t>(std::popcount(word)); };
    for (std::size_t i = 0; i < here[y].size(); ++i) {
      counts[y].at_row += ones(here[y][i] ^ shifted(here[y], i));
      if (y + 1 < here.size()) counts[y].to_next_row += ones(here[y][i] ^ here[y + 1][i]);
      if (below.empty()) continue;
      counts[y].at_row += ones(here[y][i] ^ below[y][i]);
      if (y + 1 == here.size()) continue;
      for_each_bit(active_cells(below[y], below[y + 1], here[y], here[y + 1], i), i, [&](std::size_t x) {
        counts[y].triangles += table[cube_case(below[y], below[y + 1], here[y], here[y + 1], x)].triangle_count;
      });
    }
  }

  /// Rows of one grid layer within a brick, with the vertex numbers of the crossings on their edges.
  struct Layer {
    std::vector<Row> rows;
    std::vector<std::vector<std::uint32_t>> on_x, on_y;
  };

  void emit(const Brick& brick, MeshChunk& chunk) {
    const auto& table = marching_cubes_table();
    const auto samples = static_cast<std::size_t>(field_.resolution()) + 1;
    const auto rows = static_cast<std::size_t>(brick.y_end - brick.y_begin) + 1;
    const float spacing = 2 / static_cast<float>(field_.resolution());
    chunk.positions.clear();
    chunk.triangles.clear();
    chunk.material = {};
    const auto prepare = [&](std::vector<std::vector<std::uint32_t>>& lines) {
      lines.resize(rows);
      for (auto& line : lines) line.resize(samples);
    };
    for (Layer* layer : {&below_, &here_}) {
      layer->rows.resize(rows);
      prepare(layer->on_x);
      prepare(layer->on_y);
    }
    prepare(on_z_);
    const auto add = [&](float x, float y, float z) {
      chunk.positions.push_back(Vec3(x, y, z) * spacing - 1.f);
      return static_cast<std::uint32_t>(chunk.positions.size() - 1);
    };
    for (int z = brick.z_begin; z <= brick.z_end; ++z) {
      const auto fz = static_cast<float>(z);
      for (std::size_t r = 0; r < rows; ++r) field_.row(brick.y_begin + static_cast<int>(r), z, here_.rows[r]);
      for (std::size_t r = 0; r < rows; ++r) {
        const Row& row = here_.rows[r];
        const float fy = static_cast<float>(brick.y_begin) + static_cast<float>(r);
        for (std::size_t i = 0; i < row.inside.size(); ++i) {
          for_each_bit(row.inside[i] ^ shifted(row.inside, i), i, [&](std::size_t x) {
            here_.on_x[r][x] = add(static_cast<float>(x) + Field::crossing(row.values[x], row.values[x + 1]), fy, fz);
          });
          if (r + 1 < rows) {
            for_each_bit(row.inside[i] ^ here_.rows[r + 1].inside[i], i, [&](std::size_t x) {
              here_.on_y[r][x] = add(static_cast<float>(x), fy + Field::crossing(row.values[x], here_.rows[r + 1].values[x]), fz);
            });
          }
          if (z == brick.z_begin) continue;
          const Row& under = below_.rows[r];
          for_each_bit(row.inside[i] ^ under.inside[i], i, [&](std::size_t x) {
            on_z_[r][x] = add(static_cast<float>(x), fy, fz - 1 + Field::crossing(under.values[x], row.values[x]));
          });
        }
      }
      if (z > brick.z_begin) {
        for (std::size_t r = 0; r + 1 < rows; ++r) emit_cells(table, r, chunk);
      }
      std::swap(below_, here_);
    }
  }

  void emit_cells(const std::array<CubeCase, 256>& table, std::size_t r, MeshChunk& chunk) const {
    const Words &a = below_.rows[r].inside, &b = below_.rows[r + 1].inside, &c = here_.rows[r].inside, &d = here_.rows[r + 1].inside;
    for (std::size_t i = 0; i < a.size(); ++i) {
      for_each_bit(active_cells(a, b, c, d, i), i, [&](std::size_t x) {
        const CubeCase& cube = table[cube_case(a, b, c, d, x)];
        const auto vertex = [&](std::uint8_t e) {
          const std::size_t low = e & 1, high = e >> 1 & 1;
          if (e < 4) return (high ? here_ : below_).on_x[r + low][x];
          if (e < 8) return (high ? here_ : below_).on_y[r][x + low];
          return on_z_[r + high][x + low];
        };
        for (std::size_t t = 0; t < cube.triangle_count; ++t) {
          const auto& edges = cube.triangles[t];
          chunk.triangles.emplace_back(vertex(edges[0]), vertex(edges[1]), vertex(edges[2]));
        }
      });
    }
  }

  Field field_;
  std::vector<Brick> bricks_;
  std::size_t next_brick_ = 0;
  std::uint64_t vertex_count_ = 0, triangle_count_ = 0;
  Layer below_, here_;
  std::vector<std::vector<std::uint32_t>> on_z_;
};

/// Triangles grow with the square of the resolution; a coarse trial tells by what factor.
int resolution_for(const IsosurfaceSettings& s, const Context& context) {
  if (s.resolution > 0) return std::max(s.resolution, 4);
  constexpr int kTrial = 128;
  const double trial = static_cast<double>(IsosurfaceSource(s, kTrial, context).triangle_count());
  if (trial <= 0) throw usage_error("this noise has no surface").remedy("choose another seed");
  return std::clamp(static_cast<int>(std::lround(kTrial * std::sqrt(static_cast<double>(s.triangles) / trial))), 4, 1 << 16);
}

Scene build_isosurface(const IsosurfaceSettings& s, const LoadOptions& options, const Context& context) {
  Scene scene;
  Mesh mesh;
  mesh.name = "isosurface";
  mesh.source = std::make_shared<IsosurfaceSource>(s, resolution_for(s, context), context);
  mesh.bounds = mesh.source->bounds();
  if (!options.keep_sources) mesh = materialize(mesh, context);
  add_mesh(scene, std::move(mesh), add_diffuse(scene, "stone", Color(0.7f, 0.66f, 0.6f)));
  scene.lights.push_back(
      {.name = "sun", .shape = DirectionalLight{.direction = glm::normalize(Vec3(-0.5f, -1, -0.7f)), .irradiance = Color(3)}, .node = {}});
  scene.environment = Environment{};
  scene.environment->scale = Color(0.4f, 0.5f, 0.65f);
  add_camera(scene, {2.6f, 2, 3.4f}, {0, -0.1f, 0}, 38);
  scene.hints.size_px = IVec2(1280, 960);
  return scene;
}

}  // namespace

BuiltinScene isosurface_scene() {
  return declare<IsosurfaceSettings, build_isosurface>("isosurface", "marching cubes of a noise field, any size, as a stream");
}

}  // namespace sightline::builtin
