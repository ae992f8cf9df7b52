#include "mtl_text.hpp"

#include "text_cursor.hpp"

#include <cstdlib>
#include <memory>
#include <optional>

namespace rt::loaders {
namespace {

std::optional<std::string> realPath(const std::string& path) {
    const std::unique_ptr<char, decltype(&std::free)> real(realpath(path.c_str(), nullptr),
                                                           std::free);
    return real ? std::optional<std::string>(real.get()) : std::nullopt;
}

std::string folderOf(const std::string& name) {
    const auto slash = name.find_last_of('/');
    return slash == name.npos ? "" : name.substr(0, slash + 1);
}

void swapBackslashes(std::string& name) {
    for (char& c : name)
        if (c == '\\') c = '/';
}

/// What a newmtl says until the next.
struct Statements {
    const char* at;
    std::string name;
    Color diffuse{1, 1, 1}, specular, emission;
    std::optional<Color> filter;
    std::optional<double> dissolve, transparency, shininess, ior;
    int illumination = -1;
    std::string colorFile;
};

class MtlReader {
public:
    MtlReader(const std::string& root, const std::string& name, std::string text)
        : root_(root), folder_(name), text_(name, std::move(text), true) {
        swapBackslashes(folder_);
        folder_ = folderOf(folder_);
    }

    MaterialLibrary read() {
        while (!text_.atEnd()) {
            statement();
            text_.skipLine();
        }
        finish();
        return std::move(library_);
    }

private:
    void statement() {
        text_.skipBlanks();
        if (text_.statementEnds()) return;
        const char* const from = text_.at;
        const std::string_view key = text_.word();
        if (key == "newmtl") {
            finish();
            current_.emplace();
            current_->at = from;
            current_->name = std::string(text_.restOfLine());
            return;
        }
        if (!current_) return; // nothing to belong to
        if (key == "Kd")
            current_->diffuse = color();
        else if (key == "Ks")
            current_->specular = color();
        else if (key == "Ke")
            current_->emission = color();
        else if (key == "Tf" || key == "Kt")
            current_->filter = color();
        else if (key == "d")
            current_->dissolve = fraction("d");
        else if (key == "Tr")
            current_->transparency = fraction("Tr");
        else if (key == "Ns")
            current_->shininess = notNegative("Ns");
        else if (key == "Ni")
            current_->ior = notNegative("Ni");
        else if (key == "illum")
            current_->illumination = static_cast<int>(text_.real("illum"));
        else if (key == "map_Kd")
            colorFile(from);
    }

    double notNegative(const char* what) {
        text_.skipBlanks();
        const char* const from = text_.at;
        const double value = text_.real(what);
        if (value < 0 || value > kLargest)
            text_.fail(from, std::string(what) + " must be in [0, 1e6]");
        return value;
    }

    double fraction(const char* what) {
        text_.skipBlanks();
        if (text_.at[0] == '-' && text_.at[1] == 'h')
            text_.word(); // -halo: fades at the silhouette
        const char* const from = text_.at;
        const double value = text_.real(what);
        if (value < 0 || value > 1) text_.fail(from, std::string(what) + " must be in [0, 1]");
        return value;
    }

    Color color() {
        text_.skipBlanks();
        const char* const from = text_.at;
        const std::string_view first = text_.word();
        if (first == "spectral" || first == "xyz") {
            note(from, quoted(first) + " colours are not read; white is used");
            return {1, 1, 1};
        }
        text_.at = from;
        const double r = notNegative("the colour's red");
        text_.skipBlanks();
        if (text_.statementEnds()) return {r, r, r}; // g and b default to r
        const double g = notNegative("the colour's green"), b = notNegative("the colour's blue");
        return {r, g, b};
    }

    /// map_Kd [-option value...]... name, where the name may hold blanks.
    void colorFile(const char* from) {
        for (text_.skipBlanks(); *text_.at == '-'; text_.skipBlanks()) {
            const char* const option = text_.at;
            const std::string_view word = text_.word();
            int values = 1;
            if (word == "-mm") values = 2;
            if (word == "-o" || word == "-s" || word == "-t") values = 3;
            for (int i = 0; i < values; ++i) {
                text_.skipBlanks();
                const char* const value = text_.at;
                const std::string_view given = text_.word();
                double ignored;
                const bool number =
                    std::from_chars(given.data(), given.data() + given.size(), ignored).ec ==
                    std::errc();
                if (values == 3 && i > 0 && !number) { // only the first of three is required
                    text_.at = value;
                    break;
                }
            }
            note(option, "the option " + quoted(word) + " of map_Kd is not used");
        }
        const std::string name(text_.restOfLine());
        std::string why;
        current_->colorFile = besideMesh(root_, folder_, name, &why);
        if (current_->colorFile.empty()) note(from, "image " + quoted(name) + " " + why);
    }

    void finish() {
        if (!current_) return;
        const Statements& s = *current_;
        Material m;
        m.name = s.name;
        const double opacity = s.dissolve ? *s.dissolve : s.transparency ? 1 - *s.transparency : 1;
        const Color white{1, 1, 1};
        m.diffuse = s.diffuse * opacity;
        m.specular = s.illumination == 0 || s.illumination == 1 ? Color{} : s.specular;
        m.environment = s.emission;
        if (s.dissolve || s.transparency)
            m.transmission = s.filter.value_or(white) * (1 - opacity);
        else if (s.filter && !(*s.filter == white))
            m.transmission = *s.filter;
        if (s.shininess && *s.shininess > 0) m.shininess = *s.shininess;
        if (s.ior && *s.ior > 0) m.ior = *s.ior;
        m.colorFile.path = s.colorFile;
        if (!library_.materials.emplace(s.name, m).second)
            note(s.at, "material " + quoted(s.name) + " is defined twice; the first is used");
        current_.reset();
    }

    void note(const char* at, const std::string& what) {
        library_.notes.push_back(text_.place(at) + ": " + what);
    }

    static constexpr double kLargest = 1e6; // as colours in scenes

    const std::string root_;
    std::string folder_;
    TextCursor text_;
    MaterialLibrary library_;
    std::optional<Statements> current_;
};

} // namespace

std::string besideMesh(const std::string& root, const std::string& subfolder, std::string name,
                       std::string* why) {
    const auto refuse = [&](const char* reason) {
        if (why) *why = reason;
        return std::string();
    };
    swapBackslashes(name);
    if (name.empty()) return refuse("is not named");
    if (name[0] == '/' || (name.size() > 1 && name[1] == ':'))
        return refuse("has an absolute path, which is not followed");
    const auto folder = realPath(root.empty() ? "." : root);
    const auto file = realPath((root.empty() ? "./" : root + "/") + subfolder + name);
    if (!folder || !file) return refuse("is not there");
    if (*folder != "/" && file->compare(0, folder->size() + 1, *folder + "/") != 0)
        return refuse("lies above the mesh's folder, where nothing is read");
    return *file;
}

MaterialLibrary readMtl(const std::string& root, const std::string& name, std::string text) {
    return MtlReader(root, name, std::move(text)).read();
}

} // namespace rt::loaders
