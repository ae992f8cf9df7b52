// The loader `assimp`: glTF and what else the Open Asset Import Library reads. Assimp reads the bytes; from there a file
// goes the way of every mesh: nodes placed, faces welded, wound outward and triangulated, in f64. Assimp itself computes
// in f32, and its importers are less hardened than those of `openmesh`.
#include "file_bytes.hpp"
#include "import_parameters.hpp"
#include "mtl_text.hpp"

#include <assimp/GltfMaterial.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/commonMetaData.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace {

using namespace rt::loaders;
using rt::Vector3;

class BytesInMemory final : public Assimp::IOStream {
public:
    explicit BytesInMemory(std::string bytes) : bytes_(std::move(bytes)) {}

    std::size_t Read(void* to, std::size_t size, std::size_t count) override {
        if (size == 0) return 0;
        const std::size_t items = std::min(count, (bytes_.size() - at_) / size);
        std::copy_n(bytes_.data() + at_, items * size, static_cast<char*>(to));
        at_ += items * size;
        return items;
    }
    std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
    aiReturn Seek(std::size_t offset, aiOrigin origin) override {
        const std::size_t from = origin == aiOrigin_SET   ? 0
                                 : origin == aiOrigin_CUR ? at_
                                                          : bytes_.size();
        const std::size_t to = from + offset; // wraps for steps back, as Assimp's callers mean it
        if (to > bytes_.size()) return aiReturn_FAILURE;
        at_ = to;
        return aiReturn_SUCCESS;
    }
    std::size_t Tell() const override { return at_; }
    std::size_t FileSize() const override { return bytes_.size(); }
    void Flush() override {}

private:
    std::string bytes_;
    std::size_t at_ = 0;
};

/// Lets Assimp read regular files in and below the folder of the one it was given, and write nothing.
class FolderOnly final : public Assimp::IOSystem {
public:
    explicit FolderOnly(const std::string& path) : path_(path) {
        const auto slash = path.find_last_of('/');
        folder_ = slash == std::string::npos ? "." : path.substr(0, slash);
    }

    /// Why the last file that was asked for could not be given; empty: it could.
    const std::string& refusal() const { return refusal_; }

    bool Exists(const char* name) const override { return !realOf(name, nullptr).empty(); }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* name, const char* mode) override {
        if (mode != nullptr && *mode != 'r') return nullptr;
        try {
            std::string why;
            const std::string file = realOf(name, &why);
            if (file.empty()) throw FileError("the file '" + std::string(name) + "' " + why);
            auto* const stream = new BytesInMemory(readFile(file, kLargestMesh));
            refusal_.clear();
            return stream;
        } catch (const FileError& error) {
            refusal_ = error.what();
            return nullptr;
        }
    }
    void Close(Assimp::IOStream* stream) override { delete stream; }

private:
    std::string realOf(const std::string& name, std::string* why) const {
        if (name == path_) return path_;
        // Assimp puts the folder in front of what a file names.
        const bool inFolder = name.compare(0, folder_.size() + 1, folder_ + "/") == 0;
        return besideMesh(folder_, "", inFolder ? name.substr(folder_.size() + 1) : name, why);
    }

    std::string path_, folder_, refusal_;
};

/// x -> linear x + translation, of Assimp's f32 numbers and computed in f64.
struct Placement {
    Vector3 columns[3], translation;

    Vector3 direction(const Vector3& v) const {
        return columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
    }
    Vector3 point(const Vector3& p) const { return direction(p) + translation; }
    double determinant() const { return rt::dot(columns[0], rt::cross(columns[1], columns[2])); }
    /// Of a normal: the cofactors, which are the inverse transpose but for a factor.
    Vector3 normal(const Vector3& n) const {
        const Vector3 v = rt::cross(columns[1], columns[2]) * n.x +
                          rt::cross(columns[2], columns[0]) * n.y +
                          rt::cross(columns[0], columns[1]) * n.z;
        return determinant() < 0 ? -v : v;
    }
};

Placement operator*(const Placement& parent, const aiMatrix4x4& m) {
    return {{parent.direction({m.a1, m.b1, m.c1}), parent.direction({m.a2, m.b2, m.c2}),
             parent.direction({m.a3, m.b3, m.c3})},
            parent.point({m.a4, m.b4, m.c4})};
}

