#include <converters/statement_reader.hpp>

namespace rt::converters {
namespace {

using scene::Code;
using scene::quoted;

std::string plural(std::size_t count, std::string_view thing) {
    return std::to_string(count) + " " + std::string(thing) + (count == 1 ? "" : "s");
}

std::string missing(std::span<const NumberLabel> labels) {
    std::string text = "'" + std::string(labels.front().name) + "'";
    if (labels.size() == 2) text += " and '" + std::string(labels[1].name) + "'";
    if (labels.size() > 2) text += " and " + plural(labels.size() - 1, "more number");
    return text + (labels.size() == 1 ? " is missing" : " are missing");
}

} // namespace

bool looksLikeNumber(std::string_view word) {
    const std::size_t sign = word.front() == '-' || word.front() == '+' ? 1 : 0;
    return word.size() > sign && ((word[sign] >= '0' && word[sign] <= '9') || word[sign] == '.');
}

bool StatementReader::numbers(const Word& keyword, std::span<const NumberLabel> labels,
                              std::span<const Number> inherited, std::vector<Number>& out) {
    const std::string statement = quoted(keyword.text);
    for (std::size_t i = 0; i < labels.size(); ++i) {
        const std::string label = "'" + std::string(labels[i].name) + "'";
        const std::string found(cursor.peek());
        const scene::Location place = cursor.here();
        Number number;
        const auto reading = cursor.number(labels[i].whole, number);
        if (reading == Cursor::Reading::outOfRange) {
            diagnostics.error(Code{384}, place,
                              statement + ", " + label + ": " + quoted(found) + " is out of range");
            return false;
        }
        if (reading == Cursor::Reading::number) {
            const std::string whole(cursor.insideWord() ? cursor.wordAround() : std::string_view{});
            const bool glued = cursor.insideWord() && cursor.peek().front() != '#';
            if (glued && !lenient) {
                diagnostics.error(labels[i].whole ? Code{382} : Code{381}, place,
                                  statement + ", " + label + ": " + quoted(whole) + " is not a " +
                                      (labels[i].whole ? "whole number" : "number"));
                return false;
            }
            out.push_back(number);
            continue;
        }

        const auto rest = labels.subspan(i);
        if (lenient) {
            if (inherited.size() < labels.size()) {
                diagnostics.error(Code{383}, keyword.location,
                                  statement + ": " + missing(rest) +
                                      ", and no earlier statement has set " +
                                      (rest.size() == 1 ? "it" : "them"));
                return false;
            }
            diagnostics.note(
                keyword.location, statement + ": " + missing(rest) + "; kept from before: " + [&] {
                    std::string values;
                    for (std::size_t k = i; k < labels.size(); ++k)
                        values += (k == i ? "" : " ") + shortest(inherited[k].value);
                    return values;
                }());
            out.insert(out.end(), inherited.begin() + static_cast<std::ptrdiff_t>(i),
                       inherited.begin() + static_cast<std::ptrdiff_t>(labels.size()));
            return true;
        }
        if (found.empty()) {
            diagnostics.error(Code{383}, keyword.location,
                              statement + " ends with the file: " + missing(rest));
        } else if (found.front() == '#') {
            diagnostics.error(Code{383}, place,
                              "this comment ends " + statement + " early: " + missing(rest));
        } else if (startsStatement(found) && cursor.firstOnLine()) {
            diagnostics.error(Code{383}, keyword.location,
                              statement + " is not complete: " + missing(rest));
        } else {
            diagnostics.error(Code{381}, place,
                              statement + ", " + label + ": " + quoted(found) + " is not a number");
        }
        return false;
    }
    return true;
}

bool StatementReader::word(const Word& keyword, std::string_view what, Word& out) {
    const std::string_view found = cursor.peek();
    const bool absent =
        found.empty() || found.front() == '#' || (startsStatement(found) && cursor.firstOnLine());
    if (found.empty() || (absent && !lenient)) {
        diagnostics.error(Code{386}, keyword.location,
                          quoted(keyword.text) + ": the " + std::string(what) + " is missing");
        return false;
    }
    if (absent) {
        diagnostics.note(cursor.here(), quoted(keyword.text) + " takes the word that follows, " +
                                            quoted(found) + ", for its " + std::string(what));
    }
    out = cursor.take();
    return true;
}

void StatementReader::recover() {
    while (!cursor.atEnd()) {
        const std::string_view next = cursor.peek();
        if (next.front() == '#') return;
        if (cursor.firstOnLine() && (startsStatement(next) || !looksLikeNumber(next))) return;
        cursor.take();
    }
}

std::string StatementReader::takeUnknown(bool tryEach) {
    cursor.peek();
    const std::size_t begin = cursor.offset();
    cursor.take();
    while (!cursor.atEnd()) {
        const std::string_view next = cursor.peek();
        if (next.front() == '#' || cursor.firstOnLine() || (tryEach && startsStatement(next)))
            break;
        cursor.take();
    }
    return cursor.textSince(begin);
}

} // namespace rt::converters
