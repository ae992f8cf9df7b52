#include <core/plugin_host/sink.hpp>

#include <core/plugin_host/fault_report.hpp>
#include <core/plugin_host/object_sphere.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace rt::plugin_host {
namespace {

using geometry::Kind;
using geometry::kNoIndex;
using geometry::MaterialId;
using geometry::Vec2;
using geometry::Vec3;
using Corners = std::array<std::uint32_t, 3>;

constexpr Corners kFlat{kNoIndex, kNoIndex, kNoIndex};

Vec3 vec(const double v[3]) { return {v[0], v[1], v[2]}; }

/// Nothing a plugin gives may end the program: what is thrown while it is copied becomes a status.
template <class Add> rt_status guarded(Add&& add) noexcept {
    try {
        return add();
    } catch (...) {
        return RT_OUT_OF_MEMORY;
    }
}

/// Pads an optional per-triangle array so that it has an entry for each of the first `count` triangles.
template <class T> void padTo(std::vector<T>& entries, std::size_t count, const T& fill) {
    if (entries.size() < count) entries.resize(count, fill);
}

/// Gives every triangle so far the material of its segment.
void padMaterials(geometry::Primitives& primitives) {
    std::vector<MaterialId>& materials = primitives.triangles.materials;
    for (const geometry::Segment& segment : primitives.segments)
        if (segment.kind == Kind::triangle)
            padTo(materials, std::size_t{segment.index} + segment.count, segment.material);
}

std::string number(std::uint64_t i) { return std::to_string(i); }

} // namespace

Sink::Sink(Target target, Call& call)
    : target_(std::move(target)), call_(&call),
      mirrors_(target_.worldFromObject.determinant() < 0) {
    table_.sink = this;
    table_.functions.struct_size = sizeof(rt_sink);
    table_.functions.add_mesh = [](rt_sink* sink, const rt_mesh* mesh) {
        return guarded([&] { return of(sink).addMesh(*mesh); });
    };
    table_.functions.add_spheres = [](rt_sink* sink, const rt_sphere* spheres,
                                      std::uint32_t count) {
        return guarded([&] { return of(sink).addSpheres(spheres, count); });
    };
    table_.functions.add_parallelograms = [](rt_sink* sink, const rt_parallelogram* parallelograms,
                                             std::uint32_t count) {
        return guarded([&] { return of(sink).addParallelograms(parallelograms, count); });
    };
    table_.functions.add_custom = [](rt_sink* sink, const rt_custom* custom) {
        return guarded([&] { return of(sink).addCustom(*custom); });
    };
    table_.functions.add_material = [](rt_sink* sink, const rt_material* material,
                                       std::uint32_t* handle) {
        return guarded([&] { return of(sink).addMaterial(*material, handle); });
    };
}

rt_status Sink::refuse(scene::Code code, const std::string& message) {
    if (!call_->failed) call_->refuse(code, message); // the first reason is the one that helps
    return RT_FAILED;
}

bool Sink::isUsable(const Vec3& worldPoint, const char* what, std::uint64_t index) {
    const double largest = numeric::maxComponent(numeric::abs(worldPoint));
    if (largest <= kLargestCoordinate && numeric::isFinite(worldPoint)) return true;
    if (numeric::isFinite(worldPoint))
        refuse(kTooFarOut,
               std::string(what) + " " + number(index) + " lies farther out than 2^100");
    else
        refuse(kBadGeometry, std::string(what) + " " + number(index) + " is not finite");
    return false;
}

bool Sink::hasRoomFor(std::uint64_t count) {
    const std::uint64_t most =
        std::min<std::uint64_t>(target_.maxPrimitives, kNoIndex - 1); // the last id means none
    if (target_.world->primitives.count() + count <= most) return true;
    refuse(kTooManyPrimitives, "the scene has more than " + number(most) + " primitives");
    return false;
}

void Sink::close(Kind kind, bool solid, std::size_t index, std::uint32_t count) {
    if (count == 0) return;
    auto& primitives = target_.world->primitives;
    primitives.segments.push_back({geometry::PrimitiveId{primitives.count()}, count, kind, solid,
                                   static_cast<std::uint32_t>(index), target_.object,
                                   target_.material});
}