bool isFinite(const aiVector3D& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::string inQuotes(const aiString& name) { return "'" + std::string(name.C_Str()) + "'"; }

/// What Assimp read as the plain lists that repair begins with.
class SceneReader {
public:
    SceneReader(const std::string& path, const aiScene& scene)
        : scene_(scene), name_(fileName(path)), ownMaterials_(scene.mNumMaterials) {
        file_.path = path;
        const auto slash = path.find_last_of('/');
        folder_ = slash == std::string::npos ? "." : path.substr(0, slash);
    }

    MeshFile read() {
        takeMaterials();
        place({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}}, *scene_.mRootNode, 0);
        if (file_.faceCount() == 0) throw FileError(name_ + ": holds no triangle");
        if (!anyNormal_) file_.cornerNormal.clear();
        if (!anyUv_) file_.cornerUv.clear();
        sayWhatIsLeft();
        return std::move(file_);
    }

private:
    void note(const std::string& what) { file_.notes.push_back(name_ + ": " + what); }

    void takeMaterials() {
        // Assimp appends what glTF gives to meshes without a material; here the object's is theirs.
        aiString format;
        if (scene_.mMetaData != nullptr &&
            scene_.mMetaData->Get(AI_METADATA_SOURCE_FORMAT, format) &&
            std::string_view(format.C_Str()).starts_with("glTF2") && scene_.mNumMaterials != 0)
            ownMaterials_ = scene_.mNumMaterials - 1;
        for (unsigned i = 0; i < ownMaterials_; ++i) {
            const aiMaterial& from = *scene_.mMaterials[i];
            rt::Material to;
            aiString name;
            if (from.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) to.name = name.C_Str();
            aiColor4D color(1, 1, 1, 1);
            if (from.Get(AI_MATKEY_BASE_COLOR, color) != aiReturn_SUCCESS)
                from.Get(AI_MATKEY_COLOR_DIFFUSE, color);
            const auto usable = [](double c) { return std::isfinite(c) && c >= 0 ? c : 0; };
            to.color = {usable(color.r), usable(color.g), usable(color.b)};
            to.diffuse = {1, 1, 1};
            to.colorFile.path = colorFile(from);
            carriesMore_.push_back(carriesMore(from, color));
            file_.materialIndex.push_back(static_cast<std::uint32_t>(file_.materials.size()));
            file_.materialNames.push_back(to.name);
            file_.materials.push_back(std::move(to));
        }
    }

    std::string colorFile(const aiMaterial& material) {
        for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
            aiString path;
            unsigned channel = 0;
            if (material.GetTexture(type, 0, &path, nullptr, &channel) != aiReturn_SUCCESS)
                continue;
            std::string why;
            if (path.length != 0 && path.data[0] == '*')
                why = "is inside the file, where no texture is read";
            else if (channel != 0)
                why = "uses a second set of texture coordinates, which is not read";
            else if (std::string file = besideMesh(folder_, "", path.C_Str(), &why); !file.empty())
                return file;
            note("image " + inQuotes(path) + " " + why);
            return {};
        }
        return {};
    }

    /// glTF's defaults are metallic 1 and roughness 1, and Assimp states them.
    static bool carriesMore(const aiMaterial& material, const aiColor4D& color) {
        const auto number = [&](const char* key, unsigned type, unsigned index, double otherwise) {
            ai_real value = 0;
            return material.Get(key, type, index, value) == aiReturn_SUCCESS ? double{value}
                                                                             : otherwise;
        };
        aiColor3D emission(0, 0, 0);
        material.Get(AI_MATKEY_COLOR_EMISSIVE, emission);
        for (const aiTextureType type :
             {aiTextureType_NORMALS, aiTextureType_EMISSIVE, aiTextureType_METALNESS,
              aiTextureType_DIFFUSE_ROUGHNESS, aiTextureType_UNKNOWN})
            if (material.GetTextureCount(type) != 0) return true;
        return number(AI_MATKEY_METALLIC_FACTOR, 0) != 0 ||
               number(AI_MATKEY_ROUGHNESS_FACTOR, 1) != 1 ||
               number(AI_MATKEY_TRANSMISSION_FACTOR, 0) != 0 || number(AI_MATKEY_OPACITY, 1) != 1 ||
               color.a != 1 || !emission.IsBlack();
    }

    void place(const Placement& parent, const aiNode& node, int depth) {
        constexpr int kDeepest = 1000; // far beyond any model, within any stack
        if (depth > kDeepest) throw FileError(name_ + ": its nodes are nested more than 1000 deep");
        const Placement here = parent * node.mTransformation;
        for (unsigned i = 0; i < node.mNumMeshes; ++i) add(here, *scene_.mMeshes[node.mMeshes[i]]);
        for (unsigned i = 0; i < node.mNumChildren; ++i) place(here, *node.mChildren[i], depth + 1);
    }

    void add(const Placement& here, const aiMesh& mesh) {
        if (mesh.mNumBones != 0) ++skinned_;
        if (mesh.mNumAnimMeshes != 0) ++morphed_;
        if (mesh.HasVertexColors(0)) ++colored_;
        const std::uint64_t first = file_.positions.size();
        if (first + mesh.mNumVertices >= kNone)
            throw FileError(name_ + ": has more than 2^32 - 2 vertices");
        for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
            const aiVector3D& v = mesh.mVertices[i];
            const Vector3 p = here.point({v.x, v.y, v.z});
            if (!isFinite(v) || !(std::fabs(p.x) + std::fabs(p.y) + std::fabs(p.z) <
                                  kLargestCoordinate)) // a NaN of the transform too
                throw FileError(name_ + ": mesh " + inQuotes(mesh.mName) + ", vertex " +
                                std::to_string(i) + " is not finite");
            file_.positions.push_back(p);
            takeNormal(here, mesh, i);
            takeUv(mesh, i);
        }
        const std::uint32_t material =
            mesh.mMaterialIndex < ownMaterials_ ? mesh.mMaterialIndex : kNone;
        if (material != kNone && carriesMore_[material]) beyondBaseColor_.insert(material);
        const auto object = static_cast<std::uint32_t>(file_.names.size());
        file_.names.emplace_back(mesh.mName.C_Str());
        const std::uint32_t firstFace = file_.faceCount();
        const bool mirrored = here.determinant() < 0;
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices < 3) {
                ++pointsAndLines_;
                continue;
            }
            for (unsigned k = 0; k < face.mNumIndices; ++k) {
                const unsigned v = face.mIndices[mirrored ? face.mNumIndices - 1 - k : k];
                if (v >= mesh.mNumVertices)
                    throw FileError(name_ + ": mesh " + inQuotes(mesh.mName) + ", face " +
                                    std::to_string(f) + " names vertex " + std::to_string(v) +
                                    " of " + std::to_string(mesh.mNumVertices));
                const auto corner = static_cast<std::uint32_t>(first + v);
                file_.cornerPosition.push_back(corner);
                file_.cornerNormal.push_back(normalOf_[corner]);
                file_.cornerUv.push_back(uvOf_[corner]);
            }
            file_.faceStart.push_back(static_cast<std::uint32_t>(file_.cornerPosition.size()));
        }
        if (file_.faceCount() != firstFace)
            file_.runs.push_back({firstFace, kSmoothingUnstated, material, object, kNone});
    }

    void takeNormal(const Placement& here, const aiMesh& mesh, unsigned i) {
        normalOf_.push_back(kNone);
        if (!mesh.HasNormals() || !isFinite(mesh.mNormals[i])) return;
        const aiVector3D& n = mesh.mNormals[i];
        normalOf_.back() = static_cast<std::uint32_t>(file_.normals.size());
        file_.normals.push_back(here.normal({n.x, n.y, n.z}));
        anyNormal_ = true;
    }

    void takeUv(const aiMesh& mesh, unsigned i) {
        uvOf_.push_back(kNone);
        if (!mesh.HasTextureCoords(0) || !isFinite(mesh.mTextureCoords[0][i])) return;
        uvOf_.back() = static_cast<std::uint32_t>(file_.uvs.size());
        file_.uvs.push_back({mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y});
        anyUv_ = true;
    }

    void sayWhatIsLeft() {
        const auto say = [&](std::uint64_t n, const char* one, const char* many, const char* what) {
            if (n != 0) note(std::to_string(n) + " " + (n == 1 ? one : many) + " " + what);
        };
        say(beyondBaseColor_.size(), "material says", "materials say",
            "more than a base color (metal, roughness, emission, transparency or other maps); only "
            "the base color is taken");
        say(scene_.mNumAnimations, "animation", "animations", "not carried over");
        say(skinned_, "mesh has a skeleton", "meshes have skeletons",
            "and stands as the file has it");
        say(morphed_, "mesh has morph targets", "meshes have morph targets",
            "which are not applied");
        say(colored_, "mesh has", "meshes have",
            "colors at its vertices, which are not carried over");
        say(pointsAndLines_, "point or line", "points and lines", "left out");
        say(scene_.mNumCameras, "camera", "cameras", "not carried over: a scene has its own");
        say(scene_.mNumLights, "light", "lights", "not carried over: a scene has its own");
    }

    const aiScene& scene_;
    std::string name_, folder_;
    MeshFile file_;
    std::vector<std::uint32_t> normalOf_, uvOf_; // by position, or kNone
    unsigned ownMaterials_;
    std::vector<bool> carriesMore_;           // by material
    std::set<std::uint32_t> beyondBaseColor_; // materials in use
    bool anyNormal_ = false, anyUv_ = false;
    std::uint64_t skinned_ = 0, morphed_ = 0, colored_ = 0, pointsAndLines_ = 0;
};

