#include <core/film/frame.hpp>

#include <core/geometry/bounds.hpp>
#include <core/numeric/transform.hpp>

#include <algorithm>
#include <map>

namespace rt::film {

using animation::Moving;
using animation::ObjectPose;
using animation::RestFace;
using animation::RestObject;
using geometry::Box3d;
using geometry::Kind;
using geometry::Segment;
using geometry::Vec3;
using numeric::AffineTransform;

namespace {

std::array<Vec3, 3> cornersOf(const geometry::Triangles& triangles, std::uint32_t index) {
    const auto& corners = triangles.indices[index];
    return {triangles.positions[corners[0]], triangles.positions[corners[1]],
            triangles.positions[corners[2]]};
}

std::uint32_t sourceFaceOf(const geometry::Triangles& triangles, const Segment& segment,
                           std::uint32_t index) {
    return triangles.sourceFaces.empty() ? index - segment.index : triangles.sourceFaces[index];
}

RestObject restOfOne(const geometry::Primitives& primitives, const Segment& segment) {
    switch (segment.kind) {
    case Kind::triangle: {
        const auto [a, b, c] = cornersOf(primitives.triangles, segment.index);
        return {(a + b + c) / 3.0, numeric::cross(b - a, c - a), {}};
    }
    case Kind::sphere:
        return {primitives.spheres[segment.index].center, Vec3(0), {}};
    case Kind::parallelogram: {
        const geometry::Parallelogram& p = primitives.parallelograms[segment.index];
        return {p.origin + p.edgeU / 2.0 + p.edgeV / 2.0, numeric::cross(p.edgeU, p.edgeV), {}};
    }
    case Kind::custom:
        break;
    }
    return {boundsOf(primitives, segment).centre(), Vec3(0), {}};
}

/// Centroid and area vector of each source face; a face of several triangles weighs them by area.
std::vector<RestFace> facesOf(const geometry::Triangles& triangles, const Segment& segment) {
    struct Sum {
        Vec3 weighted{0}, plain{0}, normal{0};
        double area = 0;
        int count = 0;
    };
    std::vector<Sum> sums;
    for (std::uint32_t i = segment.index; i < segment.index + segment.count; ++i) {
        const std::uint32_t face = sourceFaceOf(triangles, segment, i);
        if (face >= sums.size()) sums.resize(face + 1);
        const auto [a, b, c] = cornersOf(triangles, i);
        const Vec3 normal = numeric::cross(b - a, c - a), centroid = (a + b + c) / 3.0;
        const double area = numeric::length(normal);
        sums[face].weighted += centroid * area;
        sums[face].plain += centroid;
        sums[face].normal += normal;
        sums[face].area += area;
        ++sums[face].count;
    }
    std::vector<RestFace> faces(sums.size());
    for (std::size_t f = 0; f < sums.size(); ++f) {
        const Sum& sum = sums[f];
        if (sum.count == 0) continue; // a face of the file that repair dropped
        faces[f].normal = sum.normal;
        faces[f].centroid = sum.count == 1 || sum.area == 0 ? sum.plain / double(sum.count)
                                                            : sum.weighted / sum.area;
    }
    return faces;
}

/// Appends moved copies of values to them: one for each pose in which a value is used, if the uses of a pose come in a
/// row.
class Copies {
public:
    explicit Copies(std::vector<Vec3>& values) : values_(values) {}

    /// The index of the copy of values[index] in the pose, made by `apply`.
    template <class Apply>
    std::uint32_t of(std::uint32_t index, const AffineTransform* pose, const Apply& apply) {
        if (latest_.empty()) latest_.resize(values_.size());
        Copy& copy = latest_[index];
        if (copy.pose != pose) {
            copy = {pose, static_cast<std::uint32_t>(values_.size())};
            values_.push_back(apply(values_[index]));
        }
        return copy.index;
    }

private:
    struct Copy {
        const AffineTransform* pose = nullptr;
        std::uint32_t index = 0;
    };
    std::vector<Vec3>& values_;
    std::vector<Copy> latest_; // of each value
};

/// Moves primitives in place. A vertex that faces with different poses share is split.
class Mover {
public:
    explicit Mover(world::World& world)
        : primitives_(world.primitives), points_(primitives_.triangles.positions),
          normals_(primitives_.triangles.normals) {}

    void move(const Segment& segment, const ObjectPose& pose) {
        if (segment.kind == Kind::triangle) return moveTriangles(segment, pose);
        const AffineTransform& worldFromRest =
            pose.faces.empty() ? pose.worldFromRest : pose.faces.front();
        if (worldFromRest.isIdentity()) return;
        for (std::uint32_t i = segment.index; i < segment.index + segment.count; ++i)
            movePrimitive(segment.kind, i, worldFromRest);
    }

private:
    void movePrimitive(Kind kind, std::uint32_t i, const AffineTransform& worldFromRest) {
        if (kind == Kind::sphere) {
            auto& sphere = primitives_.spheres[i];
            sphere.center = worldFromRest.point(sphere.center);
        } else if (kind == Kind::parallelogram) {
            auto& p = primitives_.parallelograms[i];
            p = {worldFromRest.point(p.origin), worldFromRest.direction(p.edgeU),
                 worldFromRest.direction(p.edgeV)};
        } else {
            auto& custom = primitives_.customs.primitives[i];
            custom.shape = movedShape(custom.shape, worldFromRest);
            const auto& shape = *primitives_.customs.shapes[custom.shape];
            Vec3 lower(0), upper(0);
            shape.shape.bounds(shape.shape.data, custom.primitive, &lower.x, &upper.x);
            custom.bounds = numeric::boundsOf(shape.worldFromObject, {lower, upper});
        }
    }

