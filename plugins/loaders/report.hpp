// What a repair did, as JSON.
#pragma once
#include "repair.hpp"

#include <functional>
#include <string_view>

namespace rt::loaders {

/// {"file": ..., "summary": {counts}, "closed": ..., "bounds": {"min", "max"}, "notes": [sentences]}, and with `everyFace` also
/// "faces": [{"action": "kept" | "flipped" | "dropped", "reason": ...}], one per face of the file, in its order.
void writeReport(const MeshFile& file, const RepairedMesh& repaired, bool everyFace,
                 const std::function<void(std::string_view)>& write);

} // namespace rt::loaders
