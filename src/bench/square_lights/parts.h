// The parts of the square-lights benchmark: each measures one view and gives one JSON object.
#pragma once

#include "bench/square_lights/stage.h"

namespace sightline {

/// What the parts share over views: bakes by all, and those that the part `bakes` begins without.
struct SquareBenchShared {
  const SquareBenchOptions& options;
  std::shared_ptr<BakeStore> bakes;
  std::shared_ptr<BakeStore> empty_bakes = std::make_shared<BakeStore>();
};

/// l2 of squares and of wavelets over their numbers, against every texel by the same tables and traced: the paper's Figures 9 and 10.
nlohmann::ordered_json square_errors(const SquareStage& stage, const SquareBenchShared& shared, const Context& context);
/// Seconds and bytes of each bake.
nlohmann::ordered_json square_bakes(SquareStage stage, const SquareBenchShared& shared, const Context& context);
/// Frames a second with everything moving that can: the paper's Table 1.
nlohmann::ordered_json square_speed(SquareStage stage, const SquareBenchShared& shared, const Context& context);
/// From the change of a material's parameter to the picture that shows it.
nlohmann::ordered_json square_edit(SquareStage stage, const SquareBenchShared& shared, const Context& context);
/// Bytes and l2 of tables stored raw and compressed: the paper's Figures 11 and 12.
nlohmann::ordered_json square_storage(const SquareStage& stage, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures,
                                      const Context& context);
/// Light turned against scene turned, and the change from step to step of a full turn.
nlohmann::ordered_json square_rotation(SquareStage stage, const SquareBenchShared& shared, const Context& context);
/// Frames of an animation against the reference; a strip of them unless there is one already.
nlohmann::ordered_json square_moving(SquareStage stage, const SquareBenchShared& shared, std::optional<ColorImage>& strip,
                                     const Context& context);
/// What goes beyond the paper or takes something away from it, on and off.
nlohmann::ordered_json square_beyond(const SquareStage& stage, const SquareBenchShared& shared, const Context& context);
/// The paper's figures with scenes of ours: each setting beside the reference.
void square_pictures(const SquareStage& stage, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures,
                     const Context& context);

/// l2, nmse and FLIP over the pixels of the mask.
nlohmann::ordered_json square_differences(const ColorImage& reference, const ColorImage& image, std::span<const std::uint8_t> mask);

}  // namespace sightline