    /// The custom shapes of an object move together, so each is copied once. The copy shares the plugin's data.
    std::uint32_t movedShape(std::uint32_t shape, const AffineTransform& worldFromRest) {
        auto& shapes = primitives_.customs.shapes;
        const auto known = movedShapes_.find(shape);
        if (known != movedShapes_.end()) return known->second;
        const auto original = shapes[shape];
        auto moved = std::make_unique<geometry::CustomShape>(*original);
        moved->worldFromObject = worldFromRest * original->worldFromObject;
        moved->objectFromWorld = moved->worldFromObject.inverse();
        shapes[shape] = std::shared_ptr<const geometry::CustomShape>(
            moved.release(), [original](const auto* s) { delete s; });
        return movedShapes_[shape] = shape;
    }

    void moveTriangles(const Segment& segment, const ObjectPose& pose) {
        auto& triangles = primitives_.triangles;
        if (pose.faces.empty() && pose.worldFromRest.isIdentity()) return;
        for (std::uint32_t i = segment.index; i < segment.index + segment.count; ++i) {
            const std::uint32_t face = sourceFaceOf(triangles, segment, i);
            const AffineTransform* worldFromRest =
                face < pose.faces.size() ? &pose.faces[face] : &pose.worldFromRest;
            if (worldFromRest->isIdentity()) continue;
            for (std::uint32_t& corner : triangles.indices[i])
                corner = points_.of(corner, worldFromRest,
                                    [&](const Vec3& p) { return worldFromRest->point(p); });
            if (triangles.normalIndices.empty()) continue;
            for (std::uint32_t& corner : triangles.normalIndices[i])
                if (corner != geometry::kNoIndex)
                    corner = normals_.of(corner, worldFromRest, [&](const Vec3& n) {
                        return numeric::normalize(worldFromRest->normal(n));
                    });
        }
    }

    geometry::Primitives& primitives_;
    Copies points_, normals_;
    std::map<std::uint32_t, std::uint32_t> movedShapes_;
};

} // namespace

std::vector<RestObject> restObjects(const scene::Description& description,
                                    const world::World& rest) {
    const std::vector<Moving> moving = animation::whatMoves(description);
    std::vector<RestObject> objects(description.objects.size());
    std::vector<Box3d> bounds(objects.size());
    std::vector<std::uint64_t> counts(objects.size());
    for (const Segment& segment : rest.primitives.segments) {
        const auto object = static_cast<std::size_t>(segment.object);
        if (moving[object] == Moving::nothing) continue;
        counts[object] += segment.count;
        bounds[object].add(boundsOf(rest.primitives, segment));
        if (counts[object] == 1) objects[object] = restOfOne(rest.primitives, segment);
        if (moving[object] == Moving::faces && segment.kind == Kind::triangle)
            objects[object].faces = facesOf(rest.primitives.triangles, segment);
    }
    for (std::size_t i = 0; i < objects.size(); ++i)
        if (counts[i] > 1) objects[i].center = bounds[i].centre(), objects[i].normal = Vec3(0);
    return objects;
}

std::optional<Frame> frameAt(const scene::Description& description, const world::World& rest,
                             std::uint32_t frame, const Lower& lower,
                             scene::Diagnostics& diagnostics) {
    auto still = animation::descriptionAt(description, frame, diagnostics);
    if (!still) return std::nullopt;
    std::optional<world::World> world =
        animation::keyframesReachTheWorld(description) ? lower(*still, diagnostics) : rest;
    if (!world) return std::nullopt;
    const auto poses =
        animation::posesAt(description, restObjects(description, *world), frame, diagnostics);
    if (!poses) return std::nullopt;
    Frame result{std::move(*still), std::move(*world), std::vector<bool>(poses->size())};
    Mover mover(result.world);
    for (const Segment& segment : result.world.primitives.segments)
        mover.move(segment, (*poses)[static_cast<std::size_t>(segment.object)]);
    for (std::size_t i = 0; i < poses->size(); ++i) {
        const ObjectPose& pose = (*poses)[i];
        const bool stays = pose.worldFromRest.isIdentity();
        result.moved[i] = !stays || !pose.faces.empty();
        if (!stays)
            result.world.objectFromWorld[i] =
                result.world.objectFromWorld[i] * pose.worldFromRest.inverse();
    }
    return result;
}

std::vector<geometry::PrimitiveId> movedBetween(const Frame& before, const Frame& after) {
    std::vector<geometry::PrimitiveId> moved;
    for (const Segment& segment : after.world.primitives.segments) {
        const auto object = static_cast<std::size_t>(segment.object);
        if (!after.moved[object] && !before.moved[object]) continue;
        for (std::uint32_t i = 0; i < segment.count; ++i)
            moved.push_back(
                static_cast<geometry::PrimitiveId>(static_cast<std::uint32_t>(segment.first) + i));
    }
    return moved;
}

} // namespace rt::film
