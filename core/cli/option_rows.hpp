// How a subcommand says which options it has; command_line.cpp makes them known to the parser.
#pragma once
#include <core/cli/values.hpp>

#include <functional>
#include <string>
#include <vector>

namespace rt::cli {

/// Called with each word that is given to an option; throws UsageError.
using Take = std::function<void(const std::string& word)>;

class OptionRows {
public:
    virtual ~OptionRows() = default;

    void flag(const char* names, const char* text, bool& value) {
        flag(names, text, [&value](const std::string&) { value = true; });
    }
    /// Called once for each time the flag is given.
    virtual void flag(const char* names, const char* text, Take take) = 0;
    /// `--name` alone gives "", `--name=word` the word.
    virtual void flagWithWord(const char* names, const char* value, const char* text,
                              Take take) = 0;
    /// Given several times, `take` is called for each word in order.
    virtual void option(const char* names, const std::string& value, const char* text,
                        Take take) = 0;
    virtual void argument(const char* name, const char* value, const char* text, std::string& word,
                          bool required = true) = 0;
    virtual void arguments(const char* name, const char* value, const char* text,
                           std::vector<std::string>& words) = 0;
};

/// "a|b|c".
std::string choiceName(const std::vector<std::string>& choices);

} // namespace rt::cli