void load(const ImportOptions& options, const rt::File& file, rt::Kind kind, rt::Geometry& out) {
    Assimp::Importer importer;
    auto* const files = new FolderOnly(file.path); // the importer's own from the next line on
    importer.SetIOHandler(files);
    // Indices and references are held against their arrays before anything follows them.
    const aiScene* const scene = importer.ReadFile(file.path, aiProcess_ValidateDataStructure);
    if (scene == nullptr || scene->mRootNode == nullptr || scene->mNumMeshes == 0) {
        const std::string name(fileName(file.path));
        if (!files->refusal().empty()) throw FileError(name + ": " + files->refusal());
        const std::string why = importer.GetErrorString();
        if (why.starts_with("No suitable reader"))
            throw FileError(name + ": Assimp knows no file that begins and ends like this one");
        throw FileError(name + ": " + (why.empty() ? "holds no mesh" : why));
    }
    put(importMesh(SceneReader(file.path, *scene).read(), options), kind, out);
}

} // namespace

RT_LOADER_PLUGIN("assimp", "1.0.0", "gltf|glb|fbx|dae|stl|3ds|off|x3d",
                 rt::loaders::kImportParameters, load,
                 "Reads glTF and other model files by the Open Asset Import Library.",
                 "- mesh: {file: model/lamp.gltf, loader: assimp}\n")
