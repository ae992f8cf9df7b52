#include <core/octree/tables.hpp>

namespace rt::octree {
namespace {

constexpr Tables makeTables() {
    Tables tables{};
    for (unsigned mask = 0; mask < 256; ++mask) {
        unsigned n = 0;
        for (unsigned slot = 0; slot < 8; ++slot)
            if (mask >> slot & 1) tables.compress[mask][n++] = static_cast<std::uint8_t>(slot);
        for (unsigned mirror = 0; mirror < 8; ++mirror)
            for (unsigned j = 8; j-- > 0;)
                if (mask >> (j ^ mirror) & 1)
                    tables.nearest[mirror][mask] = static_cast<std::uint8_t>(j ^ mirror);
    }
    return tables;
}

} // namespace

constexpr Tables kTables = makeTables();

} // namespace rt::octree
