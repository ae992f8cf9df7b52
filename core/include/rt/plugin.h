/* The rt plugin boundary. Valid C11 and C++11; needs <stddef.h> and <stdint.h> only.
 *
 * Two kinds of struct cross it:
 *   growable  begin with struct_size; members may be appended in a minor version.
 *   frozen    never change within a major version, so arrays of them are safe.
 * The first 24 bytes of rt_module (the stamp) never change in any version: the host reads them from the
 * file before it opens the module.
 *
 * Threads: [setup] calls are serial, but for load() of a loader that says otherwise. [render] calls are concurrent and may not allocate, lock or throw.
 *
 * History of the number below:
 *   1.0  first version.
 *   1.1  rt_host: max_texels, exceeds, warn; rt_loader: traits. */
#ifndef RT_PLUGIN_H
#define RT_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RT_ABI_MAJOR 1u
#define RT_ABI_MINOR 1u
#define RT_ABI_MAGIC { 'r', 't', '-', 'p', 'l', 'u', 'g', '\0' }

typedef int32_t rt_status;
enum { RT_OK = 0, RT_FAILED = 1, RT_OUT_OF_MEMORY = 2 };

/* ---- parameters ---------------------------------------------------------------------------------- */

enum {
    RT_BOOL = 1,
    RT_INTEGER,
    RT_REAL,
    RT_VECTOR3,      /* [x, y, z] */
    RT_COLOR,        /* one number, [r, g, b] linear Rec. 709, or "#rrggbb" (sRGB) */
    RT_TEXT,
    RT_CHOICE,       /* one of `choices` */
    RT_FILE,         /* relative to the file that names it; arrives absolute */
    RT_TEXTURE,      /* name of a texture of the scene */
    RT_VECTOR3_LIST, /* [[x, y, z], ...] */
    RT_INTEGER_LISTS /* [[i, j, k, ...], ...] */
};

/* What a number means. Angles are written with a unit (45deg, 1rad) and arrive in radians; their limits are in degrees. */
enum { RT_UNIT_NONE = 0, RT_UNIT_LENGTH, RT_UNIT_ANGLE, RT_UNIT_COUNT, RT_UNIT_RATIO, RT_UNIT_LINEAR_RGB };

enum {
    RT_MIN_EXCLUSIVE = 1u << 0,
    RT_MAX_EXCLUSIVE = 1u << 1,
    RT_LOADS = 1u << 2 /* RT_FILE only: a loader reads the file, and the loader's own parameters may stand beside this one */
};

typedef struct rt_param {          /* frozen */
    const char *name;              /* snake_case YAML key, unique within its type                       */
    const char *fallback;          /* default, as YAML text; NULL: required; "" on text or file: absent */
    const char *choices;           /* "flat|smooth" for RT_CHOICE, otherwise NULL                       */
    const char *doc;               /* one sentence                                                      */
    double min, max;               /* limits of every number in the value, -INFINITY or INFINITY: none; */
                                   /* angles in degrees; every number must be finite in any case        */
    uint32_t type, unit, flags, reserved;
} rt_param;

typedef struct rt_list {           /* frozen */
    const double *items;           /* RT_VECTOR3_LIST: 3 per entry. RT_INTEGER_LISTS: the integers in a row */
    const uint32_t *counts;        /* RT_INTEGER_LISTS: how many belong to each entry; otherwise NULL   */
    uint64_t size;                 /* entries                                                           */
} rt_list;

struct rt_texture_type;

/* A texture of the scene, ready to be evaluated: type->evaluate(state, ...). */
typedef struct rt_texture {        /* frozen */
    const struct rt_texture_type *type;
    void *state;
} rt_texture;

typedef union rt_value {           /* frozen */
    int64_t integer;               /* RT_BOOL, RT_INTEGER, RT_CHOICE (index)                            */
    double real;
    double vector[3];              /* RT_VECTOR3; RT_COLOR                                              */
    const char *text;              /* RT_TEXT, RT_FILE (absolute path); UTF-8; "" when absent           */
    const rt_texture *texture;     /* NULL when absent; lives longer than what is made from the values  */
    rt_list list;
} rt_value;

/* ---- geometry: object space, right-handed, counter-clockwise seen from outside --------------------
 * Spheres are solid, parallelograms are sheets, meshes and custom shapes say which. */

enum {
    RT_SURFACE = 0, /* a sheet: light passes without entering anything            */
    RT_SOLID = 1    /* a closed body: crossing it enters or leaves its material   */
};

typedef struct rt_sphere {         /* frozen */
    double center[3], radius;
} rt_sphere;

