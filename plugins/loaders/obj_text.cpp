#include "obj_text.hpp"

#include "file_bytes.hpp"
#include "mtl_text.hpp"
#include "text_cursor.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace rt::loaders {
namespace {

class ObjReader {
public:
    ObjReader(const std::string& path, std::string text)
        : text_(std::string(fileName(path)), std::move(text), true) {
        mesh_.path = path;
        const auto slash = path.find_last_of('/');
        folder_ = slash == std::string::npos ? "." : path.substr(0, slash + 1);
    }

    MeshFile read() {
        mesh_.runs.push_back({});
        while (!text_.atEnd()) statement();
        checkForwardIndices();
        if (mesh_.faceCount() == 0) throw FileError(text_.name() + ": holds no face");
        if (widestFace_ < 3) text_.fail(firstFace_, "no face of the file has three corners");
        dropEmptyRuns();
        addNotes();
        return std::move(mesh_);
    }

private:
    struct Ignored {
        std::uint64_t count = 0;
        const char* first = nullptr;
    };
    struct ForwardIndex { // checked when the whole file has been read
        const char* at;
        std::uint32_t index;
        std::uint8_t list;
    };

    void statement() {
        text_.skipBlanks();
        const char* const p = text_.at;
        const auto keywordEnds = [](char c) { return isBlank(c) || isLineEnd(c); };
        if (p[0] == 'v') {
            if (keywordEnds(p[1])) return vertex();
            if (p[1] == 't' && keywordEnds(p[2])) return uv();
            if (p[1] == 'n' && keywordEnds(p[2])) return normal();
        } else if (p[0] == 'f') {
            if (keywordEnds(p[1])) return text_.at = p + 1, face();
            if (p[1] == 'o' && keywordEnds(p[2])) return text_.at = p + 2, face(); // before 1995
        }
        if (isLineEnd(*p) || *p == '#') return text_.skipLine();
        other(text_.word());
        text_.skipLine();
    }

    void endOfNumbers(const char* statement) {
        text_.skipBlanks();
        if (!text_.statementEnds())
            text_.fail("unexpected " + quoted(text_.peekWord()) + " at the end of '" + statement +
                       "'");
        text_.skipLine();
    }

    double coordinate(const char* what) {
        const double value = text_.real(what);
        if (!(std::fabs(value) <= kLargestCoordinate))
            text_.fail(std::string(what) + " is larger than 1e100");
        return value;
    }

    void vertex() {
        const char* const from = text_.at++;
        const double x = coordinate("the x coordinate"), y = coordinate("the y coordinate"),
                     z = coordinate("the z coordinate");
        mesh_.positions.push_back({x, y, z});
        int more = 0; // a weight, a colour, or both
        for (text_.skipBlanks(); !text_.statementEnds(); text_.skipBlanks()) {
            if (++more > 5) text_.fail("a vertex has at most eight numbers");
            text_.anyReal(more == 1 ? "the weight or colour" : "the colour");
        }
        if (more == 1 || more > 4) note(weights_, from);
        if (more > 1) note(colours_, from);
        text_.skipLine();
    }

    void uv() {
        text_.at += 2;
        Vector2 uv;
        uv.x = coordinate("u");
        text_.skipBlanks();
        if (!text_.statementEnds()) uv.y = coordinate("v");
        text_.skipBlanks();
        if (!text_.statementEnds()) coordinate("w"); // depth of a solid texture
        mesh_.uvs.push_back(uv);
        endOfNumbers("vt");
    }

    void normal() {
        text_.at += 2;
        const double x = coordinate("the normal's x"), y = coordinate("the normal's y"),
                     z = coordinate("the normal's z");
        mesh_.normals.push_back({x, y, z});
        endOfNumbers("vn");
    }

    enum List : std::uint8_t { kVertex, kUv, kNormal };
    static constexpr const char* kListNames[] = {"vertex", "texture coordinate", "normal"};

    std::size_t sizeOf(List list) const {
        return list == kVertex ? mesh_.positions.size()
               : list == kUv   ? mesh_.uvs.size()
                               : mesh_.normals.size();
    }

    [[noreturn]] void failRange(const char* at, List list) const {
        static constexpr const char* kPlurals[] = {"vertices", "texture coordinates", "normals"};
        const char* end = at;
        while (isDigit(*end) || *end == '-' || *end == '+') ++end;
        const auto size = sizeOf(list);
        text_.fail(at, std::string(kListNames[list]) + " index " + std::string(at, end) +
                           " is out of range: the file has " +
                           (size == 0 ? "no" : std::to_string(size)) + " " +
                           (size == 1 ? kListNames[list] : kPlurals[list]) +
                           (*at == '-' ? " before it" : ""));
    }