rt_status Sink::addMesh(const rt_mesh& mesh) {
    if (!RT_HAS(&mesh, rt_mesh, source_faces))
        return refuse(kBadGeometry, "rt_mesh has no struct_size");
    if (mesh.kind != RT_SURFACE && mesh.kind != RT_SOLID)
        return refuse(kBadGeometry, "the kind of the mesh is neither surface nor solid");
    if (mesh.triangle_count == 0) return RT_OK;
    if (mesh.positions == nullptr || mesh.indices == nullptr)
        return refuse(kBadGeometry, "the mesh has triangles without positions or indices");
    if (!hasRoomFor(mesh.triangle_count)) return RT_FAILED;

    auto& to = target_.world->primitives.triangles;
    const std::uint64_t total = std::uint64_t{to.positions.size()} + mesh.vertex_count;
    if (total > kNoIndex || std::uint64_t{to.normals.size()} + mesh.normal_count > kNoIndex ||
        std::uint64_t{to.uvs.size()} + mesh.uv_count > kNoIndex)
        return refuse(kTooManyPrimitives, "the scene has more than 2^32 - 1 vertices");

    // Every index is held against its array before anything is copied.
    const bool hasNormals = mesh.normals != nullptr && mesh.normal_count != 0;
    const bool hasUvs = mesh.uvs != nullptr && mesh.uv_count != 0;
    const std::uint32_t* normalIndices =
        mesh.normal_indices != nullptr ? mesh.normal_indices : mesh.indices;
    const std::uint32_t* uvIndices = mesh.uv_indices != nullptr ? mesh.uv_indices : mesh.indices;
    const auto beyond = [&](const char* what, std::uint64_t i, std::uint32_t index,
                            std::uint32_t count) {
        return refuse(kBadGeometry, "triangle " + number(i / 3) + " names " + what + " " +
                                        number(index) + " of " + number(count));
    };
    for (std::uint64_t i = 0; i < std::uint64_t{mesh.triangle_count} * 3; ++i) {
        if (mesh.indices[i] >= mesh.vertex_count)
            return beyond("vertex", i, mesh.indices[i], mesh.vertex_count);
        if (hasNormals && normalIndices[i] >= mesh.normal_count && normalIndices[i] != kNoIndex)
            return beyond("normal", i, normalIndices[i], mesh.normal_count);
        if (hasUvs && uvIndices[i] >= mesh.uv_count && uvIndices[i] != kNoIndex)
            return beyond("uv", i, uvIndices[i], mesh.uv_count);
    }
    if (mesh.materials != nullptr)
        for (std::uint32_t i = 0; i < mesh.triangle_count; ++i)
            if (mesh.materials[i] >= handles_.size() && mesh.materials[i] != kNoIndex)
                return refuse(kBadGeometry, "triangle " + number(i) + " names material " +
                                                number(mesh.materials[i]) + " of " +
                                                number(handles_.size()));

    const auto firstVertex = static_cast<std::uint32_t>(to.positions.size());
    const auto firstNormal = static_cast<std::uint32_t>(to.normals.size());
    const auto firstUv = static_cast<std::uint32_t>(to.uvs.size());
    const std::size_t firstTriangle = to.indices.size();
    const auto& frame = target_.worldFromObject;
    const bool asItIs = frame.isIdentity();

    to.positions.reserve(to.positions.size() + mesh.vertex_count);
    for (std::uint32_t i = 0; i < mesh.vertex_count; ++i) {
        const Vec3 object = vec(mesh.positions + 3 * std::size_t{i});
        to.positions.push_back(asItIs ? object : frame.point(object));
        if (!isUsable(to.positions.back(), "vertex", i)) return RT_FAILED;
    }
    if (hasNormals)
        for (std::uint32_t i = 0; i < mesh.normal_count; ++i) {
            const Vec3 normal = normalize(frame.normal(vec(mesh.normals + 3 * std::size_t{i})));
            if (!numeric::isFinite(normal))
                return refuse(kBadGeometry, "normal " + number(i) + " has no direction");
            to.normals.push_back(normal);
        }
    if (hasUvs)
        for (std::uint32_t i = 0; i < mesh.uv_count; ++i) {
            const Vec2 uv(mesh.uvs[2 * std::size_t{i}], mesh.uvs[2 * std::size_t{i} + 1]);
            if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
                return refuse(kBadGeometry, "uv " + number(i) + " is not finite");
            to.uvs.push_back(uv);
        }

    // A mirror turns the winding round; a second exchange of corners turns it back.
    const auto corners = [&](const std::uint32_t* list, std::uint32_t i, std::uint32_t first) {
        Corners c;
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t index = list[3 * std::size_t{i} + k];
            c[k] = index == kNoIndex ? kNoIndex : first + index;
        }
        if (mirrors_) std::swap(c[1], c[2]);
        return c;
    };
    const bool perTriangleMaterials = mesh.materials != nullptr && target_.fileMaterials;
    if (perTriangleMaterials) padMaterials(target_.world->primitives);
    to.indices.reserve(firstTriangle + mesh.triangle_count);
    std::uint32_t dropped = 0;
    for (std::uint32_t i = 0; i < mesh.triangle_count; ++i) {
        const Corners triangle = corners(mesh.indices, i, firstVertex);
        const Vec3 &a = to.positions[triangle[0]], &b = to.positions[triangle[1]],
                   &c = to.positions[triangle[2]];
        if (cross(b - a, c - a) == Vec3(0.0)) {
            ++dropped;
            continue;
        }
        const std::size_t at = to.indices.size();
        to.indices.push_back(triangle);
        if (hasNormals)
            padTo(to.normalIndices, at, kFlat),
                to.normalIndices.push_back(corners(normalIndices, i, firstNormal));
        if (hasUvs)
            padTo(to.uvIndices, at, kFlat), to.uvIndices.push_back(corners(uvIndices, i, firstUv));
        if (perTriangleMaterials) {
            const std::uint32_t handle = mesh.materials[i];
            to.materials.push_back(handle == kNoIndex ? target_.material : handles_[handle]);
        }
        to.sourceFaces.push_back(mesh.source_faces != nullptr ? mesh.source_faces[i] : i);
    }
    const std::size_t count = to.indices.size();
    if (!to.materials.empty()) padTo(to.materials, count, target_.material);
    if (!to.normalIndices.empty()) padTo(to.normalIndices, count, kFlat);
    if (!to.uvIndices.empty()) padTo(to.uvIndices, count, kFlat);
    close(Kind::triangle, mesh.kind == RT_SOLID, firstTriangle,
          static_cast<std::uint32_t>(count - firstTriangle));
    if (dropped != 0)
        call_->diagnostics->warning(call_->location,
                                    call_->subject + ": " + number(dropped) + " of " +
                                        number(mesh.triangle_count) +
                                        " triangles have no area and are left out");
    return RT_OK;
}

