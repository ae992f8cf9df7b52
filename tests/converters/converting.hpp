// Converting from memory, and diagnostics as short lines to compare.
#pragma once
#include <converters/inf.hpp>

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace rt::converters {

/// A folder of its own, removed at the end, for the files that a scene names.
class ScratchFolder {
public:
    ScratchFolder() {
        std::string pattern =
            (std::filesystem::temp_directory_path() / "rt-converters-XXXXXX").string();
        folder_ = ::mkdtemp(pattern.data());
    }
    ~ScratchFolder() { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return path(name);
    }

private:
    std::filesystem::path folder_;
};

struct Converted {
    std::optional<scene::Node> document;
    scene::Diagnostics diagnostics;

    /// "3:7 E0380 sentence; suggestion" for errors, "3:7 sentence" for notes and warnings; "-" is the file as a whole.
    std::vector<std::string> lines(scene::Severity severity) const {
        std::vector<std::string> lines;
        for (const scene::Diagnostic& each : diagnostics.all()) {
            if (each.severity != severity) continue;
            std::string line = each.location.line == 0 ? "-"
                                                       : std::to_string(each.location.line) + ":" +
                                                             std::to_string(each.location.column);
            if (severity == scene::Severity::error)
                line += " E0" + std::to_string(static_cast<int>(each.code));
            line += " " + each.message + (each.suggestion.empty() ? "" : "; " + each.suggestion);
            lines.push_back(std::move(line));
        }
        return lines;
    }
    std::vector<std::string> errors() const { return lines(scene::Severity::error); }
    std::vector<std::string> notes() const { return lines(scene::Severity::note); }

    /// The node at "objects.0.sphere.center", or a failure.
    const scene::Node& at(std::string_view path) const {
        static const scene::Node kNone;
        if (!document) {
            ADD_FAILURE() << "no document: " << testing::PrintToString(errors());
            return kNone;
        }
        const scene::Node* node = &*document;
        while (!path.empty()) {
            const std::size_t dot = path.find('.');
            const std::string_view key = path.substr(0, dot);
            path.remove_prefix(dot == std::string_view::npos ? path.size() : dot + 1);
            if (node->kind == scene::Node::Kind::sequence) {
                const std::size_t index = std::stoul(std::string(key));
                node = index < node->items.size() ? &node->items[index] : nullptr;
            } else {
                node = node->find(key);
            }
            if (!node) {
                ADD_FAILURE() << "no key " << key;
                return kNone;
            }
        }
        return *node;
    }
};

inline Converted convertText(const std::string& text, const InfOptions& options = {},
                             const std::string& path = "scene.inf") {
    Converted converted;
    converted.document = convertInfText(path, text, options, converted.diagnostics);
    return converted;
}

/// Window, scene, camera: what every scene must have, on lines 1 to 3.
inline const std::string kHead =
    "window 64 48\nscene 0 0 0 100 100 100\ncamera 8 6 6 50 10 50 0 1 0 0 0 1\n";
inline const std::string kMatte = " 1 0.5 0.5 0.6 0.6 0.6 0 0 0 0 0 0 0.1 0.1 0.1 -1 20";
inline const std::string kSphere = "sphere 50 50 50 4" + kMatte + "\n";

} // namespace rt::converters
