// Sums of what many rays contribute, each in the order in which a recursion would have added it.
#pragma once
#include <core/numeric/colour.hpp>

#include <cstdint>
#include <vector>

namespace rt::trace {

/// Rounding depends on the order of a sum. Rays that are traced in generations contribute out of
/// order, so their terms wait in a list for each sample; what is complete from the front is added.
class OrderedSums {
public:
    using Term = std::uint32_t;

    void start(std::size_t samples) {
        terms_.clear();
        sums_.assign(samples, {});
        front_.assign(samples, kNone);
        free_ = kNone;
    }
    /// The only term of a sample so far.
    Term first(std::uint32_t sample) { return front_[sample] = fresh(kNone); }
    /// A new term right behind `term`, which is not settled.
    Term after(Term term) {
        const Term added = fresh(terms_[term].next);
        terms_[term].next = added;
        return added;
    }
    /// Gives the term its value. None can be placed behind it any more.
    void settle(std::uint32_t sample, Term term, const numeric::LinearRgb& value) {
        terms_[term].value = value;
        terms_[term].known = true;
        Term& front = front_[sample];
        while (front != kNone && terms_[front].known) {
            sums_[sample] += terms_[front].value;
            const Term next = terms_[front].next;
            terms_[front].next = free_;
            free_ = front;
            front = next;
        }
    }
    /// To a sample without terms.
    void add(std::uint32_t sample, const numeric::LinearRgb& value) { sums_[sample] += value; }
    /// By sample.
    const std::vector<numeric::LinearRgb>& sums() const { return sums_; }

private:
    static constexpr Term kNone = 0xFFFFFFFFu;
    struct Entry {
        numeric::LinearRgb value;
        Term next;
        bool known;
    };
    Term fresh(Term next) {
        if (free_ == kNone) {
            terms_.push_back({{}, next, false});
            return static_cast<Term>(terms_.size() - 1);
        }
        const Term term = free_;
        free_ = terms_[term].next;
        terms_[term] = {{}, next, false};
        return term;
    }

    std::vector<Entry> terms_;
    std::vector<Term> front_; // by sample: the first term not added yet
    std::vector<numeric::LinearRgb> sums_;
    Term free_ = kNone;
};

} // namespace rt::trace
