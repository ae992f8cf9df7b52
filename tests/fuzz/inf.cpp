// libFuzzer: any bytes as a scene file, and as the movie file of a scene, strict and lenient. Whatever is not
// converted must say why.
#include <converters/inf.hpp>
#include <converters/node_building.hpp>
#include <converters/statements.hpp>

#include <iconv.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace {

using namespace rt;

void require(bool condition, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "%s\n", what);
    std::abort();
}

void check(const std::optional<scene::Node>& document, const scene::Diagnostics& diagnostics) {
    require(document.has_value() != diagnostics.failed(),
            "a document and errors exclude each other");
    if (document) require(!converters::flowText(*document).empty(), "an empty document");
    for (const scene::Diagnostic& each : diagnostics.all())
        require(!scene::format(each, false).empty(), "nothing is said");
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    static const iconv_t kKeptOpen =
        iconv_open("UTF-8", "GB18030"); // else each input loads the C library's module
    (void)kKeptOpen;
    const bool lenient = data[0] & 1, movie = data[0] & 2;
    const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
    converters::InfOptions options;
    options.lenient = lenient;

    scene::Diagnostics diagnostics;
    if (!movie) {
        check(converters::convertInfText("scene.inf", text, options, diagnostics), diagnostics);
        return 0;
    }
    static const char* const kMoviePath = [] {
        static char path[] = "/tmp/rt-fuzz-XXXXXX";
        require(::mkstemp(path) >= 0, "no temporary file");
        return path;
    }();
    static const std::string kMeshPath = [] { // twelve faces, which a movie file numbers
        const std::string path = kMoviePath + std::string(".obj");
        std::FILE* mesh = std::fopen(path.c_str(), "wb");
        require(mesh, "no temporary file");
        std::fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\n", mesh);
        for (int face = 0; face < 12; ++face) std::fputs("f 1 2 3\n", mesh);
        std::fclose(mesh);
        return path;
    }();
    std::FILE* file = std::fopen(kMoviePath, "wb");
    require(file && std::fwrite(text.data(), 1, text.size(), file) == text.size(),
            "the temporary file cannot be written");
    std::fclose(file);
    options.moviePath = kMoviePath;
    const std::string scene =
        "window 64 48\nscene 0 0 0 9 9 9\ncamera 8 6 6 1 1 1 0 1 0 0 0 1\ntexture a.bmp\nback 0\n"
        "sphere 1 2 3 4 1 1 1 1 1 1 0 0 0 0 0 0 0 0 0 1 1\n"
        "obj " +
        kMeshPath + " box normal 1 2 3 4 1 1 1 1 1 1 0 0 0 0 0 0 0 0 0 1 1\n";
    check(converters::convertInfText("scene.inf", scene, options, diagnostics), diagnostics);
    return 0;
}
