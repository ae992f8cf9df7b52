// Plugin types for tests of the scene language, without modules.
#pragma once
#include <core/scene/type_catalog.hpp>

#include <limits>
#include <map>

namespace rt::scene::test {

inline constexpr double kInf = std::numeric_limits<double>::infinity();

inline const rt_param kSphereRows[] = {
    {"center", "[0, 0, 0]", nullptr, "Centre of the sphere.", -kInf, kInf, RT_VECTOR3,
     RT_UNIT_LENGTH, 0, 0},
    {"radius", nullptr, nullptr, "Radius of the sphere.", 0, kInf, RT_REAL, RT_UNIT_LENGTH,
     RT_MIN_EXCLUSIVE, 0},
};
inline const rt_param kMeshRows[] = {
    {"file", "", nullptr, "The file.", -kInf, kInf, RT_FILE, RT_UNIT_NONE, RT_LOADS, 0},
    {"kind", "surface", "surface|solid", "Sheet or closed body.", -kInf, kInf, RT_CHOICE,
     RT_UNIT_NONE, 0, 0},
    {"vertices", "[]", nullptr, "Corners.", -kInf, kInf, RT_VECTOR3_LIST, RT_UNIT_LENGTH, 0, 0},
    {"faces", "[]", nullptr, "Corner numbers.", 0, 4294967295.0, RT_INTEGER_LISTS, RT_UNIT_COUNT, 0,
     0},
    {"smooth", "true", nullptr, "Interpolated normals.", -kInf, kInf, RT_BOOL, RT_UNIT_NONE, 0, 0},
    {"crease", "60deg", nullptr, "Edges sharper than this stay sharp.", 0, 180, RT_REAL,
     RT_UNIT_ANGLE, 0, 0},
};
inline const rt_param kImageRows[] = {
    {"file", nullptr, nullptr, "The picture.", -kInf, kInf, RT_FILE, RT_UNIT_NONE, 0, 0},
};
inline const rt_param kCheckerRows[] = {
    {"a", "1", nullptr, "One colour.", 0, 1e6, RT_COLOR, RT_UNIT_LINEAR_RGB, 0, 0},
    {"b", "0", nullptr, "The other.", 0, 1e6, RT_COLOR, RT_UNIT_LINEAR_RGB, 0, 0},
    {"rows", "8", nullptr, "Fields along v.", 1, 1e9, RT_INTEGER, RT_UNIT_COUNT, 0, 0},
    {"over", "", nullptr, "Drawn in the fields of a.", -kInf, kInf, RT_TEXTURE, RT_UNIT_NONE, 0, 0},
    {"label", "", nullptr, "Text.", -kInf, kInf, RT_TEXT, RT_UNIT_NONE, 0, 0},
};
inline const rt_param kObjRows[] = {
    {"winding", "file", "file|repair", "Which way faces turn.", -kInf, kInf, RT_CHOICE,
     RT_UNIT_NONE, 0, 0},
};
inline const rt_param kClashRows[] = {
    {"scale", "1", nullptr, "A key that every object has.", -kInf, kInf, RT_REAL, RT_UNIT_RATIO, 0,
     0},
};

/// shapes sphere, mesh, clash, broken (refused); textures image, checker; loader openmesh for obj.
class FakeCatalog final : public TypeCatalog {
public:
    std::variant<TypeRows, TypeRefusal> find(TypeKind kind, std::string_view name) override {
        ++asked[std::string(name)];
        if (kind == TypeKind::shape && name == "sphere") return TypeRows{name, kSphereRows};
        if (kind == TypeKind::shape && name == "mesh") return TypeRows{name, kMeshRows};
        if (kind == TypeKind::shape && name == "clash") return TypeRows{name, kClashRows};
        if (kind == TypeKind::shape && name == "broken")
            return TypeRefusal{"its ABI is 2.0; this rt offers 1.0"};
        if (kind == TypeKind::texture && name == "image") return TypeRows{name, kImageRows};
        if (kind == TypeKind::texture && name == "checker") return TypeRows{name, kCheckerRows};
        if (kind == TypeKind::loader && name == "openmesh") return TypeRows{name, kObjRows};
        return TypeRefusal{"there is no such plugin in /plugins"};
    }
    std::vector<std::string> names(TypeKind kind) override {
        if (kind == TypeKind::shape) return {"broken", "clash", "mesh", "sphere"};
        if (kind == TypeKind::texture) return {"checker", "image"};
        return {"openmesh"};
    }
    std::string loaderFor(std::string_view suffix) override {
        return suffix == "obj" ? "openmesh" : "";
    }

    std::map<std::string, int> asked;
};

} // namespace rt::scene::test
