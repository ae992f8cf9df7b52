#include <converters/inf.hpp>

#include <converters/scene_converter.hpp>
#include <converters/statements.hpp>
#include <converters/text.hpp>

namespace rt::converters {
namespace {

constexpr scene::Code kMovieFile{201};

std::optional<scene::Node> convert(const std::shared_ptr<const scene::Source>& source,
                                   const InfOptions& options, scene::Diagnostics& diagnostics) {
    if (!source) return std::nullopt;
    if (looksLikeMovie(source)) {
        diagnostics.error(
            kMovieFile, {source, 0, 0},
            "this is a movie file: it is converted with the scene that names it, or with --movie",
            "rt convert Scene.inf --movie " + source->path);
        return std::nullopt;
    }
    scene::Diagnostics found;
    SceneText text = parseSceneText(source, options.lenient, found);
    const bool complete = !found.failed();
    scene::Node document = sceneDocument(std::move(text), source, complete, options, found);
    found.sortByPlace();
    diagnostics.add(found);
    if (found.failed()) return std::nullopt;
    return document;
}

} // namespace

std::optional<scene::Node> convertInf(const std::string& path, const InfOptions& options,
                                      scene::Diagnostics& diagnostics) {
    return convert(readText(path, {}, diagnostics), options, diagnostics);
}

std::optional<scene::Node> convertInfText(const std::string& path, std::string bytes,
                                          const InfOptions& options,
                                          scene::Diagnostics& diagnostics) {
    return convert(toText(path, std::move(bytes), diagnostics), options, diagnostics);
}

bool isMovieFile(const std::string& path) {
    scene::Diagnostics ignored;
    const auto source = readText(path, {}, ignored);
    return source && looksLikeMovie(source);
}

} // namespace rt::converters
