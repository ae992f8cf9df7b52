#include <tests/stability/cases.hpp>

namespace rt::stability {

const std::vector<Case>& allCases() {
    static const std::vector<Case> all{
        {"spheres", spheres},
        {"closed_meshes", closedMeshes},
        {"triangles", triangles},
        {"leaving_surfaces", leavingSurfaces},
        {"boxes", boxes},
        {"motion", motion},
        {"refraction", refraction},
        {"interpolated_normals", interpolatedNormals},
        {"backgrounds", backgrounds},
        {"coplanar_faces", coplanarFaces},
        {"pictures", pictures},
        {"adaptive_sampling", adaptiveSampling},
    };
    return all;
}

} // namespace rt::stability
