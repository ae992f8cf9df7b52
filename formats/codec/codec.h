/* The table that a codec module exports. Modules are built and installed with the program, one per library that
   encodes or decodes pictures, so that a run maps only what its files need. */
#ifndef RT_FORMATS_CODEC_H
#define RT_FORMATS_CODEC_H

#include <stddef.h>
#include <stdint.h>

enum rt_codec_format { RT_CODEC_PNG, RT_CODEC_JPEG, RT_CODEC_BMP, RT_CODEC_EXR, RT_CODEC_HDR };

/* Rows from the top without gaps, three interleaved channels R G B, native byte order. */
typedef struct rt_samples {
    uint32_t width, height;
    uint32_t bits; /* 8 and 16: unsigned, all ones is 1; 32: binary32 */
    void* data;
} rt_samples;

typedef struct rt_encode_settings {
    uint32_t is_srgb; /* the samples carry the sRGB curve: PNG says so in an sRGB chunk */
    uint32_t quality; /* JPEG: 1 to 100 */
} rt_encode_settings;

/* What the caller lends. Neither function throws; a module stops when append answers 0 or allocate NULL. */
typedef struct rt_codec_host {
    void* context;
    int (*append)(void* context, const void* bytes, size_t count);
    void* (*allocate)(void* context, uint32_t width, uint32_t height,
                      uint32_t bits); /* before any pixel is decoded */
    char* error;                      /* a sentence, set on failure */
    size_t error_size;
} rt_codec_host;

typedef struct rt_codec_table {
    uint32_t size; /* of this struct: catches a module of another build */
    int (*encode)(uint32_t format, const rt_samples* samples, const rt_encode_settings* settings,
                  const rt_codec_host* host); /* 1: done */
    int (*decode)(uint32_t format, const void* bytes, size_t count,
                  const rt_codec_host* host); /* 1: done */
} rt_codec_table;

#define RT_CODEC_SYMBOL "rt_codec"
#define RT_CODEC_EXPORT __attribute__((visibility("default")))

#endif
