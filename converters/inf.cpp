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
    const std::size_t errors = diagnostics.errorCount();
    SceneText text = parseSceneText(source, options.lenient, diagnostics);
    const bool complete = diagnostics.errorCount() == errors;
    scene::Node document = sceneDocument(std::move(text), source, complete, options, diagnostics);
    if (diagnostics.errorCount() != errors) return std::nullopt;
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
