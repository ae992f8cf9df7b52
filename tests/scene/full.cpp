// A description written out in full is the same description.
#include <core/scene/full.hpp>
#include <formats/yaml_writer.hpp>
#include <tests/scene/scene_text.hpp>

namespace rt::scene::test {
namespace {

std::string written(const Description& description) {
    return formats::writeYaml(fullScene(description));
}

TEST(FullScene, FillsInEveryDefault) {
    EXPECT_EQ(written(described("rt: 1\n"
                                "camera: {position: [0, -9, 0], look_at: [0, 0, 0]}\n"
                                "objects:\n"
                                "  - sphere: {radius: 2}\n")),
              "rt: 1\n"
              "image:\n"
              "  width: 640\n"
              "  height: 480\n"
              "  encoding: srgb\n"
              "  tone: clamp\n"
              "  bits: 8\n"
              "camera:\n"
              "  position: [0, -9, 0]\n"
              "  look_at: [0, 0, 0]\n"
              "  up: [0, 0, 1]\n"
              "  field_of_view: 45deg\n"
              "render:\n"
              "  depth: 5\n"
              "  antialias: none\n"
              "  smooth: false\n"
              "  sampling: center\n"
              "  near_plane: none\n"
              "  cutoff: 0\n"
              "  octree: {max_objects: 16, min_size: 0}\n"
              "background:\n"
              "  color: [0, 0, 0]\n"
              "objects:\n"
              "  - sphere: {name: sphere_0, center: [0, 0, 0], radius: 2, scale: [1, 1, 1], "
              "translate: [0, 0, 0]}\n");
}

TEST(FullScene, IsReadBackAsTheSameScene) {
    const std::string everything = R"(rt: 1
image: {width: 854, height: 481, encoding: linear, tone: limit, bits: 16, file: out/a.png}
camera: {position: [90, 0, 0.1], forward: [-40, 80, -30], up: [0, 0, 3], screen: {width: 17.79, height: 10, distance: 9}}
bounds: {min: [0, 0, 0], max: [120, 120, 0.3]}
render: {depth: 3, antialias: {max_error: 0.01}, smooth: true, sampling: corner, near_plane: screen, cutoff: 0.001,
         octree: {max_objects: 3, min_size: 0.5}}
textures:
  sky: {image: {file: sky.png}}
  tiles: {checker: {a: "#336699", b: 0.25, rows: 5, over: night, label: "12"}}
  night: {image: {file: /data/night.png}}
background: {texture: sky, mapping: legacy_hemisphere, center: [50, 50, 0], radius: 86.5}
lights:
  - point: {name: key, position: [50, 50, 100], color: [0.149, 0.176, 0.349], brightness: 2}
  - point: {position: [0, 0, 1]}
materials:
  steel: {diffuse: 0.6, specular: [0.3, 0.2, 0.1], environment: 0.2, shininess: 5}
  "no": {texture: tiles}
objects:
  - sphere: {name: moon, center: [75, 65, 30], radius: 4, material: steel}
  - sphere: {radius: 1e-9, material: {transmission: 0.9, ior: 1.5}}
  - mesh: {name: dragon, file: model/dragon.obj, winding: repair, kind: solid, scale: [1, -2, 3], crease: 0.1rad,
           rotate: [{axis: [1, 1, 0], angle: 24deg}, {angle: 0.3rad}], translate: [50, 65, 30], material: "no"}
  - mesh: {name: tent, vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0.1]], faces: [[0, 1, 2]], smooth: false}
animation:
  frames: 289
  fps: 23.976
  tracks:
    - {target: moon, rotate: {center: [50, 65, 30], axis: [0, 0, 1], angle: 6.28rad}, frames: [0, 96], easing: smooth}
    - {target: [moon, dragon], move_direct: {direction: [1, 0, 0], distance: 3}, frames: [0, 9]}
    - {target: dragon, faces: [3, 9], each: true, rotate_self: {angle: 90deg}, frames: [0, 288]}
    - {target: dragon, rotate_self: {axis: [0, 1, 0], angle: 90deg}, frames: [5, 6]}
    - {target: camera.top, move: {position: [0, 0, 5]}, frames: [0, 48]}
    - {target: camera.position, move_radius: {center: [50, 65, 30], distance: -10}, frames: [0, 48]}
    - {background: night, frames: [96, 150]}
    - {target: moon.radius, keyframes: {48: 8, 0: 4}, interpolation: smooth}
    - {target: dragon.crease, keyframes: {0: 30deg, 48: 1rad}}
    - {target: lights.key.color, keyframes: {0: 1, 288: [1, 0, 0]}}
    - {target: dragon.scale, keyframes: {0: 1, 288: [1, 2, 3]}}
)";
    const Description description = described(everything);
    const std::string text = written(description);
    EXPECT_EQ(written(described(text)), text);
    // Every key of the scene is there again.
    for (const char* key :
         {"bounds", "max_error: 0.01", "over: night", "label: \"12\"", "legacy_hemisphere",
          "radius: 1e-09", "ior: 1.5", "winding: repair", "crease: 0.1rad", "angle: 24deg",
          "faces: [[0, 1, 2]]", "angle: 6.28rad", "{0: 4, 48: 8}", "{0: 30deg, 48: 1rad}",
          "faces: [3, 9]", "background: night"})
        EXPECT_NE(text.find(key), std::string::npos) << key << "\n" << text;
}

} // namespace
} // namespace rt::scene::test
