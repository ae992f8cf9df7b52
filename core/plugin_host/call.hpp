// One call into a plugin: what the host tells it, what it may ask, and where its complaints go.
#pragma once
#include <core/scene/description.hpp>
#include <core/scene/limits.hpp>
#include <rt/plugin.h>

#include <span>
#include <string>
#include <string_view>

namespace rt::plugin_host {

// The numbers of the diagnostics of lowering; core/scene/explanations.cpp explains each.
inline constexpr scene::Code kValueRefused{348}; // a plugin cannot use a value of the scene
inline constexpr scene::Code kTextureCycle{349}; // textures that need each other
inline constexpr scene::Code kNoSuchFile{401};
inline constexpr scene::Code kNotConfined{409};
inline constexpr const char* kNeedsLandlock =
    "--sandbox needs a kernel with Landlock (Linux 5.13), and this one has none";
inline constexpr scene::Code kMeshFile{420};     // a loader cannot use the file
inline constexpr scene::Code kImageFile{450};    // a texture cannot use the file
inline constexpr scene::Code kPluginType{501};   // a type that lowering itself needs cannot be had
inline constexpr scene::Code kPluginFailed{530}; // failed, and no value of the scene is to blame
inline constexpr scene::Code kPluginThrew{531};  // an exception crossed the boundary
inline constexpr scene::Code kBadGeometry{
    532}; // emitted geometry that breaks the rules of plugin.h
inline constexpr scene::Code kPluginCrashed{533}; // said by fault_report, as text
inline constexpr scene::Code kTooManyPrimitives{701};
inline constexpr scene::Code kTooFarOut{702}; // a coordinate beyond kLargestCoordinate
inline constexpr scene::Code kNoMemory{703};
inline constexpr scene::Code kFileTooLarge{710};
inline constexpr scene::Code kPluginLimit{714}; // a plugin holds a file against a limit

class ObjectLowering;

struct Call {
    rt_host host; // first, so that a plugin's pointer to it is a pointer to the call
    ObjectLowering*
        lowering; // of the object whose loader may be asked; none: a texture's or loader's own call
    scene::Diagnostics* diagnostics;
    std::string subject; // "shape 'torus'"
    std::span<const rt_param> rows;
    const std::vector<scene::Value>* values;
    scene::Location location; // for complaints about no value in particular
    scene::Code fileCode;     // for complaints about a file
    scene::Code otherCode;    // for complaints about no value
    bool failed = false;

    void refuse(scene::Code code, std::string_view message) {
        diagnostics->error(code, location, subject + ": " + std::string(message));
        failed = true;
    }
};

/// Each call is made as a non-const Call.
inline Call& callOf(const rt_host* host) {
    return *reinterpret_cast<Call*>(const_cast<rt_host*>(host));
}

/// A call about `instance`, a "shape", "texture" or "loader". `rows` and `diagnostics` outlive it.
Call callFor(const char* kind, const scene::Instance& instance, std::span<const rt_param> rows,
             scene::Code fileCode, scene::Code otherCode, const scene::Limits& limits,
             scene::Diagnostics& diagnostics);

} // namespace rt::plugin_host
