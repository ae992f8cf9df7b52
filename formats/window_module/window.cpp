// rt_window.so: a window through OpenCV's highgui. WINDOW_GUI_NORMAL has neither the toolbar nor the modal Ctrl+S dialog;
// arrow keys stop arriving there after a click (opencv#20215), so letters must do everything.
#include <formats/window_module/window_module.h>

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/highgui.hpp>
#include <opencv2/imgproc.hpp>
#include <xcb/xcb.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

std::string title;
std::vector<rt_window_event> queue;

/// Qt aborts the process when it finds no display, so the display is tried without Qt first.
int32_t probe(char* error, size_t errorSize) {
    const char* platform = std::getenv("QT_QPA_PLATFORM");
    if (platform && *platform && std::string(platform).find("xcb") == std::string::npos) return 1;
    const char* display = std::getenv("DISPLAY");
    if (!display || !*display) {
        std::snprintf(error, errorSize, "there is no display: DISPLAY is not set");
        return 0;
    }
    xcb_connection_t* connection = xcb_connect(nullptr, nullptr);
    const bool connected = xcb_connection_has_error(connection) == 0;
    xcb_disconnect(connection);
    if (!connected)
        std::snprintf(error, errorSize, "there is no display: nothing answers at DISPLAY=%s",
                      display);
    return connected;
}

void onMouse(int event, int x, int y, int flags, void*) {
    switch (event) {
    case cv::EVENT_LBUTTONDOWN:
        queue.push_back({RT_WINDOW_PRESS, 0, x, y});
        break;
    case cv::EVENT_LBUTTONUP:
        queue.push_back({RT_WINDOW_RELEASE, 0, x, y});
        break;
    case cv::EVENT_MOUSEMOVE:
        queue.push_back({RT_WINDOW_MOVE, 0, x, y});
        break;
    case cv::EVENT_MOUSEWHEEL:
        queue.push_back({RT_WINDOW_WHEEL, 0, x, cv::getMouseWheelDelta(flags) > 0 ? 1 : -1});
        break;
    default:
        break;
    }
}

int32_t open(const char* name, uint32_t width, uint32_t height, char* error, size_t errorSize) {
    try {
        cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
        title = name;
        cv::namedWindow(title, cv::WINDOW_NORMAL | cv::WINDOW_KEEPRATIO | cv::WINDOW_GUI_NORMAL);
        cv::resizeWindow(title, static_cast<int>(width), static_cast<int>(height));
        cv::setMouseCallback(title, onMouse);
        return 1;
    } catch (const std::exception& e) {
        std::snprintf(error, errorSize, "cannot open a window: %s", e.what());
        return 0;
    }
}

void show(const uint8_t* rgb, uint32_t width, uint32_t height) {
    const cv::Mat picture(static_cast<int>(height), static_cast<int>(width), CV_8UC3,
                          const_cast<uint8_t*>(rgb));
    cv::Mat swapped;
    cv::cvtColor(picture, swapped, cv::COLOR_RGB2BGR);
    cv::imshow(title, swapped);
}

bool isOpen() {
    try {
        return cv::getWindowProperty(title, cv::WND_PROP_VISIBLE) >= 1;
    } catch (const std::exception&) {
        return false;
    }
}

int32_t poll(rt_window_event* events, uint32_t capacity, int32_t milliseconds) {
    for (int wait = std::max(1, milliseconds);;
         wait = 1) { // waitKeyEx answers one key; further ones wait in highgui's queue
        const int key = cv::waitKeyEx(wait);
        if (key == -1) break;
        queue.push_back({RT_WINDOW_KEY, key, 0, 0});
    }
    if (!isOpen()) return -1;
    const auto count = static_cast<uint32_t>(std::min<size_t>(capacity, queue.size()));
    std::copy_n(queue.begin(), count, events);
    queue.erase(queue.begin(), queue.begin() + count);
    return static_cast<int32_t>(count);
}

void close() {
    try {
        if (isOpen()) cv::destroyWindow(title);
    } catch (const std::exception&) { // the window system is gone already
    }
}

void annotate(uint8_t* rgb, uint32_t width, uint32_t height, const char* const* lines,
              uint32_t count) {
    cv::Mat picture(static_cast<int>(height), static_cast<int>(width), CV_8UC3, rgb);
    const double scale = std::clamp(height / 900.0, 0.35, 1.0);
    const int step = static_cast<int>(34 * scale);
    for (uint32_t i = 0; i < count; ++i) {
        const cv::Point at(step / 3, step * static_cast<int>(i + 1));
        for (const auto& [color, thickness] :
             {std::pair{cv::Scalar(0, 0, 0), 3}, std::pair{cv::Scalar(255, 255, 255), 1}})
            cv::putText(picture, lines[i], at, cv::FONT_HERSHEY_SIMPLEX, scale, color, thickness,
                        cv::LINE_AA);
    }
}

} // namespace

extern "C" __attribute__((visibility("default"))) const rt_window_module rt_window_entry;
const rt_window_module rt_window_entry = {
    RT_WINDOW_MODULE_VERSION, sizeof(rt_window_module), probe, open, show, poll, close, annotate};
