// Who says what where: results on stdout, everything else on stderr, as loud and as coloured as the user wants.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/scene/diagnostic.hpp>

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rt::cli {

/// stdout cannot take the result.
struct StdoutError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class Console {
public:
    explicit Console(const CommonOptions& options);

    /// A result. Throws StdoutError.
    void result(std::string_view text) const;
    void result(std::span<const std::byte> bytes) const;
    /// What is done, one line; only with -v.
    void detail(const std::string& line) const;
    /// What the user asked to see beside the result, such as --stats; not with -q.
    void table(const std::string& text) const;
    /// Errors always; warnings and notes unless -q.
    void report(const scene::Diagnostics& diagnostics) const;
    void report(const scene::Diagnostic& diagnostic) const;
    /// `rt render: error: sentence; hint`, for what belongs to no file.
    void fail(const std::string& command, int exitCode, const std::string& sentence,
              const std::string& hint) const;

    bool quiet() const { return options_.verbosity < 0; }
    bool verbose() const { return options_.verbosity > 0; }
    bool jsonErrors() const { return options_.jsonErrors; }

private:
    CommonOptions options_;
    bool colour_;
};

/// Is this file descriptor a terminal that may get control sequences?
bool isCapableTerminal(int descriptor);

} // namespace rt::cli
