// A legacy text file and a cursor over it that reads as the original did: blank-separated words, scanf numbers.
#pragma once
#include <core/scene/diagnostic.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace rt::converters {

/// The file as UTF-8 with every line ending in '\n'; other encodings are converted, with a note. Null after an error:
/// those of scene::readSource, and E0410 where it is no text.
std::shared_ptr<const scene::Source>
readText(const std::string& path, const scene::Location& namedAt, scene::Diagnostics& diagnostics);

/// The same for bytes that are in memory already.
std::shared_ptr<const scene::Source> toText(std::string path, std::string bytes,
                                            scene::Diagnostics& diagnostics);

struct Word {
    std::string text;
    scene::Location location;
};

struct Number {
    double value = 0;
    scene::Location location;
};

class Cursor {
public:
    explicit Cursor(std::shared_ptr<const scene::Source> source);
    /// Reads only [begin, end) of `source`, whose place is `start`.
    Cursor(std::shared_ptr<const scene::Source> source, std::size_t begin, std::size_t end,
           const scene::Location& start);

    /// The next word without taking it; empty at the end.
    std::string_view peek();
    Word take();
    bool atEnd() { return peek().empty(); }

    enum class Reading : std::uint8_t { number, notANumber, notWhole, outOfRange };
    /// As scanf's %lf or %d: the longest prefix of the next word that is a number. The rest of the word stays.
    /// Anything but `number` takes nothing.
    Reading number(bool whole, Number& out);
    /// Is the cursor inside a word, after a number that did not end at a blank?
    bool insideWord() const;
    /// The whole word around the cursor, already taken part included.
    std::string_view wordAround() const;

    /// The rest of the line, without its end.
    std::string_view takeLine();
    scene::Location here(); // of the next word
    std::size_t offset() const { return offset_; }
    /// Source text from `begin` to the end of what was taken, runs of blanks as one space.
    std::string textSince(std::size_t begin) const;
    std::uint32_t lastLine() const { return lastLine_; } // of what was taken last
    bool firstOnLine();                                  // is the next word the first of its line?

private:
    void skipBlanks();
    void advance(std::size_t count);

    std::shared_ptr<const scene::Source> source_;
    std::string_view text_;
    std::size_t begin_, offset_, end_;
    std::uint32_t line_, column_, lastLine_;
};

/// Shortest decimal text that reads back as the same binary64.
std::string shortest(double value);

} // namespace rt::converters
