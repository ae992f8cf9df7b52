/* The boundary between rt and rt_window.so: OpenCV's highgui behind a table of functions, opened by `rt view`. */
#ifndef RT_FORMATS_WINDOW_MODULE_H
#define RT_FORMATS_WINDOW_MODULE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RT_WINDOW_MODULE_VERSION 1u

enum { RT_WINDOW_KEY = 1, RT_WINDOW_PRESS, RT_WINDOW_MOVE, RT_WINDOW_RELEASE, RT_WINDOW_WHEEL };

typedef struct rt_window_event {
    int32_t kind;
    int32_t key;  /* a character, or one of X11's 0xff00 key symbols               */
    int32_t x, y; /* pixel of the picture; wheel: y is +1 away from the user, -1 toward */
} rt_window_event;

typedef struct rt_window_module {
    uint32_t version, struct_size;
    /* 1 when a window can be opened here; otherwise 0 and a sentence. Never aborts. */
    int32_t (*probe)(char* error, size_t error_size);
    int32_t (*open)(const char* title, uint32_t width, uint32_t height, char* error,
                    size_t error_size);
    /* 8-bit RGB, top row first. */
    void (*show)(const uint8_t* rgb, uint32_t width, uint32_t height);
    /* Waits up to `milliseconds`, at least one pass of the window system. Number of events, or -1 when the window was closed. */
    int32_t (*poll)(rt_window_event* events, uint32_t capacity, int32_t milliseconds);
    void (*close)(void);
    /* Writes lines of text over a picture, from the top left down. */
    void (*annotate)(uint8_t* rgb, uint32_t width, uint32_t height, const char* const* lines,
                     uint32_t count);
} rt_window_module;

#ifdef __cplusplus
}
#endif
#endif
