#include "embree_scene.hpp"

#include <embree3/rtcore.h>

#include <chrono>
#include <cstring>
#include <stdexcept>

namespace rt::bench {

struct EmbreeScene::Impl {
    RTCDevice device;
    RTCScene scene;
    double seconds = 0;
    std::size_t bytes = 0;
    mutable RTCIntersectContext context, coherent;

    Impl(bool robust, int threads) {
        device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
        if (!device) throw std::runtime_error("Embree finds no device");
        rtcSetDeviceMemoryMonitorFunction(
            device,
            [](void* total, ssize_t change, bool) {
                *static_cast<ssize_t*>(total) += change;
                return true;
            },
            &monitored);
        scene = rtcNewScene(device);
        rtcSetSceneFlags(scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
        rtcInitIntersectContext(&context);
        coherent = context;
        coherent.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
    ~Impl() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    void commit(RTCGeometry geometry) {
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
        const ssize_t before = monitored;
        const auto start = std::chrono::steady_clock::now();
        rtcCommitScene(scene);
        seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        bytes = static_cast<std::size_t>(monitored - before);
    }

    ssize_t monitored = 0;
};

EmbreeRay embreeRay(const geometry::Ray& r) {
    return {{static_cast<float>(r.origin.x), static_cast<float>(r.origin.y),
             static_cast<float>(r.origin.z)},
            static_cast<float>(r.tMax),
            {static_cast<float>(r.direction.x), static_cast<float>(r.direction.y),
             static_cast<float>(r.direction.z)},
            0};
}

EmbreeScene::EmbreeScene(const Mesh& mesh, bool robust, int threads)
    : impl_(std::make_unique<Impl>(robust, threads)) {
    RTCGeometry g = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    for (const Vec3& p : mesh.positions)
        for (int i = 0; i < 3; ++i) *vertices++ = static_cast<float>(p[i]);
    void* const indices = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                                  mesh.indices.size());
    std::memcpy(indices, mesh.indices.data(), 12 * mesh.indices.size());
    impl_->commit(g);
}

EmbreeScene::EmbreeScene(const std::vector<Ball>& balls, bool robust)
    : impl_(std::make_unique<Impl>(robust, 1)) {
    RTCGeometry g = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, balls.size()));
    for (const Ball& b : balls) {
        for (int i = 0; i < 3; ++i) *vertices++ = static_cast<float>(b.center[i]);
        *vertices++ = static_cast<float>(b.radius);
    }
    impl_->commit(g);
}

EmbreeScene::~EmbreeScene() = default;

double EmbreeScene::buildSeconds() const { return impl_->seconds; }
std::size_t EmbreeScene::bytes() const { return impl_->bytes; }

void EmbreeScene::closest(const EmbreeRay* rays, std::size_t count, EmbreeHit* hits) const {
    for (std::size_t i = 0; i < count; ++i) {
        const EmbreeRay& r = rays[i];
        alignas(16) RTCRayHit q;
        q.ray.org_x = r.origin[0];
        q.ray.org_y = r.origin[1];
        q.ray.org_z = r.origin[2];
        q.ray.tnear = 0;
        q.ray.dir_x = r.direction[0];
        q.ray.dir_y = r.direction[1];
        q.ray.dir_z = r.direction[2];
        q.ray.time = 0;
        q.ray.tfar = r.tMax;
        q.ray.mask = 0xFFFFFFFFu;
        q.ray.id = 0;
        q.ray.flags = 0;
        q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(impl_->scene, &impl_->context, &q);
        hits[i] = {q.ray.tfar, q.hit.u, q.hit.v,
                   q.hit.geomID == RTC_INVALID_GEOMETRY_ID ? 0xFFFFFFFFu : q.hit.primID};
    }
}

void EmbreeScene::occluded(const EmbreeRay* rays, std::size_t count, char* answers) const {
    for (std::size_t i = 0; i < count; ++i) {
        const EmbreeRay& r = rays[i];
        alignas(16) RTCRay q;
        q.org_x = r.origin[0];
        q.org_y = r.origin[1];
        q.org_z = r.origin[2];
        q.tnear = 0;
        q.dir_x = r.direction[0];
        q.dir_y = r.direction[1];
        q.dir_z = r.direction[2];
        q.time = 0;
        q.tfar = r.tMax;
        q.mask = 0xFFFFFFFFu;
        q.id = 0;
        q.flags = 0;
        rtcOccluded1(impl_->scene, &impl_->context, &q);
        answers[i] = q.tfar < 0;
    }
}

namespace {

alignas(64) const
    int kAllValid[16] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};

template <class Packet> void fill(Packet& p, const EmbreeRay* rays) {
    for (int i = 0; i < 16; ++i) {
        const EmbreeRay& r = rays[i];
        p.org_x[i] = r.origin[0];
        p.org_y[i] = r.origin[1];
        p.org_z[i] = r.origin[2];
        p.dir_x[i] = r.direction[0];
        p.dir_y[i] = r.direction[1];
        p.dir_z[i] = r.direction[2];
        p.tnear[i] = 0;
        p.tfar[i] = r.tMax;
        p.time[i] = 0;
        p.mask[i] = 0xFFFFFFFFu;
        p.id[i] = 0;
        p.flags[i] = 0;
    }
}

} // namespace

void EmbreeScene::closest16(const EmbreeRay* rays, std::size_t count, EmbreeHit* hits) const {
    alignas(64) RTCRayHit16 q;
    for (std::size_t i = 0; i < count; i += 16) {
        fill(q.ray, rays + i);
        for (int k = 0; k < 16; ++k) q.hit.geomID[k] = q.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect16(kAllValid, impl_->scene, &impl_->coherent, &q);
        for (int k = 0; k < 16; ++k)
            hits[i + static_cast<std::size_t>(k)] = {
                q.ray.tfar[k], q.hit.u[k], q.hit.v[k],
                q.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID ? 0xFFFFFFFFu : q.hit.primID[k]};
    }
}

void EmbreeScene::occluded16(const EmbreeRay* rays, std::size_t count, char* answers) const {
    alignas(64) RTCRay16 q;
    for (std::size_t i = 0; i < count; i += 16) {
        fill(q, rays + i);
        rtcOccluded16(kAllValid, impl_->scene, &impl_->coherent, &q);
        for (int k = 0; k < 16; ++k) answers[i + static_cast<std::size_t>(k)] = q.tfar[k] < 0;
    }
}

} // namespace rt::bench
