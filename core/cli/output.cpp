#include <core/cli/output.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <new>
#include <system_error>

#include <sys/statvfs.h>
#include <unistd.h>

namespace rt::cli {

namespace {

namespace fs = std::filesystem;

constexpr scene::Code kUnknownSuffix{601}, kNoFolder{602}, kFolderRefuses{603}, kNotAFile{604},
    kWriteFailed{605}, kOutside{615};

void error(scene::Diagnostics& diagnostics, scene::Code code, const std::string& path,
           std::string sentence, std::string suggestion = {}) {
    diagnostics.error(code, wholeFile(path), std::move(sentence), std::move(suggestion));
}

/// What legacy scenes and films name; a picture is one of its images.
bool isFilm(const fs::path& path) {
    std::string suffix = path.extension().string();
    for (char& c : suffix) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return suffix == ".avi" || suffix == ".mp4" || suffix == ".mkv" || suffix == ".mov" ||
           suffix == ".webm" || suffix == ".mpg";
}

/// Where a scene, and not the command line, says to write, links included.
bool isBelowCurrentFolder(const std::string& path) {
    std::error_code error;
    const fs::path here = fs::canonical(".", error),
                   there = fs::weakly_canonical(fs::absolute(path, error), error);
    return !error &&
           std::mismatch(here.begin(), here.end(), there.begin(), there.end()).first == here.end();
}

/// Where the format says before anything is drawn how large the file will be.
void warnOfSpace(const Output& output, const scene::Image& image, scene::Diagnostics& diagnostics) {
    const std::uint64_t bytesPerPixel = output.format == formats::ImageFormat::pfm   ? 12
                                        : output.format == formats::ImageFormat::bmp ? 3
                                                                                     : 0;
    const std::uint64_t needed = bytesPerPixel * image.width * image.height;
    const fs::path target(output.path);
    struct statvfs space {};
    if (needed == 0 ||
        ::statvfs(target.has_parent_path() ? target.parent_path().c_str() : ".", &space) != 0)
        return;
    const std::uint64_t free = std::uint64_t{space.f_bavail} * space.f_frsize;
    if (free < needed)
        diagnostics.warning({std::make_shared<scene::Source>(scene::Source{output.path, {}}), 0, 0},
                            "needs " + std::to_string(needed) + " bytes, and its disk has " +
                                std::to_string(free) + " left");
}

std::string suffixSuggestion(const fs::path& path) {
    const std::string suffix = path.extension().string();
    const std::string near =
        suffix.size() < 2 ? ""
                          : scene::nearest(suffix.substr(1), {"png", "jpg", "jpeg", "bmp", "exr",
                                                              "pfm", "mp4", "avi", "mkv", "webm"});
    return near.empty() ? "" : "did you mean '." + near + "'?";
}

} // namespace

void checkWritable(const std::string& path, scene::Diagnostics& diagnostics) {
    std::error_code failure;
    const fs::path target(path);
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    const fs::file_status there = fs::status(target, failure);
    if (fs::is_directory(there))
        return error(diagnostics, kNotAFile, path, "is a folder", "name a file in it");
    if (fs::exists(there) && !fs::is_regular_file(there))
        return error(diagnostics, kNotAFile, path, "is not a regular file",
                     "for a pipe use -o - and the shell's |");
    const fs::file_status folderStatus = fs::status(folder, failure);
    if (!fs::exists(folderStatus))
        return error(diagnostics, kNoFolder, path,
                     "the folder " + scene::quoted(folder.string()) + " does not exist",
                     "try: mkdir -p " + folder.string());
    if (!fs::is_directory(folderStatus))
        return error(diagnostics, kNoFolder, path,
                     scene::quoted(folder.string()) + " is not a folder");
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        return error(diagnostics, kFolderRefuses, path,
                     "cannot write into the folder " + scene::quoted(folder.string()) + ": " +
                         std::strerror(errno));
}

std::vector<Output> planOutputs(const RenderOptions& options, const scene::Description& description,
                                scene::Diagnostics& diagnostics) {
    std::vector<std::string> paths = options.outputs;
    const bool byScene = paths.empty();
    if (byScene) {
        const std::string still = fs::path(options.scene).stem().string() + ".png";
        const std::string& said = description.image.file;
        paths.push_back(said.empty() || isFilm(said) ? still : said);
        if (isFilm(said))
            diagnostics.warning(wholeFile(options.scene),
                                "image.file is a film, " + scene::quoted(said) +
                                    "; its first image is drawn into " + scene::quoted(still));
    }
    std::vector<Output> outputs;
    for (const std::string& path : paths) {
        const std::optional<formats::ImageFormat> bySuffix =
            path == "-" ? formats::ImageFormat::png : formats::imageFormatOf(path);
        if (!options.format && !bySuffix) {
            error(diagnostics, kUnknownSuffix, path,
                  "the suffix must be png, jpg, jpeg, bmp, exr or pfm, or mp4, avi, mkv or webm "
                  "for a film",
                  suffixSuggestion(path));
            continue;
        }
        if (path != "-") checkWritable(path, diagnostics);
        if (byScene && !isBelowCurrentFolder(path))
            error(diagnostics, kOutside, path, "leads out of the current folder by a link",
                  "to write there: -o " + path);
        outputs.push_back({path, options.format ? *options.format : *bySuffix});
        if (path != "-" && !options.crop)
            warnOfSpace(outputs.back(), description.image, diagnostics);
    }
    return outputs;
}

std::vector<std::byte> encodePicture(const image::Framebuffer& frame, formats::ImageFormat format,
                                     const RenderOptions& options, const scene::Image& image) {
    constexpr int kJpegQuality = 95;
    const formats::Encoding encoding{.transfer = image.encoding,
                                     .bits = image.bits,
                                     .quality = options.quality.value_or(kJpegQuality)};
    const bool keepsLargeValues =
        format == formats::ImageFormat::pfm || format == formats::ImageFormat::exr;
    if (keepsLargeValues || options.shade == trace::Shade::full)
        return formats::encodeImage(frame, format, encoding);
    image::Framebuffer scaled = frame;
    trace::scaleForDisplay(scaled, options.shade);
    return formats::encodeImage(scaled, format, encoding);
}

image::Framebuffer cut(const image::Framebuffer& frame, const Rectangle& r) {
    image::Framebuffer part(r[2] - r[0], r[3] - r[1]);
    for (std::uint32_t y = 0; y < part.height; ++y)
        std::copy_n(&frame.at(r[0], r[1] + y), part.width, &part.at(0, y));
    return part;
}

scene::Location wholeFile(const std::string& path) {
    return {std::make_shared<scene::Source>(scene::Source{path, {}}), 0, 0};
}

std::string partialName(const std::string& path) {
    if (path == "-") return path;
    const fs::path whole(path);
    return (whole.parent_path() / (whole.stem().string() + ".partial" + whole.extension().string()))
        .string();
}

namespace {

/// "No space left on device (36880 bytes needed, 0 free)": what() is "cannot write 'PATH' (...): reason".
std::string reasonOf(const std::system_error& problem) {
    const std::string what = problem.what(), reason = problem.code().message();
    const std::size_t open = what.rfind(" ("), close = what.rfind("): ");
    const bool space = open != what.npos && close != what.npos && open < close &&
                       what.substr(open, close - open).ends_with(" free");
    return space ? reason + what.substr(open, close + 1 - open) : reason;
}

} // namespace

bool writeOutput(const std::string& path, const std::vector<std::byte>& bytes,
                 const Console& console, scene::Diagnostics& diagnostics) {
    if (path == "-") {
        console.result(bytes);
        return true;
    }
    try {
        std::error_code failure;
        const fs::path resolved =
            fs::is_symlink(path, failure) ? fs::weakly_canonical(path) : fs::path(path);
        formats::writeFileAtomically(resolved.string(), bytes);
        return true;
    } catch (const std::system_error& problem) {
        if (problem.code() == std::errc::not_enough_memory) throw std::bad_alloc();
        error(diagnostics, kWriteFailed, path,
              "cannot be written: " + reasonOf(problem) + "; what was there before is untouched");
        return false;
    }
}

} // namespace rt::cli
