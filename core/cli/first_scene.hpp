// What `rt new scene` writes: a small scene that shows how the others are written.
#pragma once
#include <string_view>

namespace rt::cli {

inline constexpr std::string_view kFirstScene =
    R"(# rt render NAME.yaml    draws NAME.png; rt view NAME.yaml flies through it
rt: 1                          # version of the scene language
image: {width: 640, height: 480}
camera:                        # z is up; any unit of length will do
  position: [0, -8, 2.8]
  look_at: [0.3, 0, 0.8]
  field_of_view: 36deg
render: {antialias: {grid: 2}} # 2 x 2 samples per pixel
background: {color: "#9cc4e8"}
lights:
  - point: {position: [4, -5, 8], color: 0.8}
  - point: {position: [-7, -6, 5], color: [0.2, 0.22, 0.26]} # lightens the shadows
textures:
  tiles: {checker: {a: "#e9e4da", b: "#7d8a93", scale: [40, 40, 1]}}
materials:                     # shares of the light: what is left out is 0
  floor: {texture: tiles, diffuse: 0.8, environment: 0.2}
  clay: {color: [0.9, 0.45, 0.3], diffuse: 0.8, environment: 0.2}
  mirror: {color: [0.95, 0.97, 1], diffuse: 0.05, specular: 0.9, shininess: 400}
  glass: {transmission: 0.9, specular: 0.08, ior: 1.5, shininess: 300}
objects:                       # rt plugins lists the shapes, rt plugins sphere tells its keys
  - parallelogram: {name: ground, origin: [-20, -20, 0], edge_u: [40, 0, 0], edge_v: [0, 40, 0], material: floor}
  - sphere: {name: ball, center: [-1.6, 0.8, 1], radius: 1, material: mirror}
  - sphere: {name: bubble, center: [0.3, -1.1, 0.7], radius: 0.7, material: glass}
  - box: {name: block, min: [1.2, 0, 0], max: [2.4, 1.2, 1.2], material: clay}
)";

} // namespace rt::cli
