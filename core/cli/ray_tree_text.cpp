#include <core/cli/ray_tree_text.hpp>

#include <array>
#include <charconv>

namespace rt::cli {

namespace {

using Node = trace::RayTree::Node;

std::string spelled(double value) {
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value,
                                       std::chars_format::general, 6)
                             .ptr};
}

std::string spelled(const numeric::Vec3& v) {
    return "[" + spelled(v.x) + ", " + spelled(v.y) + ", " + spelled(v.z) + "]";
}

std::string spelled(const numeric::LinearRgb& c) {
    if (c.r == c.g && c.g == c.b) return spelled(c.r);
    return "(" + spelled(c.r) + ", " + spelled(c.g) + ", " + spelled(c.b) + ")";
}

const char* kindName(Node const& node) {
    switch (node.kind) {
    case trace::RayTree::Kind::primary:
        return "primary";
    case trace::RayTree::Kind::reflected:
        return "reflected";
    case trace::RayTree::Kind::refracted:
        return "refracted";
    }
    return "?";
}

class Writer {
public:
    Writer(const trace::RayTree& tree, const world::World& world,
           const scene::Description& description)
        : tree_(tree), world_(world), description_(description) {}

    void ray(std::uint32_t number, std::size_t indent) {
        const Node& node = tree_.nodes[number];
        line(indent, std::string(kindName(node)) + " ray, weight " + spelled(node.weight) +
                         ", from " + spelled(node.origin) + " along " + spelled(node.direction));
        indent += 2;
        if (!node.media.empty()) {
            std::string names;
            for (const geometry::ObjectId object : node.media)
                names += (names.empty() ? "" : ", ") + objectName(object);
            line(indent, "travels in " + names);
        }
        switch (node.fate) {
        case trace::RayTree::Fate::nothingToAdd:
            return line(indent, "not traced: its weight is 0");
        case trace::RayTree::Fate::cutByDepth:
            return line(indent,
                        "not traced: render.depth is " + std::to_string(description_.render.depth));
        case trace::RayTree::Fate::cutByContribution:
            return line(indent,
                        "not traced: below render.cutoff, " + spelled(description_.render.cutoff));
        case trace::RayTree::Fate::traced:
            break;
        }
        if (!node.hit) return line(indent, "meets the background: " + spelled(node.seen));
        std::string what = objectName(node.object);
        if (node.sourceFace) what += ", face " + std::to_string(node.sourceFace);
        line(indent, std::string(node.leaving ? "leaves " : "meets ") + what + " at t " +
                         spelled(node.t) + ", " + spelled(node.position));
        line(indent, "normal " + spelled(node.normal) + ", material " +
                         world_.materialNames[static_cast<std::uint32_t>(node.material)] +
                         ", color " + spelled(node.color));
        for (const trace::RayTree::LightShare& share : node.lights) {
            const std::string& name = description_.lights[share.light].name;
            line(indent,
                 "light " + (name.empty() ? std::to_string(share.light) : name) +
                     (share.visible.isBlack() ? ": in shadow"
                                              : ": arrives with " + spelled(share.visible)) +
                     ", adds " + spelled(share.added));
        }
        for (const std::uint32_t child : node.children) ray(child, indent);
        line(indent,
             "own light " + spelled(node.local) + ", with what its rays add " + spelled(node.seen));
    }

    void line(std::size_t indent, const std::string& content) {
        text += std::string(indent, ' ') + content + "\n";
    }

    std::string text;

private:
    std::string objectName(geometry::ObjectId object) const {
        return world_.objectNames[static_cast<std::uint32_t>(object)];
    }

    const trace::RayTree& tree_;
    const world::World& world_;
    const scene::Description& description_;
};

} // namespace

std::string rayTreeText(const trace::RayTree& tree, std::uint32_t x, std::uint32_t y,
                        const world::World& world, const scene::Description& description) {
    Writer writer(tree, world, description);
    writer.line(0, "pixel " + std::to_string(x) + "," + std::to_string(y) + ": " +
                       spelled(tree.pixel) +
                       (tree.samples.size() == 1
                            ? std::string()
                            : ", the mean of " + std::to_string(tree.samples.size()) + " samples"));
    for (const trace::RayTree::Sample& sample : tree.samples) {
        writer.line(0, "sample at column " + spelled(sample.column) + ", row " +
                           spelled(sample.row) + ": light " + spelled(sample.light) +
                           ", drawn as " + spelled(sample.toned));
        if (sample.root)
            writer.ray(*sample.root, 2);
        else
            writer.line(2, "its ray never enters the scene's bounds");
    }
    return writer.text;
}

} // namespace rt::cli
