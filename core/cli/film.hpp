// rt render of a film: frames into a folder with a manifest, then the folder into film files.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/cli/console.hpp>
#include <core/plugin_host/catalog.hpp>
#include <core/scene/description.hpp>
#include <formats/frame_place.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rt::cli {

struct FilmPlan {
    formats::FramePlace place;
    formats::ImageFormat format; // of the frames
    std::vector<std::string> films;
    std::vector<std::uint32_t> frames; // rising
};

/// What the outputs and the scene ask for, if that is a film and not a picture; outputs are checked as for pictures.
/// Throws UsageError.
std::optional<FilmPlan> planFilm(const RenderOptions& options,
                                 const scene::Description& description,
                                 scene::Diagnostics& diagnostics);

/// The frame that a picture of a film shows. Throws UsageError if --frames names several.
std::uint32_t pictureFrame(const RenderOptions& options, const scene::Description& description);

/// Exit code.
int renderFilm(const FilmPlan& plan, const RenderOptions& options,
               const scene::Description& description, plugin_host::Catalog& catalog,
               Console& console);

} // namespace rt::cli
