#include "write_obj.hpp"

#include "triangulate.hpp"

#include <charconv>
#include <string>

namespace rt::loaders {
namespace {

class ObjWriter {
public:
    ObjWriter(const MeshFile& file, const RepairedMesh& repaired,
              const std::function<void(std::string_view)>& write)
        : file_(file), repaired_(repaired), write_(write) {}

    void run() {
        for (const std::string& library : file_.materialLibraries) line("mtllib ", library);
        std::vector<std::uint32_t> number(file_.positions.size(), kNone);
        forEachFace([&](std::uint32_t f) {
            for (auto c = repaired_.faceStart[f]; c < repaired_.faceStart[f + 1]; ++c)
                number[vertexOf(repaired_.corners[c])] = 0;
        });
        std::uint32_t vertices = 0;
        for (std::uint32_t v = 0; v < number.size(); ++v) {
            if (number[v] == kNone) continue;
            number[v] = ++vertices;
            const Vector3& p = file_.positions[v];
            numbers("v", {p.x, p.y, p.z});
        }
        for (const Vector2& uv : file_.uvs) numbers("vt", {uv.x, uv.y});
        for (const Vector3& n : file_.normals) numbers("vn", {n.x, n.y, n.z});
        // Normals that turn with their face stand behind the others.
        std::vector<std::uint32_t> negative(file_.normals.size(), kNone);
        auto normals = static_cast<std::uint32_t>(file_.normals.size());
        forEachFace([&](std::uint32_t f) {
            if (!normalsTurn(f)) return;
            forEachNormal(f, [&](std::uint32_t n) {
                if (negative[n] != kNone) return;
                negative[n] = normals++;
                const Vector3& v = file_.normals[n];
                numbers("vn", {0 - v.x, 0 - v.y, 0 - v.z});
            });
        });

        std::size_t at = 0;
        const FaceRun* before = nullptr;
        forEachFace([&](std::uint32_t f) {
            while (at + 1 < file_.runs.size() &&
                   file_.runs[at + 1].firstFace <= repaired_.sourceFace[f])
                ++at;
            if (&file_.runs[at] != before) state(before, file_.runs[at]);
            before = &file_.runs[at];
            text_ += 'f';
            const bool turn = normalsTurn(f);
            for (auto c = repaired_.faceStart[f]; c < repaired_.faceStart[f + 1]; ++c) {
                const std::uint32_t corner = repaired_.corners[c];
                const std::uint32_t uv = file_.cornerUv.empty() ? kNone : file_.cornerUv[corner];
                std::uint32_t n = file_.cornerNormal.empty() ? kNone : file_.cornerNormal[corner];
                if (n != kNone && turn) n = negative[n];
                text_ += ' ';
                put(number[vertexOf(corner)]);
                if (uv != kNone || n != kNone) text_ += '/';
                if (uv != kNone) put(uv + 1);
                if (n != kNone) text_ += '/', put(n + 1);
            }
            endLine();
        });
        if (!text_.empty()) write_(text_);
    }

private:
    std::uint32_t vertexOf(std::uint32_t corner) const {
        return repaired_.weld[file_.cornerPosition[corner]];
    }

    template <class Visit> void forEachFace(Visit&& visit) const {
        for (std::uint32_t f = 0; f < repaired_.faceCount(); ++f)
            if (repaired_.outcomes[repaired_.sourceFace[f]].action != FaceAction::dropped) visit(f);
    }

    template <class Visit> void forEachNormal(std::uint32_t f, Visit&& visit) const {
        if (file_.cornerNormal.empty()) return;
        for (auto c = repaired_.faceStart[f]; c < repaired_.faceStart[f + 1]; ++c)
            if (const std::uint32_t n = file_.cornerNormal[repaired_.corners[c]]; n != kNone)
                visit(n);
    }

    /// Was the face turned, and do its normals still point where it faced?
    bool normalsTurn(std::uint32_t f) {
        if (repaired_.outcomes[repaired_.sourceFace[f]].action != FaceAction::flipped) return false;
        polygon_.clear();
        for (auto c = repaired_.faceStart[f]; c < repaired_.faceStart[f + 1]; ++c)
            polygon_.push_back(file_.positions[file_.cornerPosition[repaired_.corners[c]]]);
        const Vector3 geometric = newellNormal(polygon_);
        double sum = 0;
        forEachNormal(f, [&](std::uint32_t n) { sum += dot(geometric, file_.normals[n]); });
        return sum < 0;
    }

    void state(const FaceRun* before, const FaceRun& now) {
        const auto changed = [&](auto member) {
            return before ? before->*member != now.*member : now.*member != FaceRun().*member;
        };
        if (changed(&FaceRun::object) && now.object != kNone) line("o ", file_.names[now.object]);
        if (changed(&FaceRun::group) && now.group != kNone) line("g ", file_.names[now.group]);
        if (changed(&FaceRun::material))
            line("usemtl ", now.material == kNone ? "" : file_.materialNames[now.material]);
        if (changed(&FaceRun::smoothing))
            line("s ", now.smoothing == kSmoothingOff ? "off" : std::to_string(now.smoothing));
    }

    void line(std::string_view keyword, std::string_view rest) {
        text_ += keyword;
        text_ += rest;
        if (rest.ends_with('\\')) text_ += " #"; // a line that ended with it would go on
        endLine();
    }
    void numbers(std::string_view keyword, std::initializer_list<double> values) {
        text_ += keyword;
        for (const double v : values) text_ += ' ', put(v);
        endLine();
    }
    template <class T> void put(T value) {
        char digits[32];
        text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    }
    void endLine() {
        text_ += '\n';
        constexpr std::size_t kPiece = std::size_t{1} << 16;
        if (text_.size() < kPiece) return;
        write_(text_);
        text_.clear();
    }

    const MeshFile& file_;
    const RepairedMesh& repaired_;
    const std::function<void(std::string_view)>& write_;
    std::string text_;
    std::vector<Vector3> polygon_;
};

} // namespace

void writeObj(const MeshFile& file, const RepairedMesh& repaired,
              const std::function<void(std::string_view)>& write) {
    ObjWriter(file, repaired, write).run();
}

} // namespace rt::loaders
