#include <cstdlib>
#include <filesystem>

#include "image/io/image_io.h"
#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline {
namespace {

/// A scene with something of everything.
const std::string kEverything = R"(# a comment
LookAt 3 4 1.5  .5 .5 0  0 0 1
Camera "perspective" "float fov" 45
Film "rgb" "string filename" "simple.exr" "integer xresolution" [ 400 ] "integer yresolution" [ 300 ]
Sampler "halton" "integer pixelsamples" 128
Integrator "volpath" "integer maxdepth" 7
WorldBegin
LightSource "infinite" "rgb L" [ .4 .45 .5 ]
LightSource "distant" "point3 from" [ -30 40 100 ] "blackbody L" 3000 "float scale" 1.5
MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_a" [ 1 2 3 ]
Texture "checks" "spectrum" "checkerboard" "float uscale" 16 "rgb tex1" .1 "rgb tex2" [ .8 .8 .8 ]
AttributeBegin
  MediumInterface "m" ""
  Material "dielectric" "spectrum eta" "glass-BK7"
  Shape "sphere" "float radius" 1 "float zmax" .5
AttributeEnd
ObjectBegin "o"
  ReverseOrientation
  Shape "bilinearmesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 1 1 1 ]
  Shape "loopsubdiv" "integer levels" 2 "point3 P" [ 0 0 0 1 0 0 0 1 0 1 1 1 ] "integer indices" [ 0 1 2 2 1 3 ]
ObjectEnd
AttributeBegin
  ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 -1 1 ]
  ObjectInstance "o"
  Attribute "material" "float roughness" .2
  MakeNamedMaterial "c" "string type" "conductor" "spectrum k" [ 400 1 500 2 ]
  NamedMaterial "c"
  AreaLightSource "diffuse" "rgb L" [ 5 5 5 ] "float power" 3
  Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point3 P" [ -2 -2 0 2 -2 0 2 2 0 -2 2 0 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ]
  Shape "disk"
AttributeEnd
)";

std::string with_good_tex(std::string text) {
  const std::string from = "\"rgb tex1\" .1";
  text.replace(text.find(from), from.size(), "\"rgb tex1\" [ .1 .1 .1 ]");
  return text;
}

/// Reads whatever comes; only Error{input} may leave.
bool survives(const std::string& text) {
  try {
    parse_text(text);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    EXPECT_NE(std::string(error.what()).find("test.pbrt:"), std::string::npos) << error.what();
    return false;
  }
}

TEST(PbrtMalformed, TheWholeSceneIsFine) {
  const Scene scene = parse_text(with_good_tex(kEverything));
  EXPECT_EQ(scene.instances.size(), 5u);
  EXPECT_NE(error_of(kEverything).find("test.pbrt:11:62: \"rgb tex1\" has 1 numbers, not a multiple of 3"), std::string::npos)
      << error_of(kEverything);
}

TEST(PbrtMalformed, TruncatedAnywhereItIsReadOrRefusedWithAPlace) {
  const std::string text = with_good_tex(kEverything);
  std::size_t refused = 0;
  for (std::size_t length = 0; length < text.size(); length += 3) refused += survives(text.substr(0, length)) ? 0 : 1;
  EXPECT_GT(refused, text.size() / 3 / 2);
}

TEST(PbrtMalformed, GarbledBytesNeverDoWorse) {
  const std::string text = with_good_tex(kEverything);
  std::uint32_t state = 12345;
  for (int round = 0; round < 300; ++round) {
    std::string garbled = text;
    for (int k = 0; k < 4; ++k) {
      state = state * 1664525u + 1013904223u;
      garbled[(state >> 8) % garbled.size()] = "\"[]# \n-9eZ\0\xff"[(state >> 3) % 12];
    }
    survives(garbled);
  }
}

TEST(PbrtMalformed, MessagesNameWhatWasExpected) {
  EXPECT_EQ(error_of(""), "test.pbrt:1:1: the file ends before WorldBegin");
  EXPECT_EQ(error_of("WorldBegin\nTranslate 1 2"), "test.pbrt:2:14: the file ends where a number is expected");
  EXPECT_EQ(error_of("WorldBegin\nTranslate 1 2 x"), "test.pbrt:2:15: 'x' is not a number");
  EXPECT_EQ(error_of("WorldBegin\nTransform [1 2 3]"), "test.pbrt:2:17: ']' is not a number");
  EXPECT_EQ(error_of("WorldBegin\nShape"), "test.pbrt:2:6: a shape type in quotes is expected where the file ends");
  EXPECT_EQ(error_of("WorldBegin\n\"Shape\""), "test.pbrt:2:1: a directive is expected, not 'Shape'");
  EXPECT_EQ(error_of("WorldBegin\nSpahe \"sphere\""), "test.pbrt:2:1: unknown directive 'Spahe'; did you mean 'Scale'?");
  EXPECT_EQ(error_of("WorldBegin\nShape \"sphere\" \"radius\" 1"),
            "test.pbrt:2:16: \"radius\" is not a parameter of the form \"type name\"");
  EXPECT_EQ(error_of("WorldBegin\nShape \"sphere\" \"flat radius\" 1"), "test.pbrt:2:16: unknown parameter type 'flat'");
  EXPECT_EQ(error_of("WorldBegin\nShape \"sphere\" \"float radius\""), "test.pbrt:2:30: \"float radius\" has no value");
  EXPECT_EQ(error_of("WorldBegin\nShape \"sphere\" \"float radius\" [1"), "test.pbrt:2:33: the list of \"float radius\" is not closed");
  EXPECT_EQ(error_of("WorldBegin\nShape \"sphere\" \"float radius\" \"one\""), "test.pbrt:2:31: 'one' is no value for \"float radius\"");
  EXPECT_EQ(error_of("WorldBegin\nShape \"sphere\" \"float radius\" -1"), "test.pbrt:2:1: \"float radius\" is not positive");
  EXPECT_EQ(error_of("Shape \"sphere\""), "test.pbrt:1:1: Shape before WorldBegin");
}

TEST(PbrtMalformed, DeepNestingIsHarmless) {
  std::string text = "WorldBegin\n";
  for (int i = 0; i < 20000; ++i) text += "AttributeBegin Attribute \"shape\" \"float a\" 1\n";
  EXPECT_NE(error_of(text).find("is never closed"), std::string::npos);
}

TEST(PbrtMalformed, OldDialectsAreReadWithWarningsOrRefusedWithAPlace) {
  const char* const data = std::getenv("SIGHTLINE_DATA");
  if (data == nullptr) return;
  std::error_code error;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(data) / "pbrt", error)) {
    if (entry.path().extension() != ".pbrt" || entry.path().string().find("v3-small") == std::string::npos) continue;
    try {
      const Context context;
      load_pbrt(entry.path(), {}, context);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    }
  }
}

}  // namespace
}  // namespace sightline
