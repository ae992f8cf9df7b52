/* PNG by libpng. C, because libpng reports errors by longjmp. */
#include <formats/codec/codec.h>

#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Knee of time against size over 35 rendered pictures (level 1 to 9, every filter): SUB at 2 takes 66 ms for 1.94 MB,
   6 would take 258 ms for 1.64 MB, all filters at 6 337 ms for 1.60 MB. */
enum { LEVEL = 2, FILTERS = PNG_FILTER_SUB };

typedef struct reader {
    const unsigned char* bytes;
    size_t left;
} reader;

static void on_error(png_structp png, png_const_charp message) {
    const rt_codec_host* host = png_get_error_ptr(png);
    snprintf(host->error, host->error_size, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) { (void)png, (void)message; }

static void append(png_structp png, png_bytep bytes, png_size_t count) {
    const rt_codec_host* host = png_get_io_ptr(png);
    if (!host->append(host->context, bytes, count)) png_error(png, "out of memory");
}

static void flush(png_structp png) { (void)png; }

static int encode(uint32_t format, const rt_samples* samples, const rt_encode_settings* settings,
                  const rt_codec_host* host) {
    (void)format;
    png_structp png =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, (png_voidp)host, on_error, on_warning);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info) {
        png_destroy_write_struct(&png, NULL);
        snprintf(host->error, host->error_size, "libpng could not start");
        return 0;
    }
    if (setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        return 0;
    }
    png_set_write_fn(png, (png_voidp)host, append, flush);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_IHDR(png, info, samples->width, samples->height, (int)samples->bits, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (settings->is_srgb) png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_compression_level(png, LEVEL);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, FILTERS);
    png_write_info(png, info);
    png_set_swap(png); /* 16 bits are big-endian in the file; no effect on 8 */
    const size_t stride = (size_t)samples->width * 3 * (samples->bits / 8);
    for (uint32_t y = 0; y < samples->height; ++y)
        png_write_row(png, (png_const_bytep)samples->data + y * stride);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return 1;
}

static void take(png_structp png, png_bytep bytes, png_size_t count) {
    reader* from = png_get_io_ptr(png);
    if (count > from->left) png_error(png, "the file is truncated");
    memcpy(bytes, from->bytes, count);
    from->bytes += count;
    from->left -= count;
}

static int decode(uint32_t format, const void* bytes, size_t count, const rt_codec_host* host) {
    (void)format;
    reader from = {bytes, count};
    png_structp png =
        png_create_read_struct(PNG_LIBPNG_VER_STRING, (png_voidp)host, on_error, on_warning);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info) {
        png_destroy_read_struct(&png, NULL, NULL);
        snprintf(host->error, host->error_size, "libpng could not start");
        return 0;
    }
    if (setjmp(png_jmpbuf(png))) {
        png_destroy_read_struct(&png, &info, NULL);
        return 0;
    }
    png_set_read_fn(png, &from, take);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); /* the host's limit decides */
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_read_info(png, info);
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    png_set_strip_alpha(png);
    png_set_swap(png);
    const int passes = png_set_interlace_handling(png);
    const uint32_t width = png_get_image_width(png, info);
    const uint32_t height = png_get_image_height(png, info);
    const uint32_t bits = png_get_bit_depth(png, info) == 16 ? 16 : 8;
    const size_t stride = (size_t)width * 3 * (bits / 8);
    unsigned char* data = host->allocate(host->context, width, height, bits);
    if (!data) png_error(png, "too large");
    png_read_update_info(png, info); /* allocates rows: after the host has judged the size */
    if (stride != png_get_rowbytes(png, info)) png_error(png, "unexpected channels");
    for (int pass = 0; pass < passes; ++pass)
        for (uint32_t y = 0; y < height; ++y) png_read_row(png, data + y * stride, NULL);
    png_read_end(png, NULL);
    png_destroy_read_struct(&png, &info, NULL);
    return 1;
}

RT_CODEC_EXPORT const rt_codec_table rt_codec = {sizeof(rt_codec_table), encode, decode};
