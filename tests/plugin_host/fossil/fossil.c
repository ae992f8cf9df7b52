/* Plugins of ABI 1.0, compiled against that version's header beside this file and never changed once 1.0 is published: every
 * rt that speaks 1.x must load them and make of them what fossil.cpp says. */
#include "plugin_1_0.h"

static const rt_param rows[] = {
    {"flag", "true", 0, "A bool.", 0, 0, RT_BOOL, RT_UNIT_NONE, 0, 0},
    {"count", "3", 0, "An integer.", 1, 9, RT_INTEGER, RT_UNIT_COUNT, 0, 0},
    {"size", "2", 0, "A real.", 0, 1e6, RT_REAL, RT_UNIT_LENGTH, RT_MIN_EXCLUSIVE, 0},
    {"turn", "90deg", 0, "An angle.", 0, 360, RT_REAL, RT_UNIT_ANGLE, 0, 0},
    {"place", "[1, 2, 3]", 0, "A vector.", -100, 100, RT_VECTOR3, RT_UNIT_LENGTH, 0, 0},
    {"tint", "[0.25, 0.5, 1]", 0, "A color.", 0, 1, RT_COLOR, RT_UNIT_LINEAR_RGB, 0, 0},
    {"word", "fossil", 0, "A text.", 0, 0, RT_TEXT, RT_UNIT_NONE, 0, 0},
    {"mode", "second", "first|second", "A choice.", 0, 0, RT_CHOICE, RT_UNIT_NONE, 0, 0},
    {"points", "[[0, 0, 0], [0, 0, 4]]", 0, "Vectors.", -100, 100, RT_VECTOR3_LIST, RT_UNIT_LENGTH,
     0, 0},
    {"lists", "[[1, 2], [3]]", 0, "Integers.", 0, 9, RT_INTEGER_LISTS, RT_UNIT_NONE, 0, 0},
};
enum { FLAG, COUNT, SIZE, TURN, PLACE, TINT, WORD, MODE, POINTS, LISTS, ROWS };

/* What is wrong with the default values as they arrive; 0: nothing. */
static int wrong_value(const rt_value* v) {
    if (v[FLAG].integer != 1) return FLAG + 1;
    if (v[COUNT].integer != 3) return COUNT + 1;
    if (v[SIZE].real != 2) return SIZE + 1;
    if (!(v[TURN].real > 1.5707 && v[TURN].real < 1.5708)) return TURN + 1;
    if (v[PLACE].vector[0] != 1 || v[PLACE].vector[1] != 2 || v[PLACE].vector[2] != 3)
        return PLACE + 1;
    if (v[TINT].vector[0] != 0.25 || v[TINT].vector[1] != 0.5 || v[TINT].vector[2] != 1)
        return TINT + 1;
    if (v[WORD].text[0] != 'f' || v[WORD].text[6] != '\0') return WORD + 1;
    if (v[MODE].integer != 1) return MODE + 1;
    if (v[POINTS].list.size != 2 || v[POINTS].list.items[5] != 4) return POINTS + 1;
    if (v[LISTS].list.size != 2 || v[LISTS].list.counts[0] != 2 || v[LISTS].list.counts[1] != 1 ||
        v[LISTS].list.items[2] != 3)
        return LISTS + 1;
    return 0;
}

#if FOSSIL_KIND == 1

/* The square 0 <= x, y <= 1 in z = 5. */
static void bounds(const void* data, uint32_t primitive, double lower[3], double upper[3]) {
    (void)data, (void)primitive;
    lower[0] = lower[1] = 0, upper[0] = upper[1] = 1, lower[2] = upper[2] = 5;
}
static int32_t intersect(const void* data, const uint32_t* primitives, uint32_t count,
                         const rt_ray* ray, rt_hit* hit) {
    const double t = (5 - ray->origin[2]) / ray->direction[2];
    const double x = ray->origin[0] + t * ray->direction[0],
                 y = ray->origin[1] + t * ray->direction[1];
    (void)data, (void)count;
    if (!(t > ray->t_min && t < ray->t_max && x >= 0 && x <= 1 && y >= 0 && y <= 1)) return 0;
    hit->t = t;
    hit->position[0] = x, hit->position[1] = y, hit->position[2] = 5;
    hit->position_error = 0;
    hit->normal[0] = hit->normal[1] = 0, hit->normal[2] = 1;
    hit->uv[0] = x, hit->uv[1] = y;
    hit->primitive = primitives[0];
    hit->reserved = 0;
    return 1;
}
static uint32_t crossings(const void* data, uint32_t primitive, const rt_ray* ray, double* t,
                          uint32_t capacity) {
    rt_hit hit;
    if (capacity == 0 || !intersect(data, &primitive, 1, ray, &hit)) return 0;
    t[0] = hit.t;
    return 1;
}
static int fossil_data;
static void release(void* data) { (void)data; }