typedef struct rt_parallelogram {  /* frozen; normal is edge_u x edge_v, uv runs 0..1 along the edges */
    double origin[3], edge_u[3], edge_v[3];
} rt_parallelogram;

#define RT_NO_INDEX 0xFFFFFFFFu

typedef struct rt_mesh {           /* growable */
    uint32_t struct_size, kind;    /* RT_SURFACE or RT_SOLID                                            */
    uint32_t vertex_count, triangle_count;
    const double *positions;       /* 3 per vertex                                                      */
    const uint32_t *indices;       /* 3 per triangle                                                    */
    uint32_t normal_count, uv_count;
    const double *normals;         /* 3 each, unit; NULL: flat                                          */
    const uint32_t *normal_indices;/* 3 per triangle, RT_NO_INDEX: this corner is flat; NULL: as indices */
    const double *uvs;             /* 2 each; NULL: none                                                */
    const uint32_t *uv_indices;    /* 3 per triangle, RT_NO_INDEX: uv (0, 0); NULL: as indices          */
    const uint32_t *materials;     /* per triangle: handle from add_material, RT_NO_INDEX: the object's; NULL: all the object's */
    const uint32_t *source_faces;  /* per triangle: number of its face in the file, from 0; NULL: as it stands */
} rt_mesh;

/* direction need not be unit length: t is a parameter, not a distance. */
typedef struct rt_ray {            /* frozen */
    double origin[3], t_min, direction[3], t_max;
} rt_ray;

typedef struct rt_hit {            /* frozen */
    double t;                      /* t_min < t < t_max                                                 */
    double position[3];            /* on the surface; may be refined, so need not equal origin + t * direction */
    double position_error;         /* bound on |error of position| along the normal                     */
    double normal[3];              /* outward, unit, ignores the ray                                    */
    double uv[2];
    uint32_t primitive, reserved;
} rt_hit;

typedef struct rt_custom {         /* growable */
    uint32_t struct_size, kind;    /* RT_SURFACE or RT_SOLID                                            */
    uint32_t primitive_count, reserved;
    void *data;                    /* immutable after add_custom                                        */
    /* [setup] conservative object-space bounds. */
    void (*bounds)(const void *data, uint32_t primitive, double lower[3], double upper[3]);
    /* [render] closest hit among the listed primitives, equal t by lowest primitive. Returns 1, or 0
     * and leaves *hit untouched. */
    int32_t (*intersect)(const void *data, const uint32_t *primitives, uint32_t count, const rt_ray *ray, rt_hit *hit);
    /* [render] t of every crossing of one primitive in (t_min, t_max), at most `capacity`, in rising
     * order; returns their number. NULL: the host repeats intersect. */
    uint32_t (*crossings)(const void *data, uint32_t primitive, const rt_ray *ray, double *t, uint32_t capacity);
    void (*release)(void *data);   /* [setup] exactly once                                              */
} rt_custom;

/* What a material file beside a mesh says; same meaning as in the scene language. */
typedef struct rt_material {       /* growable */
    uint32_t struct_size, reserved;
    const char *name;
    double color[3], diffuse[3], specular[3], transmission[3], environment[3];
    double shininess, ior;
    const char *color_file;        /* image that multiplies color, absolute path; "" when absent        */
} rt_material;

typedef struct rt_sink {           /* growable; every call copies its input */
    uint32_t struct_size, reserved;
    rt_status (*add_mesh)(struct rt_sink *, const rt_mesh *);
    rt_status (*add_spheres)(struct rt_sink *, const rt_sphere *, uint32_t count);
    rt_status (*add_parallelograms)(struct rt_sink *, const rt_parallelogram *, uint32_t count);
    /* On RT_OK the host owns data and calls release once; on failure the caller keeps it. */
    rt_status (*add_custom)(struct rt_sink *, const rt_custom *);
    /* A material for rt_mesh.materials; *handle counts from 0 within this sink. */
    rt_status (*add_material)(struct rt_sink *, const rt_material *, uint32_t *handle);
} rt_sink;

typedef struct rt_host {           /* growable */
    uint32_t struct_size, abi_minor;
    /* Say why; parameter is an index into params (the value is wrong), or -1. Always returns RT_FAILED. */
    rt_status (*fail)(const struct rt_host *, int32_t parameter, const char *message);
    /* Something the user should know and that is no error: repairs, things ignored. One sentence. */
    void (*note)(const struct rt_host *, const char *message);
    /* From lower() only: let the loader of the file named by parameter `file` (a row with RT_LOADS) put
     * its geometry into sink, as `kind`. */
    rt_status (*load)(const struct rt_host *, int32_t file, uint32_t kind, rt_sink *);
    uint64_t max_texels;           /* of one image; since 1.1                                           */
    /* As fail, where the value is right but more than the user lets the host take; since 1.1. */
    rt_status (*exceeds)(const struct rt_host *, int32_t parameter, const char *message);
    /* As note, for what is likely a mistake in the user's file; since 1.1. */
    void (*warn)(const struct rt_host *, const char *message);
} rt_host;

