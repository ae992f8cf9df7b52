// More than two hundred files that want to harm, over every format that rt reads.
#pragma once
#include <string>
#include <vector>

namespace rt::faults {

enum class Format { scene, inf, movie, mesh, library, picture, script, module };

struct HostileFile {
    Format format;
    std::string name; // with the suffix
    std::string bytes;
    int exitCode;
};

/// The same files each time. `corpus` is tests/corpus.
std::vector<HostileFile> hostileFiles(const std::string& corpus, const std::string& module);

} // namespace rt::faults
