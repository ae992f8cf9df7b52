#include <formats/frame_store.hpp>

#include <core/scene/input_file.hpp>
#include <formats/atomic_file.hpp>
#include <formats/checksum.hpp>

#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <map>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rt::formats {

namespace {

namespace fs = std::filesystem;

constexpr scene::Code kNoManifest{406}, kWriteFailed{605}, kInUse{608}, kHasFrames{609},
    kOtherSettings{610};
constexpr std::string_view kMagic = "rt-frames 1\n";

/// A file of rt's own `folder`, if it has `size` bytes.
std::optional<std::string> readAll(const std::string& folder, const std::string& path,
                                   std::optional<std::uint64_t> size = {}) {
    const auto opened = scene::InputFile::open(path, folder.empty() ? "." : folder);
    const auto* file = std::get_if<scene::InputFile>(&opened);
    if (!file || size.value_or(file->size()) != file->size()) return {};
    auto text = file->read();
    auto* const read = std::get_if<std::string>(&text);
    return read ? std::optional(std::move(*read)) : std::nullopt;
}

void append(int file, std::string_view line, const std::string& path) {
    const auto fail = [&] {
        throw std::system_error(errno, std::generic_category(), "cannot write '" + path + "'");
    };
    while (!line.empty()) {
        const ssize_t n = ::write(file, line.data(), line.size());
        if (n < 0 && errno != EINTR) fail();
        if (n > 0) line.remove_prefix(static_cast<std::size_t>(n));
    }
    if (::fsync(file) != 0) fail();
}

std::string sealed(const std::string& line) { return line + '\t' + checksum(line) + '\n'; }

/// The line without its checksum, if that is right.
std::optional<std::string_view> unsealed(std::string_view line) {
    const std::size_t tab = line.rfind('\t');
    if (tab == std::string_view::npos) return {};
    const std::string_view body = line.substr(0, tab);
    return checksum(body) == line.substr(tab + 1) ? std::optional(body) : std::nullopt;
}

std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::size_t from = 0;;) {
        const std::size_t to = line.find('\t', from);
        words.push_back(line.substr(from, to - from));
        if (to == std::string_view::npos) return words;
        from = to + 1;
    }
}

template <class Number> bool readNumber(std::string_view word, Number& number) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    return error == std::errc() && end == word.data() + word.size();
}

/// Does `file` name this frame, within the folder? A manifest may come from somebody else.
bool isFileOf(FramePlace place, std::uint32_t frame, std::string_view file) {
    place.after.clear();
    return file.starts_with(place.fileOf(frame)) && file.find('/') == std::string_view::npos;
}

std::string lockOf(const FramePlace& place) {
    return (place.manifest.starts_with('.') ? "" : ".") + place.manifest + ".lock";
}

/// Removes the temporary files of a process that was killed.
void sweep(const FramePlace& place) {
    std::error_code ignored;
    for (const std::string& name : scene::namesIn(place.folder)) {
        const std::string start = "." + place.before;
        const bool ours = (name.starts_with(start) && name.size() > start.size() &&
                           std::isdigit(static_cast<unsigned char>(name[start.size()]))) ||
                          name.starts_with("." + place.manifest + ".");
        if (ours && name.ends_with(".tmp")) fs::remove(fs::path(place.folder) / name, ignored);
    }
}

scene::Location whole(const std::string& path) {
    return {std::make_shared<scene::Source>(scene::Source{path, {}}), 0, 0};
}

} // namespace

std::string firstDifference(const Settings& before, const Settings& now) {
    const std::map<std::string, std::string> old(before.begin(), before.end()),
        current(now.begin(), now.end());
    for (const auto& [field, value] : now) {
        const auto found = old.find(field);
        if (found == old.end()) return field + " is new: " + scene::quoted(value);
        if (found->second != value)
            return field + " was " + scene::quoted(found->second) + " and is " +
                   scene::quoted(value);
    }
    for (const auto& [field, value] : before)
        if (!current.contains(field))
            return field + " was " + scene::quoted(value) + " and is gone";
    return {};
}

FrameStore::FrameStore(FrameStore&& other) noexcept
    : place_(std::move(other.place_)), settings_(std::move(other.settings_)),
      entries_(std::move(other.entries_)), lock_(std::exchange(other.lock_, -1)),
      manifest_(std::exchange(other.manifest_, -1)) {}

FrameStore::~FrameStore() {
    if (manifest_ >= 0) ::close(manifest_);
    if (lock_ >= 0) ::close(lock_);
}

std::string FrameStore::lineOf(std::uint32_t frame, const Entry& entry) {
    return sealed("frame\t" + std::to_string(frame) + '\t' + entry.file + '\t' +
                  std::to_string(entry.size) + '\t' + entry.checksum);
}

std::string FrameStore::manifest() const {
    std::string text(kMagic);
    for (const auto& [field, value] : settings_) text += sealed("set\t" + field + '\t' + value);
    for (const auto& [frame, entry] : entries_) text += lineOf(frame, entry);
    return text;
}

