#include <core/cli/mesh_summary.hpp>

#include <nlohmann/json.hpp>

namespace rt::cli {

namespace {

using Json = nlohmann::ordered_json;

struct Row {
    const char* key; // of the report's summary
    const char* one;
    const char* many;
};

/// "12 duplicates, 1 without area" of what is there at all.
std::string listed(const Json& summary, std::initializer_list<Row> rows) {
    std::string text;
    for (const Row& row : rows) {
        const std::uint64_t count = summary.value(row.key, std::uint64_t{0});
        if (count == 0) continue;
        text += (text.empty() ? "" : ", ") + std::to_string(count) + " " +
                (count == 1 ? row.one : row.many);
    }
    return text;
}

} // namespace

std::string meshSummary(const std::string& report) {
    const Json json = Json::parse(report);
    const Json& summary = json.at("summary");
    std::string text;
    const auto line = [&](std::string name, const std::string& value) {
        if (value.empty()) return;
        name.resize(13, ' ');
        text += name + value + "\n";
    };
    line("mesh", json.at("file").get<std::string>());
    line("faces", std::to_string(summary.at("faces").get<std::uint64_t>()) + ": " +
                      listed(summary, {{"kept", "kept", "kept"},
                                       {"flipped", "flipped", "flipped"},
                                       {"dropped", "dropped", "dropped"}}));
    line("dropped",
         listed(summary,
                {{"dropped_duplicate", "duplicate", "duplicates"},
                 {"dropped_reversed_duplicate", "reversed duplicate", "reversed duplicates"},
                 {"dropped_repeated_corner", "with a repeated corner", "with repeated corners"},
                 {"dropped_no_area", "without area", "without area"},
                 {"dropped_few_corners", "with fewer than three corners",
                  "with fewer than three corners"}}));
    line("flipped", listed(summary, {{"flipped_against_neighbours", "against its neighbours",
                                      "against their neighbours"},
                                     {"flipped_inside_out", "of a body turned inside out",
                                      "of bodies turned inside out"}}));
    line("vertices",
         listed(summary, {{"vertices", "vertex", "vertices"},
                          {"welded_vertices", "joined to another", "joined to others"},
                          {"texture_coordinates", "texture coordinate", "texture coordinates"},
                          {"normals", "normal", "normals"}}));
    line("components", listed(summary, {{"components", "component", "components"},
                                        {"components_turned", "turned outward", "turned outward"},
                                        {"components_nested", "inside another", "inside others"},
                                        {"components_without_outside", "without an outside",
                                         "without an outside"},
                                        {"components_one_sided", "one-sided", "one-sided"}}));
    const std::string edges = listed(
        summary,
        {{"open_edges", "boundary edge", "boundary edges"},
         {"non_manifold_edges", "edge of three faces or more", "edges of three faces or more"},
         {"seam_edges", "where the winding changes", "where the winding changes"}});
    line("edges", (json.at("closed").get<bool>() ? "closed" : "not closed") +
                      (edges.empty() ? edges : ": " + edges));
    line("materials", listed(summary, {{"materials", "material", "materials"}}));
    if (const Json& bounds = json.at("bounds"); !bounds.is_null())
        line("bounds", bounds.at("min").dump() + " to " + bounds.at("max").dump());
    return text;
}

void noteRepairs(const std::string& file, const std::string& report,
                 scene::Diagnostics& diagnostics) {
    const auto source = std::make_shared<scene::Source>(scene::Source{file, {}});
    const Json json = Json::parse(report);
    for (const Json& note : json.at("notes"))
        diagnostics.note({source, 0, 0}, note.get<std::string>());
}

} // namespace rt::cli
