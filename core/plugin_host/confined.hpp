// --sandbox for code that opens files itself: the kernel holds plugins, and the libraries behind them, to the readable folders.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rt::plugin_host {

/// Runs `work` to its end: in this thread, or where scene::readingIsConfined() in a thread of its own that may read files of
/// scene::readableFolders(), of `also` and of the system's libraries only, and write none (Landlock; inherited by the threads
/// that it starts). False: this kernel cannot, and `work` did not run. What `work` throws leaves here.
bool runConfined(const std::vector<std::filesystem::path>& also, const std::function<void()>& work);

} // namespace rt::plugin_host
