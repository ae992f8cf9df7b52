// A plain tree of boxes over primitives, for tracers that must not depend on the octree.
#pragma once
#include <core/report/vector.hpp>

#include <core/numeric/box.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace rt::report {

/// Boxes are widened by far more than any rounding of Real, so that they decide nothing.
template <class Real> class Boxes {
public:
    explicit Boxes(const std::vector<numeric::Box3d>& bounds) {
        order_.resize(bounds.size());
        for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
        if (order_.empty()) return;
        nodes_.emplace_back();
        fill(0, bounds, 0, static_cast<std::uint32_t>(order_.size()));
    }

    /// Calls test(primitive, limit), which may lower the limit, for all that the ray may meet before it.
    template <class Test>
    void visit(const Vector<Real>& origin, const Vector<Real>& direction, Real limit,
               const Test& test) const {
        if (nodes_.empty()) return;
        Scalar o[3], inverse[3];
        for (int i = 0; i < 3; ++i) {
            o[i] = static_cast<Scalar>(origin[i]);
            inverse[i] = 1 / static_cast<Scalar>(direction[i]);
        }
        std::uint32_t stack[64], depth = 0; // halving 2^32 primitives needs 33
        stack[depth++] = 0;
        while (depth > 0) {
            const Node& node = nodes_[stack[--depth]];
            Scalar enter = 0, leave = static_cast<Scalar>(limit) * kWiden;
            for (int i = 0; i < 3; ++i) {
                const Scalar a = (node.low[i] - o[i]) * inverse[i],
                             b = (node.high[i] - o[i]) * inverse[i];
                // Written so that a NaN, 0 times infinity, leaves things as they are.
                const Scalar first = a < b ? a : b, last = a < b ? b : a;
                enter = first > enter ? first : enter;
                leave = last < leave ? last : leave;
            }
            if (!(enter <= leave * kWiden)) continue;
            if (node.count) {
                for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
                    test(order_[i], limit);
            } else {
                const bool swapped = inverse[node.axis] < 0;
                stack[depth++] = swapped ? node.first - 1 : node.first;
                stack[depth++] = swapped ? node.first : node.first - 1;
            }
        }
    }

private:
    using Scalar = std::conditional_t<std::is_same_v<Real, float>, float, double>;
    static constexpr Scalar kWiden = 1 + static_cast<Scalar>(4096 * dataRoundoffOf<Real>());

    struct Node {
        Scalar low[3], high[3];
        std::uint32_t
            first; // leaf: into order_; else the second child, the first is just before it
        std::uint16_t count, axis;
    };

    void fill(std::uint32_t index, const std::vector<numeric::Box3d>& bounds, std::uint32_t from,
              std::uint32_t to) {
        numeric::Box3d box, centres;
        for (std::uint32_t i = from; i < to; ++i)
            box.add(bounds[order_[i]]), centres.add(bounds[order_[i]].centre());
        const numeric::Vec3 extent = centres.diagonal();
        const int axis =
            extent.x > extent.y ? (extent.x > extent.z ? 0 : 2) : (extent.y > extent.z ? 1 : 2);
        const double widen = 64 * dataRoundoffOf<Real>() *
                             (numeric::maxComponent(numeric::abs(box.min)) +
                              numeric::maxComponent(numeric::abs(box.max)));
        for (int i = 0; i < 3; ++i) {
            nodes_[index].low[i] = static_cast<Scalar>(box.min[i] - widen);
            nodes_[index].high[i] = static_cast<Scalar>(box.max[i] + widen);
        }
        constexpr std::uint32_t kLeaf = 4;
        if (to - from <= kLeaf) {
            nodes_[index].first = from;
            nodes_[index].count = static_cast<std::uint16_t>(to - from);
            nodes_[index].axis = 0;
            return;
        }
        const std::uint32_t middle = from + (to - from) / 2;
        std::nth_element(order_.begin() + from, order_.begin() + middle, order_.begin() + to,
                         [&](std::uint32_t a, std::uint32_t b) {
                             return bounds[a].centre()[axis] < bounds[b].centre()[axis];
                         });
        const auto children = static_cast<std::uint32_t>(nodes_.size());
        nodes_.resize(children + 2);
        nodes_[index].first = children + 1;
        nodes_[index].count = 0;
        nodes_[index].axis = static_cast<std::uint16_t>(axis);
        fill(children, bounds, from, middle);
        fill(children + 1, bounds, middle, to);
    }

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_;
};

} // namespace rt::report
