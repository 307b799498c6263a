// Settings of the square-lights method.
#pragma once

#include <string>

#include "base/settings/settings.h"

namespace sightline {

struct SquareLightsSettings {
  enum class Shading { vertex, pixel };
  enum class Storage { raw, cpca };
  enum class Tables { distance, summed };
  enum class Combine { product, distance };
  enum class Coverage { parallel, average, gradient };
  enum class Merge { paper, ward, moments };
  enum class Basis { squares, haar };

  std::string lights = "30";
  Basis basis = Basis::squares;
  bool area_weighted = true;
  Shading shading = Shading::vertex;
  int cube = 32;
  Merge merge = Merge::ward;
  bool exchange = true;
  Storage storage = Storage::raw;
  int clusters = 256;
  int vectors = 8;
  int occluder_vectors = 8;
  Tables tables = Tables::distance;
  Combine combine = Combine::distance;
  Coverage coverage = Coverage::parallel;
  int rays = 64;
  int occluder_rays = 64;
  bool zoom = true;
  bool count_horizon = false;
  bool area_penalty = true;
  bool paper_radius = false;
  float split = 0;
  int patches = 16;
  bool source_fields = false;
  bool sharp_lobes = true;
  int brdf_samples = 4;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    using S = SquareLightsSettings;
    visit(
        "lights", &S::lights,
        {.help = "squares that the environment is split into; all: every texel, traced by 16 rays; all-tables: every texel, by the tables",
         .symbol = "N"});
    visit("basis", &S::basis,
          {.help = "what the light is written in: squares, or as a rival Haar wavelets, of which `lights` terms are kept in each channel",
           .choices = {"squares", "haar"}});
    visit("area_weighted", &S::area_weighted, {.help = "haar: choose terms by coefficient times support"});
    visit("shading", &S::shading,
          {.help = "light vertices and interpolate colours, or light pixels with distances interpolated between vertices",
           .choices = {"vertex", "pixel"}});
    visit("cube", &S::cube, {.help = "texels along an edge of the cube map's faces", .minimum = 4, .maximum = 128, .unit = "texels"});
    visit("merge", &S::merge,
          {.help = "next pair of regions: of least error once merged, of least growth of that, or of least growth of flux² times spread of "
                   "direction, with squares that have their region's first two moments",
           .choices = {"paper", "ward", "moments"}});
    visit(
        "exchange", &S::exchange,
        {.help = "regions then exchange texels while that lessens flux² times spread of direction; squares have their first two moments"});
    visit("storage", &S::storage, {.help = "distance tables as bytes, or as clustered principal components", .choices = {"raw", "cpca"}});
    visit("clusters", &S::clusters, {.help = "cpca: clusters of a receiver's tables", .minimum = 1, .maximum = 65535, .symbol = "K"});
    visit("vectors", &S::vectors, {.help = "cpca: eigenvectors a cluster", .minimum = 0, .maximum = 64, .symbol = "n'"});
    visit("occluder_vectors", &S::occluder_vectors,
          {.help = "cpca: eigenvectors of each of an occluder's 384 segments", .minimum = 0, .maximum = 64});
    visit("tables", &S::tables,
          {.help = "self-visibility by distance tables, or by summed-area tables as a rival", .choices = {"distance", "summed"}});
    visit("combine", &S::combine,
          {.help = "several occluders: the product of what each leaves visible, or the least signed distance of all",
           .choices = {"product", "distance"}});
    visit("coverage", &S::coverage,
          {.help = "visible part of a square from a distance: Eq. 9, its mean over turns, or exact by the distance's gradient",
           .choices = {"parallel", "average", "gradient"}});
    visit("rays", &S::rays,
          {.help = "rays along an edge of a vertex's table when it is baked: a multiple of 32", .minimum = 32, .maximum = 256});
    visit("occluder_rays", &S::occluder_rays, {.help = "the same of an occluder's tables", .minimum = 32, .maximum = 256});
    visit("zoom", &S::zoom, {.help = "tables of far shells cover just the occluder; off: the paper"});
    visit("count_horizon", &S::count_horizon, {.help = "let the horizon hide light, which the BRDF does already (an ablation)"});
    visit("area_penalty", &S::area_penalty, {.help = "weigh a region's error by its area; off is an ablation"});
    visit("paper_radius", &S::paper_radius, {.help = "keep r on the disk, without the factor 1/sqrt(2) (an ablation)"});
    visit("split", &S::split,
          {.help = "split squares at each vertex while the bound of their error is above this part of the light; 0: never",
           .minimum = 0,
           .maximum = 1});
    visit("patches", &S::patches, {.help = "squares that a local light is cut into", .minimum = 1, .maximum = 256, .symbol = "n_p"});
    visit("source_fields", &S::source_fields,
          {.help = "local lights from tables around them, as the paper has them, instead of from the receiver's own place"});
    visit("sharp_lobes", &S::sharp_lobes, {.help = "lobes narrower than about 5 degrees as Gaussians, integrated over squares by formula"});
    visit("brdf_samples", &S::brdf_samples, {.help = "points along an edge of a cell of the BRDF's tables", .minimum = 1, .maximum = 16});
  }
};

}  // namespace sightline
