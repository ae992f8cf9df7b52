// What the two legacy grammars share: comments, numbers with named places, recovery after an error.
#pragma once
#include <converters/statements.hpp>

#include <span>

namespace rt::converters {

struct NumberLabel {
    std::string_view name;
    bool whole = false;
};

/// Does it begin like one? `word` is not empty.
bool looksLikeNumber(std::string_view word);

class StatementReader {
public:
    using StartsStatement = bool (*)(std::string_view word);

    StatementReader(Cursor cursorAtStart, bool isLenient, scene::Diagnostics& sink,
                    StartsStatement starts)
        : cursor(std::move(cursorAtStart)), lenient(isLenient), diagnostics(sink),
          startsStatement(starts) {}

    /// Appends one number per label. On failure reports, and returns false when the statement must be dropped.
    /// `inherited`: what the original's variables held, which lenient reading keeps for missing numbers.
    bool numbers(const Word& keyword, std::span<const NumberLabel> labels,
                 std::span<const Number> inherited, std::vector<Number>& out);
    /// A file name, name or mode; reports and returns false when it is missing.
    bool word(const Word& keyword, std::string_view what, Word& out);
    /// After an error: to the next comment, or the next line that does not go on with numbers.
    void recover();
    /// The words up to the next comment or line end, or with `tryEach` up to the next statement; taken.
    std::string takeUnknown(bool tryEach);
    /// Source text from `begin` to here, runs of blanks as one space.
    std::string textSince(std::size_t begin) const { return cursor.textSince(begin); }

    Cursor cursor;
    const bool lenient;
    scene::Diagnostics& diagnostics;
    const StartsStatement startsStatement;
};

/// Comments and statements in turn. `statement(reader)` takes one statement, its keyword included, and returns it,
/// or nothing when it had to be dropped; it must take at least one word.
template <class S, class TakeStatement>
Parsed<S> parseStatements(const std::shared_ptr<const scene::Source>& source,
                          StatementReader& reader, TakeStatement statement) {
    Parsed<S> parsed;
    std::vector<Comment<S>> pending;
    while (!reader.cursor.atEnd()) {
        if (reader.cursor.peek().front() != '#') {
            if (auto taken = statement(reader)) {
                parsed.statements.push_back({std::move(pending), std::move(*taken), std::nullopt});
                pending.clear();
            }
            continue;
        }
        const std::uint32_t previousLine = reader.cursor.lastLine();
        const scene::Location location = reader.cursor.here();
        const std::size_t begin = reader.cursor.offset() + 1;
        Comment<S> comment{std::string(reader.cursor.takeLine().substr(1)), location, std::nullopt};

        scene::Diagnostics ignored;
        StatementReader inner({source,
                               begin,
                               begin + comment.text.size(),
                               {source, location.line, location.column + 1}},
                              false, ignored, reader.startsStatement);
        if (!inner.cursor.atEnd() && inner.startsStatement(inner.cursor.peek())) {
            TakeStatement trial = statement; // leaves the state of the real one alone
            auto commentedOut = trial(inner);
            if (commentedOut && inner.cursor.atEnd() && !ignored.failed())
                comment.statement = std::move(commentedOut);
        }
        const bool besideStatement = !parsed.statements.empty() && pending.empty() &&
                                     !parsed.statements.back().after &&
                                     previousLine == location.line;
        if (besideStatement) {
            parsed.statements.back().after = std::move(comment);
        } else {
            pending.push_back(std::move(comment));
        }
    }
    parsed.tail = std::move(pending);
    return parsed;
}

} // namespace rt::converters
