// rt explain: what an error code means and what to do.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/scene/explanations.hpp>

#include <charconv>

namespace rt::cli {

namespace {

/// "E0312", "e312" or "312" to 312; 0 for anything else.
unsigned codeOf(std::string_view word) {
    if (word.starts_with('E') || word.starts_with('e')) word.remove_prefix(1);
    unsigned code = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), code);
    return error == std::errc() && rest == word.data() + word.size() && code <= 9999 ? code : 0;
}

} // namespace

int explain(const ExplainOptions& options, Console& console) {
    if (options.code.empty()) {
        std::string text;
        for (const scene::Explanation& explanation : scene::explanations())
            text +=
                scene::codeName(explanation.code) + "  " + std::string(explanation.title) + "\n";
        console.result(text);
        return kExitOk;
    }
    const unsigned wanted = codeOf(options.code);
    for (const scene::Explanation& explanation : scene::explanations())
        if (wanted == static_cast<unsigned>(explanation.code)) {
            console.result(scene::codeName(explanation.code) + ": " +
                           std::string(explanation.title) + "\n\n" + std::string(explanation.text) +
                           "\n");
            return kExitOk;
        }
    throw UsageError("there is no code " + scene::quoted(options.code), "rt explain lists them");
}

} // namespace rt::cli
