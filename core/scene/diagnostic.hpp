// What the program has to say about the user's files: a place, a sentence, a suggestion, an exit
// code.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rt::scene {

/// A text file as read. Shared by every location in it.
struct Source {
    std::string path; // as the user wrote it, or relative to what named it
    std::string text;
};

/// A place in a source; line and column from 1, column in bytes. line 0: the file as a whole.
struct Location {
    std::shared_ptr<const Source> source;
    std::uint32_t line = 0, column = 0;
};

/// The line of the source, without its end; none if there is no such line.
std::optional<std::string_view> lineOf(const Location& location);

/// E0<exit><nn>: the second digit is the exit code that the error ends the program with (0 for
/// notes and warnings). E0312 is explained by `rt explain E0312`, whose texts stand in
/// core/scene/explanations.cpp.
enum class Code : std::uint16_t {};

/// "E0312".
std::string codeName(Code code);

enum class Severity : std::uint8_t { note, warning, error };

struct Diagnostic {
    Severity severity = Severity::error;
    Code code{};
    Location location;
    std::string message;    // one sentence; file data in it is quoted and escaped
    std::string suggestion; // "did you mean 'radius'?", or empty
};

/// Collects; never throws, never prints. Errors beyond kMaxErrors are counted, not kept.
class Diagnostics {
public:
    static constexpr std::size_t kMaxErrors = 20;

    void error(Code code, Location location, std::string message, std::string suggestion = {});
    void warning(Location location, std::string message);
    void note(Location location, std::string message);
    /// Appends what `others` has collected.
    void add(const Diagnostics& others);

    bool failed() const { return errorCount_ != 0; }
    std::size_t errorCount() const { return errorCount_; }
    const std::vector<Diagnostic>& all() const { return all_; }
    /// Exit code of the first error, or 0.
    int exitCode() const;
    /// By file (in order of first appearance), line and column; equal places keep their order.
    void sortByPlace();

private:
    std::vector<Diagnostic> all_;
    std::size_t errorCount_ = 0;
    int exitCode_ = 0;
};

/// `scene.yaml:12:7: error[E0312]: sentence; did you mean 'radius'?`, the source line and a caret.
/// Ends with a newline.
std::string format(const Diagnostic& diagnostic, bool colour);

/// One JSON object on one line, without a newline: file, line, column, severity, code, message,
/// suggestion.
std::string formatJson(const Diagnostic& diagnostic);

/// The nearest of `candidates` within a Damerau-Levenshtein distance of 2 (and below half the
/// word), or "".
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// "'x'" with control characters and invalid UTF-8 escaped, cut to 60 characters.
std::string quoted(std::string_view fileData);

} // namespace rt::scene
