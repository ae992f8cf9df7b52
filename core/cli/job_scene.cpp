#include <core/cli/job_scene.hpp>

#include <core/cli/output.hpp>

#include <filesystem>

namespace rt::cli {

std::unique_ptr<JobScene> JobScene::load(const std::vector<std::string>& words,
                                         scene::Diagnostics& diagnostics) {
    std::vector<const char*> argv{"rt"};
    for (const std::string& word : words) argv.push_back(word.c_str());
    CommandLine line;
    parseCommandLine(static_cast<int>(argv.size()), argv.data(), line);
    std::unique_ptr<JobScene> scene(new JobScene);
    scene->options = std::get<RenderOptions>(line.options);
    scene->catalog_.emplace(plugin_host::searchPath(scene->options.pluginDirs));
    scene->scene_ = loadScene(scene->options.scene, scene->options, *scene->catalog_, diagnostics);
    if (!scene->scene_) return nullptr;
    scene->drawer_.emplace(scene->options, scene->description(), *scene->catalog_);
    return scene->drawer_->load(diagnostics) ? std::move(scene) : nullptr;
}

std::unique_ptr<JobScene> JobScene::of(const farm::Job& job, scene::Diagnostics& diagnostics) {
    constexpr scene::Code kOtherSettings{610};
    std::filesystem::current_path(job.workingFolder);
    auto scene = load(job.words, diagnostics);
    if (!scene) return nullptr;
    const std::string difference =
        formats::firstDifference(job.settings, scene->drawer().settings());
    if (difference.empty()) return scene;
    diagnostics.error(kOtherSettings, wholeFile(job.folder),
                      "the scene is not what it was when the job was made: " + difference,
                      "undo the change, or submit another job");
    return nullptr;
}

} // namespace rt::cli
