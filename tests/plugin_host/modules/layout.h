/* The layout of plugin.h as 1.0 was published, on 64-bit machines. A line that fails means that every plugin built so far breaks:
 * raise the major number or take the change back. New members of growable structs add lines at their end. */
#include <rt/plugin.h>

#ifdef __cplusplus
#define CHECK(condition) static_assert(condition, #condition)
#else
#define CHECK(condition) _Static_assert(condition, #condition)
#endif

CHECK(sizeof(rt_param) == 64);
CHECK(offsetof(rt_param, fallback) == 8);
CHECK(offsetof(rt_param, choices) == 16);
CHECK(offsetof(rt_param, doc) == 24);
CHECK(offsetof(rt_param, min) == 32);
CHECK(offsetof(rt_param, max) == 40);
CHECK(offsetof(rt_param, type) == 48);
CHECK(offsetof(rt_param, unit) == 52);
CHECK(offsetof(rt_param, flags) == 56);
CHECK(sizeof(rt_list) == 24);
CHECK(offsetof(rt_list, counts) == 8);
CHECK(offsetof(rt_list, size) == 16);
CHECK(sizeof(rt_texture) == 16);
CHECK(offsetof(rt_texture, state) == 8);
CHECK(sizeof(rt_value) == 24);
CHECK(sizeof(rt_sphere) == 32);
CHECK(offsetof(rt_sphere, radius) == 24);
CHECK(sizeof(rt_parallelogram) == 72);
CHECK(offsetof(rt_parallelogram, edge_u) == 24);
CHECK(offsetof(rt_parallelogram, edge_v) == 48);
CHECK(sizeof(rt_ray) == 64);
CHECK(offsetof(rt_ray, t_min) == 24);
CHECK(offsetof(rt_ray, direction) == 32);
CHECK(offsetof(rt_ray, t_max) == 56);
CHECK(sizeof(rt_hit) == 88);
CHECK(offsetof(rt_hit, position) == 8);
CHECK(offsetof(rt_hit, position_error) == 32);
CHECK(offsetof(rt_hit, normal) == 40);
CHECK(offsetof(rt_hit, uv) == 64);
CHECK(offsetof(rt_hit, primitive) == 80);
CHECK(sizeof(rt_surface_point) == 64);
CHECK(offsetof(rt_surface_point, object) == 16);
CHECK(offsetof(rt_surface_point, world) == 40);

CHECK(offsetof(rt_mesh, kind) == 4);
CHECK(offsetof(rt_mesh, vertex_count) == 8);
CHECK(offsetof(rt_mesh, triangle_count) == 12);
CHECK(offsetof(rt_mesh, positions) == 16);
CHECK(offsetof(rt_mesh, indices) == 24);
CHECK(offsetof(rt_mesh, normal_count) == 32);
CHECK(offsetof(rt_mesh, uv_count) == 36);
CHECK(offsetof(rt_mesh, normals) == 40);
CHECK(offsetof(rt_mesh, normal_indices) == 48);
CHECK(offsetof(rt_mesh, uvs) == 56);
CHECK(offsetof(rt_mesh, uv_indices) == 64);
CHECK(offsetof(rt_mesh, materials) == 72);
CHECK(offsetof(rt_mesh, source_faces) == 80);
CHECK(offsetof(rt_custom, kind) == 4);
CHECK(offsetof(rt_custom, primitive_count) == 8);
CHECK(offsetof(rt_custom, data) == 16);
CHECK(offsetof(rt_custom, bounds) == 24);
CHECK(offsetof(rt_custom, intersect) == 32);
CHECK(offsetof(rt_custom, crossings) == 40);
CHECK(offsetof(rt_custom, release) == 48);
CHECK(offsetof(rt_material, name) == 8);
CHECK(offsetof(rt_material, color) == 16);
CHECK(offsetof(rt_material, diffuse) == 40);
CHECK(offsetof(rt_material, specular) == 64);
CHECK(offsetof(rt_material, transmission) == 88);
CHECK(offsetof(rt_material, environment) == 112);
CHECK(offsetof(rt_material, shininess) == 136);
CHECK(offsetof(rt_material, ior) == 144);
CHECK(offsetof(rt_material, color_file) == 152);
CHECK(offsetof(rt_sink, add_mesh) == 8);
CHECK(offsetof(rt_sink, add_spheres) == 16);
CHECK(offsetof(rt_sink, add_parallelograms) == 24);
CHECK(offsetof(rt_sink, add_custom) == 32);
CHECK(offsetof(rt_sink, add_material) == 40);
CHECK(offsetof(rt_host, abi_minor) == 4);
CHECK(offsetof(rt_host, fail) == 8);
CHECK(offsetof(rt_host, note) == 16);
CHECK(offsetof(rt_host, load) == 24);
CHECK(offsetof(rt_host, max_texels) == 32);
CHECK(offsetof(rt_host, exceeds) == 40);
CHECK(offsetof(rt_shape, param_count) == 4);
CHECK(offsetof(rt_shape, params) == 8);
CHECK(offsetof(rt_shape, lower) == 16);
CHECK(offsetof(rt_loader, params) == 8);
CHECK(offsetof(rt_loader, extensions) == 16);
CHECK(offsetof(rt_loader, load) == 24);
CHECK(offsetof(rt_loader, repair) == 32);
CHECK(offsetof(rt_text_sink, write) == 8);
CHECK(offsetof(rt_texture_type, params) == 8);
CHECK(offsetof(rt_texture_type, create) == 16);
CHECK(offsetof(rt_texture_type, evaluate) == 24);
CHECK(offsetof(rt_texture_type, destroy) == 32);
CHECK(offsetof(rt_texture_type, resolution) == 40);
CHECK(offsetof(rt_module, abi_major) == 8);
CHECK(offsetof(rt_module, abi_minor) == 12);
CHECK(offsetof(rt_module, layout) == 16);
CHECK(offsetof(rt_module, struct_size) == 20);
CHECK(offsetof(rt_module, name) == 24);
CHECK(offsetof(rt_module, version) == 32);
CHECK(offsetof(rt_module, doc) == 40);
CHECK(offsetof(rt_module, example) == 48);
CHECK(offsetof(rt_module, shape) == 56);
CHECK(offsetof(rt_module, texture) == 64);
CHECK(offsetof(rt_module, loader) == 72);
CHECK(RT_ABI_LAYOUT == 5839208u);
