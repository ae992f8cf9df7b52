// A shape that loads its file.
#include <rt/plugin.hpp>

struct Loading {
    rt::File file;
};

constexpr std::array kParameters{
    rt::loadedFile<&Loading::file>("file", rt::absent, "File to load.")};

namespace {
void lower(const Loading&, rt::Geometry& out) { out.load("file", rt::Kind::solid); }
} // namespace

RT_SHAPE_PLUGIN("loading", "1.0.0", kParameters, lower, "Loads a file.", "")