rt_status Sink::addSpheres(const rt_sphere* spheres, std::uint32_t count) {
    if (count == 0) return RT_OK;
    if (spheres == nullptr) return refuse(kBadGeometry, "spheres are missing");
    for (std::uint32_t i = 0; i < count; ++i)
        if (!(spheres[i].radius > 0)) // a NaN too
            return refuse(kBadGeometry,
                          "sphere " + number(i) + " has a radius that is not positive");
    const std::optional<double> scale = target_.worldFromObject.similarityScale();
    if (!scale) {
        const rt_custom custom = objectSpheres({spheres, count});
        const rt_status status = addCustomIn(custom);
        if (status != RT_OK) custom.release(custom.data);
        return status;
    }
    if (!hasRoomFor(count)) return RT_FAILED;
    auto& to = target_.world->primitives.spheres;
    const std::size_t first = to.size();
    for (std::uint32_t i = 0; i < count; ++i) {
        const geometry::Sphere sphere{target_.worldFromObject.point(vec(spheres[i].center)),
                                      spheres[i].radius * *scale};
        if (!isUsable(sphere.center, "the center of sphere", i) ||
            !isUsable(Vec3(sphere.radius), "the radius of sphere", i))
            return RT_FAILED;
        if (!(sphere.radius * sphere.radius > 0))
            return refuse(kTooFarOut,
                          "sphere " + number(i) + " is too small for its surface to be computed");
        to.push_back(sphere);
    }
    close(Kind::sphere, true, first, count);
    return RT_OK;
}

rt_status Sink::addParallelograms(const rt_parallelogram* parallelograms, std::uint32_t count) {
    if (count == 0) return RT_OK;
    if (parallelograms == nullptr) return refuse(kBadGeometry, "parallelograms are missing");
    if (!hasRoomFor(count)) return RT_FAILED;
    auto& to = target_.world->primitives.parallelograms;
    const auto& frame = target_.worldFromObject;
    const std::size_t first = to.size();
    for (std::uint32_t i = 0; i < count; ++i) {
        const rt_parallelogram& from = parallelograms[i];
        // A mirror leaves the edges, and so the uv, as they are: both sides of a sheet are alike.
        const geometry::Parallelogram p{frame.point(vec(from.origin)),
                                        frame.direction(vec(from.edge_u)),
                                        frame.direction(vec(from.edge_v))};
        if (!isUsable(p.origin, "the origin of parallelogram", i) ||
            !isUsable(p.origin + p.edgeU + p.edgeV, "a corner of parallelogram", i) ||
            !isUsable(p.edgeU, "an edge of parallelogram", i))
            return RT_FAILED;
        if (cross(p.edgeU, p.edgeV) == Vec3(0.0))
            return refuse(kBadGeometry,
                          "the edges of parallelogram " + number(i) + " are parallel");
        to.push_back(p);
    }
    close(Kind::parallelogram, false, first, count);
    return RT_OK;
}

