// Bytes as a scene: parsed, validated, lowered by the real plugins. Half of the mutations change the tree of nodes instead of the
// text, so that keys and values meet which no change of bytes would bring together.
#include <core/plugin_host/lower.hpp>
#include <core/scene/full.hpp>
#include <core/scene/validate.hpp>
#include <formats/yaml_reader.hpp>
#include <formats/yaml_writer.hpp>

#include <cstdlib>
#include <cstring>
#include <random>

namespace {

using namespace rt;
using scene::Node;

constexpr scene::Limits kLimits{
    .pixels = 1 << 20, .texturePixels = 1 << 16, .primitives = 20'000, .nodes = 20'000};

void require(bool holds) {
    if (!holds) std::abort();
}

/// The folder does not exist, so that no file is read.
std::shared_ptr<const scene::Source> sourceOf(std::string text) {
    return std::make_shared<scene::Source>(
        scene::Source{"/nowhere/at/all/scene.yaml", std::move(text)});
}

void requireWords(const scene::Diagnostics& diagnostics) {
    for (const scene::Diagnostic& each : diagnostics.all())
        require(!each.message.empty() && scene::format(each, true).ends_with('\n') &&
                !scene::formatJson(each).empty());
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static plugin_host::Catalog catalog({RT_FUZZ_PLUGINS});
    scene::Diagnostics diagnostics;
    const auto root = formats::parseYaml(sourceOf({reinterpret_cast<const char*>(data), size}),
                                         diagnostics, kLimits);
    require(root.has_value() != diagnostics.failed());
    if (root) {
        const auto description = scene::validate(*root, catalog, diagnostics, kLimits);
        require(description.has_value() != diagnostics.failed());
        if (description) {
            const auto full = formats::writeYaml(scene::fullScene(*description));
            scene::Diagnostics second; // what it says in full is the same scene
            const auto again = formats::parseYaml(sourceOf(full), second);
            require(again && scene::validate(*again, catalog, second));
            const auto world =
                plugin_host::lower(*description, catalog, diagnostics, {.limits = kLimits});
            require(world.has_value() != diagnostics.failed());
        }
    }
    requireWords(diagnostics);
    return 0;
}

#ifdef RT_FUZZ
// ---- mutations of the tree -----------------------------------------------------------------------------------

namespace {

void collect(Node& node, std::vector<Node*>& nodes) {
    nodes.push_back(&node);
    for (Node& item : node.items) collect(item, nodes);
    for (Node::Member& member : node.members) collect(member.value, nodes);
}

constexpr const char* kHostile[] = {
    "nan",        ".inf",        "1e308",    "-1e308", "5e-324", "-0.0",   "0",
    "-1",         "1",           "1e18",     "1e19",   "65536",  "46341",  "010",
    "4294967296", "true",        "null",     "90deg",  "0deg",   "1e9rad", "\"#ff8000\"",
    "",           "../../a.obj", "\x1b[31m", "smooth", "sphere"};

Node hostileScalar(std::minstd_rand& random) {
    Node node;
    node.kind = Node::Kind::scalar;
    node.text = kHostile[random() % std::size(kHostile)];
    node.quoted = random() % 4 == 0;
    return node;
}

void mutate(Node& root, std::minstd_rand& random) {
    std::vector<Node*> nodes;
    collect(root, nodes);
    Node& target = *nodes[random() % nodes.size()];
    const Node other = *nodes[random() % nodes.size()]; // a copy: it may hold the target
    switch (random() % 6) {
    case 0:
        target = hostileScalar(random);
        break;
    case 1:
        target = other;
        break;
    case 2:
        if (!target.items.empty())
            target.items.erase(target.items.begin() + random() % target.items.size());
        if (!target.members.empty())
            target.members.erase(target.members.begin() + random() % target.members.size());
        break;
    case 3:
        if (target.kind == Node::Kind::sequence) target.items.push_back(other);
        break;
    case 4: // a key of one map in another
        if (!target.members.empty() && !other.members.empty())
            target.members[random() % target.members.size()].key =
                other.members[random() % other.members.size()].key;
        break;
    default:
        if (target.kind == Node::Kind::map && !other.members.empty())
            target.members.push_back(other.members[random() % other.members.size()]);
    }
}

} // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t maxSize);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t maxSize, unsigned seed) {
    std::minstd_rand random(seed);
    if (random() % 2 == 0) return LLVMFuzzerMutate(data, size, maxSize);
    scene::Diagnostics ignored;
    auto root =
        formats::parseYaml(sourceOf({reinterpret_cast<const char*>(data), size}), ignored, kLimits);
    if (!root) return LLVMFuzzerMutate(data, size, maxSize);
    for (unsigned i = random() % 3 + 1; i > 0; --i) mutate(*root, random);
    const std::string text = formats::writeYaml(*root);
    if (text.size() > maxSize) return LLVMFuzzerMutate(data, size, maxSize);
    std::memcpy(data, text.data(), text.size());
    return text.size();
}
#endif
