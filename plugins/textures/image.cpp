// Pictures from files. (u, v) = (0, 0) is the lower left corner of the picture and (1, 1) the upper right, so the centre
// of the texel in column x and row y, counted from the top left, is ((x + 1/2) / width, 1 - (y + 1/2) / height).
// OpenCV decodes; nothing of it is used while rendering. The orientation tag of cameras is not applied.
#include <rt/plugin.hpp>

#include "image_header.hpp"

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

struct ImageParameters {
    enum class Encoding { automatic, srgb, linear };
    enum class Filter { nearest, bilinear };
    enum class Wrap { repeat, clamp, horizontal };

    rt::File file;
    Encoding encoding;
    Filter filter;
    Wrap wrap;
};

constexpr std::array kParameters{
    rt::parameter<&ImageParameters::file>("file", rt::required,
                                          "PNG, JPEG, BMP, HDR, EXR, PFM, PGM or PPM file."),
    rt::choice<&ImageParameters::encoding>(
        "encoding", "auto|srgb|linear", "auto",
        "What the numbers mean; auto: sRGB for integers, linear light for floats."),
    rt::choice<&ImageParameters::filter>("filter", "nearest|bilinear", "bilinear",
                                         "How texels are mixed."),
    rt::choice<&ImageParameters::wrap>(
        "wrap", "repeat|clamp|horizontal", "repeat",
        "Beyond the edges; horizontal repeats sideways only, as a sky wants it.")};

namespace {

constexpr off_t kMostBytes = off_t{1} << 30; // what 2^26 texels of four floats take in a file

/// The positive fifth root for a >= 0, by Newton's method from above: + - * / only, so the same bits everywhere.
double fifthRoot(double a) {
    if (a == 0) return 0;
    double y = a < 1 ? 1 : a;
    for (;;) {
        const double y2 = y * y, next = (4 * y + a / (y2 * y2)) / 5;
        if (!(next < y)) return y;
        y = next;
    }
}

/// IEC 61966-2-1, carried on beyond 1. x^2.4 = x^2 times the fifth root of x^2.
double linearFromSrgb(double encoded) {
    if (encoded <= 0.04045) return encoded / 12.92;
    const double x = (encoded + 0.055) / 1.055, square = x * x;
    return square * fifthRoot(square);
}

class Image {
public:
    Image(const cv::Mat& pixels, const ImageParameters& parameters, rt::Host& host)
        : width_(pixels.cols), height_(pixels.rows), filter_(parameters.filter),
          wrap_(parameters.wrap) {
        const bool isFloat = pixels.depth() == CV_32F;
        const bool isSrgb =
            parameters.encoding == ImageParameters::Encoding::srgb ||
            (parameters.encoding == ImageParameters::Encoding::automatic && !isFloat);
        const auto decode = [&](double encoded) {
            return isSrgb ? linearFromSrgb(encoded) : encoded;
        };
        if (isFloat) {
            std::uint64_t negative = 0;
            copy(pixels, floats_, [&](float value) {
                if (!std::isfinite(value))
                    throw rt::ParameterError("file", "has texels that are not finite");
                negative += value < 0;
                const float linear = value < 0 ? 0 : static_cast<float>(decode(value));
                if (!std::isfinite(linear))
                    throw rt::ParameterError(
                        "file", "has texels that exceed the range of f32 in linear light");
                return linear;
            });
            if (negative != 0)
                host.note(std::to_string(negative) + " negative channels of texels count as 0");
            return;
        }
        const int levels = pixels.depth() == CV_8U ? 256 : 65536;
        for (int i = 0; i < levels; ++i) decoded_.push_back(decode(i / (levels - 1.0)));
        if (pixels.depth() == CV_8U)
            copy(pixels, bytes_, [](std::uint8_t value) { return value; });
        else
            copy(pixels, words_, [](std::uint16_t value) { return value; });
    }

    rt::Color at(const rt_surface_point& point) const {
        const double x = place(point.uv[0], wrap_ != ImageParameters::Wrap::clamp) * width_;
        const double y = (1 - place(point.uv[1], wrap_ == ImageParameters::Wrap::repeat)) * height_;
        if (filter_ == ImageParameters::Filter::nearest)
            return texel(static_cast<int>(x), static_cast<int>(y));
        const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
        const double right = x - 0.5 - left, down = y - 0.5 - top; // weights
        const int i = static_cast<int>(left), j = static_cast<int>(top);
        return (texel(i, j) * (1 - right) + texel(i + 1, j) * right) * (1 - down) +
               (texel(i, j + 1) * (1 - right) + texel(i + 1, j + 1) * right) * down;
    }

    std::array<std::uint32_t, 2> resolution() const {
        return {static_cast<std::uint32_t>(width_), static_cast<std::uint32_t>(height_)};
    }

private:
    /// In [0, 1]; what is no number is 0.
    static double place(double coordinate, bool repeats) {
        const double inside = repeats          ? coordinate - std::floor(coordinate)
                              : coordinate < 1 ? coordinate
                                               : 1;
        return inside > 0 ? inside : 0;
    }

