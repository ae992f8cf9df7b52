#include <core/trace/smooth.hpp>

namespace rt::trace {

void smooth(image::Framebuffer& frame) {
    // Row by row from the top left nothing is read after it was written.
    const std::uint32_t lastX = frame.width - 1, lastY = frame.height - 1;
    for (std::uint32_t y = 0; y < frame.height; ++y)
        for (std::uint32_t x = 0; x < frame.width; ++x) {
            auto& pixel = frame.at(x, y);
            if (x < lastX && y < lastY)
                pixel = (pixel + frame.at(x + 1, y) + frame.at(x, y + 1) + frame.at(x + 1, y + 1)) *
                        0.25;
            else if (y < lastY)
                pixel = (pixel + frame.at(x, y + 1)) * 0.5;
            else if (x < lastX)
                pixel = (pixel + frame.at(x + 1, y)) * 0.5;
        }
}

} // namespace rt::trace
