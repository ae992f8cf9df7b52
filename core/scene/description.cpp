#include <core/scene/description.hpp>

#include <core/numeric/elementary.hpp>

namespace rt::scene {

void resolve(Camera& camera, double aspect) {
    if (camera.lookAt) camera.forward = *camera.lookAt - camera.position;
    if (camera.fieldOfView) {
        camera.screenDistance = 1;
        camera.screenHeight = 2 * numeric::tan(camera.fieldOfView->value / 2);
        camera.screenWidth = camera.screenHeight * aspect;
    }
}

AffineTransform worldFromObject(const Placement& placement) {
    AffineTransform result;
    for (int i = 0; i < 3; ++i) result.linear[i][i] = placement.scale[i];
    for (const Placement::Rotation& rotation : placement.rotations)
        result = numeric::rotation(rotation.axis, rotation.angle) * result;
    result.translation = result.translation + placement.translation;
    return result;
}

} // namespace rt::scene