bool FrameStore::parse(std::string_view manifest) {
    manifest.remove_prefix(kMagic.size());
    bool clean = true;
    while (!manifest.empty()) {
        const std::size_t end = manifest.find('\n');
        clean &= end != std::string_view::npos; // else the next line would join this one
        const auto body = unsealed(manifest.substr(0, end));
        manifest.remove_prefix(end == std::string_view::npos ? manifest.size() : end + 1);
        const auto w = body ? split(*body) : std::vector<std::string_view>{};
        std::uint32_t frame = 0;
        std::uint64_t size = 0;
        if (w.size() == 3 && w[0] == "set")
            settings_.emplace_back(w[1], w[2]);
        else if (w.size() == 5 && w[0] == "frame" && readNumber(w[1], frame) &&
                 isFileOf(place_, frame, w[2]) && readNumber(w[3], size))
            clean &=
                entries_.insert_or_assign(frame, Entry{std::string(w[2]), std::string(w[4]), size})
                    .second;
        else
            clean = false;
    }
    return clean;
}

std::optional<FrameStore> FrameStore::open(const FramePlace& place, const Settings& settings,
                                           Mode mode, scene::Diagnostics& diagnostics) {
    const auto fail = [&](scene::Code code, std::string sentence, std::string suggestion = {}) {
        diagnostics.error(code, whole(place.folder), std::move(sentence), std::move(suggestion));
        return std::nullopt;
    };
    const auto failErrno = [&] {
        return fail(kWriteFailed, std::string("cannot be written: ") + std::strerror(errno));
    };
    std::error_code error;
    fs::create_directory(place.folder, error);
    if (error) return fail(kWriteFailed, "this folder cannot be made: " + error.message());

    FrameStore store(place);
    store.lock_ = ::open(store.place_.pathOf(lockOf(place)).c_str(),
                         O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (store.lock_ < 0) return failErrno();
    if (::flock(store.lock_, LOCK_EX | LOCK_NB) != 0) {
        char pid[32] = {};
        const bool known = ::pread(store.lock_, pid, sizeof pid - 1, 0) > 0;
        return fail(kInUse, "is in use by " + (known ? "process " + std::string(pid)
                                                     : std::string("another process")));
    }
    const std::string pid = std::to_string(::getpid());
    if (::ftruncate(store.lock_, 0) != 0 || ::pwrite(store.lock_, pid.data(), pid.size(), 0) < 0)
        return failErrno();
    sweep(place);

    const std::string path = store.place_.pathOf(place.manifest);
    const auto before = readAll(place.folder, path);
    const bool isManifest = before && before->starts_with(kMagic);
    bool clean = isManifest && store.parse(*before);
    if (!store.entries_.empty() && mode == Mode::fresh)
        return fail(kHasFrames,
                    "has " + std::to_string(store.entries_.size()) + " frames of an earlier run",
                    "--resume renders what is missing, --overwrite starts again");
    if (!store.entries_.empty() && mode == Mode::resume)
        if (const std::string difference = firstDifference(store.settings_, settings);
            !difference.empty())
            return fail(kOtherSettings, "these frames are of another film: " + difference,
                        "--overwrite starts again");
    const auto forgotten = mode == Mode::overwrite ? std::exchange(store.entries_, {})
                                                   : std::map<std::uint32_t, Entry>{};
    if (store.entries_.empty()) store.settings_ = settings, clean = false;
    try {
        if (!clean) {
            const std::string text = store.manifest();
            writeFileAtomically(path, std::as_bytes(std::span(text)));
        }
    } catch (const std::system_error& failure) {
        return fail(kWriteFailed, "cannot be written: " + failure.code().message());
    }
    for (const auto& [frame, entry] : forgotten) fs::remove(store.place_.pathOf(entry.file), error);
    store.manifest_ = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    if (store.manifest_ < 0) return failErrno();
    return store;
}

std::optional<FrameStore> FrameStore::read(const FramePlace& place,
                                           scene::Diagnostics& diagnostics) {
    FrameStore store(place);
    const auto manifest = readAll(place.folder, store.place_.pathOf(place.manifest));
    if (!manifest || !manifest->starts_with(kMagic)) {
        diagnostics.error(kNoManifest, whole(place.folder),
                          "is no folder of frames: it has no manifest");
        return {};
    }
    store.parse(*manifest);
    return store;
}

std::string FrameStore::setting(const std::string& field) const {
    for (const auto& [name, value] : settings_)
        if (name == field) return value;
    return {};
}

std::vector<std::uint32_t> FrameStore::listed() const {
    std::vector<std::uint32_t> frames;
    for (const auto& [frame, entry] : entries_) frames.push_back(frame);
    return frames;
}

std::optional<std::vector<std::byte>> FrameStore::load(std::uint32_t frame) const {
    const auto found = entries_.find(frame);
    if (found == entries_.end()) return {};
    const auto text = readAll(place_.folder, place_.pathOf(found->second.file), found->second.size);
    if (!text || checksum(*text) != found->second.checksum) return {};
    const auto* first = reinterpret_cast<const std::byte*>(text->data());
    return std::vector(first, first + text->size());
}

void FrameStore::commit(std::uint32_t frame, std::span<const std::byte> bytes) {
    const Entry entry{place_.fileOf(frame), checksum(bytes), bytes.size()};
    writeFileAtomically(place_.pathOf(entry.file), bytes);
    append(manifest_, lineOf(frame, entry), place_.pathOf(place_.manifest));
    entries_.insert_or_assign(frame, entry);
}

} // namespace rt::formats
