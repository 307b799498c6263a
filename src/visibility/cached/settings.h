// Settings of the visibility cache; symbols are those of [Popov2013].
#pragma once

#include <cstdint>

#include "visibility/query_batch.h"

namespace sightline {

enum class CacheRefinement : std::uint8_t { none, four, sixty_four };
enum class CacheHash : std::uint8_t { separable, recurrence, mix64 };
enum class CacheNormals : std::uint8_t { rounded, floored };
enum class CacheSphere : std::uint8_t { equal_area, octahedral };
enum class CacheScope : std::uint8_t { tile, pass, frame };

struct CachedVisibilitySettings {
  float ce = 8;
  float ce_point = 0, ce_directional = 0, ce_area = 0, ce_vpl = 0, ce_environment = 0;
  CacheRefinement refine = CacheRefinement::four;
  int depth = 0;
  CacheHash hash = CacheHash::separable;
  CacheNormals normals = CacheNormals::rounded;
  int directions = 8;
  int flatness = 8;
  float level_ratio = 1.4f;
  CacheSphere sphere = CacheSphere::equal_area;
  bool eq9_as_printed = false;
  int table_bits = 18;
  int shared_table_bits = 24;
  CacheScope scope = CacheScope::pass;
  bool reuse = false;
  int group = 512;
  float residual = 0;
  float residual_edge = 4;
  int counters = 0;
  int light_refine = 0;
  float importance = 6;

  /// C_E of one class of light ends.
  float ce_of(QuerySemantic semantic, SurfaceEnds surface) const {
    float own = 0;
    switch (semantic) {
      case QuerySemantic::point:
        own = ce_point;
        break;
      case QuerySemantic::direction:
        own = ce_directional;
        break;
      case QuerySemantic::solid_angle:
        own = ce_environment;
        break;
      case QuerySemantic::surface:
        own = surface == SurfaceEnds::area_light ? ce_area : surface == SurfaceEnds::virtual_light ? ce_vpl : 0;
        break;
    }
    return own > 0 ? own : ce;
  }

  template <class Visitor>
  static void describe(Visitor&& visit) {
    using S = CachedVisibilitySettings;
    const auto error = [&](const char* name, float S::* member, const char* help) {
      visit(name, member, {.help = help, .minimum = 0, .maximum = 1e6, .unit = "px"});
    };
    visit("ce", &S::ce,
          {.help = "edge of the screen area that shares an answer, in eye paths", .minimum = 1e-3, .maximum = 1e6, .symbol = "C_E"});
    error("ce_point", &S::ce_point, "the same for point lights; 0 = ce");
    error("ce_directional", &S::ce_directional, "the same for directional lights; 0 = ce");
    error("ce_area", &S::ce_area, "the same for area lights; 0 = ce");
    error("ce_vpl", &S::ce_vpl, "the same for virtual point lights; 0 = ce");
    error("ce_environment", &S::ce_environment, "the same for environments; 0 = ce");
    visit("refine", &S::refine,
          {.help = "neighbours that must agree, else the cell is refined; connections of paths are never refined",
           .choices = {"none", "4", "64"}});
    visit("depth", &S::depth,
          {.help = "levels of refinement; 0 = until cells are about one eye path wide", .minimum = 0, .maximum = 16, .symbol = "C_MSR"});
    visit("hash", &S::hash,
          {.help = "separable: parts of both ends, mixed once a query; the others: the paper's two recurrences",
           .choices = {"separable", "recurrence", "mix64"}});
    visit("normals", &S::normals,
          {.help = "rounded: axis-aligned normals lie in the middle of a bin; floor: as printed", .choices = {"rounded", "floor"}});
    visit("directions", &S::directions, {.help = "bins of a normal an axis", .minimum = 2, .maximum = 32, .symbol = "C_N"});
    visit("flatness", &S::flatness, {.help = "cells along the normal for one across", .minimum = 1, .maximum = 32, .symbol = "C_Z"});
    visit("level_ratio", &S::level_ratio, {.help = "ratio of grid resolutions", .minimum = 1.1, .maximum = 2.5, .symbol = "C_R"});
    visit("sphere", &S::sphere,
          {.help = "map of the sphere that is cut into cells for environments", .choices = {"equal_area", "octahedral"}});
    visit("eq9_as_printed", &S::eq9_as_printed, {.help = "resolution of environments as equation 9 is printed (ablation)"});
    visit("table_bits", &S::table_bits,
          {.help = "log2 of the slots of a thread's table", .minimum = 10, .maximum = 28, .symbol = "log2 C_T"});
    visit("shared_table_bits", &S::shared_table_bits,
          {.help = "log2 of the slots of the table that waves share", .minimum = 10, .maximum = 30, .symbol = "log2 C_T"});
    visit("scope", &S::scope,
          {.help = "what waves share answers in: a batch, a pass, or all passes of a frame; tiles always keep to themselves",
           .choices = {"tile", "pass", "frame"}});
    visit("reuse", &S::reuse, {.help = "waves keep answers from frame to frame: only for still geometry"});
    visit("group", &S::group, {.help = "queries between two packets of missing rays", .minimum = 16, .maximum = 1 << 20});
    visit("residual", &S::residual,
          {.help = "probability of a ray that corrects a cached answer: unbiased, not binary; 0 = off", .minimum = 0, .maximum = 1});
    visit("residual_edge", &S::residual_edge, {.help = "times more likely where neighbours disagreed", .minimum = 1, .maximum = 1000});
    visit("counters", &S::counters,
          {.help = "rays that a cell takes before it is trusted where no neighbour contradicts it, counted by outcome: mixed cells are "
                   "refined; 0 = one, not counted",
           .minimum = 0,
           .maximum = 7});
    visit("importance", &S::importance,
          {.help = "queries that would carry more than so many times the mean of those asked with them are traced; 0 = none",
           .minimum = 0,
           .maximum = 1e6});
    visit("light_refine", &S::light_refine,
          {.help = "levels of refinement at the light once cells at the eye are smallest", .minimum = 0, .maximum = 4});
  }
};

}  // namespace sightline
