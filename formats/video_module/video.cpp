// rt_video.so: frames to a film through libav. Colour-tagged BT.709; same bytes for the same frames.
#include <formats/video_module/video_module.h>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libavutil/log.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string>

namespace {

struct Failure {
    std::string sentence;
};

std::string reason(int code) {
    char text[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(code, text, sizeof text);
    return text;
}

int check(int code, const std::string& what) {
    if (code < 0) throw Failure{what + ": " + reason(code)};
    return code;
}

template <class T> T* check(T* pointer, const std::string& what) {
    if (!pointer) throw Failure{what};
    return pointer;
}

template <class Body> int32_t guarded(char* error, size_t errorSize, Body body) noexcept {
    try {
        body();
        return 1;
    } catch (const Failure& failure) {
        std::snprintf(error, errorSize, "%s", failure.sentence.c_str());
    } catch (const std::bad_alloc&) {
        std::snprintf(error, errorSize, "out of memory");
    }
    return 0;
}

/// The slices of x264 depend on the number of threads: a constant keeps the bytes the same on every machine.
constexpr int kEncoderThreads = 4;

struct Video {
    AVFormatContext* format = nullptr;
    AVCodecContext* codec = nullptr;
    AVStream* stream = nullptr;
    SwsContext* scaler = nullptr;
    AVFrame* frame = nullptr;
    AVPacket* packet = nullptr;
    int64_t frames = 0;

    Video() = default;
    Video(const Video&) = delete;
    Video& operator=(const Video&) = delete;
    ~Video() {
        sws_freeContext(scaler);
        av_frame_free(&frame);
        av_packet_free(&packet);
        avcodec_free_context(&codec);
        if (format && format->pb) avio_closep(&format->pb);
        avformat_free_context(format);
    }
};

/// Quality 1…100 to each encoder's own scale.
void setQuality(AVCodecContext& codec, const std::string& name, int quality) {
    const auto crf = [&](int best, int worst) {
        return std::to_string(worst + (best - worst) * (quality - 1) / 99);
    };
    if (name == "libx264" || name == "libx265") {
        av_opt_set(codec.priv_data, "crf", crf(8, 40).c_str(), 0);
        av_opt_set(codec.priv_data, "preset", "medium", 0);
        // Its frame threads change the bytes, and its note of itself holds the CPU's abilities.
        if (name == "libx265")
            av_opt_set(codec.priv_data, "x265-params", "log-level=error:frame-threads=2:info=0", 0);
        // x264 164's AVX-512 code for it reads memory that nobody wrote.
        if (name == "libx264") av_opt_set(codec.priv_data, "mbtree", "0", 0);
    } else if (name == "libvpx-vp9") {
        codec.bit_rate = 0;
        av_opt_set(codec.priv_data, "crf", crf(10, 55).c_str(), 0);
        av_opt_set(codec.priv_data, "deadline", "good", 0);
        av_opt_set(codec.priv_data, "cpu-used", "4", 0);
    } else if (name != "ffv1") { // mpeg4, mjpeg: a fixed quantiser, 2 best to 31 worst
        codec.flags |= AV_CODEC_FLAG_QSCALE;
        codec.global_quality = FF_QP2LAMBDA * (31 + (2 - 31) * (quality - 1) / 99);
    }
}

AVPixelFormat pixelFormat(const rt_video_settings& settings) {
    const std::string codec = settings.codec;
    if (codec == "ffv1") return AV_PIX_FMT_BGR0; // lossless RGB
    if (codec == "mjpeg") return AV_PIX_FMT_YUVJ444P;
    // H.264 and H.265 crop by whole chroma samples: with halved chroma their sides are even.
    const bool odd = settings.width % 2 != 0 || settings.height % 2 != 0;
    if (odd && codec.starts_with("libx26")) return AV_PIX_FMT_YUV444P;
    return AV_PIX_FMT_YUV420P;
}

constexpr const char* kCannotWrite = "cannot be written";

void writePackets(Video& video) {
    for (;;) {
        const int code = avcodec_receive_packet(video.codec, video.packet);
        if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
        check(code, "the encoder failed");
        av_packet_rescale_ts(video.packet, video.codec->time_base, video.stream->time_base);
        video.packet->stream_index = video.stream->index;
        check(av_interleaved_write_frame(video.format, video.packet), kCannotWrite);
        check(video.format->pb->error, kCannotWrite); // a full disk shows here first
    }
}

int32_t open(const rt_video_settings* settings, void** result, char* error, size_t errorSize) {
    return guarded(error, errorSize, [&] {
        av_log_set_level(AV_LOG_QUIET);
        auto video = std::make_unique<Video>();
        const std::string name = settings->codec;
        const AVCodec* encoder = check(avcodec_find_encoder_by_name(name.c_str()),
                                       "this machine's libav has no encoder '" + name + "'");
        check(avformat_alloc_output_context2(&video->format, nullptr, settings->container,
                                             settings->path),
              "cannot make a film of this kind");
        video->format->flags |= AVFMT_FLAG_BITEXACT;
        video->stream = check(avformat_new_stream(video->format, nullptr), "out of memory");
        AVCodecContext& codec =
            *(video->codec = check(avcodec_alloc_context3(encoder), "out of memory"));
        codec.width = static_cast<int>(settings->width);
        codec.height = static_cast<int>(settings->height);
        codec.pix_fmt = pixelFormat(*settings);
        codec.framerate = {static_cast<int>(settings->fps_numerator),
                           static_cast<int>(settings->fps_denominator)};
        codec.time_base = av_inv_q(codec.framerate);
        codec.thread_count = kEncoderThreads;
        codec.flags |= AV_CODEC_FLAG_BITEXACT;
        codec.color_primaries = AVCOL_PRI_BT709;
        codec.color_trc = AVCOL_TRC_IEC61966_2_1;
        codec.colorspace = codec.pix_fmt == AV_PIX_FMT_BGR0 ? AVCOL_SPC_RGB : AVCOL_SPC_BT709;
        codec.color_range =
            codec.pix_fmt == AV_PIX_FMT_YUV420P || codec.pix_fmt == AV_PIX_FMT_YUV444P
                ? AVCOL_RANGE_MPEG
                : AVCOL_RANGE_JPEG;
        setQuality(codec, name, settings->quality);
        if (video->format->oformat->flags & AVFMT_GLOBALHEADER)
            codec.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
        check(avcodec_open2(&codec, encoder, nullptr),
              "the encoder '" + name + "' refuses these settings");
        check(avcodec_parameters_from_context(video->stream->codecpar, &codec), "out of memory");
        video->stream->time_base = codec.time_base;
        video->stream->avg_frame_rate = codec.framerate;
        check(avio_open(&video->format->pb, settings->path, AVIO_FLAG_WRITE), kCannotWrite);
        AVDictionary* options = nullptr;
        if (std::strcmp(settings->container, "mp4") == 0)
            av_dict_set(&options, "movflags", "+faststart+write_colr", 0);
        const int code = avformat_write_header(video->format, &options);
        av_dict_free(&options);
        check(code, kCannotWrite);
        video->frame = check(av_frame_alloc(), "out of memory");
        video->frame->format = codec.pix_fmt;
        video->frame->width = codec.width;
        video->frame->height = codec.height;
        check(av_frame_get_buffer(video->frame, 0), "out of memory");
        video->packet = check(av_packet_alloc(), "out of memory");
        video->scaler =
            check(sws_getContext(codec.width, codec.height, AV_PIX_FMT_RGB24, codec.width,
                                 codec.height, codec.pix_fmt,
                                 SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_BITEXACT,
                                 nullptr, nullptr, nullptr),
                  "cannot convert to the codec's pixels");
        const int full = codec.color_range == AVCOL_RANGE_JPEG;
        const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
        sws_setColorspaceDetails(video->scaler, bt709, 1, bt709, full, 0, 1 << 16, 1 << 16);
        *result = video.release();
    });
}

int32_t add(void* handle, const uint8_t* rgb, char* error, size_t errorSize) {
    return guarded(error, errorSize, [&] {
        Video& video = *static_cast<Video*>(handle);
        check(av_frame_make_writable(video.frame), "out of memory");
        const uint8_t* planes[1] = {rgb};
        const int strides[1] = {3 * video.codec->width};
        check(sws_scale(video.scaler, planes, strides, 0, video.codec->height, video.frame->data,
                        video.frame->linesize),
              "cannot convert to the codec's pixels");
        video.frame->pts = video.frames++;
        video.frame->quality = video.codec->global_quality;
        check(avcodec_send_frame(video.codec, video.frame), "the encoder failed");
        writePackets(video);
    });
}

int32_t finish(void* handle, char* error, size_t errorSize) {
    return guarded(error, errorSize, [&] {
        Video& video = *static_cast<Video*>(handle);
        check(avcodec_send_frame(video.codec, nullptr), "the encoder failed");
        writePackets(video);
        check(av_write_trailer(video.format), kCannotWrite);
        avio_flush(video.format->pb);
        check(video.format->pb->error, kCannotWrite);
        check(avio_closep(&video.format->pb), kCannotWrite);
    });
}

void close(void* handle) { delete static_cast<Video*>(handle); }

/// An opened film and its decoder.
struct Input {
    AVFormatContext* format = nullptr;
    AVCodecContext* codec = nullptr;
    AVFrame* frame = nullptr;
    AVPacket* packet = nullptr;

    Input() = default;
    Input(const Input&) = delete;
    Input& operator=(const Input&) = delete;
    ~Input() {
        av_frame_free(&frame);
        av_packet_free(&packet);
        avcodec_free_context(&codec);
        avformat_close_input(&format);
    }
};

int32_t inspect(const char* path, int32_t (*stop)(void* data), void* data, rt_video_facts* facts,
                char* error, size_t errorSize) {
    return guarded(error, errorSize, [&] {
        constexpr const char* kCannotRead = "cannot be read back";
        av_log_set_level(AV_LOG_QUIET);
        Input input;
        check(avformat_open_input(&input.format, path, nullptr, nullptr), kCannotRead);
        check(avformat_find_stream_info(input.format, nullptr), kCannotRead);
        const AVCodec* decoder = nullptr;
        const int index =
            check(av_find_best_stream(input.format, AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0),
                  "holds no pictures");
        input.codec = check(avcodec_alloc_context3(decoder), "out of memory");
        check(avcodec_parameters_to_context(input.codec, input.format->streams[index]->codecpar),
              "out of memory");
        input.codec->thread_count = 0; // as many as there are processors
        check(avcodec_open2(input.codec, decoder, nullptr), kCannotRead);
        input.frame = check(av_frame_alloc(), "out of memory");
        input.packet = check(av_packet_alloc(), "out of memory");
        *facts = {};
        const auto drain = [&] {
            int code;
            while ((code = avcodec_receive_frame(input.codec, input.frame)) >= 0) {
                if (input.frame->decode_error_flags || (input.frame->flags & AV_FRAME_FLAG_CORRUPT))
                    throw Failure{"holds a damaged picture"};
                ++facts->frames;
                facts->width = static_cast<uint32_t>(input.frame->width);
                facts->height = static_cast<uint32_t>(input.frame->height);
            }
            if (code != AVERROR(EAGAIN) && code != AVERROR_EOF) check(code, kCannotRead);
        };
        int code;
        while ((code = av_read_frame(input.format, input.packet)) >= 0) {
            if (stop(data)) return;
            if (input.packet->stream_index == index) {
                check(avcodec_send_packet(input.codec, input.packet), kCannotRead);
                drain();
            }
            av_packet_unref(input.packet);
        }
        if (code != AVERROR_EOF) check(code, kCannotRead);
        check(avcodec_send_packet(input.codec, nullptr), kCannotRead);
        drain();
    });
}

} // namespace

extern "C" __attribute__((visibility("default"))) const rt_video_module rt_video_entry;
const rt_video_module rt_video_entry = {
    RT_VIDEO_MODULE_VERSION, sizeof(rt_video_module), open, add, finish, close, inspect};
