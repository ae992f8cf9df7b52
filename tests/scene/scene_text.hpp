// Scenes from text for tests: validated against the fake catalog.
#pragma once
#include <core/scene/validate.hpp>
#include <formats/yaml_reader.hpp>
#include <tests/scene/fake_catalog.hpp>

#include <gtest/gtest.h>

#include <string>

namespace rt::scene::test {

/// A scene that is valid, to which tests add what they are about.
inline const std::string kHead = "rt: 1\ncamera: {position: [0, -9, 0], forward: [0, 1, 0]}\n";

struct Outcome {
    std::optional<Description> description;
    Diagnostics diagnostics;
    std::string messages; // one line each, without excerpts
};

inline Outcome outcomeOf(const std::string& text, TypeCatalog& catalog, const Limits& limits = {}) {
    Outcome outcome;
    const auto root = formats::parseYaml(std::make_shared<Source>(Source{"/scenes/s.yaml", text}),
                                         outcome.diagnostics);
    if (root) outcome.description = validate(*root, catalog, outcome.diagnostics, limits);
    for (const Diagnostic& diagnostic : outcome.diagnostics.all()) {
        const std::string message = format(diagnostic, false);
        outcome.messages += message.substr(0, message.find('\n') + 1);
    }
    EXPECT_EQ(outcome.description.has_value(), !outcome.diagnostics.failed()) << outcome.messages;
    return outcome;
}

inline Outcome outcomeOf(const std::string& text, const Limits& limits = {}) {
    FakeCatalog catalog;
    return outcomeOf(text, catalog, limits);
}

/// The description of a scene that must be valid.
inline Description described(const std::string& text) {
    Outcome outcome = outcomeOf(text);
    EXPECT_EQ(outcome.messages, "") << text;
    return outcome.description ? std::move(*outcome.description) : Description{};
}

/// The messages of a scene that must be refused, each without the path before its line number.
inline std::string refusal(const std::string& text) {
    Outcome outcome = outcomeOf(text);
    EXPECT_TRUE(outcome.diagnostics.failed()) << text;
    std::string& messages = outcome.messages;
    for (std::size_t at = 0; (at = messages.find("/scenes/s.yaml:", at)) != std::string::npos;)
        messages.erase(at, 15);
    return messages;
}

} // namespace rt::scene::test