/* ---- what a module offers: exactly one of shape, texture, loader ---------------------------------- */

typedef struct rt_shape {          /* growable */
    uint32_t struct_size, param_count;
    const rt_param *params;
    /* [setup] values has param_count entries: defaulted, range-checked, in order. */
    rt_status (*lower)(const rt_host *, const rt_value *values, rt_sink *);
} rt_shape;

/* Where a module writes text; modules open no file for writing. */
typedef struct rt_text_sink {      /* growable */
    uint32_t struct_size, reserved;
    rt_status (*write)(struct rt_text_sink *, const char *bytes, uint64_t size);
} rt_text_sink;

enum { RT_REPORT_FACES = 1u << 0 /* the report also says what became of every face */ };

enum { RT_LOADS_CONCURRENTLY = 1u << 0 /* load() may be called by several threads at once, each with a sink of its own */ };

typedef struct rt_loader {         /* growable */
    uint32_t struct_size, param_count;
    const rt_param *params;
    const char *extensions;        /* "obj|ply", lower case; documentation: the host's table decides    */
    rt_status (*load)(const rt_host *, const char *path, uint32_t kind, const rt_value *values, rt_sink *);
    /* [setup] The file repaired as load() repairs it, as OBJ text into `mesh`, and what was done to it, as a
     * JSON object, into `report`; either may be NULL. NULL: this loader repairs nothing. */
    rt_status (*repair)(const rt_host *, const char *path, const rt_value *values, rt_text_sink *mesh,
                        rt_text_sink *report, uint32_t flags);
    uint32_t traits, reserved;     /* RT_LOADS_CONCURRENTLY; since 1.1                                  */
} rt_loader;

typedef struct rt_surface_point {  /* frozen */
    double uv[2], object[3], world[3];
} rt_surface_point;

typedef struct rt_texture_type {   /* growable */
    uint32_t struct_size, param_count;
    const rt_param *params;
    /* [setup] On RT_OK the host owns *state and destroys it once. */
    rt_status (*create)(const rt_host *, const rt_value *values, void **state);
    /* [render] linear Rec. 709, 3 per point. */
    void (*evaluate)(const void *state, const rt_surface_point *, uint32_t count, double *rgb);
    void (*destroy)(void *state);
    /* [setup] width and height in texels; texel (column, row), row 0 on top, has its middle at
     * uv ((column + 0.5) / width, 1 - (row + 0.5) / height). NULL: there are no texels. */
    void (*resolution)(const void *state, uint32_t size[2]);
} rt_texture_type;

typedef struct rt_module {         /* growable after the stamp */
    char magic[8];                 /* -- the stamp: fixed for ever ------------------------------------ */
    uint32_t abi_major, abi_minor;
    uint32_t layout;               /* RT_ABI_LAYOUT as compiled into the module                         */
    uint32_t struct_size;          /* -- end of the stamp --------------------------------------------- */
    const char *name;              /* the YAML key; equals the file's stem                              */
    const char *version;
    const char *doc;               /* one sentence                                                      */
    const char *example;           /* a few lines of YAML that use it                                   */
    const rt_shape *shape;
    const rt_texture_type *texture;
    const rt_loader *loader;
} rt_module;

/* A fingerprint of every frozen struct as this compiler laid it out. */
#define RT_ABI_LAYOUT \
    ((uint32_t)(sizeof(rt_param) + 31u * offsetof(rt_param, type) + 131u * sizeof(rt_value) + 523u * sizeof(rt_list) \
    + 1031u * sizeof(rt_ray) + 2053u * offsetof(rt_ray, direction) + 5003u * sizeof(rt_hit) + 7001u * offsetof(rt_hit, uv) \
    + 9001u * sizeof(rt_texture) + 10007u * sizeof(rt_parallelogram) + 13007u * sizeof(rt_sphere) + 20011u * sizeof(rt_surface_point) \
    + 40009u * offsetof(rt_module, shape)))

/* Does this growable struct, as its maker compiled it, have this member? */
#define RT_HAS(object, type, member) \
    ((object)->struct_size >= offsetof(type, member) + sizeof((object)->member))

#define RT_EXPORT __attribute__((visibility("default")))

/* The one symbol a plugin exports. It is data: reading it runs no plugin code. */
RT_EXPORT extern const rt_module rt_plugin_entry;

#ifdef __cplusplus
}
#endif
#endif
