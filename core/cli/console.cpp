#include <core/cli/console.hpp>

#include <core/scene/display_text.hpp>

#include <nlohmann/json.hpp>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <unistd.h>

namespace rt::cli {

namespace {

/// All of it, or an errno.
int writeAll(int descriptor, const char* data, std::size_t size) {
    while (size > 0) {
        const ssize_t written = ::write(descriptor, data, size);
        if (written < 0) {
            if (errno == EINTR) continue;
            return errno;
        }
        data += written, size -= static_cast<std::size_t>(written);
    }
    return 0;
}

/// stderr has nobody to complain to.
void sayOnStderr(const std::string& text) { writeAll(STDERR_FILENO, text.data(), text.size()); }

bool isSet(const char* variable) {
    const char* const value = std::getenv(variable);
    return value && *value;
}

std::string jsonLine(const nlohmann::ordered_json& json) {
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

} // namespace

bool isCapableTerminal(int descriptor) {
    const char* const term = std::getenv("TERM");
    return ::isatty(descriptor) && !(term && std::strcmp(term, "dumb") == 0);
}

Console::Console(const CommonOptions& options)
    : options_(options),
      colour_(!options.jsonErrors && isCapableTerminal(STDERR_FILENO) && !isSet("NO_COLOR")) {}

void Console::result(std::string_view text) const {
    if (const int error = writeAll(STDOUT_FILENO, text.data(), text.size()))
        throw StdoutError(std::string("cannot write to stdout: ") + std::strerror(error));
}

void Console::result(std::span<const std::byte> bytes) const {
    result(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void Console::detail(const std::string& line) const {
    if (verbose() && !options_.jsonErrors) sayOnStderr(line + "\n");
}

void Console::table(const std::string& text) const {
    if (!quiet()) sayOnStderr(text);
}

void Console::report(const scene::Diagnostic& diagnostic) const {
    if (quiet() && diagnostic.severity != scene::Severity::error) return;
    if (!options_.jsonErrors) {
        sayOnStderr(scene::format(diagnostic, colour_));
        return;
    }
    sayOnStderr(scene::formatJson(diagnostic) + "\n");
}

void Console::report(const scene::Diagnostics& diagnostics) const {
    for (const scene::Diagnostic& diagnostic : diagnostics.all()) report(diagnostic);
    if (diagnostics.errorCount() > scene::Diagnostics::kMaxErrors && !options_.jsonErrors)
        sayOnStderr("and " +
                    std::to_string(diagnostics.errorCount() - scene::Diagnostics::kMaxErrors) +
                    " more errors\n");
}

void Console::fail(const std::string& command, int exitCode, const std::string& sentence,
                   const std::string& hint) const {
    if (options_.jsonErrors) {
        nlohmann::ordered_json json{
            {"severity", "error"}, {"exit", exitCode}, {"message", sentence}};
        if (!hint.empty()) json["suggestion"] = hint;
        sayOnStderr(jsonLine(json));
        return;
    }
    sayOnStderr("rt" + (command.empty() ? "" : " " + command) + ": " +
                (colour_ ? "\033[1;31merror:\033[0m " : "error: ") +
                scene::displayed(sentence + (hint.empty() ? "" : "; " + hint)) + "\n");
}

} // namespace rt::cli
