// Bytes as the words of a command line, one per line: understood, or refused with a sentence. What --set says goes into a scene.
#include <core/cli/command_line.hpp>
#include <core/scene/override.hpp>

#include <cstdint>
#include <cstdlib>
#include <string>

namespace {

using namespace rt;

void require(bool holds) {
    if (!holds) std::abort();
}

void apply(const cli::SceneOptions& options) {
    scene::Node root;
    root.kind = scene::Node::Kind::map;
    for (const std::string& word : options.overrides) {
        scene::Diagnostics diagnostics;
        require(scene::applyOverride(root, word, diagnostics) != diagnostics.failed());
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::vector<std::string> words{"rt"};
    const std::string text(reinterpret_cast<const char*>(data), size);
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t to = std::min(text.find('\n', from), text.size());
        words.push_back(
            text.substr(from, to - from).c_str()); // up to a NUL, as exec would hand it over
        from = to + 1;
    }
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    cli::CommandLine line;
    try {
        cli::parseCommandLine(static_cast<int>(argv.size()), argv.data(), line);
    } catch (const cli::UsageError& error) {
        require(*error.what() != '\0');
        return 0;
    }
    if (const auto* const options = std::get_if<cli::RenderOptions>(&line.options)) apply(*options);
    return 0;
}
