/* A plugin in C: one sphere. Compiled with other numbers in its stamp it is the hostile modules that the loader must refuse. */
#include <rt/plugin.h>

#ifndef DOT_NAME
#define DOT_NAME "dot"
#endif
#ifndef DOT_MAJOR
#define DOT_MAJOR RT_ABI_MAJOR
#endif
#ifndef DOT_MINOR
#define DOT_MINOR RT_ABI_MINOR
#endif
#ifndef DOT_LAYOUT
#define DOT_LAYOUT RT_ABI_LAYOUT
#endif
#ifndef DOT_MAGIC
#define DOT_MAGIC RT_ABI_MAGIC
#endif
#ifndef DOT_SIZE
#define DOT_SIZE sizeof(rt_module)
#endif
#ifndef DOT_SHAPE
#define DOT_SHAPE &shape
#endif
#ifndef DOT_TEXTURE
#define DOT_TEXTURE NULL
#endif
#ifndef DOT_SHAPE_SIZE
#define DOT_SHAPE_SIZE sizeof(rt_shape)
#endif
#ifndef DOT_ROWS
#define DOT_ROWS                                                                                   \
    {                                                                                              \
        "radius", "1", NULL, "Radius of the dot.", 0, 1e6, RT_REAL, RT_UNIT_LENGTH,                \
            RT_MIN_EXCLUSIVE, 0                                                                    \
    }
#endif

#ifdef DOT_CONSTRUCTOR
#include <stdlib.h>
__attribute__((constructor)) static void constructor(void) {
    setenv("RT_TEST_CONSTRUCTOR_RAN", DOT_NAME, 1);
}
#endif

#ifdef DOT_NEEDS
extern int rt_test_nobody_defines_this(void);
#endif

static rt_status lower(const rt_host* host, const rt_value* values, rt_sink* sink) {
    const rt_sphere sphere = {{0, 0, 0}, values[0].real};
    (void)host;
#ifdef DOT_NEEDS
    rt_test_nobody_defines_this();
#endif
    return sink->add_spheres(sink, &sphere, 1);
}

static const rt_param rows[] = {DOT_ROWS};
static const rt_shape shape = {DOT_SHAPE_SIZE, sizeof rows / sizeof rows[0], rows, lower};

RT_EXPORT const rt_module rt_plugin_entry = {DOT_MAGIC,  DOT_MAJOR,   DOT_MINOR,
                                             DOT_LAYOUT, DOT_SIZE,    DOT_NAME,
                                             "1.0.0",    "A dot.",    "- dot: {radius: 2}\n",
                                             DOT_SHAPE,  DOT_TEXTURE, NULL};
