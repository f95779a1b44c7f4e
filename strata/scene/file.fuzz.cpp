// SPDX-License-Identifier: Apache-2.0
// For any bytes, the scene reader must give a one-line error, or a scene that is unchanged when written and read again.
#include <stdexcept>

#include "core/fuzz_target.h"
#include "strata/scene/envelope.h"
#include "strata/scene/file.h"

namespace graze::strata {
namespace {

const RegisterFuzzTarget kScene("scene", [](std::string_view bytes) {
  try {
    const SceneFile scene = parse_scene("scene", bytes);
    const std::string text = scene_text(scene);
    must_hold(parse_scene("again", text) == scene, "a scene's text gives the same scene");
    must_hold(scene_text(parse_scene("again", text)) == text, "the same scene gives the same text");
    const Scene drawn = resolved(scene);
    for (int axis = 0; axis < 3; ++axis)
      must_hold(component(drawn.low, axis) <= component(drawn.high, axis), "an extent is not empty");
  } catch (const std::runtime_error& error) {
    must_be_one_line(error.what());
  }
});

}  // namespace
}  // namespace graze::strata
