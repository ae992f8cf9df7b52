// The stability suite in full, family by family; a campaign that was interrupted goes on where it was. Families of
// random trials can be run in parts, each with the next seed, so that hours of them are not lost.
//
//   stability --folder DIR [--commit C] [--share S] [--parts N] [--only FAMILY] [--results FILE.md]
//   stability --mesh FILE [--rays N] [--seed S] [--json]
//
// Exit code: 0 every target met, 1 one missed, 2 usage.
#include <core/octree/octree.hpp>
#include <tests/stability/any_mesh.hpp>
#include <tests/stability/cases.hpp>

#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace rt::stability {

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
    std::map<std::string, std::string> values;
    bool json = false;

    const std::string& of(const std::string& name, const std::string& otherwise) {
        return values.try_emplace(name, otherwise).first->second;
    }
};

std::string cpuModel() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "unknown CPU";
}

/// What a family's rows were measured with, and the rows.
Json measured(const Case& family, const Load& load, const std::string& commit) {
    Table table;
    family.run(load, table);
    return {{"family", family.id},
            {"commit", commit},
            {"share", load.share},
            {"seed", load.seed},
            {"cpu", cpuModel()},
            {"simd", octree::Octree::simdLevel()},
            {"rows", Json::parse(asJson("", table))["rows"]}};
}

/// Both parts together: what they counted, and the worse of what they measured.
Json joined(Json a, const Json& b) {
    for (std::size_t i = 0; i < a["rows"].size(); ++i) {
        Json &row = a["rows"][i], other = b["rows"].at(i);
        if (row["case"] != other["case"])
            throw std::runtime_error("parts differ in their cases: run this family in one");
        row["of"] = row["of"].get<std::uint64_t>() + other["of"].get<std::uint64_t>();
        if (!row.contains("worst"))
            row["wrong"] = row["wrong"].get<std::uint64_t>() + other["wrong"].get<std::uint64_t>();
        else if (!row["worst"].is_null() &&
                 (other["worst"].is_null() || other["worst"] > row["worst"]))
            row["worst"] = other["worst"]; // null: not a number
    }
    a["share"] = a["share"].get<double>() + b["share"].get<double>();
    return a;
}

Table tableOf(const Json& family) {
    Table table;
    for (const Json& row : family["rows"]) {
        const std::string id = row["id"], what = row["case"];
        if (row.contains("worst"))
            table.measure(id, what, row["worst"].is_null() ? NAN : row["worst"].get<double>(),
                          row["limit"], row["unit"], row["of"]);
        else
            table.count(id, what, row["wrong"], row["of"]);
    }
    return table;
}

int campaign(Arguments& arguments) {
    const std::filesystem::path folder = arguments.of("--folder", "build/stability");
    const std::string commit = arguments.of("--commit", "unknown"),
                      only = arguments.of("--only", "");
    Load load;
    load.full = true;
    load.share = std::stod(arguments.of("--share", "1"));
    load.seed = std::stoull(arguments.of("--seed", "1"));
    const std::uint64_t parts = std::stoull(arguments.of("--parts", "1"));
    std::filesystem::create_directories(folder);
    std::string text = "# Numerical stability, measured\n\nMade by `./dev stability`; each family "
                       "says at which commit. What the ids mean: tests/stability/cases.hpp.\n";
    std::size_t rows = 0, missed = 0;
    for (const Case& family : allCases()) {
        const std::filesystem::path file = folder / (std::string(family.id) + ".json");
        if (!only.empty() && only != family.id && !std::filesystem::exists(file)) continue;
        Json result;
        std::uint64_t done = 0;
        if (std::ifstream kept(file); kept) {
            result = Json::parse(kept);
            done = result["parts"];
            std::fprintf(stderr, "%s: %ju parts kept from %s\n", family.id,
                         static_cast<std::uintmax_t>(done), file.c_str());
            if (result["commit"] != commit || !(only.empty() || only == family.id)) done = parts;
        }
        for (; done < parts; ++done) {
            std::fprintf(stderr, "%s: running\n", family.id);
            Load part = load;
            part.share = load.share / static_cast<double>(parts), part.seed = load.seed + done;
            const Json more = measured(family, part, commit);
            result = done ? joined(result, more) : more;
            result["parts"] = done + 1;
            std::ofstream(file) << result.dump(2) << '\n';
        }
        const Table table = tableOf(result);
        std::ostringstream facts;
        facts << "Commit " << result["commit"].get<std::string>() << ", "
              << result["cpu"].get<std::string>() << ", " << result["simd"].get<std::string>()
              << ", seed " << result["seed"];
        if (const std::uint64_t of = result["parts"]; of > 1) facts << " to " << of;
        facts << ", " << 100 * result["share"].get<double>() << " % of the full trials.";
        text += "\n#" + asMarkdown(family.id, facts.str(), table);
        rows += table.rows().size();
        for (const Row& row : table.rows()) {
            if (row.met()) continue;
            ++missed;
            std::fprintf(stderr, "missed: %s %s\n", row.id.c_str(), row.what.c_str());
        }
    }
    text += "\n" + std::to_string(rows - missed) + " of " + std::to_string(rows) +
            " rows meet their target.\n";
    if (const std::string file = arguments.of("--results", ""); !file.empty())
        std::ofstream(file) << text;
    else
        std::fputs(text.c_str(), stdout);
    return missed ? 1 : 0;
}

int anyMesh(Arguments& arguments) {
    Table table;
    const std::string facts =
        checkMesh(arguments.values["--mesh"], std::stoull(arguments.of("--rays", "1000000")),
                  std::stoull(arguments.of("--seed", "1")), table);
    std::fputs(
        (arguments.json ? asJson(facts, table) : asMarkdown("Stability", facts, table)).c_str(),
        stdout);
    for (const Row& row : table.rows())
        if (!row.met()) return 1;
    return 0;
}

int run(int argc, char** argv) {
    Arguments arguments;
    const std::string known[] = {"--folder", "--commit", "--share", "--only", "--results",
                                 "--mesh",   "--rays",   "--seed",  "--parts"};
    for (int i = 1; i < argc; ++i) {
        const std::string name = argv[i];
        if (name == "--json")
            arguments.json = true;
        else if (std::find(std::begin(known), std::end(known), name) != std::end(known) &&
                 i + 1 < argc)
            arguments.values[name] = argv[++i];
        else {
            std::fprintf(stderr, "stability: no option %s, or its value is missing\n", argv[i]);
            return 2;
        }
    }
    return arguments.values.count("--mesh") ? anyMesh(arguments) : campaign(arguments);
}

} // namespace

} // namespace rt::stability

int main(int argc, char** argv) {
    try {
        return rt::stability::run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "stability: %s\n", error.what());
        return 2;
    }
}