    std::uint32_t index(List list) {
        const char* const from = text_.at;
        const char* p = from;
        const bool negative = *p == '-';
        if (*p == '-' || *p == '+') ++p;
        const char* const first = p;
        std::uint64_t value = 0;
        while (isDigit(*p) && value < (std::uint64_t{1} << 40))
            value = 10 * value + static_cast<unsigned>(*p++ - '0');
        if (p == first || !(isBlank(*p) || isLineEnd(*p) || *p == '/' || *p == '#' || isDigit(*p)))
            text_.fail(from, std::string("the ") + kListNames[list] +
                                 " index is not an integer: " + quoted(text_.peekWord()));
        while (isDigit(*p)) ++p;
        text_.at = p;
        const auto size = sizeOf(list);
        if (value == 0)
            text_.fail(from, std::string(kListNames[list]) + " index 0: OBJ counts from 1");
        if (negative && value <= size) return static_cast<std::uint32_t>(size - value);
        if (negative || value >= kNone) {
            // Without any texture coordinate or normal in the file, corners that name some are forgiven.
            if (list == kVertex || size != 0) failRange(from, list);
            forward_.push_back({from, kNone, list});
            return kNone;
        }
        const auto resolved = static_cast<std::uint32_t>(value - 1);
        if (resolved >= size) forward_.push_back({from, resolved, list});
        return resolved;
    }

    /// Optional second or third index of a corner: the array exists from its first use on.
    void putOptional(std::vector<std::uint32_t>& list, std::uint32_t value) {
        if (value == kNone && list.empty()) return;
        list.resize(mesh_.cornerPosition.size() - 1, kNone);
        list.push_back(value);
    }

    void face() {
        const char* const from = text_.at;
        std::uint32_t corners = 0;
        for (text_.skipBlanks(); !text_.statementEnds(); text_.skipBlanks(), ++corners) {
            mesh_.cornerPosition.push_back(index(kVertex));
            std::uint32_t uv = kNone, normal = kNone;
            if (*text_.at == '/') {
                ++text_.at;
                if (*text_.at == '-' || *text_.at == '+' || isDigit(*text_.at)) uv = index(kUv);
                if (*text_.at == '/') {
                    ++text_.at;
                    if (*text_.at == '-' || *text_.at == '+' || isDigit(*text_.at))
                        normal = index(kNormal);
                }
                if (!isBlank(*text_.at) && !text_.statementEnds())
                    text_.fail("a corner is v, v/t, v//n or v/t/n, not " +
                               quoted(text_.peekWord()));
            }
            putOptional(mesh_.cornerUv, uv);
            putOptional(mesh_.cornerNormal, normal);
        }
        if (mesh_.cornerPosition.size() >= kNone)
            text_.fail(from, "the file has more than 2^32 - 2 corners");
        if (mesh_.faceStart.size() == 1) firstFace_ = from;
        widestFace_ = std::max(widestFace_, corners);
        mesh_.faceStart.push_back(static_cast<std::uint32_t>(mesh_.cornerPosition.size()));
        text_.skipLine();
    }

    void checkForwardIndices() {
        for (const ForwardIndex& f : forward_) {
            const List list{f.list};
            if (list != kVertex && sizeOf(list) == 0)
                note(absent_[list], f.at);
            else if (f.index >= sizeOf(list))
                failRange(f.at, list);
        }
        if (mesh_.uvs.empty()) mesh_.cornerUv.clear();
        if (mesh_.normals.empty()) mesh_.cornerNormal.clear();
        // A corner without uv or normal behind the last that has one.
        for (auto* list : {&mesh_.cornerUv, &mesh_.cornerNormal})
            if (!list->empty()) list->resize(mesh_.cornerPosition.size(), kNone);
        if (mesh_.positions.size() >= kNone || mesh_.uvs.size() >= kNone ||
            mesh_.normals.size() >= kNone)
            throw FileError(text_.name() + ": has more than 2^32 - 2 vertices");
    }

    void other(std::string_view keyword) {
        const char* const from = keyword.data();
        if (keyword == "s") return smoothing();
        if (keyword == "usemtl") return useMaterial();
        if (keyword == "mtllib") return materialLibrary(from);
        if (keyword == "g" || keyword == "o") {
            std::string name(text_.restOfLine());
            FaceRun& r = run();
            (keyword == "g" ? r.group : r.object) = static_cast<std::uint32_t>(mesh_.names.size());
            mesh_.names.push_back(std::move(name));
            return;
        }
        const bool printable = std::all_of(keyword.begin(), keyword.end(),
                                           [](char c) { return c > 0x20 && c < 0x7f; });
        if (!printable) text_.fail(from, quoted(keyword) + " is no OBJ statement");
        note(ignored_[std::string(keyword.substr(0, 40))], from);
    }

