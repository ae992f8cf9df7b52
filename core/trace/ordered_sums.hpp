// Sums of what many rays contribute, each in the order in which a recursion would have added it.
#pragma once
#include <core/numeric/colour.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace rt::trace {

/// Rounding depends on the order of a sum. Rays that are traced in generations contribute out of
/// order, so their terms wait in a list for each sample until those before them are known.
class OrderedSums {
public:
    using Term = std::uint32_t;

    /// Sums to which terms are added in order.
    void start(std::size_t samples) {
        sums_.assign(samples, {});
        front_.clear();
    }
    /// Sums of terms that wait for each other; term i < samples is the only one of sample i so far.
    void startWaiting(std::size_t samples) {
        sums_.assign(samples, {});
        front_.resize(samples);
        if (terms_.size() < samples) terms_.resize(2 * samples);
        for (Term i = 0; i < samples; ++i) {
            front_[i] = i;
            terms_[i] = {{}, kNone, false};
        }
        free_.clear();
        used_ = samples;
        many_ = samples + kMany;
    }
    /// A new term right behind `term`, whose sample has not been added up to there.
    Term after(Term term) {
        Term added;
        if (!free_.empty()) {
            added = free_.back();
            free_.pop_back();
        } else {
            added = static_cast<Term>(used_++);
            if (added == terms_.size()) terms_.resize(2 * terms_.size());
        }
        Entry* const terms = terms_.data();
        terms[added].next = terms[term].next;
        terms[added].known = false;
        terms[term].next = added;
        return added;
    }
    /// Gives the term its value. None can be placed behind it after the next tidy().
    void settle(Term term, const numeric::LinearRgb& value) {
        Entry& entry = terms_.data()[term];
        entry.value = value;
        entry.known = true;
    }
    /// After start().
    void add(std::uint32_t sample, const numeric::LinearRgb& value) { sums_[sample] += value; }
    /// Where there are many terms: adds those that are complete from the front, for new ones in their place.
    void tidy() {
        if (used_ - free_.size() > many_ && free_.size() < kMany / 4) addUp();
    }
    /// By sample, when all terms are settled.
    std::span<const numeric::LinearRgb> sums() {
        addUp();
        return sums_;
    }

private:
    static constexpr Term kNone = 0xFFFFFFFFu;
    static constexpr std::size_t kMany = 4096;
    struct Entry {
        numeric::LinearRgb value;
        Term next;
        bool known;
    };

    /// One term of each sample in turn: following one list to its end would wait for memory at each step.
    void addUp() {
        active_.resize(front_.size());
        for (std::uint32_t i = 0; i < active_.size(); ++i) active_[i] = i;
        const Entry* const terms = terms_.data();
        while (!active_.empty()) {
            const std::size_t freed = free_.size();
            free_.resize(freed + active_.size());
            Term* const free = free_.data() + freed;
            std::uint32_t* const active = active_.data();
            std::size_t left = 0;
            for (const std::uint32_t sample : active_) {
                const Term term = front_.data()[sample];
                if (term == kNone || !terms[term].known) continue;
                sums_.data()[sample] += terms[term].value;
                front_.data()[sample] = terms[term].next;
                free[left] = term;
                active[left++] = sample;
            }
            active_.resize(left);
            free_.resize(freed + left);
        }
    }

    std::vector<Entry> terms_; // the first used_
    std::size_t used_ = 0, many_ = kMany;
    std::vector<Term> free_;            // of those
    std::vector<Term> front_;           // by sample: the first term not added yet
    std::vector<std::uint32_t> active_; // samples whose next term may be known
    std::vector<numeric::LinearRgb> sums_;
};

} // namespace rt::trace