rt_status Sink::addCustom(const rt_custom& custom) {
    if (!RT_HAS(&custom, rt_custom, release))
        return refuse(kBadGeometry, "rt_custom has no struct_size");
    if (custom.kind != RT_SURFACE && custom.kind != RT_SOLID)
        return refuse(kBadGeometry, "the kind of the custom shape is neither surface nor solid");
    if (custom.bounds == nullptr || custom.intersect == nullptr || custom.release == nullptr)
        return refuse(kBadGeometry, "rt_custom lacks a function");
    nameCall(custom.bounds, "bounds");
    nameCall(custom.intersect, "intersect");
    nameCall(custom.crossings, "crossings");
    nameCall(custom.release, "release");
    return addCustomIn(custom);
}

rt_status Sink::addCustomIn(const rt_custom& custom) {
    if (custom.primitive_count == 0)
        return refuse(kBadGeometry, "the custom shape has no primitives");
    if (!hasRoomFor(custom.primitive_count)) return RT_FAILED;
    std::vector<geometry::Box3d> boxes(custom.primitive_count);
    for (std::uint32_t i = 0; i < custom.primitive_count; ++i) {
        Vec3 lower(std::nan("")), upper(std::nan(""));
        custom.bounds(custom.data, i, &lower.x, &upper.x);
        if (!(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z))
            return refuse(kBadGeometry,
                          "the bounds of primitive " + number(i) + " are empty or not a number");
        boxes[i] = numeric::boundsOf(target_.worldFromObject, {lower, upper});
        if (!isUsable(boxes[i].min, "the box of primitive", i) ||
            !isUsable(boxes[i].max, "the box of primitive", i))
            return RT_FAILED;
    }
    auto& to = target_.world->primitives.customs;
    const auto shape = static_cast<std::uint32_t>(to.shapes.size());
    const std::size_t first = to.primitives.size();
    // The data changes hands in the last line, after all that may throw: on failure it stays the caller's.
    const std::shared_ptr<geometry::CustomShape> made(new geometry::CustomShape{},
                                                      [](geometry::CustomShape* s) {
                                                          if (s->shape.release != nullptr)
                                                              s->shape.release(s->shape.data);
                                                          delete s;
                                                      });
    made->worldFromObject = target_.worldFromObject;
    made->objectFromWorld = target_.worldFromObject.inverse();
    to.shapes.push_back(made);
    for (std::uint32_t i = 0; i < custom.primitive_count; ++i)
        to.primitives.push_back({shape, i, boxes[i]});
    close(Kind::custom, custom.kind == RT_SOLID, first, custom.primitive_count);
    std::memcpy(&made->shape, &custom, std::min<std::size_t>(custom.struct_size, sizeof custom));
    return RT_OK;
}

rt_status Sink::addMaterial(const rt_material& material, std::uint32_t* handle) {
    if (!RT_HAS(&material, rt_material, color_file))
        return refuse(kBadGeometry, "rt_material has no struct_size");
    *handle = static_cast<std::uint32_t>(handles_.size());
    if (!target_.fileMaterials) { // the object names its own: the file's are not even looked at
        handles_.push_back(target_.material);
        return RT_OK;
    }
    const std::string name = material.name != nullptr ? material.name : "";
    const auto color = [](const double v[3]) { return numeric::LinearRgb{v[0], v[1], v[2]}; };
    material::Material made;
    made.color = color(material.color);
    made.diffuse = color(material.diffuse);
    made.specular = color(material.specular);
    made.transmission = color(material.transmission);
    made.environment = color(material.environment);
    made.shininess = material.shininess;
    made.ior = material.ior;
    for (const double* c : {material.color, material.diffuse, material.specular,
                            material.transmission, material.environment})
        for (int i = 0; i < 3; ++i)
            if (!(c[i] >= 0 && std::isfinite(c[i])))
                return refuse(kBadGeometry, "material '" + name +
                                                "' has a colour that is negative or not finite");
    if (!(material.shininess >= 0 && std::isfinite(material.shininess) && material.ior > 0 &&
          std::isfinite(material.ior)))
        return refuse(kBadGeometry,
                      "material '" + name + "' has a shininess or ior that is out of range");
    if (material.color_file != nullptr && *material.color_file != '\0') {
        made.colorTexture = target_.imageTexture(*call_, material.color_file);
        if (made.colorTexture == nullptr && call_->failed) return RT_FAILED;
    }
    handles_.push_back(MaterialId{static_cast<std::uint32_t>(target_.world->materials.size())});
    target_.world->materials.push_back(made);
    target_.world->materialNames.push_back(name);
    return RT_OK;
}

} // namespace rt::plugin_host