    void smoothing() {
        const std::string_view word = text_.restOfLine();
        std::uint32_t group = kSmoothingOff;
        const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), group);
        if (word == "on")
            group = 1;
        else if (word == "off" || word.empty())
            group = kSmoothingOff;
        else if (error != std::errc() || stop != word.data() + word.size() ||
                 group == kSmoothingUnstated)
            text_.fail(word.data(), "a smoothing group is a number or off, not " + quoted(word));
        run().smoothing = group;
    }

    void useMaterial() {
        const std::string_view name = text_.restOfLine();
        const char* const at = name.data();
        if (name.empty()) {
            run().material = kNone;
            return;
        }
        const auto known = materialIndex_.find(name);
        if (known != materialIndex_.end()) {
            run().material = known->second;
            return;
        }
        // Resolved when all libraries are read: mtllib may follow its first use.
        const auto index = static_cast<std::uint32_t>(mesh_.materialNames.size());
        materialIndex_.emplace(std::string(name), index);
        mesh_.materialNames.emplace_back(name);
        materialPlaces_.push_back(at);
        run().material = index;
    }

    void materialLibrary(const char* from) {
        const std::string line(text_.restOfLine());
        mesh_.materialLibraries.push_back(line);
        if (readLibrary(line)) return; // a name may hold blanks
        bool found = false;
        std::string why;
        for (std::size_t at = 0; at < line.size();) {
            const auto end = std::min(line.find_first_of(" \t", at), line.size());
            found |= readLibrary(line.substr(at, end - at), &why);
            at = line.find_first_not_of(" \t", end);
            if (at == line.npos) break;
        }
        if (!found)
            mesh_.notes.push_back(text_.place(from) + ": material library " + quoted(line) + " " +
                                  (why.empty() ? "is not named" : why));
    }

    bool readLibrary(const std::string& name, std::string* why = nullptr) {
        const std::string path = besideMesh(folder_, "", name, why);
        if (path.empty()) return false;
        if (!libraries_.insert({path, 0}).second) return true;
        MaterialLibrary library = readMtl(folder_, name, readFile(path, kLargestLibrary));
        mesh_.notes.insert(mesh_.notes.end(), library.notes.begin(), library.notes.end());
        known_.merge(library.materials);
        return true;
    }

    /// The run of the faces to come.
    FaceRun& run() {
        if (mesh_.runs.back().firstFace != mesh_.faceCount()) {
            mesh_.runs.push_back(mesh_.runs.back());
            mesh_.runs.back().firstFace = mesh_.faceCount();
        }
        return mesh_.runs.back();
    }

    void dropEmptyRuns() {
        if (mesh_.runs.back().firstFace == mesh_.faceCount()) mesh_.runs.pop_back();
        resolveMaterials();
    }

    void resolveMaterials() {
        std::vector<char> used(mesh_.materialNames.size(), 0);
        for (const FaceRun& r : mesh_.runs)
            if (r.material != kNone) used[r.material] = 1;
        mesh_.materialIndex.assign(used.size(), kNone);
        for (std::uint32_t i = 0; i < used.size(); ++i) {
            if (!used[i]) continue;
            const auto found = known_.find(mesh_.materialNames[i]);
            if (found == known_.end()) {
                note(unknownMaterials_, materialPlaces_[i]);
                continue;
            }
            mesh_.materialIndex[i] = static_cast<std::uint32_t>(mesh_.materials.size());
            mesh_.materials.push_back(found->second);
        }
    }

    static void note(Ignored& ignored, const char* at) {
        if (ignored.count++ == 0 || at < ignored.first) ignored.first = at;
    }

    void addNote(const Ignored& ignored, const std::string& what) {
        if (ignored.count == 0) return;
        mesh_.notes.push_back(text_.place(ignored.first) + ": " + std::to_string(ignored.count) +
                              " " + what);
    }

    void addNotes() {
        addNote(absent_[kUv], "corners name texture coordinates, and the file has none");
        addNote(absent_[kNormal], "corners name normals, and the file has none");
        addNote(colours_, "vertex colours are not used");
        addNote(weights_, "vertex weights are not used");
        addNote(unknownMaterials_,
                "material names are defined by no library; the object's material is used");
        for (const auto& [keyword, ignored] : ignored_) {
            if (keyword == "l")
                addNote(ignored, "lines (l) are not drawn");
            else if (keyword == "p")
                addNote(ignored, "points (p) are not drawn");
            else if (keyword == "vp" || keyword == "curv" || keyword == "curv2" ||
                     keyword == "surf")
                addNote(ignored, "free-form statements (" + keyword + ") are not drawn");
            else
                addNote(ignored, "statements " + quoted(keyword) + " are not used");
        }
    }

    TextCursor text_;
    MeshFile mesh_;
    std::string folder_;
    std::vector<ForwardIndex> forward_;
    const char* firstFace_ = nullptr;
    std::uint32_t widestFace_ = 0;
    Ignored colours_, weights_, unknownMaterials_, absent_[3];
    std::map<std::string, Ignored> ignored_;
    std::map<std::string, Material, std::less<>> known_;
    std::map<std::string, std::uint32_t, std::less<>> materialIndex_;
    std::map<std::string, int> libraries_;
    std::vector<const char*> materialPlaces_;
};

} // namespace

MeshFile readObj(const std::string& path, std::string text) {
    return ObjReader(path, std::move(text)).read();
}

} // namespace rt::loaders
