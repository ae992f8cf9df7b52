// Where a plugin's geometry arrives: checked, taken to world space and appended to the world.
#pragma once
#include <core/plugin_host/call.hpp>
#include <core/world/world.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace rt::plugin_host {

/// Coordinates beyond this are refused: their products would leave the range of f64, and they that of f32 boxes.
inline constexpr double kLargestCoordinate = 0x1p100;

/// Everything one object emits. Calls from plugins arrive through `table`.
class Sink {
public:
    struct Target {
        world::World* world;
        geometry::ObjectId object;
        geometry::MaterialId material; // of what names no other
        bool fileMaterials;            // the object leaves its materials to the file
        numeric::AffineTransform worldFromObject;
        std::uint64_t maxPrimitives = 0; // of the whole world
        // A texture for a material's color_file, or nothing after having refused.
        std::function<const material::Texture*(Call&, const char* path)> imageTexture;
    };

    Sink(Target target, Call& call);

    rt_sink* table() { return &table_.functions; }
    /// Complaints go to `call` from now on; returns the call before.
    Call* answerTo(Call* call) { return std::exchange(call_, call); }

    // The functions of rt_sink, with exceptions. Each refuses through the call and returns RT_FAILED.
    rt_status addMesh(const rt_mesh& mesh);
    rt_status addSpheres(const rt_sphere* spheres, std::uint32_t count);
    rt_status addParallelograms(const rt_parallelogram* parallelograms, std::uint32_t count);
    rt_status addCustom(const rt_custom& custom);
    rt_status addMaterial(const rt_material& material, std::uint32_t* handle);

private:
    struct Table {
        rt_sink functions; // first, so that a plugin's pointer to it is a pointer to the table
        Sink* sink;
    };
    static Sink& of(rt_sink* functions) { return *reinterpret_cast<Table*>(functions)->sink; }

    rt_status refuse(scene::Code code, const std::string& message);
    /// Finite and within kLargestCoordinate; otherwise refuses as "vertex 3 is not finite".
    bool isUsable(const geometry::Vec3& worldPoint, const char* what, std::uint64_t index);
    bool hasRoomFor(std::uint64_t count);
    /// Says that `count` primitives of `kind` have been appended from `index` on.
    void close(geometry::Kind kind, bool solid, std::size_t index, std::uint32_t count);
    rt_status addCustomIn(const rt_custom& custom);

    Table table_{};
    Target target_;
    Call* call_;
    bool mirrors_;
    std::vector<geometry::MaterialId> handles_; // by handle of add_material
};

} // namespace rt::plugin_host