    rt::Color texel(int x, int y) const {
        x = index(x, width_, wrap_ != ImageParameters::Wrap::clamp);
        y = index(y, height_, wrap_ == ImageParameters::Wrap::repeat);
        const std::size_t i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                   static_cast<std::size_t>(x));
        if (!bytes_.empty())
            return {decoded_[bytes_[i]], decoded_[bytes_[i + 1]], decoded_[bytes_[i + 2]]};
        if (!words_.empty())
            return {decoded_[words_[i]], decoded_[words_[i + 1]], decoded_[words_[i + 2]]};
        return {floats_[i], floats_[i + 1], floats_[i + 2]};
    }

    /// i is at most one texel outside.
    static int index(int i, int count, bool repeats) {
        if (i < 0) return repeats ? count - 1 : 0;
        if (i >= count) return repeats ? i - count : count - 1;
        return i;
    }

    /// To RGB from OpenCV's grey, grey with alpha, BGR or BGR with alpha.
    template <class T, class Convert>
    void copy(const cv::Mat& pixels, std::vector<T>& to, Convert&& convert) {
        const int channels = pixels.channels();
        to.reserve(3 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
        for (int y = 0; y < height_; ++y) {
            const T* row = pixels.ptr<T>(y);
            for (int x = 0; x < width_; ++x, row += channels)
                for (int k : {2, 1, 0}) to.push_back(convert(row[channels < 3 ? 0 : k]));
        }
    }

    int width_, height_;
    ImageParameters::Filter filter_;
    ImageParameters::Wrap wrap_;
    std::vector<double> decoded_; // linear light by integer level
    std::vector<std::uint8_t> bytes_;
    std::vector<std::uint16_t> words_;
    std::vector<float> floats_; // linear; only one of the three is filled
};

/// Open only as long as it is read.
class OpenFile {
public:
    explicit OpenFile(const std::string& path)
        : fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
        struct stat status {};
        if (fd_ < 0 || fstat(fd_, &status) != 0)
            throw rt::ParameterError("file", "cannot be opened");
        if (!S_ISREG(status.st_mode)) throw rt::ParameterError("file", "is not a regular file");
        if (status.st_size > kMostBytes) throw rt::ParameterError("file", "is larger than 1 GiB");
        bytes_.resize(static_cast<std::size_t>(status.st_size));
        for (std::size_t at = 0; at < bytes_.size();) {
            const ssize_t got = read(fd_, bytes_.data() + at, bytes_.size() - at);
            if (got <= 0) throw rt::ParameterError("file", "cannot be read");
            at += static_cast<std::size_t>(got);
        }
    }
    ~OpenFile() {
        if (fd_ >= 0) close(fd_);
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;

    std::string_view bytes() const { return bytes_; }
    /// Names this very file even if another has taken its path.
    std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

private:
    int fd_;
    std::string bytes_;
};

/// What OpenCV says on std::cerr, and libpng on stderr, about a file is said better below. The variable is exchanged, not the
/// descriptor, which others write to.
class QuietErrorStream {
public:
    QuietErrorStream() : before_(std::cerr.rdbuf(nullptr)), file_(stderr) {
        if (std::FILE* const nowhere = fopencookie(nullptr, "w", {})) stderr = nowhere;
    }
    ~QuietErrorStream() {
        std::cerr.rdbuf(before_);
        if (stderr == file_) return;
        std::fclose(stderr);
        stderr = file_;
    }
    QuietErrorStream(const QuietErrorStream&) = delete;
    QuietErrorStream& operator=(const QuietErrorStream&) = delete;

private:
    std::streambuf* before_;
    std::FILE* file_;
};

Image create(const ImageParameters& parameters, rt::Host& host) {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    const OpenFile file(parameters.file.path);
    const auto header = readImageHeader(file.bytes());
    if (const auto* why = std::get_if<std::string>(&header)) throw rt::ParameterError("file", *why);
    const auto [format, width, height] = std::get<ImageHeader>(header);
    const std::string size = std::to_string(width) + " x " + std::to_string(height);
    if (width == 0 || height == 0)
        throw rt::ParameterError("file", "says that it has " + size + " texels");
    if (width > host.maxTexels() || height > host.maxTexels() / width)
        throw rt::LimitError("file", "has " + size + " texels, more than the limit of " +
                                         std::to_string(host.maxTexels()));

    cv::Mat pixels;
    try {
        const QuietErrorStream quiet;
        pixels = cv::imread(file.path(), cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
        pixels.release();
    }
    if (pixels.empty())
        throw rt::ParameterError("file",
                                 std::string("is a damaged or truncated ") + format + " file");
    if (pixels.depth() != CV_8U && pixels.depth() != CV_16U && pixels.depth() != CV_32F)
        throw rt::ParameterError("file", std::string("is a ") + format +
                                             " file of an unusual kind of number");
    if (pixels.channels() == 4 || pixels.channels() == 2)
        host.note("the alpha channel of the image is ignored");
    return Image(pixels, parameters, host);
}

} // namespace

RT_TEXTURE_PLUGIN("image", "1.0.0", kParameters, create, "A picture from a file.",
                  "wood: {image: {file: texture/wood.png}}\n")
