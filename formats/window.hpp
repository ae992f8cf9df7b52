// The window module (OpenCV highgui), opened when a viewer needs it.
#pragma once
#include <formats/window_module/window_module.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace rt::formats {

/// There is no display to open a window on.
struct NoDisplay : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The module itself. Throws std::runtime_error when it cannot be opened.
const rt_window_module& windowModule();

/// One window per process.
class Window {
public:
    /// Throws NoDisplay, or std::runtime_error.
    Window(const std::string& title, std::uint32_t width, std::uint32_t height);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    void show(const std::uint8_t* rgb, std::uint32_t width, std::uint32_t height);
    /// Nothing when the window was closed.
    std::optional<std::vector<rt_window_event>> poll(int milliseconds);

private:
    const rt_window_module& module_;
};

} // namespace rt::formats