static rt_status lower(const rt_host* host, const rt_value* values, rt_sink* sink) {
    static const double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, normals[] = {0, 0, 1},
                        uvs[] = {0, 0, 1, 0, 0, 1};
    static const uint32_t indices[] = {0, 1, 2}, normal_indices[] = {0, 0, RT_NO_INDEX},
                          source[] = {41};
    const rt_sphere sphere = {
        {values[PLACE].vector[0], values[PLACE].vector[1], values[PLACE].vector[2]},
        values[SIZE].real};
    const rt_parallelogram parallelogram = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
    rt_material material = {0};
    rt_mesh mesh = {0};
    rt_custom custom = {0};
    uint32_t handle = RT_NO_INDEX;
    const int wrong = wrong_value(values);
    if (wrong) return host->fail(host, wrong - 1, "did not arrive as its default");
    if (host->struct_size < sizeof(rt_host) || sink->struct_size < sizeof(rt_sink))
        return host->fail(host, -1, "the host shrank");
    host->note(host, "a fossil");
    material.struct_size = sizeof material;
    material.name = "clay";
    material.color[0] = material.diffuse[0] = 0.5;
    material.shininess = 10, material.ior = 1.5;
    material.color_file = "";
    if (sink->add_material(sink, &material, &handle) != RT_OK) return RT_FAILED;
    mesh.struct_size = sizeof mesh;
    mesh.kind = RT_SURFACE;
    mesh.vertex_count = 3, mesh.triangle_count = 1, mesh.normal_count = 1, mesh.uv_count = 3;
    mesh.positions = positions, mesh.indices = indices;
    mesh.normals = normals, mesh.normal_indices = normal_indices, mesh.uvs = uvs;
    mesh.materials = &handle, mesh.source_faces = source;
    if (sink->add_mesh(sink, &mesh) != RT_OK) return RT_FAILED;
    if (sink->add_spheres(sink, &sphere, 1) != RT_OK) return RT_FAILED;
    if (sink->add_parallelograms(sink, &parallelogram, 1) != RT_OK) return RT_FAILED;
    custom.struct_size = sizeof custom;
    custom.kind = RT_SURFACE;
    custom.primitive_count = 1;
    custom.data = &fossil_data;
    custom.bounds = bounds, custom.intersect = intersect, custom.crossings = crossings,
    custom.release = release;
    return sink->add_custom(sink, &custom);
}
static const rt_shape shape = {sizeof(rt_shape), ROWS, rows, lower};

#elif FOSSIL_KIND == 2

static rt_status create(const rt_host* host, const rt_value* values, void** state) {
    const int wrong = wrong_value(values);
    if (wrong) return host->fail(host, wrong - 1, "did not arrive as its default");
    *state = 0;
    return RT_OK;
}
static void evaluate(const void* state, const rt_surface_point* points, uint32_t count,
                     double* rgb) {
    (void)state;
    for (uint32_t i = 0; i < count; ++i) {
        rgb[3 * i] = points[i].uv[0];
        rgb[3 * i + 1] = points[i].object[1];
        rgb[3 * i + 2] = points[i].world[2];
    }
}
static void destroy(void* state) { (void)state; }
static void resolution(const void* state, uint32_t size[2]) {
    (void)state;
    size[0] = 7, size[1] = 5;
}
static const rt_texture_type texture = {
    sizeof(rt_texture_type), ROWS, rows, create, evaluate, destroy, resolution};

#else

static rt_status load(const rt_host* host, const char* path, uint32_t kind, const rt_value* values,
                      rt_sink* sink) {
    static const double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t indices[] = {0, 1, 2};
    rt_mesh mesh = {0};
    const int wrong = wrong_value(values);
    if (wrong) return host->fail(host, wrong - 1, "did not arrive as its default");
    if (path[0] != '/') return host->fail(host, -1, "the path is not absolute");
    mesh.struct_size = sizeof mesh;
    mesh.kind = kind;
    mesh.vertex_count = 3, mesh.triangle_count = 1;
    mesh.positions = positions, mesh.indices = indices;
    return sink->add_mesh(sink, &mesh);
}
static const rt_loader loader = {sizeof(rt_loader), ROWS, rows, "fossil", load, 0};

#endif

RT_EXPORT const rt_module rt_plugin_entry = {RT_ABI_MAGIC,
                                             1,
                                             0,
                                             RT_ABI_LAYOUT,
                                             sizeof(rt_module),
#if FOSSIL_KIND == 1
                                             "fossil_shape",
                                             "1.0.0",
                                             "A shape of ABI 1.0.",
                                             "- fossil_shape: {}\n",
                                             &shape,
                                             0,
                                             0
#elif FOSSIL_KIND == 2
                                              "fossil_texture",
                                              "1.0.0",
                                              "A texture of ABI 1.0.",
                                              "old: {fossil_texture: {}}\n",
                                              0,
                                              &texture,
                                              0
#else
                                              "fossil_loader",
                                              "1.0.0",
                                              "A loader of ABI 1.0.",
                                              "- mesh: {file: x, loader: fossil_loader}\n",
                                              0,
                                              0,
                                              &loader
#endif
};
