// Where pictures go: checked before anything is traced, so that nobody waits for a picture that cannot be saved.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/cli/console.hpp>
#include <core/image/framebuffer.hpp>
#include <core/scene/description.hpp>
#include <formats/image_writer.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rt::cli {

struct Output {
    std::string path; // as the user wrote it; "-": stdout
    formats::ImageFormat format;
};

/// The outputs of `--output`, or else the scene's own file, or else ./<stem>.png; all of them checked: the suffix is known, the
/// folder is there and takes files, what is there now is a regular file. Errors E0601 to E0604, E0615.
std::vector<Output> planOutputs(const RenderOptions& options, const scene::Description& description,
                                scene::Diagnostics& diagnostics);

/// Folder of `path` exists and takes files, and `path` itself is a regular file or nothing. Gains E0602 to E0605.
void checkWritable(const std::string& path, scene::Diagnostics& diagnostics);

/// What a file of this format holds: depth and cost scaled for display, unless the format keeps large values. Throws
/// std::runtime_error.
std::vector<std::byte> encodePicture(const image::Framebuffer& frame, formats::ImageFormat format,
                                     const RenderOptions& options, const scene::Image& image);

/// The pixels within `--crop`.
image::Framebuffer cut(const image::Framebuffer& frame, const Rectangle& rectangle);

/// The place of an error about a file as a whole.
scene::Location wholeFile(const std::string& path);

/// `out/a.png` -> `out/a.partial.png`; stdout stays.
std::string partialName(const std::string& path);

/// Writes bytes to a file through any symbolic link, or to stdout. Gains E0605 when that fails.
bool writeOutput(const std::string& path, const std::vector<std::byte>& bytes,
                 const Console& console, scene::Diagnostics& diagnostics);

} // namespace rt::cli
