// Sums of what the rays of many trees see, in an order that is each tree's own.
#pragma once
#include <core/numeric/colour.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace rt::trace {

/// Rounding depends on the order of a sum, and rays that are traced in generations contribute in the order of
/// their batches. So each path has a term of its own: one of a ray's children goes on with the ray's term, the
/// other branches off. A term is added to the one that it branched off when neither is contributed to any more,
/// later branches first. Which term a ray has, and when, then depends on its own tree alone.
class PathSums {
public:
    using Term = std::uint32_t;

    /// Terms 0 .. samples - 1 are the samples'.
    void start(std::size_t samples) {
        sums_.assign(samples, {});
        from_.resize(samples);
    }
    Term branch(Term from) {
        sums_.emplace_back();
        from_.push_back(from);
        return end() - 1;
    }
    void add(Term term, const numeric::LinearRgb& value) { sums_.data()[term] += value; }
    /// One more than the last term.
    Term end() const { return static_cast<Term>(sums_.size()); }
    /// To the terms from `end` on nothing is added any more.
    void foldTo(Term end) {
        for (std::size_t i = sums_.size(); i-- > end;) add(from_.data()[i], sums_.data()[i]);
        sums_.resize(end);
        from_.resize(end);
    }
    /// By sample, when all else is folded; until the next call.
    std::span<const numeric::LinearRgb> sums() const { return sums_; }

private:
    std::vector<numeric::LinearRgb> sums_; // by term
    std::vector<Term> from_; // likewise: that which it branched off; of samples' nothing
};

} // namespace rt::trace
