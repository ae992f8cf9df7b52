#include <core/trace/ray_tree.hpp>

#include <core/trace/camera.hpp>
#include <core/trace/media.hpp>
#include <core/trace/tone.hpp>
#include <core/trace/whitted.hpp>

#include <algorithm>

namespace rt::trace {
namespace {

using Node = RayTree::Node;

/// Writes down what the kernel does; the kernel is the one that renders.
class TreeObserver {
public:
    static constexpr bool kActive = true;

    TreeObserver(RayTree& tree, const world::World& world) : tree_(tree), world_(world) {}

    std::vector<geometry::ObjectId> mediaOfPrimary;

    std::uint32_t primary(const Work& work, const geometry::Ray& ray) {
        const auto number = static_cast<std::uint32_t>(tree_.nodes.size());
        Node node{};
        node.parent = number;
        node.kind = RayTree::Kind::primary;
        node.weight = work.weight;
        node.origin = ray.origin, node.direction = ray.direction;
        node.media = mediaOfPrimary;
        tree_.nodes.push_back(std::move(node));
        return number;
    }

    std::uint32_t child(const Work& parent, std::uint32_t depth, const LinearRgb& weight,
                        RayKind kind, Fate fate) {
        const auto number = static_cast<std::uint32_t>(tree_.nodes.size());
        Node node{};
        node.parent = parent.node;
        node.kind =
            kind == RayKind::reflected ? RayTree::Kind::reflected : RayTree::Kind::refracted;
        node.fate = static_cast<RayTree::Fate>(fate);
        node.depth = depth;
        node.weight = weight;
        node.media = tree_.nodes[parent.node].media;
        tree_.nodes.push_back(std::move(node));
        tree_.nodes[parent.node].children.push_back(number);
        return number;
    }

    /// A child ray starts.
    void starts(std::uint32_t number, const geometry::Ray& ray) {
        Node& node = tree_.nodes[number];
        node.origin = ray.origin, node.direction = ray.direction;
    }

    void transmitted(std::uint32_t number, const Facing& facing, const Coincident* also) {
        auto& media = tree_.nodes[number].media;
        if (facing.surface.solid) cross(media, facing.surface.object, facing.leaving);
        if (!also) return;
        for (const auto object : also->leftSolids) cross(media, object, true);
        for (const auto object : also->enteredSolids) cross(media, object, false);
    }

    void miss(const Work& work, const LinearRgb& seen) { tree_.nodes[work.node].local = seen; }

    void hit(const Work& work, const geometry::Hit& hit, const Facing& facing,
             const material::Material&, const LinearRgb& color) {
        Node& node = tree_.nodes[work.node];
        node.hit = true;
        node.t = hit.t;
        node.primitive = hit.id;
        node.object = facing.surface.object;
        node.material = facing.surface.material;
        node.sourceFace = geometry::sourceFaceOf(world_.primitives, hit.id);
        node.position = facing.surface.position;
        node.normal = facing.normal;
        node.leaving = facing.leaving;
        node.color = color;
    }

    void light(const Work& work, const Light& light, const LinearRgb& visible,
               const LinearRgb& added) {
        Node& node = tree_.nodes[work.node];
        node.lights.push_back({light.index, visible, added});
        node.local += added;
    }

private:
    static void cross(std::vector<geometry::ObjectId>& media, geometry::ObjectId object,
                      bool leaving) {
        const auto inside = std::find(media.begin(), media.end(), object);
        if (!leaving)
            media.push_back(object);
        else if (inside != media.end())
            media.erase(inside);
    }

    RayTree& tree_;
    const world::World& world_;
};

LinearRgb ratio(const LinearRgb& a, const LinearRgb& b) {
    return {b.r != 0 ? a.r / b.r : 0, b.g != 0 ? a.g / b.g : 0, b.b != 0 ? a.b / b.b : 0};
}

/// Children have higher numbers than their parents.
void sumUp(std::vector<Node>& nodes, std::size_t first) {
    for (std::size_t i = nodes.size(); i-- > first;) {
        nodes[i].seen += nodes[i].local;
        if (nodes[i].parent != i)
            nodes[nodes[i].parent].seen +=
                ratio(nodes[i].weight, nodes[nodes[i].parent].weight) * nodes[i].seen;
    }
}

} // namespace

RayTree tracePixel(const octree::Octree& octree, const world::World& world,
                   const scene::Description& description, std::uint32_t x, std::uint32_t y) {
    const scene::Render& settings = description.render;
    const Stage stage(octree, world, description);
    const Camera camera(description.camera, description.image.width, description.image.height,
                        settings.nearPlane);
    std::uint32_t n = 1;
    double first = settings.sampling == scene::Sampling::center ? 0.5 : 0;
    if (std::holds_alternative<scene::AntialiasFsaa4>(settings.antialias)) n = 2;
    if (const auto* grid = std::get_if<scene::AntialiasGrid>(&settings.antialias)) n = grid->n;
    if (std::holds_alternative<scene::AntialiasMaxError>(settings.antialias)) first = 0.5;

    RayTree tree;
    TreeObserver observer(tree, world);
    Scratch scratch;
    RayCounts counts;
    for (std::uint32_t row = 0; row < n; ++row)
        for (std::uint32_t column = 0; column < n; ++column) {
            RayTree::Sample sample{x + (column + first) / n, y + (row + first) / n, {}, {}, {}};
            geometry::Ray ray = camera.through(sample.column, sample.row);
            if (stage.box.clip(ray)) {
                observer.mediaOfPrimary = mediaAt(stage, ray.origin);
                sample.root = static_cast<std::uint32_t>(tree.nodes.size());
                if (stage.transmits)
                    sample.light = Whitted<Features{true, Counting::none}, TreeObserver>(
                                       stage, scratch, counts, observer)
                                       .radiance({&ray, 1})
                                       .front();
                else
                    sample.light = Whitted<Features{false, Counting::none}, TreeObserver>(
                                       stage, scratch, counts, observer)
                                       .radiance({&ray, 1})
                                       .front();
                sumUp(tree.nodes, *sample.root);
                sample.toned = toned(sample.light, description.image.tone);
            }
            tree.pixel += sample.toned;
            tree.samples.push_back(sample);
        }
    tree.pixel *= 1.0 / (double(n) * n);
    return tree;
}

} // namespace rt::trace
