#include <core/cli/memory.hpp>

#include <core/numeric/colour.hpp>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

namespace rt::cli {

namespace {

constexpr scene::Code kNoRoom{715};

/// Linear light twice, since a tone-mapped copy is encoded; f32 samples and the file they become, as PFM or uncompressed EXR.
constexpr std::uint64_t kBytesPerPixel = 2 * sizeof(numeric::LinearRgb) + 2 * 3 * sizeof(float);

std::string gigabytes(std::uint64_t bytes) {
    const std::uint64_t tenths = (bytes + 50'000'000) / 100'000'000;
    return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " GB";
}

/// The number a file of the control group starts with; "max" and missing files are none.
std::uint64_t numberIn(const std::string& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    std::uint64_t value = 0;
    std::from_chars(line.data(), line.data() + line.size(), value);
    return value;
}

} // namespace

std::uint64_t machineMemory() {
    std::uint64_t least = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                          static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
    const auto consider = [&](const std::string& path) {
        if (const std::uint64_t limit = numberIn(path)) least = std::min(least, limit);
    };
    std::ifstream groups("/proc/self/cgroup"); // lines "hierarchy:controllers:path"
    for (std::string line; std::getline(groups, line);)
        if (const auto colon = line.find(":/"); colon != std::string::npos)
            consider("/sys/fs/cgroup" + line.substr(colon + 1) + "/memory.max");
    consider("/sys/fs/cgroup/memory.max"); // a container's own root
    consider("/sys/fs/cgroup/memory/memory.limit_in_bytes");
    return least;
}

void enforceMemoryLimit(const scene::Limits& limits) {
    if (limits.memory == 0) return;
    rlimit limit{};
    ::getrlimit(RLIMIT_DATA, &limit);
    limit.rlim_cur = std::min<rlim_t>(limits.memory, limit.rlim_max);
    ::setrlimit(RLIMIT_DATA, &limit);
}

void checkPictureFits(const scene::Image& image, const scene::Limits& limits,
                      const scene::Location& location, scene::Diagnostics& diagnostics) {
    const std::uint64_t needed = std::uint64_t{image.width} * image.height * kBytesPerPixel;
    const std::uint64_t most = limits.memory != 0 ? limits.memory : machineMemory();
    if (needed <= most) return;
    diagnostics.error(kNoRoom, location,
                      "the picture of " + std::to_string(image.width) + "x" +
                          std::to_string(image.height) + " pixels takes about " +
                          gigabytes(needed) + " of memory, more than the " + gigabytes(most) +
                          (limits.memory != 0 ? " of --limit-memory" : " that this machine has"),
                      limits.memory != 0 ? ""
                                         : "to try it in spite of that: --limit-memory " +
                                               std::to_string((needed >> 30) + 1) + "G");
}

} // namespace rt::cli
