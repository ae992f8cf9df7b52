/* JPEG by libjpeg-turbo. C, because libjpeg reports errors by longjmp. What libjpeg only warns of (a truncated file,
   damaged entropy-coded data) is an error here, where OpenCV would fill up with grey and print. */
#include <formats/codec/codec.h>

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>

#include <jpeglib.h>

enum {
    MAX_SCANS = 200
}; /* a progressive picture has some ten; a hostile one costs a pass over all pixels for each */

typedef struct errors {
    struct jpeg_error_mgr base; /* first: libjpeg hands back its address */
    const rt_codec_host* host;
    jmp_buf recover;
} errors;

static void on_error(j_common_ptr jpeg) {
    errors* state = (errors*)jpeg->err;
    char message[JMSG_LENGTH_MAX];
    jpeg->err->format_message(jpeg, message);
    snprintf(state->host->error, state->host->error_size, "%s", message);
    longjmp(state->recover, 1);
}

static void on_message(j_common_ptr jpeg, int level) {
    if (level < 0) on_error(jpeg); /* others are traces */
}

static void fail(errors* state, const char* message) {
    snprintf(state->host->error, state->host->error_size, "%s", message);
    longjmp(state->recover, 1);
}

static void on_progress(j_common_ptr jpeg) {
    if (jpeg->is_decompressor && ((j_decompress_ptr)jpeg)->input_scan_number > MAX_SCANS)
        fail((errors*)jpeg->err, "it has too many scans");
}

static struct jpeg_error_mgr* start(errors* state, const rt_codec_host* host) {
    struct jpeg_error_mgr* base = jpeg_std_error(&state->base);
    base->error_exit = on_error;
    base->emit_message = on_message;
    state->host = host;
    return base;
}

typedef struct encoder {
    struct jpeg_compress_struct jpeg;
    errors errors;
    unsigned char* bytes; /* by malloc */
    unsigned long count;
} encoder;

static int encode(uint32_t format, const rt_samples* samples, const rt_encode_settings* settings,
                  const rt_codec_host* host) {
    (void)format;
    encoder* state = calloc(1, sizeof *state); /* on the heap: longjmp spoils changed locals */
    if (!state) {
        snprintf(host->error, host->error_size, "out of memory");
        return 0;
    }
    struct jpeg_compress_struct* jpeg = &state->jpeg;
    jpeg->err = start(&state->errors, host);
    const int failed = setjmp(state->errors.recover);
    if (!failed) {
        jpeg_create_compress(jpeg);
        jpeg_mem_dest(jpeg, &state->bytes, &state->count);
        jpeg->image_width = samples->width;
        jpeg->image_height = samples->height;
        jpeg->input_components = 3;
        jpeg->in_color_space = JCS_RGB;
        jpeg_set_defaults(jpeg);
        jpeg_set_quality(jpeg, (int)settings->quality, TRUE);
        if (settings->quality >= 90) /* full chroma: rendered edges are sharp */
            jpeg->comp_info[0].h_samp_factor = jpeg->comp_info[0].v_samp_factor = 1;
        jpeg->optimize_coding = TRUE;
        jpeg_start_compress(jpeg, TRUE);
        while (jpeg->next_scanline < jpeg->image_height) {
            JSAMPROW row =
                (JSAMPROW)samples->data + (size_t)jpeg->next_scanline * samples->width * 3;
            jpeg_write_scanlines(jpeg, &row, 1);
        }
        jpeg_finish_compress(jpeg);
        if (!host->append(host->context, state->bytes, state->count))
            fail(&state->errors, "out of memory");
    }
    jpeg_destroy_compress(jpeg);
    free(state->bytes);
    free(state);
    return !failed;
}

typedef struct decoder {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_progress_mgr progress;
    errors errors;
} decoder;

static int decode(uint32_t format, const void* bytes, size_t count, const rt_codec_host* host) {
    (void)format;
    decoder* state = calloc(1, sizeof *state);
    if (!state) {
        snprintf(host->error, host->error_size, "out of memory");
        return 0;
    }
    struct jpeg_decompress_struct* jpeg = &state->jpeg;
    jpeg->err = start(&state->errors, host);
    const int failed = setjmp(state->errors.recover);
    if (!failed) {
        jpeg_create_decompress(jpeg);
        jpeg->progress = &state->progress;
        state->progress.progress_monitor = on_progress;
        jpeg_mem_src(jpeg, (const unsigned char*)bytes, (unsigned long)count);
        jpeg_read_header(jpeg, TRUE);
        if (jpeg->jpeg_color_space == JCS_CMYK || jpeg->jpeg_color_space == JCS_YCCK)
            fail(&state->errors, "its colours are CMYK");
        jpeg->out_color_space = JCS_RGB;
        unsigned char* data =
            host->allocate(host->context, jpeg->image_width, jpeg->image_height, 8);
        if (!data) fail(&state->errors, "too large");
        jpeg_start_decompress(jpeg);
        while (jpeg->output_scanline < jpeg->output_height) {
            JSAMPROW row = data + (size_t)jpeg->output_scanline * jpeg->output_width * 3;
            jpeg_read_scanlines(jpeg, &row, 1);
        }
        jpeg_finish_decompress(jpeg);
    }
    jpeg_destroy_decompress(jpeg);
    free(state);
    return !failed;
}

RT_CODEC_EXPORT const rt_codec_table rt_codec = {sizeof(rt_codec_table), encode, decode};
