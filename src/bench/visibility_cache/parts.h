// The parts of the visibility-cache benchmark: each measures one view and gives one JSON object.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/visibility_cache/cache_bench.h"
#include "bench/visibility_cache/cache_view.h"

namespace sightline {

/// The paper's charts: ray reduction, speed-up and errors against C_E, without and with anti-aliasing.
nlohmann::ordered_json cache_curves(const CacheView& view, const CacheBenchOptions& options, std::vector<BenchPicture>& pictures,
                                    const Context& context);
/// Errors against a reference in equal time: cached answers, exact rays with fewer samples, NEE++. Direct light.
nlohmann::ordered_json cache_equal_time(const CacheView& view, const CacheBenchOptions& options, const Context& context);
/// Shadow maps of several sizes beside the cache, for views with lights without extent.
nlohmann::ordered_json cache_shadow_maps(const CacheView& view, const CacheBenchOptions& options, const Context& context);
/// Nanoseconds a query and a miss on the view's own batches; the exact path beside bare Embree.
nlohmann::ordered_json cache_lookup(const CacheView& view, const CacheBenchOptions& options, const Context& context);
/// A camera move: flicker, frames a second, and a strip of frames unless there is one already.
nlohmann::ordered_json cache_flicker(CacheView view, const CacheBenchOptions& options, std::optional<ColorImage>& strip,
                                     const Context& context);
/// What single choices cost and give.
nlohmann::ordered_json cache_ablations(const CacheView& view, const CacheBenchOptions& options, const Context& context);

/// Errors of a picture against another of the view.
nlohmann::ordered_json cache_errors(const ColorImage& reference, const ColorImage& image, std::span<const std::uint8_t> mask);
/// What the counts of a picture say, beside the exact picture with the same samples.
nlohmann::ordered_json cache_rays(const Shot& shot, const Shot& exact);

}  // namespace sightline
