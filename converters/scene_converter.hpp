// A legacy scene's statements to a scene-language document.
#pragma once
#include <converters/inf.hpp>
#include <converters/statements.hpp>

namespace rt::converters {

/// Errors E0384 and E0390 to E0394, and those of the movie file that the scene names. `complete`: no statement of the
/// file had to be dropped, so that what is counted or absent means something.
scene::Node sceneDocument(SceneText text, const std::shared_ptr<const scene::Source>& source,
                          bool complete, const InfOptions& options,
                          scene::Diagnostics& diagnostics);

} // namespace rt::converters
