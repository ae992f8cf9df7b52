/* The boundary between rt and rt_video.so: libav behind a table of functions, opened when a film is encoded. */
#ifndef RT_FORMATS_VIDEO_MODULE_H
#define RT_FORMATS_VIDEO_MODULE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RT_VIDEO_MODULE_VERSION 1u

typedef struct rt_video_settings {
    const char* path;      /* the file to write                                          */
    const char* container; /* libav muxer: "mp4", "avi", "matroska", "webm"               */
    const char* codec;     /* libav encoder: "libx264", "mpeg4", "mjpeg", "ffv1" ...      */
    uint32_t width, height;
    uint32_t fps_numerator, fps_denominator;
    int32_t quality; /* 1 worst ... 100 best; lossless codecs ignore it                  */
} rt_video_settings;

typedef struct rt_video_facts {
    uint64_t frames; /* that can be decoded */
    uint32_t width, height;
} rt_video_facts;

/* Every function returns 1, or 0 with a sentence in error. rgb is 8-bit, width * height * 3, top row first. */
typedef struct rt_video_module {
    uint32_t version, struct_size;
    int32_t (*open)(const rt_video_settings*, void** video, char* error, size_t error_size);
    int32_t (*add)(void* video, const uint8_t* rgb, char* error, size_t error_size);
    /* Flushes, writes the trailer and closes the file. */
    int32_t (*finish)(void* video, char* error, size_t error_size);
    void (*close)(void* video); /* frees; a file not finished stays as it is */
    /* Decodes the whole file, or as far as `stop`, polled for each frame, answers 0. */
    int32_t (*inspect)(const char* path, int32_t (*stop)(void* data), void* data,
                       rt_video_facts* facts, char* error, size_t error_size);
} rt_video_module;

#ifdef __cplusplus
}
#endif
#endif
